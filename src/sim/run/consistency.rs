//! Whether the filter of people's motion knows how wrong it is: its errors against the truth, in units of its own
//! stated error.
//!
//! Main types: [`Consistency`] (collects errors), [`NeesFigures`]. The normalised estimation error squared has a
//! chi-square distribution if the filter is consistent (Bar-Shalom, Li and Kirubarajan 2001, section 5.4). Refuses: to
//! tell the fleet anything.

use crate::world::World;
use giveway_fleet::Fleet;
use giveway_floor::geometry::{Point, Vector};
use giveway_floor::id::WorkerId;
use giveway_floor::time::{Span, Time};
use std::collections::{BTreeMap, VecDeque};

/// Interval between two samples, since errors of successive moments are much the same.
const APART: Span = Span::from_secs(2);
/// How long the truth is kept: the newest pose of a worker is never older.
const TRAIL: Span = Span::from_secs(3);
/// Interval that holds 95 % of a chi-square variable of two, and of four, degrees of freedom.
const WITHIN_95: [(f64, f64); 2] = [(0.050_636, 7.377_759), (0.484_419, 11.143_287)];

/// Collected errors of the filter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Consistency {
    trails: BTreeMap<WorkerId, VecDeque<(Time, Point)>>,
    next: Time,
    /// Normalised squared errors of the position, and of position and velocity.
    nees: [Vec<f64>; 2],
}

/// Statistics of the errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeesFigures {
    /// Degrees of freedom, which a consistent filter has as its mean.
    pub freedom: f64,
    /// Number of errors.
    pub samples: usize,
    /// Mean of the errors. Higher: the filter is too sure; lower: it is too unsure.
    pub mean: f64,
    /// Interval that holds the mean of this many independent errors of a consistent filter in 95 % of all cases.
    pub mean_bounds: [f64; 2],
    /// The share of single errors within their 95 % bounds.
    pub within: f64,
}

impl Consistency {
    /// Compares the fleet's estimates after a step with where people truly were.
    pub(crate) fn note(&mut self, now: Time, world: &World, fleet: &Fleet) {
        for (worker, walker) in world.walkers().filter(|(_, w)| !w.is_gone()) {
            let trail = self.trails.entry(worker).or_default();
            trail.push_back((now, walker.way_at()));
            while trail.front().is_some_and(|(t, _)| *t < now - TRAIL) {
                trail.pop_front();
            }
        }
        if now < self.next {
            return;
        }
        self.next = now + APART;
        for (worker, estimate) in fleet.motion_estimates() {
            let Some((at, velocity)) = self.truth(worker, estimate.seen) else { continue };
            self.nees[0].push(estimate.nees_of_place(at));
            self.nees[1].push(estimate.nees(at, velocity));
        }
    }

    /// A worker's true position and velocity between two steps; nothing outside of what is kept.
    fn truth(&self, worker: WorkerId, t: Time) -> Option<(Point, Vector)> {
        let trail = self.trails.get(&worker)?;
        let after = trail.partition_point(|(known, _)| *known <= t);
        let ((t0, a), (t1, b)) = (*trail.get(after.checked_sub(1)?)?, *trail.get(after)?);
        let share = (t - t0).as_secs_f64() / (t1 - t0).as_secs_f64();
        Some((a + (b - a) * share, (b - a) / (t1 - t0).as_secs_f64()))
    }

    /// Figures of the position, and of position and velocity; nothing if there are no errors.
    pub fn figures(&self) -> [Option<NeesFigures>; 2] {
        std::array::from_fn(|i| figures(&self.nees[i], [2.0, 4.0][i], WITHIN_95[i]))
    }
}

fn figures(nees: &[f64], freedom: f64, (low, high): (f64, f64)) -> Option<NeesFigures> {
    let samples = nees.len();
    if samples == 0 {
        return None;
    }
    let n = samples as f64;
    let within = nees.iter().filter(|e| (low..=high).contains(*e)).count() as f64 / n;
    let bound = |z: f64| chi_square(n * freedom, z) / n;
    let (mean, mean_bounds) = (nees.iter().sum::<f64>() / n, [bound(-1.96), bound(1.96)]);
    Some(NeesFigures { freedom, samples, mean, mean_bounds, within })
}

/// The quantile of a chi-square distribution at `z` standard deviations of a normal one (Wilson and Hilferty 1931).
fn chi_square(freedom: f64, z: f64) -> f64 {
    let v = 2.0 / (9.0 * freedom);
    freedom * (1.0 - v + z * v.sqrt()).max(0.0).powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        for (freedom, low, high) in [(20.0, 9.591, 34.170), (100.0, 74.222, 129.561)] {
            assert!((chi_square(freedom, -1.96) - low).abs() < 0.05, "{}", chi_square(freedom, -1.96));
            assert!((chi_square(freedom, 1.96) - high).abs() < 0.05, "{}", chi_square(freedom, 1.96));
        }
    }

    #[test]
    fn errors_that_are_what_the_filter_says_are_consistent_and_others_are_not() {
        // Quantiles of a chi-square distribution with two degrees of freedom, evenly spaced.
        let honest: Vec<f64> = (0..1000).map(|i| -2.0 * (1.0 - (f64::from(i) + 0.5) / 1000.0).ln()).collect();
        let found = figures(&honest, 2.0, WITHIN_95[0]).expect("there are errors");
        assert!((found.within - 0.95).abs() < 0.002, "{found:?}");
        assert!((found.mean_bounds[0]..found.mean_bounds[1]).contains(&found.mean), "{found:?}");
        // A filter that takes its standard deviation to be half of the true one.
        let sure: Vec<f64> = honest.iter().map(|e| 4.0 * e).collect();
        let found = figures(&sure, 2.0, WITHIN_95[0]).expect("there are errors");
        assert!(found.mean > found.mean_bounds[1] && found.within < 0.7, "{found:?}");
        assert_eq!(figures(&[], 2.0, WITHIN_95[0]), None);
    }
}
