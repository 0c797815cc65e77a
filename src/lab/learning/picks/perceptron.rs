//! Perceptrons of a few layers, forward and back.
//!
//! Main types: [`Perceptron`], [`Bend`]. Refuses: recurrence.

use super::adam::Adam;
use super::layers::{affine, affine_back};
use giveway_people::reach::net::Affine;
use giveway_people::reach::net::squash::tanh;
use giveway_sim::random::Stream;
use serde::{Deserialize, Serialize};

/// The function between layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Bend {
    /// Hyperbolic tangent.
    Tanh,
    /// Zero below zero, identity above.
    Relu,
}

/// Layers with a nonlinear function between each two.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Perceptron {
    /// The function between layers.
    pub bend: Bend,
    /// The layers, from input to output.
    pub layers: Vec<Affine>,
}

/// Intermediate values of a batch: the input of every layer.
#[derive(Clone, Debug, Default)]
pub(super) struct PerceptronTape {
    inputs: Vec<Vec<f32>>,
    /// Outputs of the batch.
    pub output: Vec<f32>,
}

impl Perceptron {
    /// A perceptron of these widths with random weights.
    pub(super) fn new(widths: &[usize], bend: Bend, chance: &mut Stream) -> Perceptron {
        let layers = widths.windows(2).map(|w| affine(w[0], w[1], chance)).collect();
        Perceptron { bend, layers }
    }

    /// A perceptron of the same shape with zero weights, for gradients.
    pub(super) fn zeros(&self) -> Perceptron {
        let layers = self.layers.iter().map(|l| Affine::new(l.inputs, l.outputs)).collect();
        Perceptron { bend: self.bend, layers }
    }

    /// The output for one or several inputs.
    pub fn apply(&self, x: &[f32]) -> Vec<f32> {
        let mut tape = PerceptronTape::default();
        tape.run(self, x);
        tape.output
    }

    /// All weights.
    pub(super) fn weights(&mut self) -> Vec<&mut [f32]> {
        self.layers.iter_mut().flat_map(|l| [&mut l.weights[..], &mut l.bias[..]]).collect()
    }

    /// What is wrong with the net's shape or weights, if anything.
    pub fn fault(&self, widths: &[usize]) -> Option<String> {
        if self.layers.len() + 1 != widths.len() {
            return Some(format!("a net of {} layers must have {}", self.layers.len(), widths.len() - 1));
        }
        self.layers.iter().zip(widths.windows(2)).find_map(|(l, w)| l.fault(w[0], w[1]))
    }
}

impl PerceptronTape {
    /// Runs a batch.
    pub fn run(&mut self, net: &Perceptron, x: &[f32]) {
        let rows = x.len() / net.layers[0].inputs;
        self.inputs.clear();
        let mut x = x.to_vec();
        for (i, layer) in net.layers.iter().enumerate() {
            let mut y = vec![0.0f32; rows * layer.outputs];
            layer.apply(&x, &mut y);
            if i + 1 < net.layers.len() {
                match net.bend {
                    Bend::Tanh => y.iter_mut().for_each(|v| *v = tanh(*v)),
                    Bend::Relu => y.iter_mut().for_each(|v| *v = v.max(0.0)),
                }
            }
            self.inputs.push(std::mem::replace(&mut x, y));
        }
        self.output = x;
    }

    /// Back-propagates: adds to the gradient, returns the gradient at the input.
    pub fn back(&self, net: &Perceptron, slopes: &[f32], gradient: &mut Perceptron) -> Vec<f32> {
        let mut d = slopes.to_vec();
        for (i, layer) in net.layers.iter().enumerate().rev() {
            let mut dx = vec![0.0f32; self.inputs[i].len()];
            affine_back(layer, &self.inputs[i], &d, &mut gradient.layers[i], Some(&mut dx));
            if i > 0 {
                for (d, y) in dx.iter_mut().zip(&self.inputs[i]) {
                    *d *= match net.bend {
                        Bend::Tanh => 1.0 - y * y,
                        Bend::Relu => f32::from(u8::from(*y > 0.0)),
                    };
                }
            }
            d = dx;
        }
        d
    }
}

/// Trains a map on pairs of rows by their mean squared error.
pub(super) fn learn_map(
    net: &mut Perceptron,
    x: &[f32],
    y: &[f32],
    epochs: usize,
    rate: f32,
    chance: &mut Stream,
) {
    const BATCH: usize = 32;
    let (inputs, outputs) = (net.layers[0].inputs, net.layers[net.layers.len() - 1].outputs);
    let mut order: Vec<usize> = (0..x.len() / inputs).collect();
    let (mut gradient, mut adam, mut tape) = (net.zeros(), Adam::new(0.0), PerceptronTape::default());
    let batches = order.len().div_ceil(BATCH) * epochs;
    let mut done = 0;
    for _ in 0..epochs {
        super::course::shuffle(&mut order, chance);
        for batch in order.chunks(BATCH) {
            let rows = |from: &[f32], n: usize| -> Vec<f32> {
                batch.iter().flat_map(|i| from[i * n..(i + 1) * n].iter().copied()).collect()
            };
            tape.run(net, &rows(x, inputs));
            let truth = rows(y, outputs);
            let slope = |(a, b): (&f32, &f32)| 2.0 * (a - b) / batch.len() as f32;
            let slopes: Vec<f32> = tape.output.iter().zip(&truth).map(slope).collect();
            tape.back(net, &slopes, &mut gradient);
            let rate = super::course::rate_at(rate, f64::from(done) / batches as f64);
            adam.step(rate, &mut net.weights(), &mut gradient.weights());
            done += 1;
        }
    }
}
