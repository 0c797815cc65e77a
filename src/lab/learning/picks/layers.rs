//! Back-propagation through layers, for batches of sequences (Werbos 1990).
//!
//! Main types: [`Sequence`] (shape of a batch), [`LstmTape`], [`ElmanTape`]. Numbers are ordered by time, then by
//! sequence of the batch, then by feature. Gradients have the form of the layer itself. The order of additions is
//! fixed, so the same data give the same bytes. Refuses: to choose what is learned.

use giveway_people::reach::net::squash::{sigmoid, tanh};
use giveway_people::reach::net::{Affine, Elman, Lstm, add_product};
use giveway_sim::random::Stream;

/// Shape of a batch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Sequence {
    /// Number of time steps.
    pub steps: usize,
    /// Number of sequences.
    pub rows: usize,
}

/// Adds `d Wᵀ` to `x`: back through a product. Sums are kept in eight parts, in a fixed order.
pub(super) fn add_transposed(d: &[f32], weights: &[f32], outputs: usize, x: &mut [f32]) {
    let inputs = weights.len() / outputs;
    for (d, x) in d.chunks_exact(outputs).zip(x.chunks_exact_mut(inputs)) {
        for (x, row) in x.iter_mut().zip(weights.chunks_exact(outputs)) {
            let ((d8, d1), (w8, w1)) = (d.as_chunks::<8>(), row.as_chunks::<8>());
            let mut sums = [0.0f32; 8];
            for (d, w) in d8.iter().zip(w8) {
                for k in 0..8 {
                    sums[k] += d[k] * w[k];
                }
            }
            let rest: f32 = d1.iter().zip(w1).map(|(d, w)| d * w).sum();
            let [a, b, c, e, f, g, h, i] = sums;
            *x += ((a + b) + (c + e)) + ((f + g) + (h + i)) + rest;
        }
    }
}

/// Adds `xᵀ d` to the gradient of weights, four rows at a time.
pub(super) fn add_outer(x: &[f32], d: &[f32], outputs: usize, gradient: &mut [f32]) {
    let inputs = gradient.len() / outputs;
    let (xs, ds) = (x.chunks_exact(4 * inputs), d.chunks_exact(4 * outputs));
    let (x_rest, d_rest) = (xs.remainder(), ds.remainder());
    for (x, d) in xs.zip(ds) {
        let (d0, rest) = d.split_at(outputs);
        let (d1, rest) = rest.split_at(outputs);
        let (d2, d3) = rest.split_at(outputs);
        for (i, row) in gradient.chunks_exact_mut(outputs).enumerate() {
            let x = [x[i], x[inputs + i], x[2 * inputs + i], x[3 * inputs + i]];
            for ((((g, d0), d1), d2), d3) in row.iter_mut().zip(d0).zip(d1).zip(d2).zip(d3) {
                *g += (x[0] * d0 + x[1] * d1) + (x[2] * d2 + x[3] * d3);
            }
        }
    }
    for (x, d) in x_rest.chunks_exact(inputs).zip(d_rest.chunks_exact(outputs)) {
        for (x, row) in x.iter().zip(gradient.chunks_exact_mut(outputs)) {
            row.iter_mut().zip(d).for_each(|(g, d)| *g += x * d);
        }
    }
}

/// Random weights of a layer (Glorot and Bengio 2010).
pub(super) fn affine(inputs: usize, outputs: usize, chance: &mut Stream) -> Affine {
    let mut layer = Affine::new(inputs, outputs);
    let width = (6.0 / (inputs + outputs) as f64).sqrt();
    layer.weights.iter_mut().for_each(|w| *w = chance.between(-width, width) as f32);
    layer
}

/// Random weights of a memory; its forget gates begin open.
pub(super) fn lstm(inputs: usize, hidden: usize, chance: &mut Stream) -> Lstm {
    let mut layer = Lstm::new(inputs, hidden);
    let width = (6.0 / (inputs + 2 * hidden) as f64).sqrt();
    layer.gates.weights.iter_mut().for_each(|w| *w = chance.between(-width, width) as f32);
    layer.gates.bias[hidden..2 * hidden].fill(1.0);
    layer
}

/// Random weights of a recurrent layer.
pub(super) fn elman(inputs: usize, hidden: usize, chance: &mut Stream) -> Elman {
    Elman { inputs, map: affine(inputs + hidden, hidden, chance) }
}

/// Back through an affine map: adds to the gradient, and to `dx` if given.
pub(super) fn affine_back(
    layer: &Affine,
    x: &[f32],
    dy: &[f32],
    gradient: &mut Affine,
    dx: Option<&mut [f32]>,
) {
    add_outer(x, dy, layer.outputs, &mut gradient.weights);
    for dy in dy.chunks_exact(layer.outputs) {
        gradient.bias.iter_mut().zip(dy).for_each(|(g, d)| *g += d);
    }
    if let Some(dx) = dx {
        add_transposed(dy, &layer.weights, layer.outputs, dx);
    }
}

/// Intermediate values of a memory for a batch: gates after their functions, cells, and states.
#[derive(Clone, Debug, Default)]
pub(super) struct LstmTape {
    gates: Vec<f32>,
    cells: Vec<f32>,
    /// States, including those before the first step.
    states: Vec<f32>,
    slopes: Vec<f32>,
    shape: Sequence,
}

impl LstmTape {
    /// States after each step.
    pub fn states(&self, rows: usize, hidden: usize) -> &[f32] {
        &self.states[rows * hidden..]
    }

    /// State and cell after the last step.
    pub fn end(&self, rows: usize, hidden: usize) -> (&[f32], &[f32]) {
        let size = rows * hidden;
        (&self.states[self.states.len() - size..], &self.cells[self.cells.len() - size..])
    }

    /// Runs a batch, from zero states and cells or from given ones.
    pub fn run(&mut self, layer: &Lstm, x: &[f32], shape: Sequence, start: Option<(&[f32], &[f32])>) {
        self.shape = shape;
        let Sequence { steps, rows } = shape;
        let (n, width) = (layer.hidden, 4 * layer.hidden);
        let (input_rows, state_rows) = layer.gates.weights.split_at(layer.inputs * width);
        self.gates.resize(steps * rows * width, 0.0);
        self.cells.resize((steps + 1) * rows * n, 0.0);
        self.states.resize((steps + 1) * rows * n, 0.0);
        let (h, c) = (&mut self.states[..rows * n], &mut self.cells[..rows * n]);
        match start {
            Some((state, cell)) => (h.copy_from_slice(state), c.copy_from_slice(cell)),
            None => (h.fill(0.0), c.fill(0.0)),
        };
        self.gates.chunks_exact_mut(width).for_each(|z| z.copy_from_slice(&layer.gates.bias));
        add_product(x, input_rows, width, &mut self.gates);
        for t in 0..steps {
            let z = &mut self.gates[t * rows * width..(t + 1) * rows * width];
            let (before, after) = self.states.split_at_mut((t + 1) * rows * n);
            add_product(&before[t * rows * n..], state_rows, width, z);
            let (old, new) = self.cells.split_at_mut((t + 1) * rows * n);
            let old = &old[t * rows * n..];
            let by_row = z.chunks_exact_mut(width).zip(old.chunks_exact(n));
            let by_row = by_row.zip(new.chunks_exact_mut(n)).zip(after.chunks_exact_mut(n));
            for (((z, old), new), h) in by_row {
                let (i, rest) = z.split_at_mut(n);
                let (f, rest) = rest.split_at_mut(n);
                let (g, o) = rest.split_at_mut(n);
                i.iter_mut().for_each(|v| *v = sigmoid(*v));
                f.iter_mut().for_each(|v| *v = sigmoid(*v));
                g.iter_mut().for_each(|v| *v = tanh(*v));
                o.iter_mut().for_each(|v| *v = sigmoid(*v));
                for k in 0..n {
                    new[k] = f[k] * old[k] + i[k] * g[k];
                }
                for k in 0..n {
                    h[k] = o[k] * tanh(new[k]);
                }
            }
        }
    }

    /// Back through all steps: `dh` is the gradient at each state, `end` a further one at the last state and cell. Adds
    /// to the layer's gradient and to `dx`; returns the gradient at the first state and cell.
    pub fn back(
        &mut self,
        layer: &Lstm,
        x: &[f32],
        dh: &[f32],
        end: Option<(&[f32], &[f32])>,
        gradient: &mut Lstm,
        dx: Option<&mut [f32]>,
    ) -> (Vec<f32>, Vec<f32>) {
        let Sequence { steps, rows } = self.shape;
        let (n, width) = (layer.hidden, 4 * layer.hidden);
        let (input_rows, state_rows) = layer.gates.weights.split_at(layer.inputs * width);
        let (mut dh_next, mut dc) = match end {
            Some((h, c)) => (h.to_vec(), c.to_vec()),
            None => (vec![0.0; rows * n], vec![0.0; rows * n]),
        };
        self.slopes.resize(steps * rows * width, 0.0);
        for t in (0..steps).rev() {
            let span = t * rows * n..(t + 1) * rows * n;
            let later = (t + 1) * rows * n..(t + 2) * rows * n;
            dh_next.iter_mut().zip(&dh[span.clone()]).for_each(|(a, b)| *a += b);
            let z = &self.gates[t * rows * width..(t + 1) * rows * width];
            let d = &mut self.slopes[t * rows * width..(t + 1) * rows * width];
            let cells = self.cells[span].chunks_exact(n).zip(self.cells[later].chunks_exact(n));
            let by_row = z.chunks_exact(width).zip(d.chunks_exact_mut(width)).zip(cells);
            let by_row = by_row.zip(dh_next.chunks_exact(n).zip(dc.chunks_exact_mut(n)));
            for (((z, d), (old, new)), (dh, dc)) in by_row {
                gate_slopes(z, d, old, new, dh, dc);
            }
            dh_next.fill(0.0);
            add_transposed(d, state_rows, width, &mut dh_next);
        }
        let (input_gradient, state_gradient) = gradient.gates.weights.split_at_mut(layer.inputs * width);
        add_outer(x, &self.slopes, width, input_gradient);
        add_outer(&self.states[..steps * rows * n], &self.slopes, width, state_gradient);
        for d in self.slopes.chunks_exact(width) {
            gradient.gates.bias.iter_mut().zip(d).for_each(|(g, d)| *g += d);
        }
        if let Some(dx) = dx {
            add_transposed(&self.slopes, input_rows, width, dx);
        }
        (dh_next, dc)
    }
}

/// Gradients before the gates' functions of one row at one step; `dc` continues to the step before.
fn gate_slopes(z: &[f32], d: &mut [f32], old: &[f32], new: &[f32], dh: &[f32], dc: &mut [f32]) {
    let n = old.len();
    let ((i, z), (di, d)) = (z.split_at(n), d.split_at_mut(n));
    let ((f, z), (df, d)) = (z.split_at(n), d.split_at_mut(n));
    let ((g, o), (dg, d_o)) = (z.split_at(n), d.split_at_mut(n));
    for k in 0..n {
        let squashed = tanh(new[k]);
        d_o[k] = dh[k] * squashed * o[k] * (1.0 - o[k]);
        let cell = dc[k] + dh[k] * o[k] * (1.0 - squashed * squashed);
        di[k] = cell * g[k] * i[k] * (1.0 - i[k]);
        df[k] = cell * old[k] * f[k] * (1.0 - f[k]);
        dg[k] = cell * i[k] * (1.0 - g[k] * g[k]);
        dc[k] = cell * f[k];
    }
}

/// Intermediate values of a recurrent layer for a batch.
#[derive(Clone, Debug, Default)]
pub(super) struct ElmanTape {
    states: Vec<f32>,
    slopes: Vec<f32>,
}

impl ElmanTape {
    /// States after each step.
    pub fn states(&self, rows: usize, hidden: usize) -> &[f32] {
        &self.states[rows * hidden..]
    }

    /// Runs a batch from zero states.
    pub fn run(&mut self, layer: &Elman, x: &[f32], shape: Sequence) {
        let Sequence { steps, rows } = shape;
        let n = layer.map.outputs;
        let (input_rows, state_rows) = layer.map.weights.split_at(layer.inputs * n);
        self.states.resize((steps + 1) * rows * n, 0.0);
        self.states[..rows * n].fill(0.0);
        self.states[rows * n..].chunks_exact_mut(n).for_each(|z| z.copy_from_slice(&layer.map.bias));
        add_product(x, input_rows, n, &mut self.states[rows * n..]);
        for t in 0..steps {
            let (before, after) = self.states.split_at_mut((t + 1) * rows * n);
            let z = &mut after[..rows * n];
            add_product(&before[t * rows * n..], state_rows, n, z);
            z.iter_mut().for_each(|z| *z = tanh(*z));
        }
    }

    /// Back through all steps, as for [`LstmTape::back`].
    pub fn back(
        &mut self,
        layer: &Elman,
        x: &[f32],
        shape: Sequence,
        dh: &[f32],
        gradient: &mut Elman,
        dx: Option<&mut [f32]>,
    ) {
        let Sequence { steps, rows } = shape;
        let n = layer.map.outputs;
        let (input_rows, state_rows) = layer.map.weights.split_at(layer.inputs * n);
        let mut next = vec![0.0; rows * n];
        self.slopes.resize(steps * rows * n, 0.0);
        for t in (0..steps).rev() {
            let states = &self.states[(t + 1) * rows * n..(t + 2) * rows * n];
            let d = &mut self.slopes[t * rows * n..(t + 1) * rows * n];
            let both = dh[t * rows * n..].iter().zip(&next);
            for ((d, h), (a, b)) in d.iter_mut().zip(states).zip(both) {
                *d = (a + b) * (1.0 - h * h);
            }
            next.fill(0.0);
            add_transposed(d, state_rows, n, &mut next);
        }
        let (input_gradient, state_gradient) = gradient.map.weights.split_at_mut(layer.inputs * n);
        add_outer(x, &self.slopes, n, input_gradient);
        add_outer(&self.states[..steps * rows * n], &self.slopes, n, state_gradient);
        for d in self.slopes.chunks_exact(n) {
            gradient.map.bias.iter_mut().zip(d).for_each(|(g, d)| *g += d);
        }
        if let Some(dx) = dx {
            add_transposed(&self.slopes, input_rows, n, dx);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A loss that is a weighted sum of all states, so that its gradient is known.
    fn loss(states: &[f32]) -> f64 {
        states.iter().enumerate().map(|(i, s)| f64::from(*s) * libm::sin(i as f64)).sum()
    }

    fn slopes(count: usize) -> Vec<f32> {
        (0..count).map(|i| libm::sin(i as f64) as f32).collect()
    }

    /// Compares the gradient with the difference quotient for some weights.
    fn check(analytic: &[f32], mut loss_with: impl FnMut(usize, f32) -> f64) {
        for i in (0..analytic.len()).step_by(7) {
            let quotient = (loss_with(i, 1e-2) - loss_with(i, -1e-2)) / 2e-2;
            let error = (quotient - f64::from(analytic[i])).abs();
            assert!(error < 2e-3 * (1.0 + quotient.abs()), "weight {i}: {quotient} and {}", analytic[i]);
        }
    }

    #[test]
    fn gradients_of_memories_are_difference_quotients() {
        let (shape, mut chance) = (Sequence { steps: 6, rows: 3 }, Stream::new(1, 1, 1));
        let layer = lstm(5, 4, &mut chance);
        let x: Vec<f32> = (0..6 * 3 * 5).map(|_| chance.normal() as f32).collect();
        let mut tape = LstmTape::default();
        tape.run(&layer, &x, shape, None);
        let (mut gradient, mut dx) = (Lstm::new(5, 4), vec![0.0; x.len()]);
        tape.back(&layer, &x, &slopes(6 * 3 * 4), None, &mut gradient, Some(&mut dx));
        check(&gradient.gates.weights, |i, step| {
            let mut other = layer.clone();
            other.gates.weights[i] += step;
            tape.run(&other, &x, shape, None);
            loss(tape.states(3, 4))
        });
        check(&dx, |i, step| {
            let mut other = x.clone();
            other[i] += step;
            tape.run(&layer, &other, shape, None);
            loss(tape.states(3, 4))
        });
    }

    #[test]
    fn gradients_of_recurrent_layers_are_difference_quotients() {
        let (shape, mut chance) = (Sequence { steps: 5, rows: 2 }, Stream::new(2, 1, 1));
        let layer = elman(3, 5, &mut chance);
        let x: Vec<f32> = (0..5 * 2 * 3).map(|_| chance.normal() as f32).collect();
        let mut tape = ElmanTape::default();
        tape.run(&layer, &x, shape);
        let mut gradient = Elman::new(3, 5);
        tape.back(&layer, &x, shape, &slopes(5 * 2 * 5), &mut gradient, None);
        check(&gradient.map.weights, |i, step| {
            let mut other = layer.clone();
            other.map.weights[i] += step;
            tape.run(&other, &x, shape);
            loss(tape.states(2, 5))
        });
    }

    #[test]
    fn a_batch_and_single_steps_say_the_same() {
        let (shape, mut chance) = (Sequence { steps: 4, rows: 2 }, Stream::new(3, 1, 1));
        let layer = lstm(3, 6, &mut chance);
        let x: Vec<f32> = (0..4 * 2 * 3).map(|_| chance.normal() as f32).collect();
        let mut tape = LstmTape::default();
        tape.run(&layer, &x, shape, None);
        let (mut h, mut c, mut z) = ([0.0; 6], [0.0; 6], [0.0; 24]);
        for t in 0..4 {
            layer.step(&x[(t * 2 + 1) * 3..][..3], &mut h, &mut c, &mut z);
            let batch = &tape.states(2, 6)[(t * 2 + 1) * 6..][..6];
            assert!(h.iter().zip(batch).all(|(a, b)| (a - b).abs() < 1e-6), "{h:?} {batch:?}");
        }
    }
}
