//! Where a worker will be, and when, with what probability.
//!
//! Main types: [`Hypothesis`] (a path with its probability), [`Band`] (how fast), [`Passage`] (a place, a window, a
//! probability). Each place along a path is occupied from the moment when a fast walker enters it until a slow one has
//! left it (Petković 2021, section 4.3.3). Refuses: to know what is at those places.

use giveway_floor::geometry::Point;
use giveway_floor::time::{Span, Time, Window};

/// One way in which a worker may go on.
#[derive(Clone, Debug, PartialEq)]
pub struct Hypothesis {
    /// Probability of the hypothesis.
    pub probability: f64,
    /// Path from the worker's position.
    pub path: Vec<Point>,
    /// How long the worker stays at the end; nothing if the worker may stay for ever.
    pub stay: Option<Span>,
}

/// Range of a worker's walking speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Lower bound of the speed, metres per second.
    pub slow_mps: f64,
    /// Upper bound of the speed, metres per second.
    pub fast_mps: f64,
}

impl Hypothesis {
    /// From the arrival of a fast walker at the end of the path until a slow one has left; nothing for a worker who may
    /// stay for ever.
    pub fn stays(&self, band: Band, now: Time) -> Option<Window> {
        let length_m: f64 = self.path.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
        let arrival = band.passes(length_m, now);
        Some(Window::new(arrival.start(), arrival.end() + self.stay?))
    }
}

impl Band {
    /// The range assumed for a worker whose speed is not known (safety figures of walking: 0.5 to 1.8 m/s).
    pub const ANY: Band = Band { slow_mps: 0.5, fast_mps: 1.8 };

    /// From the arrival of a fast walker at a place `ahead_m` ahead until a slow one has left it.
    fn passes(self, ahead_m: f64, now: Time) -> Window {
        let fast = now + Span::from_secs_f64(ahead_m / self.fast_mps);
        Window::new(fast, now + Span::from_secs_f64(ahead_m / self.slow_mps) + GONE)
    }

    /// The range around a measured speed, metres per second. A standing worker may start at any time.
    pub fn around(speed_mps: f64) -> Band {
        let slow = (0.6 * speed_mps).clamp(0.4, 0.9);
        Band { slow_mps: slow, fast_mps: (1.25 * speed_mps + 0.2).clamp(1.2, 2.2) }
    }
}

/// A place that a worker may occupy, with its window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Number of the hypothesis.
    pub hypothesis: usize,
    /// Position of the place.
    pub at: Point,
    /// When the worker may be there.
    pub window: Window,
    /// Distance along the path from the worker's position, metres.
    pub ahead_m: f64,
}

/// Time to leave a place, beyond the time of passing it.
const GONE: Span = Span::from_millis(600);
/// Distance between two places along a path, metres.
const STEP_M: f64 = 0.4;

/// Calls `each` for the passages of one hypothesis within the next `horizon`, from `now` on.
pub fn passages(
    index: usize,
    h: &Hypothesis,
    band: Band,
    now: Time,
    horizon: Span,
    mut each: impl FnMut(Passage),
) {
    let mut ahead_m = 0.0;
    for pair in h.path.windows(2) {
        let length = (pair[1] - pair[0]).norm();
        let steps = (length / STEP_M).ceil().max(1.0) as usize;
        for k in 0..steps {
            let share = k as f64 / steps as f64;
            let ahead = ahead_m + share * length;
            let w = band.passes(ahead, now);
            if w.start() > now + horizon {
                return;
            }
            each(Passage {
                hypothesis: index,
                at: pair[0] + (pair[1] - pair[0]) * share,
                window: w,
                ahead_m: ahead,
            });
        }
        ahead_m += length;
    }
    let Some(end) = h.path.last() else { return };
    let arrival = band.passes(ahead_m, now);
    if arrival.start() <= now + horizon {
        let until = h.stay.map_or(now + horizon, |s| arrival.end() + s).max(arrival.end());
        each(Passage { hypothesis: index, at: *end, window: Window::new(arrival.start(), until), ahead_m });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(path: &[(f64, f64)], horizon_s: i64) -> Vec<Passage> {
        let path = path.iter().map(|(x, y)| Point::new(*x, *y)).collect();
        let h = Hypothesis { probability: 1.0, path, stay: Some(Span::from_secs(2)) };
        let mut found = Vec::new();
        passages(0, &h, Band::ANY, Time::ZERO, Span::from_secs(horizon_s), |p| found.push(p));
        found
    }

    #[test]
    fn a_place_is_taken_from_the_fast_entry_to_the_slow_exit() {
        let found = all(&[(0.0, 0.0), (9.0, 0.0)], 60);
        let end = found.last().unwrap();
        assert_eq!(end.window.start(), Time::ZERO + Span::from_secs(5));
        assert_eq!(end.window.end(), Time::ZERO + Span::from_millis(18_000 + 600 + 2_000));
        assert!(found.windows(2).all(|p| p[0].window.start() <= p[1].window.start()));
    }

    #[test]
    fn who_stays_at_the_end_of_a_way_is_there_until_a_slow_walker_has_stayed_as_long() {
        let path = vec![Point::new(0.0, 0.0), Point::new(9.0, 0.0)];
        let h = Hypothesis { probability: 1.0, path, stay: Some(Span::from_secs(2)) };
        let all = all(&[(0.0, 0.0), (9.0, 0.0)], 60);
        assert_eq!(h.stays(Band::ANY, Time::ZERO), all.last().map(|p| p.window));
        assert_eq!(Hypothesis { stay: None, ..h }.stays(Band::ANY, Time::ZERO), None);
    }

    #[test]
    fn nothing_is_said_beyond_the_horizon() {
        let found = all(&[(0.0, 0.0), (90.0, 0.0)], 5);
        assert!(found.iter().all(|p| p.ahead_m <= 9.0 + 1e-9));
        assert!(found.len() > 15);
    }

    #[test]
    fn who_stands_takes_the_place_where_they_stand() {
        let found = all(&[(3.0, 4.0)], 5);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].at, found[0].window.start()), (Point::new(3.0, 4.0), Time::ZERO));
    }
}
