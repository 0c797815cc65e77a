//! The same walk through a worse source: another rate, noise, losses, gaps.
//!
//! Main type: [`Degrade`]. Refuses: to change the truth; only what is seen of it.

use super::tracks::TrackPoint;
use crate::dice::Dice;
use giveway_floor::time::{Span, Time};
use std::f64::consts::TAU;

/// How samples are degraded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Degrade {
    /// Fixes per second.
    pub rate_hz: f64,
    /// Standard deviation of noise along each axis, metres.
    pub noise_m: f64,
    /// Share of fixes that are lost.
    pub loss: f64,
    /// Longest gap in which nothing is seen, seconds.
    pub gap_s: f64,
}

/// Mean time from one gap to the next, seconds.
const GAP_EVERY_S: f64 = 4.0;

impl Degrade {
    /// All reported variants: three rates and two noises.
    pub const ALL: [Degrade; 6] = {
        const fn one(rate_hz: f64, noise_m: f64) -> Degrade {
            Degrade { rate_hz, noise_m, loss: 0.05, gap_s: 0.6 }
        }
        [one(2.5, 0.01), one(10.0, 0.01), one(60.0, 0.01), one(2.5, 0.3), one(10.0, 0.3), one(60.0, 0.3)]
    };

    /// The degraded view of some samples, always the same for the same `seed`. Between samples people walk straight.
    /// The first and the last sample are always seen, so that the source is judged and not the length of the
    /// observation.
    pub fn apply(&self, seen: &[TrackPoint], seed: u64) -> Vec<TrackPoint> {
        let (Some(first), Some(last)) = (seen.first(), seen.last()) else { return Vec::new() };
        let mut dice = Dice::new(seed);
        let period = Span::from_secs_f64(1.0 / self.rate_hz);
        let mut times: Vec<Time> = Vec::new();
        let mut t = first.t;
        while t < last.t {
            times.push(t);
            t += period;
        }
        times.push(last.t);
        let mut quiet = first.t;
        let (mut found, mut part) = (Vec::with_capacity(times.len()), 0);
        for (i, t) in times.iter().enumerate() {
            while part + 2 < seen.len() && seen[part + 1].t <= *t {
                part += 1;
            }
            let ends = i == 0 || i + 1 == times.len();
            if dice.chance() < period.as_secs_f64() / GAP_EVERY_S {
                quiet = *t + Span::from_secs_f64(self.gap_s * dice.chance());
            }
            let is_lost = dice.chance() < self.loss || *t < quiet;
            let (x, y) = dice.normal();
            if is_lost && !ends {
                continue;
            }
            let [a, b] = [seen[part], seen[(part + 1).min(seen.len() - 1)]];
            let whole = (b.t - a.t).as_secs_f64();
            let share = if whole > 0.0 { ((*t - a.t).as_secs_f64() / whole).clamp(0.0, 1.0) } else { 0.0 };
            let noise = giveway_floor::geometry::Vector::new(x, y) * self.noise_m;
            found.push(TrackPoint { t: *t, step: a.step, at: a.at + (b.at - a.at) * share + noise });
        }
        found
    }
}

impl Dice {
    /// A random number from 0 to below 1.
    fn chance(&mut self) -> f64 {
        self.below(1 << 24) as f64 / f64::from(1 << 24)
    }

    /// Two normally distributed numbers (Box and Muller 1958).
    fn normal(&mut self) -> (f64, f64) {
        let radius = (-2.0 * (1.0 - self.chance()).ln()).sqrt();
        let angle = TAU * self.chance();
        (radius * angle.cos(), radius * angle.sin())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::geometry::Point;

    #[test]
    fn a_worse_source_sees_the_same_walk_with_noise_and_holes() {
        let walk: Vec<TrackPoint> = (0..200)
            .map(|i| TrackPoint { t: Time(i * 400_000), step: i, at: Point::new(0.5 * i as f64, 0.0) })
            .collect();
        let d = Degrade { rate_hz: 60.0, noise_m: 0.3, loss: 0.05, gap_s: 0.6 };
        let seen = d.apply(&walk, 7);
        assert_eq!(seen, d.apply(&walk, 7), "the same seed, the same chance");
        let full = 199.0 * 0.4 * 60.0;
        let kept = seen.len() as f64 / full;
        assert!((0.80..0.95).contains(&kept), "{kept}");
        let error = |s: &TrackPoint| s.at - Point::new(0.5 * s.t.0 as f64 / 4e5, 0.0);
        let spread = seen.iter().map(|s| error(s).norm_squared()).sum::<f64>() / (2 * seen.len()) as f64;
        assert!((spread.sqrt() - 0.3).abs() < 0.02, "{}", spread.sqrt());
        let longest = seen.windows(2).map(|p| (p[1].t - p[0].t).as_secs_f64()).fold(0.0, f64::max);
        assert!((0.3..0.8).contains(&longest), "{longest}");
    }

    #[test]
    fn a_perfect_source_changes_nothing() {
        let walk: Vec<TrackPoint> = (0..8)
            .map(|i| TrackPoint { t: Time(i * 400_000), step: i, at: Point::new(0.5 * i as f64, 0.0) })
            .collect();
        let d = Degrade { rate_hz: 2.5, noise_m: 0.0, loss: 0.0, gap_s: 0.0 };
        let seen = d.apply(&walk, 1);
        assert_eq!(seen.len(), 8);
        assert!(seen.iter().zip(&walk).all(|(a, b)| a.t == b.t && (a.at - b.at).norm() < 1e-9));
    }
}
