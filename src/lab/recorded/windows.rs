//! Choice of the scored stretches of walks: the protocols of the public benchmarks.
//!
//! Main types: [`Stretch`] (20 steps of one walk), [`Trip`] (from goal to goal). Refuses: stretches with gaps.

use super::tracks::{Format, RecordedWalk, RecordedWalks};
use giveway_floor::geometry::Point;
use std::collections::BTreeMap;

/// Number of steps observed before a prediction.
pub const OBSERVED: usize = 8;
/// Number of predicted steps.
pub const PREDICTED: usize = 12;
/// Number of observed and predicted steps.
pub const STEPS: usize = OBSERVED + PREDICTED;
/// A person this near to a goal visits it, metres.
pub const VISIT_M: f64 = 1.0;
/// Least number of samples of a trip.
const TRIP_SAMPLES: usize = 6;
/// Least distance between a trip's goals, metres.
const TRIP_M: f64 = 2.0;

/// Twenty steps of a walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stretch {
    /// Number of the walk.
    pub walk: usize,
    /// Index of the first sample.
    pub first: usize,
}

/// The stretches that the benchmark scores. ETH and UCY: all, if at least two people have one that begins in the same
/// step (the loader of Social-GAN). THÖR-MAGNI: the tracklets as given. THÖR: all.
pub fn scored(recording: &RecordedWalks) -> Vec<Stretch> {
    let sliding = all(recording);
    match recording.format {
        Format::Thor => sliding,
        Format::Magni => (recording.walks.iter().enumerate())
            .flat_map(|(walk, w)| {
                let whole = |first: &&usize| {
                    let next = w.tracklets.iter().find(|t| *t > *first).copied().unwrap_or(w.seen.len());
                    next - **first >= STEPS
                };
                w.tracklets.iter().filter(whole).map(move |first| Stretch { walk, first: *first })
            })
            .collect(),
        Format::Eth => {
            let step = |s: &Stretch| recording.walks[s.walk].seen[s.first].step;
            let mut together: BTreeMap<i64, usize> = BTreeMap::new();
            sliding.iter().for_each(|s| *together.entry(step(s)).or_default() += 1);
            sliding.into_iter().filter(|s| together[&step(s)] >= 2).collect()
        }
    }
}

/// All stretches, sliding by one sample: for training.
pub fn all(recording: &RecordedWalks) -> Vec<Stretch> {
    let of = |(walk, w): (usize, &RecordedWalk)| {
        (0..(w.seen.len() + 1).saturating_sub(STEPS))
            .map(move |first| Stretch { walk, first })
            .collect::<Vec<_>>()
    };
    recording.walks.iter().enumerate().flat_map(of).collect()
}

/// A walk from one goal to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trip {
    /// Number of the walk.
    pub walk: usize,
    /// The last sample at the first goal.
    pub first: usize,
    /// The first sample at the second goal.
    pub last: usize,
    /// The goal where the trip began, as an index into the goals.
    pub origin: usize,
    /// The goal where the trip ended, as an index into the goals.
    pub goal: usize,
}

/// The trips in a recording: from the last sample of a visit to the first sample of the next visit of another goal.
pub fn trips(recording: &RecordedWalks, goals: &[Point]) -> Vec<Trip> {
    let mut found = Vec::new();
    for (walk, w) in recording.walks.iter().enumerate() {
        let visits = visits(w, goals);
        for pair in visits.windows(2) {
            let [(origin, _, first), (goal, last, _)] = [pair[0], pair[1]];
            let far = (goals[origin] - goals[goal]).norm() > TRIP_M;
            if origin != goal && far && last - first + 1 >= TRIP_SAMPLES {
                found.push(Trip { walk, first, last, origin, goal });
            }
        }
    }
    found
}

/// Visits of a walk: goal, first and last sample.
pub fn visits(w: &RecordedWalk, goals: &[Point]) -> Vec<(usize, usize, usize)> {
    let nearest = |at: Point| {
        let away = goals.iter().map(|g| (g - at).norm()).enumerate();
        away.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, d)| *d <= VISIT_M).map(|(g, _)| g)
    };
    let mut found: Vec<(usize, usize, usize)> = Vec::new();
    let mut before = None;
    for (i, s) in w.seen.iter().enumerate() {
        let now = nearest(s.at);
        match (now, found.last_mut()) {
            (Some(g), Some(visit)) if before == Some(g) => visit.2 = i,
            (Some(g), _) => found.push((g, i, i)),
            (None, _) => {}
        }
        before = now;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::tracks::TrackPoint;
    use super::*;
    use giveway_floor::time::Time;

    fn walk(points: impl Iterator<Item = (f64, f64)>) -> RecordedWalk {
        let seen = points.enumerate().map(|(i, (x, y))| TrackPoint {
            t: Time(i as i64 * 400_000),
            step: i as i64,
            at: Point::new(x, y),
        });
        RecordedWalk { person: "1".into(), seen: seen.collect(), tracklets: vec![0] }
    }

    #[test]
    fn a_trip_goes_from_the_last_sample_of_a_visit_to_the_first_of_the_next() {
        let goals = [Point::new(0.0, 0.0), Point::new(10.0, 0.0)];
        let there = (0..22).map(|i| (i as f64 * 0.5, 0.0));
        let back = (0..20).map(|i| (10.5 - i as f64 * 0.5, 0.0));
        let w = walk(there.chain(back));
        assert_eq!(visits(&w, &goals), [(0, 0, 2), (1, 18, 25), (0, 41, 41)]);
        let r = RecordedWalks { format: Format::Magni, walks: vec![w] };
        let found = trips(&r, &goals);
        assert_eq!((found.len(), found[0]), (2, Trip { walk: 0, first: 2, last: 18, origin: 0, goal: 1 }));
    }

    #[test]
    fn on_the_street_only_stretches_with_company_count() {
        let alone =
            RecordedWalks { format: Format::Eth, walks: vec![walk((0..21).map(|i| (i as f64, 0.0)))] };
        assert_eq!((all(&alone).len(), scored(&alone).len()), (2, 0));
        let mut two = alone.clone();
        two.walks.push(walk((0..20).map(|i| (i as f64, 3.0))));
        assert_eq!(scored(&two).len(), 2, "both who begin in the first step");
    }
}
