//! Times as messages have them: ISO 8601, as microseconds since 1970 in UTC.
//!
//! Main functions: [`text`], [`of_text`]. Refuses: clocks; years of which ISO 8601 says nothing without agreement.

/// Microseconds of a second and of a day.
const SECOND_US: i64 = 1_000_000;
const DAY_US: i64 = 86_400 * SECOND_US;
/// The first and last instants that are written: those of the years 1970 and 9999.
const FIRST_US: i64 = 0;
const LAST_US: i64 = 2_932_896 * DAY_US + DAY_US - 1;
/// The longest text that is read, characters.
const LONGEST: usize = 40;

/// A time in UTC, with milliseconds. What is beyond the years that can be written is their first or last instant.
pub(crate) fn text(at_us: i64) -> String {
    let at_us = at_us.clamp(FIRST_US, LAST_US);
    let (year, month, day) = date(at_us / DAY_US);
    let ms = at_us % DAY_US / 1_000;
    let (hour, minute, second) = (ms / 3_600_000, ms / 60_000 % 60, ms / 1_000 % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}.{:03}Z", ms % 1_000)
}

/// The time that a text says, with any number of decimals and any offset from UTC.
pub(crate) fn of_text(text: &str) -> Option<i64> {
    let text = text.trim();
    if !text.is_ascii() || text.len() > LONGEST {
        return None;
    }
    let (day, time) = text.split_once(['T', 't', ' '])?;
    let [year, month, day] = numbers(day, '-')?;
    let is_date = (1..=9999).contains(&year) && (1..=12).contains(&month) && (1..=31).contains(&day);
    let (clock, offset_min) = zone(time)?;
    let (clock, decimals) = clock.split_once('.').unwrap_or((clock, "0"));
    let [hour, minute, second] = numbers(clock, ':')?;
    // 60 is a leap second.
    let is_time = hour < 24 && minute < 60 && second <= 60;
    if !is_date || !is_time || !decimals.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let us: i64 = format!("{decimals:0<6}").get(..6)?.parse().ok()?;
    let minutes = (hour * 60 + minute) - offset_min;
    Some(days(year, month, day) * DAY_US + (minutes * 60 + second) * SECOND_US + us)
}

/// What is before the offset from UTC, and the offset in minutes.
fn zone(time: &str) -> Option<(&str, i64)> {
    if let Some(clock) = time.strip_suffix(['Z', 'z']) {
        return Some((clock, 0));
    }
    let at = time.rfind(['+', '-'])?;
    let (clock, offset) = time.split_at(at);
    let [hours, minutes] = numbers(&offset[1..], ':')?;
    let sign = if offset.starts_with('-') { -1 } else { 1 };
    (hours < 24 && minutes < 60).then_some((clock, sign * (hours * 60 + minutes)))
}

/// So many numbers of one to four digits.
fn numbers<const N: usize>(text: &str, between: char) -> Option<[i64; N]> {
    let is_number = |part: &&str| (1..=4).contains(&part.len()) && part.bytes().all(|b| b.is_ascii_digit());
    let all: Option<Vec<i64>> =
        text.split(between).map(|part| Some(part).filter(is_number)?.parse().ok()).collect();
    all?.try_into().ok()
}

/// The days from 1970 to a date. Years begin in March here, so that a leap day is the last of its year.
fn days(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let (era, of_era) = (year.div_euclid(400), year.rem_euclid(400));
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + day_of_year - 719_468
}

/// The date so many days after 1970 began.
fn date(days: i64) -> (i64, i64, i64) {
    let days = days + 719_468;
    let (era, of_era) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let day_of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    (era * 400 + year + i64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_read_as_it_was_written_on_every_day_of_four_hundred_years() {
        for day in 0..146_097 {
            let at_us = day * DAY_US + (day * 7_919 % 86_400_000) * 1_000;
            assert_eq!(of_text(&text(at_us)), Some(at_us), "{}", text(at_us));
        }
    }

    #[test]
    fn known_instants_have_the_texts_that_everybody_gives_them() {
        for (at_us, said) in [
            (0, "1970-01-01T00:00:00.000Z"),
            (951_782_400_000_000, "2000-02-29T00:00:00.000Z"),
            (1_796_040_381_250_999, "2026-11-30T12:06:21.250Z"),
            (-1, "1970-01-01T00:00:00.000Z"),
            (i64::MAX, "9999-12-31T23:59:59.999Z"),
        ] {
            assert_eq!(text(at_us), said);
        }
    }

    #[test]
    fn decimals_and_offsets_are_understood_and_what_is_no_time_is_not() {
        let noon = of_text("2026-11-30T12:00:00Z").expect("a time");
        for same in
            ["2026-11-30T12:00:00.000000000Z", "2026-11-30T13:30:00+01:30", " 2026-11-30 07:00:00.0-05:00 "]
        {
            assert_eq!(of_text(same), Some(noon), "{same}");
        }
        assert_eq!(of_text("2026-11-30T12:00:00.25Z"), Some(noon + 250_000));
        for other in [
            "",
            "Z",
            "T",
            "+",
            "2026-11-30",
            "2026-11-30T12:00:00",
            "2026-13-30T12:00:00Z",
            "2026-11-30T24:00:00Z",
            "2026-11-30T12:00Z",
            "2026-11-30T12:00:00.xZ",
            "99999-11-30T12:00:00Z",
            "2026-11-30T12:00:00+25:00",
            "-1-1-1T0:0:0Z",
            "2026-11-30T12:00:00üZ",
            &"9".repeat(1_000),
        ] {
            assert_eq!(of_text(other), None, "{other}");
        }
    }
}
