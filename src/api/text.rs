//! Ids, times and numbers as they are written on the wire, and read from it.
//!
//! Main functions: [`job_name`], [`worker_name`], [`time_text`], [`round3`] and their reverse. Jobs are "j17", workers
//! "w1", assignments "a1", closures "c1". Refuses: to look anything up.

use crate::id::{AssignmentId, ClosureId, JobId, SeriesId, WorkerId};
use crate::time::Time;

/// A job's name on the wire.
pub fn job_name(id: JobId) -> String {
    format!("j{}", id.0)
}

/// A job's number from its name, if it is one.
pub fn parse_job_name(text: &str) -> Option<JobId> {
    number(text, 'j').map(JobId)
}

/// A time as RFC 3339 in UTC.
pub fn time_text(t: Time) -> String {
    jiff::Timestamp::from_microsecond(t.0).map_or_else(|_| "out of range".into(), |t| t.to_string())
}

/// A time from RFC 3339 with any offset.
pub fn parse_time(text: &str) -> Option<Time> {
    text.parse::<jiff::Timestamp>().ok().map(|t| Time(t.as_microsecond()))
}

/// Rounded to a thousandth; never minus zero, never something JSON cannot say.
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
    number(text, 's').map(SeriesId)
}

/// The number behind a letter, from 1 on.
fn number(text: &str, letter: char) -> Option<u64> {
    let digits = text.strip_prefix(letter)?;
    let plain = digits.bytes().all(|b| b.is_ascii_digit()) && !digits.starts_with('0');
    if plain { digits.parse().ok() } else { None }
}

/// An assignment's number.
pub fn parse_assignment(text: &str) -> Option<AssignmentId> {
    number(text, 'a').map(AssignmentId)
}

/// A closure's number.
pub fn parse_closure(text: &str) -> Option<ClosureId> {
    number(text, 'c').map(ClosureId)
}

/// A worker's number from its name, if it is one.
pub fn parse_worker_name(text: &str) -> Option<WorkerId> {
    number(text, 'w').and_then(|n| u32::try_from(n - 1).ok()).map(WorkerId)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_behind_letters_are_read_strictly() {
        assert_eq!(number("w12", 'w'), Some(12));
        for bad in ["w0", "w", "12", "w-1", "w01", "a1", "w99999999999999999999", "w1 "] {
            assert_eq!(number(bad, 'w'), None, "{bad}");
        }
    }
}
