//! Training of nets that forecast the arm.
//!
//! Main types: [`ArmWindow`], main functions: [`windows`], [`learn_arm`]. The loss uses lengths of errors, not their
//! squares, and widths are learned with them (a Laplace distribution in space). Refuses: windows with gaps.

use super::adam::Adam;
use super::course::{rate_at, shuffle};
use super::items::ReachItem;
use super::layers::{LstmTape, Sequence, affine, affine_back, lstm};
use giveway_people::reach::ArmSample;
use giveway_people::reach::arm::{ARM_FIGURES, ARM_SCALE, ARM_STEPS, ArmNet, fading, read};
use giveway_people::reach::features::{ArmMotion, BODY};
use giveway_people::reach::net::squash::exp;
use giveway_people::reach::net::{Affine, Lstm};
use giveway_people::reach::sample::ARM_PARTS;
use giveway_sim::random::Stream;

/// Ten observed samples and the ten after them.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmWindow {
    /// Number of the person.
    pub person: usize,
    /// Observed samples; the first one is repeated if there are fewer.
    pub observed: [ArmSample; ARM_STEPS],
    /// The samples that followed.
    pub after: [ArmSample; ARM_STEPS],
}

/// All windows of a movement whose last observed sample lies between onset and arrival.
pub fn windows(item: &ReachItem) -> Vec<ArmWindow> {
    let last = item.arrival.min(item.samples.len().saturating_sub(ARM_STEPS));
    let window = |t: usize| ArmWindow {
        person: item.person,
        observed: std::array::from_fn(|k| item.samples[(t + k + 1).saturating_sub(ARM_STEPS)]),
        after: std::array::from_fn(|k| item.samples[t + k + 1]),
    };
    (item.onset + 1..last).map(window).collect()
}

/// Learns a net from windows.
pub fn learn_arm(windows: &[ArmWindow], hidden: usize, epochs: usize, chance: &mut Stream) -> ArmNet {
    const BATCH: usize = 32;
    let mut net = ArmNet { memory: lstm(BODY, hidden, chance), out: affine(hidden, ARM_FIGURES, chance) };
    net.out.weights.iter_mut().for_each(|w| *w *= 0.1);
    let mut gradient = ArmNet { memory: Lstm::new(BODY, hidden), out: Affine::new(hidden, ARM_FIGURES) };
    let (mut adam, mut tape) = (Adam::new(0.0), LstmTape::default());
    let mut order: Vec<usize> = (0..windows.len()).collect();
    let batches = windows.len().div_ceil(BATCH) * epochs;
    let mut done = 0;
    for _ in 0..epochs {
        shuffle(&mut order, chance);
        for batch in order.chunks(BATCH) {
            let batch: Vec<&ArmWindow> = batch.iter().map(|i| &windows[*i]).collect();
            batch_gradient(&net, &batch, &mut tape, &mut gradient);
            let (m, o) = (&mut net.memory.gates, &mut net.out);
            let mut weights = [&mut m.weights[..], &mut m.bias, &mut o.weights, &mut o.bias];
            let (m, o) = (&mut gradient.memory.gates, &mut gradient.out);
            let rate = rate_at(0.004, f64::from(done) / batches as f64);
            adam.step(
                rate,
                &mut weights,
                &mut [&mut m.weights[..], &mut m.bias, &mut o.weights, &mut o.bias],
            );
            done += 1;
        }
    }
    net
}

fn batch_gradient(net: &ArmNet, windows: &[&ArmWindow], tape: &mut LstmTape, gradient: &mut ArmNet) {
    let (rows, n) = (windows.len(), net.memory.hidden);
    let shape = Sequence { steps: ARM_STEPS, rows };
    let mut x = vec![0.0f32; ARM_STEPS * rows * BODY];
    for (row, window) in windows.iter().enumerate() {
        let mut motion = ArmMotion::new(window.observed[0]);
        for (t, sample) in window.observed.iter().enumerate() {
            motion = motion.then(*sample);
            motion.body(&mut x[(t * rows + row) * BODY..][..BODY]);
        }
    }
    tape.run(&net.memory, &x, shape, None);
    let last = (ARM_STEPS - 1) * rows * n;
    let states = tape.states(rows, n)[last..].to_vec();
    let mut said = vec![0.0f32; rows * ARM_FIGURES];
    net.out.apply(&states, &mut said);
    let mut slopes = vec![0.0f32; said.len()];
    for ((window, said), slopes) in
        windows.iter().zip(said.chunks(ARM_FIGURES)).zip(slopes.chunks_mut(ARM_FIGURES))
    {
        let base = fading(&window.observed[ARM_STEPS - 2], &window.observed[ARM_STEPS - 1]);
        let forecast = read(said, &base, 0);
        for k in 0..ARM_STEPS {
            let truth = window.after[k].parts();
            for (p, truth) in truth.into_iter().enumerate() {
                let at = (k * ARM_PARTS + p) * 4;
                let error = (forecast.middle[k][p] - truth) * ARM_SCALE;
                let length = (error.norm() + 1e-4) as f32;
                let sharp = exp(-said[at + 3]) / (rows * ARM_STEPS * ARM_PARTS) as f32;
                for d in 0..3 {
                    slopes[at + d] = error[d] as f32 / length * sharp;
                }
                slopes[at + 3] = 3.0 / (rows * ARM_STEPS * ARM_PARTS) as f32 - length * sharp;
            }
        }
    }
    let mut d_last = vec![0.0f32; states.len()];
    affine_back(&net.out, &states, &slopes, &mut gradient.out, Some(&mut d_last));
    let mut d_states = vec![0.0f32; ARM_STEPS * rows * n];
    d_states[last..].copy_from_slice(&d_last);
    tape.back(&net.memory, &x, &d_states, None, &mut gradient.memory, None);
}
