//! Where the arm will be within 0.4 seconds, with how sure that is.
//!
//! Main types: [`ArmNet`], [`ArmForecast`]. From ten samples, 0.04 s apart, one memory tells ten further places of
//! shoulder, forearm, hand and finger tip, and a width each. Widths become regions by figures that were fitted on
//! people left out, per horizon and speed. Refuses: to look farther than it was shown.

use super::features::{ArmMotion, BODY};
use super::net::squash::exp;
use super::net::{Affine, Lstm};
use super::sample::{ARM_PARTS, ArmPoint, ArmSample, ArmVector};
use serde::{Deserialize, Serialize};

/// Samples that are observed, and steps that are forecast.
pub const ARM_STEPS: usize = 10;
/// Between samples, seconds.
pub const ARM_STEP_S: f64 = 0.04;
/// Numbers the net says: three coordinates and a width for every part at every step.
pub const ARM_FIGURES: usize = ARM_STEPS * ARM_PARTS * 4;
/// Classes of the finger tip's speed, metres per second: below, between, above.
pub const SPEED_CLASSES: [f64; 2] = [0.5, 1.5];

/// Units per metre of the net's figures.
pub const ARM_SCALE: f64 = 10.0;
/// Over so many seconds a speed is expected to fade where the net says nothing.
const FADES_S: f64 = 0.25;

/// The net.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmNet {
    /// From figures of the body to a state.
    pub memory: Lstm,
    /// From the state to [`ARM_FIGURES`].
    pub out: Affine,
}

/// Places of the arm's parts in the next steps.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmForecast {
    /// Middle of each part at each step.
    pub middle: [[ArmPoint; ARM_PARTS]; ARM_STEPS],
    /// How wide, metres: a length that goes with the error, no region yet.
    pub width_m: [[f64; ARM_PARTS]; ARM_STEPS],
    /// Class of speed.
    pub class: usize,
}

/// Class of a speed of the finger tip.
pub fn speed_class(speed_mps: f64) -> usize {
    SPEED_CLASSES.iter().filter(|c| speed_mps > **c).count()
}

/// Where parts would be if their speeds faded.
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
    /// The forecast after [`ARM_STEPS`] samples; nothing of fewer than two.
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

    /// What is wrong with its shape or figures.
    pub fn fault(&self) -> Option<String> {
        self.memory.fault(BODY).or_else(|| self.out.fault(self.memory.hidden, ARM_FIGURES))
    }
}

/// A forecast from what the net says beside fading speeds.
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
