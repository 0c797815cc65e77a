//! The only clock: microseconds since 1970, read from the system once and then counted on.
//!
//! Main type: [`Clock`]. Times are strictly increasing, and never before the last fact of the journal, even if the
//! system's clock was set back in between. Refuses: to follow the system's clock while it runs.

use giveway_floor::time::{Span, Time};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// How far the journal may be ahead of the system's clock without a warning.
const TOLERANCE: Span = Span::from_secs(60);

/// A clock that only goes forward.
#[derive(Debug)]
pub struct Clock {
    origin: Instant,
    start: i64,
    last: AtomicI64,
}

impl Clock {
    /// A clock that starts now, or just after `last` if that is later.
    pub fn start(last: Option<Time>) -> Clock {
        let wall = wall();
        let start = last.map_or(wall, |last| wall.max(last.0 + 1));
        if start - wall > TOLERANCE.0 {
            let ahead_s = (start - wall) / 1_000_000;
            tracing::warn!(ahead_s, "the journal is ahead of the system clock: was the clock set back?");
        }
        Clock { origin: Instant::now(), start, last: AtomicI64::new(start) }
    }

    /// When this clock started.
    pub fn started(&self) -> Time {
        Time(self.start)
    }

    /// How far the system's clock is ahead of this one; negative if it is behind. This clock does not follow it, since
    /// times must not jump; if the system's clock was set meanwhile, an operator should know.
    pub fn system_ahead(&self) -> Span {
        Span(wall() - self.now().0)
    }

    /// The current time, later than every time returned before.
    pub fn now(&self) -> Time {
        let elapsed = i64::try_from(self.origin.elapsed().as_micros()).unwrap_or(i64::MAX / 2);
        let now = self.start + elapsed;
        let last = self.last.fetch_max(now, Ordering::Relaxed);
        if now > last { Time(now) } else { Time(self.last.fetch_add(1, Ordering::Relaxed) + 1) }
    }
}

/// The system's clock, microseconds since 1970.
fn wall() -> i64 {
    let wall = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_micros());
    i64::try_from(wall).unwrap_or(0)
}

/// Nanoseconds since the first call, for measuring durations.
pub fn stopwatch() -> u64 {
    static ORIGIN: OnceLock<Instant> = OnceLock::new();
    u64::try_from(ORIGIN.get_or_init(Instant::now).elapsed().as_nanos()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_only_goes_forward() {
        let clock = Clock::start(None);
        let times: Vec<_> = (0..10_000).map(|_| clock.now()).collect();
        assert!(times.is_sorted_by(|a, b| a < b));
    }

    #[test]
    fn time_starts_after_the_last_fact_even_if_that_is_in_the_future() {
        let future = Time(i64::MAX / 2);
        let clock = Clock::start(Some(future));
        assert!(clock.now() > future);
        assert!(clock.system_ahead() < Span::from_secs(-60), "{:?}", clock.system_ahead());
        assert!(Clock::start(None).system_ahead().0.abs() < 10_000_000);
    }
}
