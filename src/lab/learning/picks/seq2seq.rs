//! Sequence to sequence (seed 002, section III.A): an encoder and a decoder, from ten positions of the arm to ten.
//!
//! Main type: [`SeqToSeq`]. Hidden state 128, teacher forcing 0.6, joint weights of equation 1 with its missing index
//! j. The decoder outputs displacements; batch normalisation is left out. Refuses: to state its uncertainty.

use super::adam::Adam;
use super::arm::ArmWindow;
use super::course::{rate_at, shuffle};
use super::layers::{LstmTape, Sequence, affine, affine_back, lstm};
use giveway_people::reach::arm::ARM_STEPS;
use giveway_people::reach::net::{Affine, Lstm};
use giveway_people::reach::sample::{ARM_PARTS, ArmPoint, ArmSample, ArmVector};
use giveway_sim::random::Stream;
use serde::{Deserialize, Serialize};

/// Number of features of the arm at one step.
const WIDTH: usize = 3 * ARM_PARTS;
/// Size of the hidden state, as published.
const HIDDEN: usize = 128;
/// Share of decoder steps that are fed the truth during training.
const TEACHER: f64 = 0.6;
/// Weights of shoulder, elbow, wrist and palm in equation 1.
const WEIGHTS: [f32; ARM_PARTS] = [0.08, 0.16, 0.32, 0.44];
/// Units of the nets per metre.
const SCALE: f64 = 5.0;

/// The encoder and decoder nets.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeqToSeq {
    /// Reads the observed steps.
    pub encoder: Lstm,
    /// Writes the steps ahead.
    pub decoder: Lstm,
    /// Map from the decoder's state to displacements.
    pub out: Affine,
}

/// Features of the arm relative to a shoulder.
fn figures(sample: &ArmSample, shoulder: ArmPoint, out: &mut [f32]) {
    for (out, part) in out.chunks_exact_mut(3).zip(sample.parts()) {
        out.iter_mut().zip(((part - shoulder) * SCALE).iter()).for_each(|(o, v)| *o = *v as f32);
    }
}

impl SeqToSeq {
    /// Learns from windows.
    pub(super) fn learn(windows: &[ArmWindow], epochs: usize, chance: &mut Stream) -> SeqToSeq {
        const BATCH: usize = 64;
        let mut net = SeqToSeq {
            encoder: lstm(WIDTH, HIDDEN, chance),
            decoder: lstm(WIDTH, HIDDEN, chance),
            out: affine(HIDDEN, WIDTH, chance),
        };
        net.out.weights.iter_mut().for_each(|w| *w *= 0.1);
        let zero = || Lstm::new(WIDTH, HIDDEN);
        let mut gradient = SeqToSeq { encoder: zero(), decoder: zero(), out: Affine::new(HIDDEN, WIDTH) };
        let (mut adam, mut tapes) = (Adam::new(0.0), [LstmTape::default(), LstmTape::default()]);
        let mut order: Vec<usize> = (0..windows.len()).collect();
        let batches = windows.len().div_ceil(BATCH) * epochs;
        let mut done = 0;
        for _ in 0..epochs {
            shuffle(&mut order, chance);
            for batch in order.chunks(BATCH) {
                let batch: Vec<&ArmWindow> = batch.iter().map(|i| &windows[*i]).collect();
                net.gradient(&batch, &mut tapes, &mut gradient, chance);
                let rate = rate_at(0.005, f64::from(done) / batches as f64);
                adam.step(rate, &mut net.weights(), &mut gradient.weights());
                done += 1;
            }
        }
        net
    }

    fn weights(&mut self) -> Vec<&mut [f32]> {
        let (e, d, o) = (&mut self.encoder.gates, &mut self.decoder.gates, &mut self.out);
        vec![&mut e.weights, &mut e.bias, &mut d.weights, &mut d.bias, &mut o.weights, &mut o.bias]
    }

    fn gradient(
        &self,
        windows: &[&ArmWindow],
        tapes: &mut [LstmTape; 2],
        gradient: &mut SeqToSeq,
        chance: &mut Stream,
    ) {
        let rows = windows.len();
        let shape = Sequence { steps: ARM_STEPS, rows };
        let (seen, truth) = (self.seen(windows), self.truth(windows));
        let [encoder, decoder] = tapes;
        encoder.run(&self.encoder, &seen, shape, None);
        let (h, c) = encoder.end(rows, HIDDEN);
        let (h, c) = (h.to_vec(), c.to_vec());
        let inputs = self.decoder_inputs(&seen, Some((&truth, chance)), rows, &h, &c);
        decoder.run(&self.decoder, &inputs, shape, Some((&h, &c)));
        let states = decoder.states(rows, HIDDEN).to_vec();
        let mut said = vec![0.0f32; truth.len()];
        self.out.apply(&states, &mut said);
        let mut slopes = vec![0.0f32; said.len()];
        for i in (0..said.len()).step_by(3) {
            let weight = WEIGHTS[i % WIDTH / 3] / rows as f32;
            let error: [f32; 3] = std::array::from_fn(|d| inputs[i + d] + said[i + d] - truth[i + d]);
            let length = error.iter().map(|e| e * e).sum::<f32>().sqrt() + 1e-4;
            (0..3).for_each(|d| slopes[i + d] = weight * error[d] / length);
        }
        let mut d_states = vec![0.0f32; states.len()];
        affine_back(&self.out, &states, &slopes, &mut gradient.out, Some(&mut d_states));
        let g = &mut gradient.decoder;
        let (dh, dc) = decoder.back(&self.decoder, &inputs, &d_states, None, g, None);
        d_states.fill(0.0);
        encoder.back(&self.encoder, &seen, &d_states, Some((&dh, &dc)), &mut gradient.encoder, None);
    }

    fn seen(&self, windows: &[&ArmWindow]) -> Vec<f32> {
        rows_of(windows, |w, t| &w.observed[t])
    }

    fn truth(&self, windows: &[&ArmWindow]) -> Vec<f32> {
        rows_of(windows, |w, t| &w.after[t])
    }

    /// Inputs of the decoder: its own last step, or the truth as often as teacher forcing says.
    fn decoder_inputs(
        &self,
        seen: &[f32],
        mut taught: Option<(&[f32], &mut Stream)>,
        rows: usize,
        h: &[f32],
        c: &[f32],
    ) -> Vec<f32> {
        let size = rows * WIDTH;
        let mut inputs = vec![0.0f32; ARM_STEPS * size];
        inputs[..size].copy_from_slice(&seen[(ARM_STEPS - 1) * size..]);
        let (mut h, mut c, mut z) = (h.to_vec(), c.to_vec(), vec![0.0f32; 4 * HIDDEN]);
        let mut moved = [0.0f32; WIDTH];
        for t in 0..ARM_STEPS - 1 {
            let (before, after) = inputs.split_at_mut((t + 1) * size);
            let states = h.chunks_exact_mut(HIDDEN).zip(c.chunks_exact_mut(HIDDEN));
            for (row, (h, c)) in states.enumerate() {
                let span = row * WIDTH..(row + 1) * WIDTH;
                let now = &before[t * size..][span.clone()];
                self.decoder.step(now, h, c, &mut z);
                let next = &mut after[span.clone()];
                self.out.apply(h, &mut moved);
                next.iter_mut().zip(now).zip(&moved).for_each(|((n, x), m)| *n = x + m);
                if let Some((truth, chance)) = &mut taught
                    && chance.happens(TEACHER)
                {
                    next.copy_from_slice(&truth[t * size..][span]);
                }
            }
        }
        inputs
    }

    /// Positions of the arm's parts at the steps ahead.
    pub fn forecast(&self, window: &ArmWindow) -> [[ArmPoint; ARM_PARTS]; ARM_STEPS] {
        let seen = self.seen(&[window]);
        let (mut h, mut c, mut z) = (vec![0.0f32; HIDDEN], vec![0.0f32; HIDDEN], vec![0.0f32; 4 * HIDDEN]);
        seen.chunks_exact(WIDTH).for_each(|x| self.encoder.step(x, &mut h, &mut c, &mut z));
        let mut now: [f32; WIDTH] = std::array::from_fn(|i| seen[(ARM_STEPS - 1) * WIDTH + i]);
        let mut moved = [0.0f32; WIDTH];
        let shoulder = window.observed[ARM_STEPS - 1].shoulder;
        std::array::from_fn(|_| {
            self.decoder.step(&now, &mut h, &mut c, &mut z);
            self.out.apply(&h, &mut moved);
            now.iter_mut().zip(&moved).for_each(|(n, m)| *n += m);
            std::array::from_fn(|p| {
                let v = ArmVector::new(now[3 * p].into(), now[3 * p + 1].into(), now[3 * p + 2].into());
                shoulder + v / SCALE
            })
        })
    }

    /// What is wrong with the nets' shapes or weights, if anything.
    pub fn fault(&self) -> Option<String> {
        let memories = self.encoder.fault(WIDTH).or_else(|| self.decoder.fault(WIDTH));
        if self.encoder.hidden != HIDDEN || self.decoder.hidden != HIDDEN {
            return Some(format!("its memories must have {HIDDEN} states"));
        }
        memories.or_else(|| self.out.fault(HIDDEN, WIDTH))
    }
}

/// Steps of all windows, by time, relative to the shoulder seen last.
fn rows_of(windows: &[&ArmWindow], at: impl Fn(&ArmWindow, usize) -> &ArmSample) -> Vec<f32> {
    let rows = windows.len();
    let mut all = vec![0.0f32; ARM_STEPS * rows * WIDTH];
    for (row, window) in windows.iter().enumerate() {
        let shoulder = window.observed[ARM_STEPS - 1].shoulder;
        for t in 0..ARM_STEPS {
            figures(at(window, t), shoulder, &mut all[(t * rows + row) * WIDTH..][..WIDTH]);
        }
    }
    all
}
