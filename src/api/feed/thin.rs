//! At most sixty poses a second: faster ones are thinned, never queued.
//!
//! Main type: [`RateLimiter`]. A token bucket with room for a few permits, since radios deliver in bunches; beyond it
//! only the newest pose waits, for the next permit. Pure. Refuses: to keep more than one pose waiting.

use giveway_floor::time::{Span, Time};

/// Time per permit: a little more than sixty a second, so that a device whose clock runs fast is not penalised.
const PERMIT: Span = Span(1_000_000 / 66);

/// The most permits that accumulate.
const MOST: i64 = 4;

/// Thins items that come too fast.
#[derive(Clone, Debug, PartialEq)]
pub struct RateLimiter<T> {
    /// When the bucket was last empty; permits accumulate from there.
    empty: Option<Time>,
    waiting: Option<T>,
    /// How many items were left out.
    pub thinned: u64,
}

impl<T> Default for RateLimiter<T> {
    fn default() -> RateLimiter<T> {
        RateLimiter { empty: None, waiting: None, thinned: 0 }
    }
}

impl<T> RateLimiter<T> {
    /// Offers a new item; returns it if it may pass now.
    pub fn offer(&mut self, item: T, now: Time) -> Option<T> {
        if self.permit(now) {
            self.thinned += u64::from(self.waiting.take().is_some());
            return Some(item);
        }
        self.thinned += u64::from(self.waiting.replace(item).is_some());
        None
    }

    /// When the waiting item may pass.
    pub fn due(&self) -> Option<Time> {
        self.waiting.as_ref().and(self.empty).map(|empty| empty + PERMIT)
    }

    /// The waiting item, if it may pass now.
    pub fn ready(&mut self, now: Time) -> Option<T> {
        if self.waiting.is_some() && self.permit(now) { self.waiting.take() } else { None }
    }

    fn permit(&mut self, now: Time) -> bool {
        let full = now - PERMIT * MOST;
        let empty = self.empty.map_or(full, |e| e.max(full));
        let granted = empty + PERMIT <= now;
        self.empty = Some(if granted { empty + PERMIT } else { empty });
        granted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The items that pass, of items that come at these milliseconds, polled every millisecond.
    fn pass(times: impl IntoIterator<Item = i64>) -> Vec<(i64, i64)> {
        let times: Vec<i64> = times.into_iter().collect();
        let mut limiter = RateLimiter::default();
        let mut passed = Vec::new();
        for ms in 0..3000 {
            let now = Time(ms * 1000);
            passed.extend(limiter.ready(now).map(|item| (ms, item)));
            for t in times.iter().filter(|t| **t == ms) {
                passed.extend(limiter.offer(*t, now).map(|item| (ms, item)));
            }
        }
        passed
    }

    #[test]
    fn sixty_a_second_pass_as_they_come() {
        let times: Vec<i64> = (0..120).map(|i| i * 1000 / 60 + i64::from(i % 3 == 0) * 5).collect();
        assert_eq!(pass(times.clone()), times.iter().map(|t| (*t, *t)).collect::<Vec<_>>());
    }

    #[test]
    fn five_hundred_a_second_are_thinned_and_never_old() {
        let passed = pass((0..1000).map(|i| i * 2));
        assert!((130..=140).contains(&passed.len()), "two seconds at 66: {}", passed.len());
        assert!(passed.iter().all(|(at, made)| at - made <= 2), "{passed:?}");
    }

    #[test]
    fn of_a_bunch_after_a_stall_the_newest_passes() {
        let passed = pass([0].into_iter().chain(std::iter::repeat_n(1000, 59)).chain([1001]));
        assert!(passed.len() <= 6);
        assert_eq!(passed.last().unwrap().1, 1001);
    }
}
