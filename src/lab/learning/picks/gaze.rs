//! Learning where eyes look if only the head is seen.
//!
//! Main functions: [`fit_gaze`], [`learn_gaze_net`], [`gaze_pairs`]. The loss uses lengths of errors, not their squares
//! (least squares with weights, repeated). Refuses: a claim about others from one wearer.

use super::perceptron::{Bend, Perceptron, learn_map};
use crate::picks::GazeTrial;
use giveway_people::reach::ArmVector;
use giveway_people::reach::gaze::{GAZE_FIGURES, gaze_figures};
use giveway_people::reach::sample::{angles, ray};
use giveway_sim::random::Stream;
use nalgebra::{SMatrix, SVector};

/// First sample that counts, seconds before the end of a trial.
pub const GAZE_FROM_S: f64 = -1.8;
/// Neurons of the published net (section 5.2.3).
const HIDDEN: usize = 10;
const ROUNDS: usize = 12;

/// Head, its speed, and the eyes: yaw and pitch each, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GazePair {
    /// Head angles.
    pub head: (f64, f64),
    /// Speed of the head angles, radians per second.
    pub speed: (f64, f64),
    /// Eye angles.
    pub eye: (f64, f64),
}

/// The samples of a trial that count.
pub fn gaze_pairs(trial: &GazeTrial) -> Vec<GazePair> {
    let pair = |i: usize| {
        let (now, before) = (trial.samples[i], trial.samples[i.saturating_sub(2)]);
        let dt = (now.at_s - before.at_s).max(0.02);
        let speed = ((now.head.0 - before.head.0) / dt, (now.head.1 - before.head.1) / dt);
        GazePair { head: now.head, speed, eye: now.eye }
    };
    (0..trial.samples.len()).filter(|i| trial.samples[*i].at_s > GAZE_FROM_S).map(pair).collect()
}

/// Angle between two directions, degrees.
pub fn degrees_between(a: (f64, f64), b: (f64, f64)) -> f64 {
    let cos = ray(a.0, a.1).dot(&ray(b.0, b.1)).clamp(-1.0, 1.0);
    libm::acos(cos).to_degrees()
}

/// Weights of the linear estimate.
pub fn fit_gaze(pairs: &[GazePair]) -> [[f64; GAZE_FIGURES]; 2] {
    let mut weights = [[0.0; GAZE_FIGURES]; 2];
    (weights[0][1], weights[1][2]) = (1.0, 1.0);
    for _ in 0..ROUNDS {
        let mut square = SMatrix::<f64, GAZE_FIGURES, GAZE_FIGURES>::identity() * 0.5;
        let mut sides = [SVector::<f64, GAZE_FIGURES>::zeros(); 2];
        // The rest is drawn to the head itself.
        (sides[0][1], sides[1][2]) = (0.5, 0.5);
        for pair in pairs {
            let figures = SVector::from(gaze_figures(pair.head, pair.speed));
            let said = |k: usize| SVector::from(weights[k]).dot(&figures);
            let error = libm::hypot(said(0) - pair.eye.0, said(1) - pair.eye.1);
            let counts = 1.0 / (error + 0.03);
            square += figures * figures.transpose() * counts;
            sides[0] += figures * (pair.eye.0 * counts);
            sides[1] += figures * (pair.eye.1 * counts);
        }
        let Some(root) = square.cholesky() else { break };
        weights = sides.map(|s| root.solve(&s).into());
    }
    weights
}

/// The published net without the hand, which is not recorded here: head direction to the eyes' direction.
pub(super) fn learn_gaze_net(pairs: &[GazePair], chance: &mut Stream) -> Perceptron {
    let rows = |of: fn(&GazePair) -> (f64, f64)| -> Vec<f32> {
        let unit = |p: &GazePair| -> [f32; 3] { ray(of(p).0, of(p).1).map(|v| v as f32).into() };
        pairs.iter().flat_map(unit).collect()
    };
    learn_gaze_from(3, &rows(|p| p.head), &rows(|p| p.eye), chance)
}

/// The published net: ten rectifiers between `inputs` numbers and the eyes' direction. `seen` and `eyes` (three
/// numbers) are rows of the same samples. Corrected: Adam instead of plain gradient descent.
pub fn learn_gaze_from(inputs: usize, seen: &[f32], eyes: &[f32], chance: &mut Stream) -> Perceptron {
    let mut net = Perceptron::new(&[inputs, HIDDEN, 3], Bend::Relu, chance);
    learn_map(&mut net, seen, eyes, 30, 0.01, chance);
    net
}

/// Yaw and pitch by the published net.
fn gaze_of(net: &Perceptron, head: (f64, f64)) -> (f64, f64) {
    let unit: [f32; 3] = ray(head.0, head.1).map(|v| v as f32).into();
    let said = net.apply(&unit);
    angles(ArmVector::new(said[0].into(), said[1].into(), said[2].into()))
}

/// What is wrong with the net's shape, if anything.
pub(super) fn gaze_net_fault(net: &Perceptron) -> Option<String> {
    net.fault(&[3, HIDDEN, 3])
}

/// Error of the published net, degrees.
pub fn gaze_net_degrees(net: &Perceptron, pair: &GazePair) -> f64 {
    degrees_between(gaze_of(net, pair.head), pair.eye)
}

/// Median and 90 % quantile of errors in degrees.
pub fn gaze_quantiles(mut errors: Vec<f64>) -> Option<(f64, f64)> {
    errors.sort_by(f64::total_cmp);
    let at = |share: f64| errors.get(((errors.len() as f64 - 1.0) * share).round() as usize).copied();
    Some((at(0.5)?, at(0.9)?))
}
