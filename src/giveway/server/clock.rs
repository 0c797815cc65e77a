//! The only clock: microseconds since 1970, read from the system once and then counted on.
//!
//! Main type: [`Clock`]. Times are strictly increasing, and never before the last fact of the journal, even if the
//! system's clock was set back in between. Refuses: to follow the system's clock while it runs.

use giveway_floor::time::{Span, Time};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// How far the journal may be ahead of the system's clock without a warning.
const TOLERANCE: Span = Span::from_secs(60);

/// A clock that only goes forward.
#[derive(Debug)]
pub struct Clock {
    origin: Instant,
    start: i64,
    /// How many times as fast as the system's clock it goes.
    speed: u32,
    last: AtomicI64,
}

impl Clock {
    /// A clock that starts now, or just after `last` if that is later.
    pub fn start(last: Option<Time>) -> Clock {
        let wall = wall();
        let start = last.map_or(wall, |last| wall.max(last.0 + 1));
        if start - wall > TOLERANCE.0 {
            let ahead_s = (start - wall) / 1_000_000;
            let why = "was that set back, or did the floor run with --speed?";
            tracing::warn!(ahead_s, "the journal is ahead of the system's clock: {why}");
        }
        Clock { origin: Instant::now(), start, speed: 1, last: AtomicI64::new(start) }
    }

    /// The same clock, going this many times as fast. Only where all robots and people are simulated, since they live
    /// by this clock.
    pub fn at_speed(self, speed: u32) -> Clock {
        assert!(speed > 0, "a clock that stands moves no robot");
        Clock { speed, ..self }
    }

    /// For how long a span of this clock lasts by the system's clock.
    pub fn lasts(&self, span: Span) -> Duration {
        Duration::from_micros(span.0.max(0).unsigned_abs()) / self.speed
    }

    /// How far this clock goes while the system's goes this far.
    pub fn passes(&self, while_: Duration) -> Span {
        Span(i64::try_from((while_ * self.speed).as_micros()).unwrap_or(i64::MAX))
    }

    /// When this clock started.
    pub fn started(&self) -> Time {
        Time(self.start)
    }

    /// How far the system's clock is ahead of this one; negative if it is behind. This clock does not follow it, since
    /// times must not jump; if the system's clock was set meanwhile, an operator should know.
    pub fn system_ahead(&self) -> Span {
        Span(wall() - self.start - self.elapsed_us())
    }

    /// The current time, later than every time returned before.
    pub fn now(&self) -> Time {
        let now = self.start + self.elapsed_us().saturating_mul(i64::from(self.speed));
        let last = self.last.fetch_max(now, Ordering::Relaxed);
        if now > last { Time(now) } else { Time(self.last.fetch_add(1, Ordering::Relaxed) + 1) }
    }

    /// Microseconds since the start, by the system's clock.
    fn elapsed_us(&self) -> i64 {
        i64::try_from(self.origin.elapsed().as_micros()).unwrap_or(i64::MAX / 2)
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
    fn a_clock_at_a_speed_goes_that_much_faster_and_is_not_taken_for_one_that_was_set() {
        let (clock, real) = (Clock::start(None).at_speed(1000), Instant::now());
        let began = clock.now();
        std::thread::sleep(Duration::from_millis(20));
        let (passed, most) = (clock.now() - began, real.elapsed().as_micros() as i64 * 1000);
        assert!((20_000_000..=most).contains(&passed.0), "{passed:?} of {most} us");
        assert!(clock.system_ahead().0.abs() < 10_000_000, "{:?}", clock.system_ahead());
        assert_eq!(clock.lasts(Span::from_secs(10)), Duration::from_millis(10));
        assert_eq!(clock.passes(Duration::from_millis(10)), Span::from_secs(10));
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
