//! Where the arm will be within 0.4 seconds, and how certain that is.
//!
//! Main types: [`ArmNet`], [`ArmForecast`]. From ten samples, 0.04 s apart, one recurrent net predicts ten further
//! positions of shoulder, forearm, hand and finger tip, with a width each. Widths become regions by factors fitted on
//! people left out of training, per horizon and speed. Refuses: to look farther ahead than it was trained for.

use super::features::{ArmMotion, BODY};
use super::net::squash::exp;
use super::net::{Affine, Lstm};
use super::sample::{ARM_PARTS, ArmPoint, ArmSample, ArmVector};
use serde::{Deserialize, Serialize};

/// Number of observed samples, and of forecast steps.
pub const ARM_STEPS: usize = 10;
/// Time between samples, seconds.
pub const ARM_STEP_S: f64 = 0.04;
/// Number of outputs of the net: three coordinates and a width for every part at every step.
pub const ARM_FIGURES: usize = ARM_STEPS * ARM_PARTS * 4;
/// Boundaries between the classes of the finger tip's speed, metres per second.
pub const SPEED_CLASSES: [f64; 2] = [0.5, 1.5];

/// Units of the net per metre.
pub const ARM_SCALE: f64 = 10.0;
/// Time in which a speed fades if the net predicts no change, seconds.
const FADES_S: f64 = 0.25;

/// The net that forecasts an arm.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmNet {
    /// From body features to a state.
    pub memory: Lstm,
    /// From the state to [`ARM_FIGURES`].
    pub out: Affine,
}

/// Forecast positions of the arm's parts in the next steps.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmForecast {
    /// Middle of each part at each step.
    pub middle: [[ArmPoint; ARM_PARTS]; ARM_STEPS],
    /// Width of each part at each step, metres: a length proportional to the error, not yet a region.
    pub width_m: [[f64; ARM_PARTS]; ARM_STEPS],
    /// Class of speed.
    pub class: usize,
}

/// Class of a speed of the finger tip.
pub fn speed_class(speed_mps: f64) -> usize {
    SPEED_CLASSES.iter().filter(|c| speed_mps > **c).count()
}

/// Positions of the parts if their speeds faded.
pub fn fading(before: &ArmSample, last: &ArmSample) -> [[ArmPoint; ARM_PARTS]; ARM_STEPS] {
    let dt = (last.at_s - before.at_s).max(1e-3);
    let (old, new) = (before.parts(), last.parts());
    std::array::from_fn(|k| {
        let ahead_s = (k + 1) as f64 * ARM_STEP_S;
        let share = FADES_S * (1.0 - libm::exp(-ahead_s / FADES_S)) / dt;
        std::array::from_fn(|p| new[p] + (new[p] - old[p]) * share)
    })
}

impl ArmNet {
    /// The forecast after [`ARM_STEPS`] samples; nothing from fewer than two.
    pub fn forecast(&self, observed: &[ArmSample]) -> Option<ArmForecast> {
        let (first, last) = (observed.first()?, observed.last()?);
        let before = observed.get(observed.len().checked_sub(2)?)?;
        let n = self.memory.hidden;
        let (mut h, mut c, mut z) = (vec![0.0; n], vec![0.0; n], vec![0.0; 4 * n]);
        let (mut motion, mut body) = (ArmMotion::new(*first), [0.0; BODY]);
        for sample in observed {
            motion = motion.then(*sample);
            motion.body(&mut body);
            self.memory.step(&body, &mut h, &mut c, &mut z);
        }
        let mut said = [0.0; ARM_FIGURES];
        self.out.apply(&h, &mut said);
        Some(read(&said, &fading(before, last), speed_class(motion.velocity().norm())))
    }

    /// What is wrong with the net's shape or weights, if anything.
    pub fn fault(&self) -> Option<String> {
        self.memory.fault(BODY).or_else(|| self.out.fault(self.memory.hidden, ARM_FIGURES))
    }
}

/// A forecast from the net's outputs, which are relative to fading speeds.
pub fn read(said: &[f32], base: &[[ArmPoint; ARM_PARTS]; ARM_STEPS], class: usize) -> ArmForecast {
    let figure = |k: usize, p: usize| &said[(k * ARM_PARTS + p) * 4..][..4];
    let middle = std::array::from_fn(|k| {
        std::array::from_fn(|p| {
            let f = figure(k, p);
            base[k][p] + ArmVector::new(f[0].into(), f[1].into(), f[2].into()) / ARM_SCALE
        })
    });
    let width_m =
        std::array::from_fn(|k| std::array::from_fn(|p| f64::from(exp(figure(k, p)[3])) / ARM_SCALE));
    ArmForecast { middle, width_m, class }
}
