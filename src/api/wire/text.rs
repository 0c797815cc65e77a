//! Ids, times and numbers: how they are written on the wire and read from it.
//!
//! Main functions: [`job_name`], [`worker_name`], [`time_text`], [`round3`] and their reverse. Jobs are "j17", workers
//! "w1", assignments "a1", closures "c1". Refuses: to look anything up.

use giveway_floor::id::{AssignmentId, ClosureId, JobId, SeriesId, WorkerId};
use giveway_floor::time::{Span, Time};

/// A job's name on the wire.
pub fn job_name(id: JobId) -> String {
    format!("j{}", id.0)
}

/// A job's number from its name; nothing if the text is no such name.
pub fn parse_job_name(text: &str) -> Option<JobId> {
    number(text, "j").map(JobId)
}

/// A time as RFC 3339 in UTC.
pub fn time_text(t: Time) -> String {
    jiff::Timestamp::from_microsecond(t.0).map_or_else(|_| "out of range".into(), |t| t.to_string())
}

/// A time from RFC 3339 with any offset, up to [`LATEST`].
pub fn parse_time(text: &str) -> Option<Time> {
    text.parse::<jiff::Timestamp>().ok().map(|t| Time(t.as_microsecond()))
}

/// The latest time.
pub const LATEST: &str = "9999-12-30T22:00:00Z";

/// Whether a text is a time later than the latest one: business systems write 9999-12-31T23:59:59Z for "never".
pub fn is_never(text: &str) -> bool {
    let pieces = jiff::fmt::temporal::Pieces::parse(text);
    let last = jiff::Timestamp::MAX.to_zoned(jiff::tz::TimeZone::UTC).date();
    let is_late =
        |p: jiff::fmt::temporal::Pieces<'_>| p.time().is_some() && p.offset().is_some() && p.date() >= last;
    parse_time(text).is_none() && pieces.is_ok_and(is_late)
}

/// An offset from UTC such as +01:00.
pub fn offset_text(offset: Span) -> String {
    let minutes = offset.0 / 60_000_000;
    let sign = if minutes < 0 { '-' } else { '+' };
    format!("{sign}{:02}:{:02}", minutes.abs() / 60, minutes.abs() % 60)
}

/// Reads an offset from UTC: +01:00, -05:30 or Z; at most a day.
pub fn parse_offset(text: &str) -> Option<Span> {
    if text == "Z" {
        return Some(Span::ZERO);
    }
    let sign = match text.as_bytes().first()? {
        b'+' => 1,
        b'-' => -1,
        _ => return None,
    };
    let of_day = parse_time_of_day(text.get(1..)?)?;
    Some(of_day * sign)
}

/// Reads a time of day, HH:MM, as the time since midnight.
pub fn parse_time_of_day(text: &str) -> Option<Span> {
    let (hours, minutes) = text.split_once(':')?;
    let digits = |t: &str| t.len() == 2 && t.bytes().all(|b| b.is_ascii_digit());
    if !digits(hours) || !digits(minutes) {
        return None;
    }
    let (hours, minutes): (i64, i64) = (hours.parse().ok()?, minutes.parse().ok()?);
    (hours < 24 && minutes < 60).then(|| Span::from_secs(hours * 3600 + minutes * 60))
}

/// Rounded to a thousandth; never minus zero, and never a value that JSON cannot express.
pub fn round3(x: f64) -> f64 {
    let rounded = (x * 1000.0).round() / 1000.0;
    if rounded.is_finite() { rounded + 0.0 } else { 0.0 }
}

/// A worker's number on the wire.
pub fn worker_name(id: WorkerId) -> String {
    format!("w{}", id.0 + 1)
}

/// An assignment's number on the wire.
pub fn assignment_name(id: AssignmentId) -> String {
    format!("a{}", id.0)
}

/// A closure's number on the wire.
pub fn closure_name(id: ClosureId) -> String {
    format!("c{}", id.0)
}

/// The number of a recurring closure on the wire.
pub fn series_name(id: SeriesId) -> String {
    format!("s{}", id.0)
}

/// The number of a recurring closure.
pub fn parse_series(text: &str) -> Option<SeriesId> {
    number(text, "s").map(SeriesId)
}

/// An alarm's number on the wire.
pub fn alarm_name(id: u64) -> String {
    format!("al{id}")
}

/// An alarm's number.
pub fn parse_alarm(text: &str) -> Option<u64> {
    number(text, "al")
}

/// A token's number on the wire.
pub fn token_name(id: i64) -> String {
    format!("t{id}")
}

/// A token's number.
pub fn parse_token_name(text: &str) -> Option<i64> {
    number(text, "t").and_then(|id| i64::try_from(id).ok())
}

/// The number after these letters, from 1 on.
fn number(text: &str, letters: &str) -> Option<u64> {
    let digits = text.strip_prefix(letters)?;
    let plain = digits.bytes().all(|b| b.is_ascii_digit()) && !digits.starts_with('0');
    if plain { digits.parse().ok() } else { None }
}

/// An assignment's number.
pub fn parse_assignment(text: &str) -> Option<AssignmentId> {
    number(text, "a").map(AssignmentId)
}

/// A closure's number.
pub fn parse_closure(text: &str) -> Option<ClosureId> {
    number(text, "c").map(ClosureId)
}

/// A worker's number from its name; nothing if the text is no such name.
pub fn parse_worker_name(text: &str) -> Option<WorkerId> {
    number(text, "w").and_then(|n| u32::try_from(n - 1).ok()).map(WorkerId)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_and_times_of_day_are_read_strictly() {
        for (text, minutes) in [("+01:00", 60), ("-05:30", -330), ("Z", 0), ("+00:00", 0)] {
            assert_eq!(parse_offset(text), Some(Span::from_secs(minutes * 60)), "{text}");
        }
        assert_eq!(offset_text(Span::from_secs(-330 * 60)), "-05:30");
        assert_eq!(parse_time_of_day("22:15"), Some(Span::from_secs(80_100)));
        for bad in ["1:00", "24:00", "12:60", "12", "", "+1:00", "ab:cd"] {
            assert_eq!((parse_time_of_day(bad), parse_offset(bad)), (None, None), "{bad}");
        }
    }

    #[test]
    fn the_never_of_business_systems_is_known_and_times_that_cannot_be_are_not_taken_for_it() {
        for text in [
            "9999-12-31T23:59:59Z",
            "9999-12-31T00:00:00Z",
            "9999-12-31T23:59:59.9999999Z",
            "9999-12-31T23:59:59+01:00",
            "9999-12-30T23:00:00Z",
        ] {
            assert!(is_never(text) && parse_time(text).is_none(), "{text}");
        }
        for text in [LATEST, "9999-12-30T21:59:59Z", "9999-12-31T00:00:00+14:00", "2027-01-31T12:00:00Z"] {
            assert!(!is_never(text) && parse_time(text).is_some(), "{text}");
        }
        for text in [
            "",
            "never",
            "9999-12-31",
            "9999-12-31T23:59:59",
            "9999-13-31T00:00:00Z",
            "10000-01-01T00:00:00Z",
        ] {
            assert!(!is_never(text) && parse_time(text).is_none(), "{text}");
        }
    }

    #[test]
    fn numbers_behind_letters_are_read_strictly() {
        assert_eq!((number("w12", "w"), parse_alarm("al17")), (Some(12), Some(17)));
        for bad in ["w0", "w", "12", "w-1", "w01", "a1", "w99999999999999999999", "w1 "] {
            assert_eq!(number(bad, "w"), None, "{bad}");
        }
    }
}
