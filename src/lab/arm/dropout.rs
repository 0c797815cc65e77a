//! How much a spread by dropout says about the error of a forecast (Liu et al. 2024, equations 1 to 4, table II).
//!
//! Main types: [`DropoutNet`], [`DropoutFigures`]. Equation 4 is corrected: per dimension, u = (Σ F² − K E²) / (K − 1).
//! A small dense net stands for the published three layers of LSTM; it sees half a second of bone vectors and forecasts
//! one second. Refuses: to score people that it learned from, or to whose errors its scale was fitted.

use super::bolts::recorded;
use super::forecast::Watched;
use super::person::ArmJoints;
use super::teaching::{AdamMoments, drawn};
use giveway_sim::random::Stream;
use nalgebra::{DMatrix, Vector3};

/// Number of observed instants, 0.05 s apart.
const SEEN: usize = 10;
/// Number of forecast instants, 0.1 s apart.
const AHEAD: usize = 10;
/// Number of inputs per instant: two bone vectors.
const BONE_NUMBERS: usize = 6;
/// Width of both hidden layers.
const WIDTH: usize = 64;
/// Share of hidden units that are dropped.
const DROPPED: f64 = 0.1;
/// Samples per step of learning, and rounds over all samples.
const BATCH: usize = 32;
const ROUNDS: usize = 15;

/// One training example: what was seen, and what followed.
struct BoneLesson {
    seen: Vec<f64>,
    /// Changes of the bone vectors afterwards.
    came: Vec<f64>,
    /// Lengths of upper arm and forearm, metres.
    lengths_m: [f64; 2],
    /// Bone vectors now.
    now: [f64; BONE_NUMBERS],
}

/// A net with two hidden layers and dropout.
pub struct DropoutNet {
    /// Weights and biases, layer by layer.
    weights: Vec<DMatrix<f64>>,
}

/// Figures of the wrist's forecast for one number of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DropoutFigures {
    /// Mean standard deviation of the samples, millimetres.
    pub sd_mm: f64,
    /// Mean error of the samples' mean, millimetres.
    pub error_mm: f64,
    /// Correlation between error and standard deviation.
    pub correlation: f64,
    /// Share of coordinates within 1.96 standard deviations.
    pub cov95: f64,
    /// Share of coordinates within 1.96 scaled standard deviations.
    pub cov95_scaled: f64,
    /// The scale of standard deviations, fitted on other people.
    pub scale: f64,
}

/// Figures for each of these numbers of samples.
pub fn figures(seed: u64, counts: &[usize]) -> Vec<DropoutFigures> {
    let taught = lessons(seed, 0..8, 2);
    let net = DropoutNet::teach(seed, &taught);
    let (fitted, scored) = (lessons(seed, 20..23, 1), lessons(seed, 30..34, 1));
    let of = |count: &usize| {
        let (mut ratios, _) = net.scored(seed, &fitted, *count);
        ratios.sort_by(f64::total_cmp);
        let scale = ratios[ratios.len() * 95 / 100] / 1.96;
        let (ratios, pairs) = net.scored(seed + 1, &scored, *count);
        let within =
            |scale: f64| ratios.iter().filter(|r| **r <= 1.96 * scale).count() as f64 / ratios.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / pairs.len() as f64;
        DropoutFigures {
            sd_mm: mean(|p| p.1) * 1e3,
            error_mm: mean(|p| p.0) * 1e3,
            correlation: correlation(&pairs),
            cov95: within(1.0),
            cov95_scaled: within(scale),
            scale,
        }
    };
    counts.iter().map(of).collect()
}

/// Slope below zero: without it some inputs activate no unit at all, and dropout makes no difference.
const LEAK: f64 = 0.1;

fn rectified(x: f64) -> f64 {
    if x > 0.0 { x } else { LEAK * x }
}

fn correlation(pairs: &[(f64, f64)]) -> f64 {
    let n = pairs.len() as f64;
    let (a, b) = (pairs.iter().map(|p| p.0).sum::<f64>() / n, pairs.iter().map(|p| p.1).sum::<f64>() / n);
    let sum = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
    let cross = sum(&|p| (p.0 - a) * (p.1 - b));
    let (x, y) = (sum(&|p| (p.0 - a).powi(2)), sum(&|p| (p.1 - b).powi(2)));
    cross / (x * y).sqrt().max(1e-30)
}

fn bones(joints: &ArmJoints) -> [f64; BONE_NUMBERS] {
    let upper = (joints[1] - joints[0]).normalize();
    let fore = (joints[2] - joints[1]).normalize();
    [upper.x, upper.y, upper.z, fore.x, fore.y, fore.z]
}

fn lessons(seed: u64, people: std::ops::Range<u64>, times: usize) -> Vec<BoneLesson> {
    let each = |who: u64| (0..12).flat_map(move |target| recorded(seed, who, target, times));
    let all: Vec<Watched> = people.flat_map(each).map(|(full, _)| full).collect();
    let of = |watched: &Watched| -> Vec<BoneLesson> {
        let last = watched.len().saturating_sub(2 * AHEAD + 1);
        (SEEN..last.max(SEEN)).step_by(2).map(|at| lesson(watched, at)).collect()
    };
    all.iter().flat_map(of).collect()
}

fn lesson(watched: &Watched, at: usize) -> BoneLesson {
    let now = bones(&watched[at]);
    let seen = (at + 1 - SEEN..at).flat_map(|k| {
        let then = bones(&watched[k]);
        (0..BONE_NUMBERS).map(move |i| (then[i] - now[i]) * 5.0)
    });
    let came = (1..=AHEAD).flat_map(|h| {
        let then = bones(&watched[at + 2 * h]);
        (0..BONE_NUMBERS).map(move |i| then[i] - now[i])
    });
    let length = |k: usize| (watched[at][k + 1] - watched[at][k]).norm();
    BoneLesson {
        seen: now.into_iter().chain(seen).collect(),
        came: came.collect(),
        lengths_m: [length(0), length(1)],
        now,
    }
}

impl DropoutNet {
    fn teach(seed: u64, lessons: &[BoneLesson]) -> DropoutNet {
        let mut chance = Stream::new(seed, 96, 0);
        let widths = [SEEN * BONE_NUMBERS, WIDTH, WIDTH, AHEAD * BONE_NUMBERS];
        let layer = |k: usize, chance: &mut Stream| {
            [drawn(chance, widths[k], widths[k + 1]), DMatrix::zeros(1, widths[k + 1])]
        };
        let weights: Vec<DMatrix<f64>> = (0..3).flat_map(|k| layer(k, &mut chance)).collect();
        let mut net = DropoutNet { weights };
        let mut adam = AdamMoments::new(1e-3, &net.weights.iter().collect::<Vec<_>>());
        let mut order: Vec<usize> = (0..lessons.len()).collect();
        for round in 0..ROUNDS {
            adam.set_rate(1e-3 * (1.0 - 0.9 * round as f64 / ROUNDS as f64));
            (1..order.len()).rev().for_each(|k| order.swap(k, chance.below(k + 1)));
            for batch in order.chunks(BATCH) {
                let rows = batch.len();
                let input = DMatrix::from_fn(rows, widths[0], |r, c| lessons[batch[r]].seen[c]);
                let wanted = DMatrix::from_fn(rows, widths[3], |r, c| lessons[batch[r]].came[c]);
                let gradients = net.gradients(&input, &wanted, &mut chance);
                adam.descend(&mut net.weights.iter_mut().collect::<Vec<_>>(), &gradients);
            }
        }
        net
    }

    /// The output of a layer, with some units dropped.
    fn layer(&self, k: usize, input: &DMatrix<f64>) -> DMatrix<f64> {
        let mut z = input * &self.weights[2 * k];
        for mut row in z.row_iter_mut() {
            row += self.weights[2 * k + 1].row(0);
        }
        z
    }

    fn mask(rows: usize, chance: &mut Stream) -> DMatrix<f64> {
        let keep = 1.0 / (1.0 - DROPPED);
        DMatrix::from_fn(rows, WIDTH, |_, _| if chance.happens_of(DROPPED) { 0.0 } else { keep })
    }

    /// Gradients of the mean squared error, layer by layer.
    fn gradients(
        &self,
        input: &DMatrix<f64>,
        wanted: &DMatrix<f64>,
        chance: &mut Stream,
    ) -> Vec<DMatrix<f64>> {
        let rows = input.nrows();
        let masks = [DropoutNet::mask(rows, chance), DropoutNet::mask(rows, chance)];
        let h1 = self.layer(0, input).map(rectified).component_mul(&masks[0]);
        let h2 = self.layer(1, &h1).map(rectified).component_mul(&masks[1]);
        let off = (self.layer(2, &h2) - wanted) * (2.0 / rows as f64);
        let active = |h: &DMatrix<f64>, mask: &DMatrix<f64>, back: DMatrix<f64>| {
            let open = h.zip_map(mask, |h, m| if h > 0.0 { m } else { LEAK * m });
            back.component_mul(&open)
        };
        let sums = |m: &DMatrix<f64>| DMatrix::from_fn(1, m.ncols(), |_, c| m.column(c).sum());
        let d2 = active(&h2, &masks[1], &off * self.weights[4].transpose());
        let d1 = active(&h1, &masks[0], &d2 * self.weights[2].transpose());
        vec![
            input.transpose() * &d1,
            sums(&d1),
            h1.transpose() * &d2,
            sums(&d2),
            h2.transpose() * &off,
            sums(&off),
        ]
    }

    /// Samples of one forecast as one batch: the input in `count` rows, each with its own mask.
    fn sampled(&self, lesson: &BoneLesson, count: usize, chance: &mut Stream) -> DMatrix<f64> {
        let input = DMatrix::from_fn(count, lesson.seen.len(), |_, c| lesson.seen[c]);
        let h1 = self.layer(0, &input).map(rectified).component_mul(&DropoutNet::mask(count, chance));
        let h2 = self.layer(1, &h1).map(rectified).component_mul(&DropoutNet::mask(count, chance));
        self.layer(2, &h2)
    }

    /// For all coordinates of the wrist, errors in units of their standard deviation; and for all wrists, error and
    /// standard deviation, metres.
    fn scored(&self, seed: u64, lessons: &[BoneLesson], count: usize) -> (Vec<f64>, Vec<(f64, f64)>) {
        let mut chance = Stream::new(seed, 97, count as u64);
        let (mut ratios, mut pairs) = (Vec::new(), Vec::new());
        for lesson in lessons.iter().step_by(3) {
            let samples = self.sampled(lesson, count, &mut chance);
            for h in 0..AHEAD {
                let wrist = |change: &dyn Fn(usize) -> f64| {
                    let at = |i: usize| lesson.now[i] + change(h * BONE_NUMBERS + i);
                    let bone = |k: usize| Vector3::new(at(k), at(k + 1), at(k + 2)).normalize();
                    bone(0) * lesson.lengths_m[0] + bone(3) * lesson.lengths_m[1]
                };
                let all: Vec<Vector3<f64>> = (0..count).map(|s| wrist(&|c| samples[(s, c)])).collect();
                let k = count as f64;
                let mean: Vector3<f64> = all.iter().sum::<Vector3<f64>>() / k;
                let squares: Vector3<f64> = all.iter().map(|f| f.component_mul(f)).sum();
                let u = (squares - mean.component_mul(&mean) * k) / (k - 1.0);
                let off = wrist(&|c| lesson.came[c]) - mean;
                ratios.extend((0..3).map(|i| off[i].abs() / u[i].max(1e-12).sqrt()));
                pairs.push((off.norm(), u.sum().max(0.0).sqrt()));
            }
        }
        (ratios, pairs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_of_the_dropout_net_are_slopes() {
        let mut chance = Stream::new(2, 0, 0);
        let net = DropoutNet::teach(1, &[]);
        let input = drawn(&mut chance, 3, SEEN * BONE_NUMBERS);
        let wanted = drawn(&mut chance, 3, AHEAD * BONE_NUMBERS);
        // The same masks each time.
        let masks = || Stream::new(9, 0, 0);
        let error = |net: &DropoutNet| {
            let mut chance = masks();
            let [m1, m2] = [DropoutNet::mask(3, &mut chance), DropoutNet::mask(3, &mut chance)];
            let h1 = net.layer(0, &input).map(rectified).component_mul(&m1);
            let h2 = net.layer(1, &h1).map(rectified).component_mul(&m2);
            (net.layer(2, &h2) - &wanted).norm_squared() / 3.0
        };
        let gradients = net.gradients(&input, &wanted, &mut masks());
        for (k, at) in [(0, (3, 5)), (1, (0, 7)), (2, (2, 9)), (4, (5, 1)), (5, (0, 3))] {
            let mut moved = DropoutNet { weights: net.weights.clone() };
            moved.weights[k][at] += 1e-6;
            let slope = (error(&moved) - error(&net)) / 1e-6;
            assert!((slope - gradients[k][at]).abs() < 1e-3 * slope.abs().max(1.0), "{k}: {slope}");
        }
    }

    #[test]
    fn what_goes_together_is_correlated() {
        assert!((correlation(&[(1.0, 2.0), (2.0, 4.0), (3.0, 6.0)]) - 1.0).abs() < 1e-12);
        assert!((correlation(&[(1.0, 6.0), (2.0, 4.0), (3.0, 2.0)]) + 1.0).abs() < 1e-12);
    }
}
