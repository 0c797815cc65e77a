//! Layers of nets, forward only: an affine map, a long short-term memory (Hochreiter and Schmidhuber 1997) and a plain
//! recurrent layer (Elman 1990).
//! Main types: [`Affine`], [`Lstm`], [`Elman`]. Weights are rows by input, so that one input meets all outputs in
//! memory order. Nothing here allocates: the caller provides the states. Refuses: to learn.

use super::squash::{sigmoid, tanh};
use serde::{Deserialize, Serialize};

/// `y = x W + b`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Affine {
    /// Length of `x`.
    pub inputs: usize,
    /// Length of `y`.
    pub outputs: usize,
    /// `W`: `inputs` rows of `outputs` numbers; in files as whole ten-thousandths.
    #[serde(with = "ten_thousandths")]
    pub weights: Vec<f32>,
    /// `b`; in files as whole ten-thousandths.
    #[serde(with = "ten_thousandths")]
    pub bias: Vec<f32>,
}

/// Weights in files: whole numbers of 0.0001, which are short, and never NaN.
mod ten_thousandths {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(weights: &[f32], to: S) -> Result<S::Ok, S::Error> {
        weights.iter().map(|w| (f64::from(*w) * 1e4).round() as i64).collect::<Vec<i64>>().serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f32>, D::Error> {
        Ok(Vec::<i64>::deserialize(from)?.into_iter().map(|w| (w as f64 / 1e4) as f32).collect())
    }
}

/// A long short-term memory. Its four gates, each `hidden` wide, are in the order input, forget, cell, output.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lstm {
    /// Length of the input.
    pub inputs: usize,
    /// Length of the state.
    pub hidden: usize,
    /// From input and state to the gates.
    pub gates: Affine,
}

/// A plain recurrent layer: `h = tanh([x, h] W + b)`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Elman {
    /// Length of the input.
    pub inputs: usize,
    /// From input and state to the state.
    pub map: Affine,
}

/// Adds `x W` to `y`, with rows of `x` and `y` of the given lengths. Four rows of `W` are processed at a time, which
/// fixes the order of additions.
pub fn add_product(x: &[f32], weights: &[f32], outputs: usize, y: &mut [f32]) {
    let inputs = weights.len() / outputs;
    for (x, y) in x.chunks_exact(inputs).zip(y.chunks_exact_mut(outputs)) {
        let (fours, rest) = x.as_chunks::<4>();
        for (x, rows) in fours.iter().zip(weights.chunks_exact(4 * outputs)) {
            let (w0, rows) = rows.split_at(outputs);
            let (w1, rows) = rows.split_at(outputs);
            let (w2, w3) = rows.split_at(outputs);
            for ((((y, w0), w1), w2), w3) in y.iter_mut().zip(w0).zip(w1).zip(w2).zip(w3) {
                *y += (x[0] * w0 + x[1] * w1) + (x[2] * w2 + x[3] * w3);
            }
        }
        let done = fours.len() * 4;
        for (x, row) in rest.iter().zip(weights[done * outputs..].chunks_exact(outputs)) {
            y.iter_mut().zip(row).for_each(|(y, w)| *y += x * w);
        }
    }
}

impl Affine {
    /// A map with all weights zero.
    pub fn new(inputs: usize, outputs: usize) -> Affine {
        Affine { inputs, outputs, weights: vec![0.0; inputs * outputs], bias: vec![0.0; outputs] }
    }

    /// Computes `y` from `x`; several rows at once if both hold several.
    pub fn apply(&self, x: &[f32], y: &mut [f32]) {
        y.chunks_exact_mut(self.outputs).for_each(|y| y.copy_from_slice(&self.bias));
        add_product(x, &self.weights, self.outputs, y);
    }

    /// Rounds all weights to the precision of a file.
    pub fn round(&mut self) {
        let all = self.weights.iter_mut().chain(&mut self.bias);
        all.for_each(|w| *w = ((f64::from(*w) * 1e4).round() / 1e4) as f32);
    }

    /// What is wrong with the map's shape or weights; nothing if it maps `inputs` numbers to `outputs` numbers.
    pub fn fault(&self, inputs: usize, outputs: usize) -> Option<String> {
        let is_shaped = self.inputs == inputs && self.outputs == outputs;
        let is_full = self.weights.len() == inputs * outputs && self.bias.len() == outputs;
        if !is_shaped || !is_full {
            let (i, o, n) = (self.inputs, self.outputs, self.weights.len());
            return Some(format!("a layer of {i} by {o} with {n} weights must be {inputs} by {outputs}"));
        }
        let all = self.weights.iter().chain(&self.bias);
        let is_sound = all.into_iter().all(|w| w.is_finite() && w.abs() < 1e4);
        (!is_sound).then(|| "a layer has weights that no net has learned".to_owned())
    }
}

impl Lstm {
    /// A memory with all weights zero.
    pub fn new(inputs: usize, hidden: usize) -> Lstm {
        Lstm { inputs, hidden, gates: Affine::new(inputs + hidden, 4 * hidden) }
    }

    /// One step of one sequence: `h` and `c` are its state, `z` has room for `4 × hidden` numbers.
    pub fn step(&self, x: &[f32], h: &mut [f32], c: &mut [f32], z: &mut [f32]) {
        let n = self.hidden;
        let (input_rows, state_rows) = self.gates.weights.split_at(self.inputs * 4 * n);
        z.copy_from_slice(&self.gates.bias);
        add_product(x, input_rows, 4 * n, z);
        add_product(h, state_rows, 4 * n, z);
        let (input, rest) = z.split_at_mut(n);
        let (forget, rest) = rest.split_at_mut(n);
        let (cell, output) = rest.split_at_mut(n);
        for k in 0..n {
            c[k] = sigmoid(forget[k]) * c[k] + sigmoid(input[k]) * tanh(cell[k]);
        }
        for k in 0..n {
            h[k] = sigmoid(output[k]) * tanh(c[k]);
        }
    }

    /// What is wrong with the memory's shape or weights, as for [`Affine::fault`].
    pub fn fault(&self, inputs: usize) -> Option<String> {
        if self.inputs != inputs || self.hidden == 0 {
            return Some(format!("a memory of {} inputs must have {inputs}", self.inputs));
        }
        self.gates.fault(inputs + self.hidden, 4 * self.hidden)
    }
}

impl Elman {
    /// A layer with all weights zero.
    pub fn new(inputs: usize, hidden: usize) -> Elman {
        Elman { inputs, map: Affine::new(inputs + hidden, hidden) }
    }

    /// One step of one sequence; `z` has room for the state.
    pub fn step(&self, x: &[f32], h: &mut [f32], z: &mut [f32]) {
        let n = self.map.outputs;
        let (input_rows, state_rows) = self.map.weights.split_at(self.inputs * n);
        z.copy_from_slice(&self.map.bias);
        add_product(x, input_rows, n, z);
        add_product(h, state_rows, n, z);
        h.iter_mut().zip(z).for_each(|(h, z)| *h = tanh(*z));
    }

    /// What is wrong with the layer's shape or weights, as for [`Affine::fault`].
    pub fn fault(&self, inputs: usize) -> Option<String> {
        if self.inputs != inputs || self.map.outputs == 0 {
            return Some(format!("a recurrent layer of {} inputs must have {inputs}", self.inputs));
        }
        self.map.fault(inputs + self.map.outputs, self.map.outputs)
    }
}
