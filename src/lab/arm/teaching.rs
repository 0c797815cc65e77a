//! Training of small nets: Adam (Kingma and Ba 2015), and the graph net from an oracle's paths.
//!
//! Main types: [`AdamMoments`], [`NetStep`]. Refuses: data that it was not given; the order of samples comes from the
//! seed.

use crate::arm::net::{GRAPH_FEATURES, GRAPH_LAYERS, GraphNet, WorkGraph};
use giveway_cell::arm::Joints;
use giveway_sim::random::Stream;
use nalgebra::DMatrix;

/// One step of a path: where the arm is, where it goes, and the step in between.
#[derive(Clone, Debug)]
pub(super) struct NetStep {
    /// Number of the workspace.
    pub workspace: usize,
    /// The arm's present joints.
    pub now: Joints,
    /// The joints at the end of the path.
    pub goal: Joints,
    /// The step, radians.
    pub step: Joints,
}

/// Moments of Adam for a list of matrices.
pub(super) struct AdamMoments {
    rate: f64,
    steps: i32,
    first: Vec<DMatrix<f64>>,
    second: Vec<DMatrix<f64>>,
}

impl AdamMoments {
    /// Moments for matrices of these shapes.
    pub fn new(rate: f64, like: &[&DMatrix<f64>]) -> AdamMoments {
        let zeros: Vec<DMatrix<f64>> = like.iter().map(|m| DMatrix::zeros(m.nrows(), m.ncols())).collect();
        AdamMoments { rate, steps: 0, first: zeros.clone(), second: zeros }
    }

    /// Sets the learning rate.
    pub fn set_rate(&mut self, rate: f64) {
        self.rate = rate;
    }

    /// One step down these gradients.
    pub fn descend(&mut self, weights: &mut [&mut DMatrix<f64>], gradients: &[DMatrix<f64>]) {
        const B1: f64 = 0.9;
        const B2: f64 = 0.999;
        self.steps += 1;
        let (c1, c2) = (1.0 - B1.powi(self.steps), 1.0 - B2.powi(self.steps));
        for (k, gradient) in gradients.iter().enumerate() {
            let (first, second) = (&mut self.first[k], &mut self.second[k]);
            for i in 0..gradient.len() {
                first[i] = B1 * first[i] + (1.0 - B1) * gradient[i];
                second[i] = B2 * second[i] + (1.0 - B2) * gradient[i] * gradient[i];
                weights[k][i] -= self.rate * (first[i] / c1) / ((second[i] / c2).sqrt() + 1e-8);
            }
        }
    }
}

/// Random weights for rectified layers (He et al. 2015).
pub(super) fn drawn(chance: &mut Stream, rows: usize, columns: usize) -> DMatrix<f64> {
    let sigma = (2.0 / rows as f64).sqrt();
    DMatrix::from_fn(rows, columns, |_, _| chance.normal() * sigma)
}

/// Width of the graph net's layers.
const WIDTH: usize = 32;
/// Samples per step of training.
const BATCH: usize = 32;

/// Trains the graph net on these steps (equation 8), in `rounds` passes over all of them.
pub(super) fn teach_graph(
    seed: u64,
    graphs: &[WorkGraph],
    steps: &[NetStep],
    rounds: usize,
) -> Option<GraphNet> {
    let mut chance = Stream::new(seed, 91, 0);
    let widths = [GRAPH_FEATURES, WIDTH, WIDTH, WIDTH, WIDTH, WIDTH];
    let layers = (0..GRAPH_LAYERS).map(|k| drawn(&mut chance, widths[k], widths[k + 1])).collect();
    let output = drawn(&mut chance, WIDTH, 6) * 0.02;
    let mut net = GraphNet::new(layers, output, DMatrix::zeros(1, 6))?;
    let all: Vec<&DMatrix<f64>> = net.layers.iter().chain([&net.output, &net.bias]).collect();
    let mut adam = AdamMoments::new(2e-3, &all);
    let mut order: Vec<usize> = (0..steps.len()).collect();
    for round in 0..rounds {
        adam.set_rate(2e-3 * (1.0 - 0.9 * round as f64 / rounds as f64));
        (1..order.len()).rev().for_each(|k| order.swap(k, chance.below(k + 1)));
        for batch in order.chunks(BATCH) {
            let mut gradients: Option<Vec<DMatrix<f64>>> = None;
            for k in batch {
                let of_one = gradient(&net, &graphs[steps[*k].workspace], &steps[*k]);
                match &mut gradients {
                    Some(sum) => sum.iter_mut().zip(&of_one).for_each(|(a, b)| *a += b),
                    None => gradients = Some(of_one),
                }
            }
            let mut gradients = gradients?;
            gradients.iter_mut().for_each(|g| *g /= batch.len() as f64);
            let GraphNet { layers, output, bias, .. } = &mut net;
            let mut weights: Vec<&mut DMatrix<f64>> = layers.iter_mut().chain([output, bias]).collect();
            adam.descend(&mut weights, &gradients);
        }
    }
    Some(net)
}

/// Mean squared error of the net's steps, rad².
pub(super) fn step_error(net: &GraphNet, graphs: &[WorkGraph], steps: &[NetStep]) -> f64 {
    let of = |s: &NetStep| {
        let step = net.pass(&graphs[s.workspace], &s.now, &s.goal).step;
        (0..6).map(|k| (step[k] - s.step[k]).powi(2)).sum::<f64>()
    };
    steps.iter().map(of).sum::<f64>() / steps.len().max(1) as f64
}

/// Gradients of the squared error of one step: layers, output, bias.
fn gradient(net: &GraphNet, graph: &WorkGraph, of: &NetStep) -> Vec<DMatrix<f64>> {
    let pass = net.pass(graph, &of.now, &of.goal);
    let off = DMatrix::from_fn(1, 6, |_, k| 2.0 * (pass.step[k] - of.step[k]));
    let output = pass.pooled.transpose() * &off;
    let pooled = &off * net.output.transpose();
    let nodes = pass.hidden[0].nrows();
    let mut back = DMatrix::from_fn(nodes, pooled.ncols(), |_, k| pooled[(0, k)]);
    let mut layers = Vec::with_capacity(GRAPH_LAYERS);
    for k in (0..GRAPH_LAYERS).rev() {
        let active = pass.hidden[k].zip_map(&back, |h, b| if h > 0.0 { b } else { 0.0 });
        layers.push(pass.means[k].transpose() * &active);
        if k > 0 {
            back = net.mean(&(active * net.layers[k].transpose()));
        }
    }
    layers.reverse();
    layers.extend([output, off]);
    layers
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    #[test]
    fn gradients_are_the_slopes_of_the_error() {
        let graph =
            WorkGraph::new(&[], &[Point3::new(0.1, 0.2, 0.3); 4], &[[Point3::new(0.2, 0.1, 0.3); 4]; 5]);
        let of = NetStep {
            workspace: 0,
            now: [0.3, -0.2, 0.5, -0.7, 0.1, 0.9],
            goal: [1.0, -1.0, 0.2, 0.3, -0.5, 0.4],
            step: [0.1, -0.2, 0.0, 0.1, -0.1, 0.0],
        };
        let graphs = [graph];
        let steps = [of];
        let net = teach_graph(3, &graphs, &steps, 1).unwrap();
        let gradients = gradient(&net, &graphs[0], &steps[0]);
        for (layer, at) in [(0, (2, 5)), (2, (7, 3)), (4, (1, 9))] {
            let mut moved = net.clone();
            moved.layers[layer][at] += 1e-5;
            let slope = (step_error(&moved, &graphs, &steps) - step_error(&net, &graphs, &steps)) / 1e-5;
            let expected = gradients[layer][at];
            assert!((slope - expected).abs() < 1e-3 * expected.abs().max(1.0), "{layer}: {slope} {expected}");
        }
    }

    #[test]
    fn what_is_taught_is_learned() {
        let graphs = [WorkGraph::new(&[], &[Point3::origin(); 4], &[[Point3::origin(); 4]; 5])];
        let mut chance = Stream::new(5, 0, 0);
        let steps: Vec<NetStep> = (0..64)
            .map(|_| {
                let now: Joints = std::array::from_fn(|_| chance.between(-1.0, 1.0));
                let goal: Joints = std::array::from_fn(|_| chance.between(-1.0, 1.0));
                NetStep { workspace: 0, now, goal, step: std::array::from_fn(|k| (goal[k] - now[k]) * 0.2) }
            })
            .collect();
        let early = step_error(&teach_graph(1, &graphs, &steps, 1).unwrap(), &graphs, &steps);
        let late = step_error(&teach_graph(1, &graphs, &steps, 30).unwrap(), &graphs, &steps);
        assert!(late < 0.8 * early, "{early} {late}");
    }
}
