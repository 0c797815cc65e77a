//! Encounters as a curve over the radius that counts as near: how often, how long and how fast robots approached.
//!
//! Main types: [`RingColumn`]. A figure within one radius says little: a policy whose robots stand where others drive
//! looks good close by and bad farther out. Refuses: to choose the radius at which one policy looks best.

use crate::measure::encounter::EncounterFigures;

/// A figure within one radius. Dividing by the workers' time on the floor, or by the distance that robots drove
/// meanwhile, makes runs comparable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RingColumn {
    /// Entries per minute of workers on the floor.
    EntriesPerWorkerMinute,
    /// Entries per kilometre that robots drove while workers were on the floor.
    EntriesPerKilometre,
    /// Seconds that robots drove towards a worker, per minute of workers on the floor.
    TowardsPerWorkerMinute,
    /// The fastest approach of a robot to a worker, metres per second.
    FastestMps,
}

impl RingColumn {
    /// All figures.
    pub const ALL: [RingColumn; 4] = [
        RingColumn::EntriesPerWorkerMinute,
        RingColumn::EntriesPerKilometre,
        RingColumn::TowardsPerWorkerMinute,
        RingColumn::FastestMps,
    ];

    /// The figure's word in reports.
    pub fn word(self) -> &'static str {
        match self {
            RingColumn::EntriesPerWorkerMinute => "entries_per_worker_minute",
            RingColumn::EntriesPerKilometre => "entries_per_km",
            RingColumn::TowardsPerWorkerMinute => "towards_s_per_worker_minute",
            RingColumn::FastestMps => "fastest_mps",
        }
    }

    /// The figure of one run within one radius; nothing if no person was on the floor, or no robot drove.
    pub fn of(self, figures: &EncounterFigures, ring: usize) -> Option<f64> {
        let minutes = figures.worker_time.as_secs_f64() / 60.0;
        let per = |n: f64, of: f64| (of > 0.0).then(|| n / of);
        let ring = &figures.rings[ring];
        match self {
            RingColumn::EntriesPerWorkerMinute => per(ring.entries as f64, minutes),
            RingColumn::EntriesPerKilometre => per(ring.entries as f64, figures.driven_m / 1000.0),
            RingColumn::TowardsPerWorkerMinute => per(ring.towards.as_secs_f64(), minutes),
            RingColumn::FastestMps => Some(ring.fastest_mps),
        }
    }
}

/// Quantiles of the closest distances of all entries within one radius, over all runs, metres: the distances that 5,
/// 25, 50 and 75 of every hundred encounters came nearer than.
pub fn closest_quantiles<'a>(
    runs: impl Iterator<Item = &'a EncounterFigures>,
    ring: usize,
) -> [(&'static str, Option<f64>); 4] {
    let mut all: Vec<f64> = runs.flat_map(|figures| figures.rings[ring].closest_m.iter().copied()).collect();
    all.sort_unstable_by(f64::total_cmp);
    let at = |q: f64| all.get((all.len() as f64 * q) as usize).copied();
    [("p05", at(0.05)), ("p25", at(0.25)), ("p50", at(0.5)), ("p75", at(0.75))]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::encounter::Ring;
    use giveway_floor::time::Span;

    fn figures() -> EncounterFigures {
        let closest_m = (0..100).map(|i| 0.5 + f64::from(i) / 100.0).collect();
        let towards = Span::from_secs(30);
        EncounterFigures {
            worker_time: Span::from_secs(600),
            driven_m: 2000.0,
            rings: vec![Ring { radius_m: 1.5, entries: 100, towards, fastest_mps: 0.7, closest_m }],
            ..EncounterFigures::default()
        }
    }

    #[test]
    fn figures_are_per_minute_of_workers_and_per_kilometre_of_robots() {
        let all = RingColumn::ALL.map(|c| c.of(&figures(), 0).expect("there were workers and robots"));
        assert_eq!(all, [10.0, 50.0, 3.0, 0.7]);
        let nobody = EncounterFigures { worker_time: Span::ZERO, driven_m: 0.0, ..figures() };
        assert_eq!(RingColumn::EntriesPerWorkerMinute.of(&nobody, 0), None);
    }

    #[test]
    fn quantiles_are_over_all_runs_together() {
        let near = EncounterFigures {
            rings: vec![Ring { closest_m: vec![0.1; 100], ..figures().rings[0].clone() }],
            ..figures()
        };
        let quantiles = closest_quantiles([&figures(), &near].into_iter(), 0);
        assert_eq!(quantiles.map(|(_, q)| q), [Some(0.1), Some(0.1), Some(0.5), Some(1.0)]);
    }
}
