//! A graph net that proposes the next configuration, and paths that it grows from both ends (Liu et al. 2024, equations
//! 5 to 8).
//!
//! Main types: [`WorkGraph`], [`GraphNet`]. Refuses: to return a path that was not checked; where it finds none, the
//! caller falls back on RRT-Connect.

use giveway_cell::arm::{ArmSpace, ArmWay, Capsule, Joints, joint_distance};
use nalgebra::{DMatrix, Point3};
use std::f64::consts::PI;

/// Nodes of the graph: six joints now, six at the goal, three points for each of eight obstacles, four joints of the
/// person's arm, and elbow, wrist and palm for each of five forecast arms.
pub const GRAPH_NODES: usize = 55;
/// Number of features per node.
pub const GRAPH_FEATURES: usize = 6;
/// Number of graph convolutions.
pub const GRAPH_LAYERS: usize = 5;
/// Number of obstacles that are shown to the net; the first ones.
const SHOWN: usize = 8;
/// Longest step of the net, radians.
pub const NET_STEP_RAD: f64 = 0.4;

/// What the net sees besides the configurations: places of obstacles and of the person's arm, now and forecast.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkGraph {
    /// Features of the 43 nodes that do not depend on the configuration.
    places: Vec<[f64; GRAPH_FEATURES]>,
}

impl WorkGraph {
    /// The graph of obstacles, the person's joints (shoulder to palm), and forecast arms.
    pub fn new(obstacles: &[Capsule], arm: &[Point3<f64>; 4], forecast: &[[Point3<f64>; 4]; 5]) -> WorkGraph {
        let place = |p: Point3<f64>, radius: f64, ahead: f64| [p.x, p.y, p.z, radius, ahead, 1.0];
        let mut places = Vec::with_capacity(GRAPH_NODES - 12);
        for k in 0..SHOWN {
            match obstacles.get(k) {
                Some(o) => places.extend([0.0, 0.5, 1.0].map(|s| place(o.at(s), o.radius_m, 0.0))),
                None => places.extend([[0.0; GRAPH_FEATURES]; 3]),
            }
        }
        places.extend(arm.map(|p| place(p, 0.05, 0.0)));
        places.extend(forecast.iter().flat_map(|joints| [1, 2, 3].map(|j| place(joints[j], 0.05, 1.0))));
        WorkGraph { places }
    }

    /// The feature matrix: joint k has its angle in column k, over π; its goal node has the angle still to go.
    pub fn features(&self, now: &Joints, goal: &Joints) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(GRAPH_NODES, GRAPH_FEATURES);
        for k in 0..6 {
            matrix[(k, k)] = now[k] / PI;
            matrix[(6 + k, k)] = (goal[k] - now[k]) / PI;
        }
        for (row, place) in self.places.iter().enumerate() {
            (0..GRAPH_FEATURES).for_each(|k| matrix[(12 + row, k)] = place[k]);
        }
        matrix
    }
}

/// Neighbours of each node with the weights of D^-½ (A + I) D^-½ (equation 6): joints along the arm, each joint with
/// its goal and all places, and points of one obstacle or arm with the next.
pub fn adjacency() -> Vec<Vec<(usize, f64)>> {
    let mut near = vec![Vec::new(); GRAPH_NODES];
    let mut join = |a: usize, b: usize| {
        near[a].push(b);
        near[b].push(a);
    };
    for k in 0..6 {
        join(k, 6 + k);
        if k < 5 {
            join(k, k + 1);
            join(6 + k, 7 + k);
        }
        (12..GRAPH_NODES).for_each(|place| join(k, place));
    }
    for place in 12..GRAPH_NODES - 1 {
        let begins = match place - 12 {
            n if n < 24 => n % 3 == 2,
            n if n < 28 => n == 27,
            n => (n - 28) % 3 == 2,
        };
        if !begins {
            join(place, place + 1);
        }
    }
    let degree: Vec<f64> = near.iter().map(|n| n.len() as f64 + 1.0).collect();
    let weighted = |k: usize| {
        let all = near[k].iter().copied().chain(std::iter::once(k));
        all.map(|other| (other, 1.0 / (degree[k] * degree[other]).sqrt())).collect()
    };
    (0..GRAPH_NODES).map(weighted).collect()
}

/// The net: five graph convolutions, the sum over all nodes, and one dense layer; its output is a step from the
/// configuration.
#[derive(Clone, Debug)]
pub struct GraphNet {
    /// Weights Θ of equation 6, by layer.
    pub layers: Vec<DMatrix<f64>>,
    /// The output layer, width × 6.
    pub output: DMatrix<f64>,
    /// Bias of the output layer, 1 × 6.
    pub bias: DMatrix<f64>,
    near: Vec<Vec<(usize, f64)>>,
}

/// Intermediate values of a pass through the net, kept for learning.
#[derive(Clone, Debug)]
pub struct NetPass {
    /// The neighbourhood means that went into each layer.
    pub means: Vec<DMatrix<f64>>,
    /// The output of each layer, after the rectifier.
    pub hidden: Vec<DMatrix<f64>>,
    /// The sum over nodes, 1 × width.
    pub pooled: DMatrix<f64>,
    /// The step, radians.
    pub step: Joints,
}

impl GraphNet {
    /// A net with these weights; nothing if their shapes do not fit or a number is not finite.
    pub fn new(layers: Vec<DMatrix<f64>>, output: DMatrix<f64>, bias: DMatrix<f64>) -> Option<GraphNet> {
        let chain = layers.windows(2).all(|pair| pair[0].ncols() == pair[1].nrows());
        let ends = layers.len() == GRAPH_LAYERS
            && layers[0].nrows() == GRAPH_FEATURES
            && layers[GRAPH_LAYERS - 1].ncols() == output.nrows()
            && output.ncols() == 6
            && bias.shape() == (1, 6);
        let all = layers.iter().chain([&output, &bias]);
        let finite = all.into_iter().all(|m| m.iter().all(|x| x.is_finite()));
        (chain && ends && finite).then(|| GraphNet { layers, output, bias, near: adjacency() })
    }

    /// The mean over each node's neighbours.
    pub fn mean(&self, of: &DMatrix<f64>) -> DMatrix<f64> {
        let mut mean = DMatrix::zeros(of.nrows(), of.ncols());
        for column in 0..of.ncols() {
            let from = of.column(column);
            let mut to = mean.column_mut(column);
            for (node, near) in self.near.iter().enumerate() {
                to[node] = near.iter().map(|(other, weight)| from[*other] * weight).sum();
            }
        }
        mean
    }

    /// Runs the net and keeps all intermediate values.
    pub fn pass(&self, graph: &WorkGraph, now: &Joints, goal: &Joints) -> NetPass {
        let mut h = graph.features(now, goal);
        let (mut means, mut hidden) = (Vec::new(), Vec::new());
        for layer in &self.layers {
            let mean = self.mean(&h);
            h = (&mean * layer).map(|x| x.max(0.0));
            means.push(mean);
            hidden.push(h.clone());
        }
        let pooled = DMatrix::from_fn(1, h.ncols(), |_, k| h.column(k).sum());
        let step = &pooled * &self.output + &self.bias;
        NetPass { means, hidden, pooled, step: std::array::from_fn(|k| step[(0, k)]) }
    }

    /// The next configuration (equation 7), at most [`NET_STEP_RAD`] away.
    pub fn next(&self, graph: &WorkGraph, now: &Joints, goal: &Joints) -> Joints {
        let step = self.pass(graph, now, goal).step;
        let length = joint_distance(&step, &[0.0; 6]);
        let share = (NET_STEP_RAD / length.max(1e-9)).min(1.0);
        std::array::from_fn(|k| now[k] + step[k] * share)
    }

    /// A path that grows from both ends by the net's steps, up to a number of steps from each, until the straight line
    /// between both is free. A step that is not free ends its branch. The path is checked as a whole.
    pub fn plan(
        &self,
        space: &ArmSpace,
        graph: &WorkGraph,
        start: &Joints,
        goal: &Joints,
        steps: usize,
    ) -> Option<ArmWay> {
        let mut branches = [vec![*start], vec![*goal]];
        let mut grows = [true, true];
        let end = |branch: &Vec<Joints>| branch[branch.len() - 1];
        for k in 0..2 * steps {
            let (from, to) = (end(&branches[0]), end(&branches[1]));
            if space.is_free_between(&from, &to) {
                let mut way = branches[0].clone();
                way.extend(branches[1].iter().rev());
                return space.check(way);
            }
            let turn = k % 2;
            if !grows[turn] {
                continue;
            }
            let (now, aim) = if turn == 0 { (from, to) } else { (to, from) };
            let next = self.next(graph, &now, &aim);
            grows[turn] = joint_distance(&now, &next) > 0.02 && space.is_free_between(&now, &next);
            if grows[turn] {
                branches[turn].push(next);
            } else if !grows[1 - turn] {
                return None;
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_cell::arm::ArmKind;
    use nalgebra::Isometry3;

    fn space(obstacles: Vec<Capsule>) -> ArmSpace {
        ArmSpace {
            kind: ArmKind::collaborative().clone(),
            base: Isometry3::identity(),
            obstacles,
            floor_m: 0.0,
            low_rad: [-2.6; 6],
            high_rad: [2.6; 6],
        }
    }

    /// A net with zero layers: its step is its bias.
    fn constant(step: Joints) -> GraphNet {
        let layers = (0..GRAPH_LAYERS).map(|_| DMatrix::zeros(6, 6)).collect();
        GraphNet::new(layers, DMatrix::zeros(6, 6), DMatrix::from_row_slice(1, 6, &step)).expect("it fits")
    }

    fn graph(obstacles: &[Capsule]) -> WorkGraph {
        WorkGraph::new(obstacles, &[Point3::origin(); 4], &[[Point3::origin(); 4]; 5])
    }

    #[test]
    fn the_graph_has_the_published_shape_and_its_weights_are_symmetric() {
        let near = adjacency();
        assert_eq!(near.len(), 55);
        for (a, of) in near.iter().enumerate() {
            for (b, weight) in of {
                assert!(near[*b].iter().any(|(back, same)| *back == a && same == weight), "{a} {b}");
            }
        }
        assert_eq!(graph(&[]).features(&[0.0; 6], &[1.0; 6]).shape(), (55, 6));
    }

    #[test]
    fn a_net_of_the_wrong_shape_or_with_a_figure_that_is_none_is_refused() {
        let layers = |n: usize| -> Vec<DMatrix<f64>> { (0..n).map(|_| DMatrix::zeros(6, 6)).collect() };
        let square = || DMatrix::zeros(6, 6);
        assert!(GraphNet::new(layers(5), square(), DMatrix::zeros(1, 6)).is_some());
        assert!(GraphNet::new(layers(4), square(), DMatrix::zeros(1, 6)).is_none());
        assert!(GraphNet::new(layers(5), DMatrix::zeros(7, 6), DMatrix::zeros(1, 6)).is_none());
        assert!(GraphNet::new(layers(5), square(), DMatrix::from_element(1, 6, f64::NAN)).is_none());
    }

    #[test]
    fn a_net_that_leads_into_an_obstacle_finds_no_way_rather_than_an_unchecked_one() {
        let (start, goal) = ([-0.8, -1.3, 1.7, -1.97, -1.57, 0.0], [0.8, -1.3, 1.7, -1.97, -1.57, 0.0]);
        let straight = constant([0.3, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let open = straight.plan(&space(Vec::new()), &graph(&[]), &start, &goal, 12);
        assert_eq!(open.map(|way| way.configurations().to_vec()), Some(vec![start, goal]));
        let wall =
            Capsule { a: Point3::new(-0.5, -0.1, 0.0), b: Point3::new(-0.5, -0.1, 1.0), radius_m: 0.1 };
        assert_eq!(straight.plan(&space(vec![wall]), &graph(&[wall]), &start, &goal, 12), None);
    }
}
