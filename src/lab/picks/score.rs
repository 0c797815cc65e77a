//! How well the place that a hand goes to is predicted on the way.
//!
//! Main types: [`SlotScore`], [`SlotTally`]. Predictions are scored at 10, 20, …, 100 % of the time from onset to
//! arrival, with nothing later known. Refuses: movements without a right candidate.

use crate::learning::picks::ReachItem;
use giveway_people::reach::ArmVector;
use giveway_people::reach::net::squash::softmax;

/// Parts of the way, percent.
pub const PARTS: [usize; 10] = [10, 20, 30, 40, 50, 60, 70, 80, 90, 100];
/// Least probability of a place.
const FLOOR: f64 = 1e-6;
/// A right place less probable than this counts as missed.
const MISS: f64 = 0.05;
/// Number of bins of the calibration error.
const BINS: usize = 10;

/// Scores of a predictor.
#[derive(Clone, Debug, PartialEq)]
pub struct SlotScore {
    /// Share of movements whose right place was the most probable, by part of the way.
    pub top1: [f64; PARTS.len()],
    /// Mean of `top1` over the parts.
    pub top1_mean: f64,
    /// Expected distance from the right place, in mean distances of the others (Petković, equation 5.1).
    pub location_error: f64,
    /// Mean negative logarithm of the right place's probability, nats.
    pub nll: f64,
    /// Expected calibration error of the most probable place.
    pub ece: f64,
    /// Share of predictions with less than 5 % for the right place.
    pub miss5: f64,
}

/// Counts over movements.
#[derive(Clone, Debug, Default)]
pub struct SlotTally {
    hits: [usize; PARTS.len()],
    seen: [usize; PARTS.len()],
    location: f64,
    nll: f64,
    missed: usize,
    bins: [(usize, usize, f64); BINS],
}

impl SlotTally {
    /// Adds one movement at one part of the way: `distances[i]` is the distance of place `i` from the right one,
    /// `expected` that of the mean place.
    pub fn add(
        &mut self,
        part: usize,
        probabilities: &[f64],
        right: usize,
        distances: &[f64],
        expected: f64,
    ) {
        let top = (0..probabilities.len()).max_by(|a, b| probabilities[*a].total_cmp(&probabilities[*b]));
        let top = top.unwrap_or(0);
        let p = probabilities[right];
        self.seen[part] += 1;
        self.hits[part] += usize::from(top == right);
        self.nll -= libm::log(p.max(FLOOR));
        self.missed += usize::from(p < MISS);
        let bin = &mut self.bins[((probabilities[top] * BINS as f64) as usize).min(BINS - 1)];
        *bin = (bin.0 + 1, bin.1 + usize::from(top == right), bin.2 + probabilities[top]);
        let sum: f64 = distances.iter().sum();
        self.location += expected * distances.len() as f64 / sum.max(1e-9);
    }

    /// Adds the counts of another tally.
    pub fn merge(&mut self, other: &SlotTally) {
        for i in 0..PARTS.len() {
            self.hits[i] += other.hits[i];
            self.seen[i] += other.seen[i];
        }
        for (a, b) in self.bins.iter_mut().zip(other.bins) {
            *a = (a.0 + b.0, a.1 + b.1, a.2 + b.2);
        }
        self.location += other.location;
        self.nll += other.nll;
        self.missed += other.missed;
    }

    /// The score; nothing if no movement was seen at some part of the way.
    pub fn score(&self) -> Option<SlotScore> {
        let all: usize = self.seen.iter().sum();
        if self.seen.contains(&0) {
            return None;
        }
        let n = all as f64;
        let top1: [f64; PARTS.len()] = std::array::from_fn(|i| self.hits[i] as f64 / self.seen[i] as f64);
        let gap = |b: &(usize, usize, f64)| (b.1 as f64 - b.2).abs();
        Some(SlotScore {
            top1,
            top1_mean: top1.iter().sum::<f64>() / PARTS.len() as f64,
            location_error: self.location / n,
            nll: self.nll / n,
            ece: self.bins.iter().map(gap).sum::<f64>() / n,
            miss5: self.missed as f64 / n,
        })
    }
}

/// Adds a movement with scores of its candidates at the ten parts of the way.
pub fn tally_item(tally: &mut SlotTally, item: &ReachItem, scores: &[Vec<f64>], sharpness: f64) {
    let right = item.targets[item.right].hand;
    let distances: Vec<f64> = item.targets.iter().map(|t| (t.hand - right).norm()).collect();
    for (part, scores) in scores.iter().enumerate() {
        let mut p: Vec<f64> = scores.iter().map(|s| s * sharpness).collect();
        softmax(&mut p);
        let mean: ArmVector = item.targets.iter().zip(&p).map(|(t, p)| t.hand.coords * *p).sum();
        tally.add(part, &p, item.right, &distances, (mean - right.coords).norm());
    }
}

/// Indices of the samples nearest to the ten parts of a movement's way from onset to arrival.
pub fn way_samples(item: &ReachItem) -> [usize; PARTS.len()] {
    let at_s = |i: usize| item.samples[i].at_s;
    let (from, to) = (at_s(item.onset), at_s(item.arrival));
    PARTS.map(|part| {
        let wanted = from + (to - from) * part as f64 / 100.0;
        let far = |i: &usize| (at_s(*i) - wanted).abs();
        (item.onset..=item.arrival).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(item.onset)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sure_and_right_predictor_has_no_error_and_an_ignorant_one_is_calibrated() {
        let distances = [0.0, 1.0, 1.0, 2.0];
        let (mut sure, mut ignorant) = (SlotTally::default(), SlotTally::default());
        for part in 0..PARTS.len() {
            sure.add(part, &[1.0, 0.0, 0.0, 0.0], 0, &distances, 0.0);
            for right in 0..4 {
                ignorant.add(part, &[0.25; 4], right, &distances, 1.0);
            }
        }
        let (sure, ignorant) = (sure.score().unwrap(), ignorant.score().unwrap());
        assert_eq!(
            (sure.top1_mean, sure.nll, sure.ece, sure.miss5, sure.location_error),
            (1.0, 0.0, 0.0, 0.0, 0.0)
        );
        assert!((ignorant.nll - libm::log(4.0)).abs() < 1e-12 && ignorant.ece < 1e-12);
        assert_eq!((ignorant.top1_mean, ignorant.location_error), (0.25, 1.0));
    }

    #[test]
    fn parts_that_were_counted_apart_add_up() {
        let (mut a, mut b, mut both) = (SlotTally::default(), SlotTally::default(), SlotTally::default());
        for part in 0..PARTS.len() {
            a.add(part, &[0.7, 0.3], 0, &[0.0, 1.0], 0.3);
            b.add(part, &[0.2, 0.8], 0, &[0.0, 1.0], 0.8);
            both.add(part, &[0.7, 0.3], 0, &[0.0, 1.0], 0.3);
            both.add(part, &[0.2, 0.8], 0, &[0.0, 1.0], 0.8);
        }
        a.merge(&b);
        assert!((a.score().unwrap().nll - both.score().unwrap().nll).abs() < 1e-12);
        assert_eq!(a.score().unwrap().top1, both.score().unwrap().top1);
    }
}
