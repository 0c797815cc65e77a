//! Destination first, posture after (seed 000, section 3.2): a variational autoencoder of postures predicts where the
//! hand will be, and a second net the posture for that.
//!
//! Main type: [`DestinationNets`]. Latent size 50, as published; from postures alone, since Giveway takes no pictures.
//! Its published horizons are 0.5 and 1.0 s; here it is 0.4 s, as far as the recordings' protocol looks. Refuses:
//! images.

use super::adam::Adam;
use super::arm::ArmWindow;
use super::course::{rate_at, shuffle};
use super::perceptron::{Bend, Perceptron, PerceptronTape, learn_map};
use giveway_people::reach::arm::ARM_STEPS;
use giveway_people::reach::net::squash::exp;
use giveway_people::reach::sample::{ARM_PARTS, ArmPoint, ArmVector};
use giveway_sim::random::Stream;
use serde::{Deserialize, Serialize};

/// Number of last postures that are used.
const LOOKED_AT: usize = 4;
const POSTURE: usize = 3 * ARM_PARTS;
const INPUTS: usize = LOOKED_AT * POSTURE;
const LATENT: usize = 50;
const HIDDEN: usize = 64;
/// Weight of the divergence from a normal distribution.
const DIVERGENCE: f32 = 1e-4;
/// Units of the nets per metre.
const SCALE: f64 = 5.0;

/// The three nets.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DestinationNets {
    /// Maps postures to mean and logarithm of the variance of the latent values.
    pub encoder: Perceptron,
    /// Maps latent values to the hand's destination.
    pub decoder: Perceptron,
    /// Maps posture and destination to the postures on the way.
    pub posture: Perceptron,
}

fn inputs(window: &ArmWindow) -> Vec<f32> {
    let shoulder = window.observed[ARM_STEPS - 1].shoulder;
    let last = window.observed[ARM_STEPS - LOOKED_AT..].iter();
    last.flat_map(|s| s.parts()).flat_map(|p| relative(p, shoulder)).collect()
}

fn relative(p: ArmPoint, shoulder: ArmPoint) -> [f32; 3] {
    ((p - shoulder) * SCALE).map(|v| v as f32).into()
}

impl DestinationNets {
    /// Learns from windows.
    pub(super) fn learn(windows: &[ArmWindow], epochs: usize, chance: &mut Stream) -> DestinationNets {
        let mut encoder = Perceptron::new(&[INPUTS, HIDDEN, 2 * LATENT], Bend::Tanh, chance);
        let mut decoder = Perceptron::new(&[LATENT, HIDDEN, 3], Bend::Tanh, chance);
        let mut posture = Perceptron::new(&[POSTURE + 3, HIDDEN, ARM_STEPS * POSTURE], Bend::Tanh, chance);
        autoencode(&mut encoder, &mut decoder, windows, epochs, chance);
        let (mut x, mut y) = (Vec::new(), Vec::new());
        for window in windows {
            let shoulder = window.observed[ARM_STEPS - 1].shoulder;
            let now = inputs(window);
            x.extend_from_slice(&now[INPUTS - POSTURE..]);
            x.extend(relative(window.after[ARM_STEPS - 1].hand, shoulder));
            let after = window.after.iter().flat_map(|s| s.parts()).flat_map(|p| relative(p, shoulder));
            let now = now[INPUTS - POSTURE..].iter().cycle();
            y.extend(after.zip(now).map(|(a, n)| a - n));
        }
        learn_map(&mut posture, &x, &y, epochs, 0.002, chance);
        DestinationNets { encoder, decoder, posture }
    }

    /// Positions of the arm's parts at the steps ahead, at the mean of the latent values.
    pub fn forecast(&self, window: &ArmWindow) -> [[ArmPoint; ARM_PARTS]; ARM_STEPS] {
        let now = inputs(window);
        let latent = self.encoder.apply(&now);
        let destination = self.decoder.apply(&latent[..LATENT]);
        let mut x = now[INPUTS - POSTURE..].to_vec();
        x.extend_from_slice(&destination);
        let changed = self.posture.apply(&x);
        let shoulder = window.observed[ARM_STEPS - 1].shoulder;
        std::array::from_fn(|k| {
            std::array::from_fn(|p| {
                let v = |d: usize| f64::from(x[3 * p + d] + changed[k * POSTURE + 3 * p + d]);
                shoulder + ArmVector::new(v(0), v(1), v(2)) / SCALE
            })
        })
    }

    /// What is wrong with the nets' shapes or weights, if anything.
    pub fn fault(&self) -> Option<String> {
        let encoder = self.encoder.fault(&[INPUTS, HIDDEN, 2 * LATENT]);
        let decoder = encoder.or_else(|| self.decoder.fault(&[LATENT, HIDDEN, 3]));
        decoder.or_else(|| self.posture.fault(&[POSTURE + 3, HIDDEN, ARM_STEPS * POSTURE]))
    }
}

fn autoencode(
    encoder: &mut Perceptron,
    decoder: &mut Perceptron,
    windows: &[ArmWindow],
    epochs: usize,
    chance: &mut Stream,
) {
    const BATCH: usize = 32;
    let (mut d_encoder, mut d_decoder, mut adam) = (encoder.zeros(), decoder.zeros(), Adam::new(0.0));
    let (mut first, mut second) = (PerceptronTape::default(), PerceptronTape::default());
    let mut order: Vec<usize> = (0..windows.len()).collect();
    let batches = windows.len().div_ceil(BATCH) * epochs;
    let mut done = 0;
    for _ in 0..epochs {
        shuffle(&mut order, chance);
        for batch in order.chunks(BATCH) {
            let x: Vec<f32> = batch.iter().flat_map(|i| inputs(&windows[*i])).collect();
            first.run(encoder, &x);
            let mut drawn = vec![0.0f32; batch.len() * LATENT];
            let noise: Vec<f32> = drawn.iter().map(|_| chance.normal() as f32).collect();
            for (i, z) in drawn.iter_mut().enumerate() {
                let (row, k) = (i / LATENT * 2 * LATENT, i % LATENT);
                let spread = exp(0.5 * first.output[row + LATENT + k].clamp(-10.0, 4.0));
                *z = first.output[row + k] + noise[i] * spread;
            }
            second.run(decoder, &drawn);
            let truth = batch.iter().flat_map(|i| {
                let window = &windows[*i];
                relative(window.after[ARM_STEPS - 1].hand, window.observed[ARM_STEPS - 1].shoulder)
            });
            let share = 1.0 / batch.len() as f32;
            let slopes: Vec<f32> =
                second.output.iter().zip(truth).map(|(a, b)| 2.0 * (a - b) * share).collect();
            let dz = second.back(decoder, &slopes, &mut d_decoder);
            let mut d_latent = vec![0.0f32; first.output.len()];
            for (i, dz) in dz.iter().enumerate() {
                let (row, k) = (i / LATENT * 2 * LATENT, i % LATENT);
                let (mean, log) = (first.output[row + k], first.output[row + LATENT + k].clamp(-10.0, 4.0));
                d_latent[row + k] = dz + DIVERGENCE * mean * share;
                let spread = exp(0.5 * log);
                d_latent[row + LATENT + k] =
                    dz * noise[i] * spread * 0.5 + DIVERGENCE * 0.5 * (spread * spread - 1.0) * share;
            }
            first.back(encoder, &d_latent, &mut d_encoder);
            let rate = rate_at(0.002, f64::from(done) / batches as f64);
            let mut weights = encoder.weights();
            weights.extend(decoder.weights());
            let mut gradients = d_encoder.weights();
            gradients.extend(d_decoder.weights());
            adam.step(rate, &mut weights, &mut gradients);
            done += 1;
        }
    }
}
