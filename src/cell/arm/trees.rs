//! Arm paths from two trees that grow at random towards one another: RRT-Connect (Kuffner and LaValle 2000).
//!
//! Main types: [`rrt_connect`], [`JointTree`]. Numbers come from the caller; work is bounded by counted samples.
//! Refuses: paths that were not checked, and clocks.

use super::kinematics::{Joints, between, joint_distance};
use super::space::{ArmSpace, ArmWay};

/// Longest growth of a branch in one step, radians.
pub const GROWS_RAD: f64 = 0.5;

/// A tree of configurations.
#[derive(Clone, Debug)]
pub struct JointTree {
    /// The configurations, the root first.
    pub nodes: Vec<Joints>,
    /// The parent of each node; the root is its own.
    pub parents: Vec<usize>,
    /// The length of the branch from the root to each node, radians.
    pub costs: Vec<f64>,
}

impl JointTree {
    /// A tree of its root alone.
    pub fn new(root: &Joints) -> JointTree {
        JointTree { nodes: vec![*root], parents: vec![0], costs: vec![0.0] }
    }

    /// The node nearest to a configuration.
    pub fn nearest(&self, to: &Joints) -> usize {
        let square = |q: &Joints| (0..6).map(|k| (q[k] - to[k]) * (q[k] - to[k])).sum::<f64>();
        let (mut best, mut least) = (0, f64::INFINITY);
        for (k, q) in self.nodes.iter().enumerate() {
            let d = square(q);
            if d < least {
                (best, least) = (k, d);
            }
        }
        best
    }

    /// Adds a configuration below a node, to which the path must be free. Gives the new node.
    pub fn add(&mut self, joints: Joints, parent: usize) -> usize {
        self.costs.push(self.costs[parent] + joint_distance(&self.nodes[parent], &joints));
        self.nodes.push(joints);
        self.parents.push(parent);
        self.nodes.len() - 1
    }

    /// The configurations from the root to a node.
    pub fn branch(&self, mut node: usize) -> Vec<Joints> {
        let mut all = vec![self.nodes[node]];
        while node != 0 {
            node = self.parents[node];
            all.push(self.nodes[node]);
        }
        all.reverse();
        all
    }

    /// Grows towards a configuration; gives the new node if the path to it is free.
    pub fn grow(&mut self, space: &ArmSpace, to: &Joints) -> Option<usize> {
        let near = self.nearest(to);
        let new = towards(&self.nodes[near], to);
        space.is_free_between(&self.nodes[near], &new).then(|| self.add(new, near))
    }
}

/// A configuration on the straight path to another one, at most [`GROWS_RAD`] away.
pub fn towards(from: &Joints, to: &Joints) -> Joints {
    let far = joint_distance(from, to);
    if far <= GROWS_RAD { *to } else { between(from, to, GROWS_RAD / far) }
}

/// The first path that two trees find, from the start and from the goal, within `samples` samples.
pub fn rrt_connect(
    space: &ArmSpace,
    start: &Joints,
    goal: &Joints,
    samples: usize,
    draw: &mut dyn FnMut() -> f64,
) -> Option<ArmWay> {
    if space.is_free_between(start, goal) {
        return space.check(vec![*start, *goal]);
    }
    let mut trees = [JointTree::new(start), JointTree::new(goal)];
    for sample in 0..samples {
        let grows = sample % 2;
        let Some(new) = trees[grows].grow(space, &space.configuration(draw)) else { continue };
        let aim = trees[grows].nodes[new];
        // The other tree comes as far as it can.
        while let Some(met) = trees[1 - grows].grow(space, &aim) {
            if trees[1 - grows].nodes[met] == aim {
                let ends = if grows == 0 { (new, met) } else { (met, new) };
                let mut way = trees[0].branch(ends.0);
                way.extend(trees[1].branch(ends.1).into_iter().rev().skip(1));
                return space.check(way);
            }
        }
    }
    None
}
