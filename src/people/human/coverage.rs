//! Whether forecasts hold while the system runs, and how regions adapt if they do not.
//!
//! Main types: [`Coverage`] (one record for all people), [`HorizonCoverage`] (its figures). A forecast is kept until it
//! is due and compared with where the person was. Regions grow with every miss and shrink with every hit, so that in
//! the long run they contain the stated share, whatever people do (adaptive conformal inference: Gibbs and Candès
//! 2021). If they still do not, forecasts are not trusted, and the caller falls back on what people can reach. Refuses:
//! people who were not seen when a forecast was due.

use super::mixture::Mixture;
use giveway_floor::geometry::Point;
use giveway_floor::id::WorkerId;
use giveway_floor::time::{Span, Time};
use std::collections::{BTreeMap, VecDeque};

/// Horizons for which coverage is measured, seconds.
pub const WATCHED_S: [f64; 3] = [0.8, 2.0, 4.8];
/// Probability of the measured region.
const LEVEL: f64 = 0.95;
/// Interval between two forecasts of one person.
const EVERY: Span = Span::from_millis(800);
/// A sighting later than this after a forecast's due time does not score it.
const LATE: Span = Span::from_millis(250);
/// Rate at which regions grow and shrink.
const RATE: f64 = 0.04;
/// Smallest and largest scale of regions, as factors of their standard deviations.
const SCALES: (f64, f64) = (0.6, 3.0);
/// Number of recent forecasts that shares are averaged over.
const MEMORY: f64 = 500.0;
/// Least number of forecasts for any conclusion.
const ENOUGH: u64 = 150;
/// Coverage below the first value is not trusted until it is above the second.
const BAND: (f64, f64) = (0.88, 0.92);

/// Coverage at one horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HorizonCoverage {
    /// Length of the horizon, seconds.
    pub horizon_s: f64,
    /// How many forecasts have come due.
    pub forecasts: u64,
    /// Share of people who were within the stated 95 % region.
    pub covered: f64,
    /// Factor by which standard deviations have grown.
    pub scale: f64,
    /// Whether forecasts at this horizon are trusted.
    pub trusted: bool,
}

/// A forecast that is not due yet.
#[derive(Clone, Debug)]
struct PendingForecast {
    due: Time,
    horizon: usize,
    forecast: Mixture,
}

/// The record of all forecasts.
#[derive(Clone, Debug)]
pub struct Coverage {
    pending: BTreeMap<WorkerId, VecDeque<PendingForecast>>,
    made: BTreeMap<WorkerId, Time>,
    horizons: [HorizonCoverage; 3],
}

impl Default for Coverage {
    fn default() -> Coverage {
        let fresh = |horizon_s| HorizonCoverage {
            horizon_s,
            forecasts: 0,
            covered: LEVEL,
            scale: 1.0,
            trusted: true,
        };
        Coverage { pending: BTreeMap::new(), made: BTreeMap::new(), horizons: WATCHED_S.map(fresh) }
    }
}

impl Coverage {
    /// Coverage at all horizons.
    pub fn forecast_coverage(&self) -> &[HorizonCoverage; 3] {
        &self.horizons
    }

    /// Whether forecasts are trusted at all horizons.
    pub fn is_trusted(&self) -> bool {
        self.horizons.iter().all(|h| h.trusted)
    }

    /// The factor on standard deviations at a horizon of `ahead_s` seconds.
    pub fn scale(&self, ahead_s: f64) -> f64 {
        let [a, b, c] = &self.horizons;
        let between = |p: &HorizonCoverage, q: &HorizonCoverage| {
            let share = ((ahead_s - p.horizon_s) / (q.horizon_s - p.horizon_s)).clamp(0.0, 1.0);
            p.scale + (q.scale - p.scale) * share
        };
        if ahead_s < b.horizon_s { between(a, b) } else { between(b, c) }
    }

    /// Whether another forecast of a person is due.
    pub fn wants(&self, worker: WorkerId, now: Time) -> bool {
        self.made.get(&worker).is_none_or(|t| now - *t >= EVERY)
    }

    /// Keeps the forecasts of a person, one for each of [`WATCHED_S`] after `seen`.
    pub fn expect(&mut self, worker: WorkerId, now: Time, seen: Time, forecasts: [Mixture; 3]) {
        self.made.insert(worker, now);
        let queue = self.pending.entry(worker).or_default();
        for (horizon, forecast) in forecasts.into_iter().enumerate() {
            let due = seen + Span::from_secs_f64(WATCHED_S[horizon]);
            queue.push_back(PendingForecast { due, horizon, forecast });
        }
    }

    /// Scores the due forecasts of a person who was seen.
    pub fn score(&mut self, worker: WorkerId, seen: Time, at: Point) {
        let Some(queue) = self.pending.get_mut(&worker) else { return };
        let horizons = &mut self.horizons;
        queue.retain(|p| {
            if p.due > seen {
                return true;
            }
            if seen - p.due <= LATE {
                horizons[p.horizon].learn(p.forecast.level(at) <= LEVEL);
            }
            false
        });
    }

    /// Drops the forecasts of a person who was relocated or has left.
    pub fn forget(&mut self, worker: WorkerId) {
        self.pending.remove(&worker);
        self.made.remove(&worker);
    }
}

impl HorizonCoverage {
    fn learn(&mut self, hit: bool) {
        self.forecasts += 1;
        let weight = 1.0 / (self.forecasts as f64 + 20.0).min(MEMORY);
        self.covered += weight * (f64::from(hit) - self.covered);
        let step = RATE * (if hit { LEVEL - 1.0 } else { LEVEL });
        self.scale = (self.scale * step.exp()).clamp(SCALES.0, SCALES.1);
        if self.forecasts >= ENOUGH {
            self.trusted = self.covered >= if self.trusted { BAND.0 } else { BAND.1 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::human::Part;
    use nalgebra::Matrix2;

    const W: WorkerId = WorkerId(0);

    /// A person who is a step of `error(k)` away from each forecast, whose standard deviation is stated as 0.3 m.
    fn live(coverage: &mut Coverage, from: usize, count: usize, error: impl Fn(usize) -> f64) {
        for k in from..from + count {
            let t = Time(k as i64 * 1_000_000);
            let forecast = |h: usize| {
                let s = 0.3 * coverage.scale(WATCHED_S[h]);
                let cov = Matrix2::identity() * s * s;
                Mixture { parts: vec![Part { weight: 1.0, mean: Point::origin(), cov }] }
            };
            let forecasts = [forecast(0), forecast(1), forecast(2)];
            coverage.expect(W, t, t, forecasts);
            for h in WATCHED_S {
                let seen = t + Span::from_secs_f64(h);
                coverage.score(W, seen, Point::new(error(k), 0.0));
            }
        }
    }

    /// Errors like those of a round Gaussian with standard deviation `sigma`.
    fn like(sigma: f64) -> impl Fn(usize) -> f64 {
        move |k| sigma * (-2.0 * f64::ln(1.0 - ((k * 617 % 1000) as f64 + 0.5) / 1000.0)).sqrt()
    }

    #[test]
    fn regions_grow_until_they_hold_what_they_say() {
        let mut coverage = Coverage::default();
        live(&mut coverage, 0, 3000, like(0.6));
        for f in coverage.forecast_coverage() {
            assert!((f.scale - 2.0).abs() < 0.4, "{f:?}");
            assert!((0.92..0.98).contains(&f.covered) && f.trusted, "{f:?}");
        }
    }

    #[test]
    fn forecasts_that_cannot_be_mended_are_not_trusted_and_are_again_when_they_hold() {
        let mut coverage = Coverage::default();
        live(&mut coverage, 0, 400, |_| 5.0);
        assert!(!coverage.is_trusted());
        live(&mut coverage, 400, 3000, like(0.3));
        assert!(coverage.is_trusted(), "{:?}", coverage.forecast_coverage());
    }

    #[test]
    fn whoever_is_not_seen_in_time_teaches_nothing() {
        let mut coverage = Coverage::default();
        let sure =
            || Mixture { parts: vec![Part { weight: 1.0, mean: Point::origin(), cov: Matrix2::identity() }] };
        coverage.expect(W, Time::ZERO, Time::ZERO, [sure(), sure(), sure()]);
        coverage.score(W, Time(20_000_000), Point::new(99.0, 0.0));
        assert!(coverage.forecast_coverage().iter().all(|f| f.forecasts == 0));
        coverage.expect(W, Time(30_000_000), Time(30_000_000), [sure(), sure(), sure()]);
        coverage.forget(W);
        coverage.score(W, Time(30_800_000), Point::new(99.0, 0.0));
        assert!(coverage.forecast_coverage().iter().all(|f| f.forecasts == 0));
    }
}
