//! Unit vectors of bones (seed 003, section III): three recurrent layers, dropout, several draws as one batch.
//!
//! Main types: [`BoneNet`], [`BoneForecast`]. Every recurrent layer is followed by a dropout of 10 %, which stays on
//! for forecasts: the spread of the draws is equation 4, corrected (K·EᵀE stands outside of the sum) and per dimension.
//! Bones keep their lengths. Refuses: to call that spread a region.

use super::adam::Adam;
use super::arm::ArmWindow;
use super::course::{rate_at, shuffle};
use super::layers::{LstmTape, Sequence, affine, affine_back, lstm};
use giveway_people::reach::arm::ARM_STEPS;
use giveway_people::reach::net::{Affine, Lstm};
use giveway_people::reach::sample::{ARM_PARTS, ArmPoint, ArmSample, ArmVector};
use giveway_sim::random::Stream;
use serde::{Deserialize, Serialize};

/// Bones: shoulder to forearm, forearm to hand, hand to finger tip.
const BONES: usize = ARM_PARTS - 1;
const WIDTH: usize = 3 * BONES;
const OUTPUTS: usize = ARM_STEPS * WIDTH;
const HIDDEN: usize = 32;
const LAYERS: usize = 3;
/// Share of states that are dropped, as published.
const DROPOUT: f64 = 0.1;
/// Number of draws, as published.
pub const DRAWS: usize = 5;

/// The net that forecasts bones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoneNet {
    /// Three recurrent layers, one above the other.
    pub memories: Vec<Lstm>,
    /// Map from the last state to changes of all bones at all steps.
    pub out: Affine,
}

/// Mean and variance of the draws.
#[derive(Clone, Debug, PartialEq)]
pub struct BoneForecast {
    /// Mean positions of the arm's parts at the steps ahead.
    pub mean: [[ArmPoint; ARM_PARTS]; ARM_STEPS],
    /// Variance of each coordinate, m².
    pub variance: [[ArmVector; ARM_PARTS]; ARM_STEPS],
}

fn bones(sample: &ArmSample) -> [ArmVector; BONES] {
    let parts = sample.parts();
    std::array::from_fn(|b| parts[b + 1] - parts[b])
}

fn units(sample: &ArmSample, out: &mut [f32]) {
    for (out, bone) in out.chunks_exact_mut(3).zip(bones(sample)) {
        out.iter_mut().zip(bone.normalize().iter()).for_each(|(o, v)| *o = *v as f32);
    }
}

/// A random mask over `count` states; the kept ones are scaled up.
fn mask(count: usize, chance: &mut Stream) -> Vec<f32> {
    let kept = 1.0 / (1.0 - DROPOUT) as f32;
    (0..count).map(|_| if chance.happens(DROPOUT) { 0.0 } else { kept }).collect()
}

fn times(x: &mut [f32], mask: &[f32]) {
    x.chunks_exact_mut(mask.len()).for_each(|x| x.iter_mut().zip(mask).for_each(|(x, m)| *x *= m));
}

/// Intermediate values of a batch.
#[derive(Default)]
struct BoneTape {
    tapes: [LstmTape; LAYERS],
    inputs: [Vec<f32>; LAYERS + 1],
    masks: [Vec<f32>; LAYERS],
}

impl BoneNet {
    /// Learns from windows.
    pub(super) fn learn(windows: &[ArmWindow], epochs: usize, chance: &mut Stream) -> BoneNet {
        const BATCH: usize = 32;
        let inputs = |l: usize| if l == 0 { WIDTH } else { HIDDEN };
        let mut net = BoneNet {
            memories: (0..LAYERS).map(|l| lstm(inputs(l), HIDDEN, chance)).collect(),
            out: affine(HIDDEN, OUTPUTS, chance),
        };
        net.out.weights.iter_mut().for_each(|w| *w *= 0.1);
        let zero = (0..LAYERS).map(|l| Lstm::new(inputs(l), HIDDEN)).collect();
        let mut gradient = BoneNet { memories: zero, out: Affine::new(HIDDEN, OUTPUTS) };
        let (mut adam, mut tape) = (Adam::new(0.0), BoneTape::default());
        let mut order: Vec<usize> = (0..windows.len()).collect();
        let batches = windows.len().div_ceil(BATCH) * epochs;
        let mut done = 0;
        for _ in 0..epochs {
            shuffle(&mut order, chance);
            for batch in order.chunks(BATCH) {
                let batch: Vec<&ArmWindow> = batch.iter().map(|i| &windows[*i]).collect();
                net.gradient(&batch, &mut tape, &mut gradient, chance);
                let rate = rate_at(0.004, f64::from(done) / batches as f64);
                adam.step(rate, &mut net.weights(), &mut gradient.weights());
                done += 1;
            }
        }
        net
    }

    fn weights(&mut self) -> Vec<&mut [f32]> {
        let memories = self.memories.iter_mut().map(|m| &mut m.gates);
        memories.chain([&mut self.out]).flat_map(|a| [&mut a.weights[..], &mut a.bias[..]]).collect()
    }

    /// Runs a batch; the outputs are changes of unit vectors.
    fn run(&self, windows: &[&ArmWindow], tape: &mut BoneTape, chance: &mut Stream) -> Vec<f32> {
        let rows = windows.len();
        let shape = Sequence { steps: ARM_STEPS, rows };
        tape.inputs[0].resize(ARM_STEPS * rows * WIDTH, 0.0);
        for (row, window) in windows.iter().enumerate() {
            for (t, sample) in window.observed.iter().enumerate() {
                units(sample, &mut tape.inputs[0][(t * rows + row) * WIDTH..][..WIDTH]);
            }
        }
        for (l, memory) in self.memories.iter().enumerate() {
            tape.masks[l] = mask(rows * HIDDEN, chance);
            tape.tapes[l].run(memory, &tape.inputs[l], shape, None);
            let mut states = tape.tapes[l].states(rows, HIDDEN).to_vec();
            times(&mut states, &tape.masks[l]);
            tape.inputs[l + 1] = states;
        }
        let last = (ARM_STEPS - 1) * rows * HIDDEN;
        let mut said = vec![0.0f32; rows * OUTPUTS];
        self.out.apply(&tape.inputs[LAYERS][last..], &mut said);
        said
    }

    fn gradient(
        &self,
        windows: &[&ArmWindow],
        tape: &mut BoneTape,
        gradient: &mut BoneNet,
        chance: &mut Stream,
    ) {
        let rows = windows.len();
        let said = self.run(windows, tape, chance);
        let mut slopes = vec![0.0f32; said.len()];
        let (mut now, mut then) = ([0.0f32; WIDTH], [0.0f32; WIDTH]);
        for (row, window) in windows.iter().enumerate() {
            units(&window.observed[ARM_STEPS - 1], &mut now);
            for (k, after) in window.after.iter().enumerate() {
                units(after, &mut then);
                let at = row * OUTPUTS + k * WIDTH;
                for i in 0..WIDTH {
                    slopes[at + i] = (now[i] + said[at + i] - then[i]) / (rows * ARM_STEPS) as f32;
                }
            }
        }
        let last = (ARM_STEPS - 1) * rows * HIDDEN;
        let mut d = vec![0.0f32; ARM_STEPS * rows * HIDDEN];
        affine_back(
            &self.out,
            &tape.inputs[LAYERS][last..],
            &slopes,
            &mut gradient.out,
            Some(&mut d[last..]),
        );
        for l in (0..LAYERS).rev() {
            times(&mut d, &tape.masks[l]);
            let mut below = vec![0.0f32; tape.inputs[l].len()];
            let (memory, g) = (&self.memories[l], &mut gradient.memories[l]);
            tape.tapes[l].back(memory, &tape.inputs[l], &d, None, g, Some(&mut below));
            d = below;
        }
    }

    /// Mean and variance of [`DRAWS`] draws, computed as one batch.
    pub fn forecast(&self, window: &ArmWindow, chance: &mut Stream) -> BoneForecast {
        let said = self.run(&[window; DRAWS], &mut BoneTape::default(), chance);
        let last = &window.observed[ARM_STEPS - 1];
        let lengths = bones(last).map(|b| b.norm());
        let mut now = [0.0f32; WIDTH];
        units(last, &mut now);
        let place = |draw: usize, k: usize| -> [ArmPoint; ARM_PARTS] {
            let mut places = [last.shoulder; ARM_PARTS];
            for b in 0..BONES {
                let at = draw * OUTPUTS + k * WIDTH + 3 * b;
                let v = |d: usize| f64::from(now[3 * b + d] + said[at + d]);
                let unit = ArmVector::new(v(0), v(1), v(2)).normalize();
                places[b + 1] = places[b] + unit * lengths[b];
            }
            places
        };
        let all: Vec<[[ArmPoint; ARM_PARTS]; ARM_STEPS]> =
            (0..DRAWS).map(|draw| std::array::from_fn(|k| place(draw, k))).collect();
        let count = DRAWS as f64;
        let mean: [[ArmPoint; ARM_PARTS]; ARM_STEPS] = std::array::from_fn(|k| {
            std::array::from_fn(|p| {
                ArmPoint::from(all.iter().map(|a| a[k][p].coords).sum::<ArmVector>() / count)
            })
        });
        let spread = |k: usize, p: usize, mean: ArmPoint| {
            let square = |a: &[[ArmPoint; ARM_PARTS]; ARM_STEPS]| (a[k][p] - mean).map(|d| d * d);
            all.iter().map(square).sum::<ArmVector>() / (count - 1.0)
        };
        let variance = std::array::from_fn(|k| std::array::from_fn(|p| spread(k, p, mean[k][p])));
        BoneForecast { mean, variance }
    }

    /// What is wrong with the net's shape or weights, if anything.
    pub fn fault(&self) -> Option<String> {
        if self.memories.len() != LAYERS || self.memories.iter().any(|m| m.hidden != HIDDEN) {
            return Some(format!("it must have {LAYERS} memories of {HIDDEN} states"));
        }
        let inputs = |l: usize| if l == 0 { WIDTH } else { HIDDEN };
        let memories = self.memories.iter().enumerate().find_map(|(l, m)| m.fault(inputs(l)));
        memories.or_else(|| self.out.fault(HIDDEN, OUTPUTS))
    }
}
