//! Arm paths from trees that grow at random: RRT (LaValle 1998), RRT-Connect (Kuffner and LaValle 2000), RRT* (Karaman
//! and Frazzoli 2011).
//!
//! Main functions: [`rrt`], [`rrt_connect`], [`rrt_star`]. Numbers come from the caller; work is bounded by counted
//! samples. Refuses: paths that were not checked, and clocks.

use super::kinematics::{Joints, between, joint_distance};
use super::space::{ArmSpace, ArmWay};

/// Longest growth of a branch in one step, radians.
const GROWS_RAD: f64 = 0.5;
/// Share of samples that are the goal.
const TO_GOAL: f64 = 0.05;

/// A tree of configurations.
struct JointTree {
    nodes: Vec<Joints>,
    parents: Vec<usize>,
    costs: Vec<f64>,
}

impl JointTree {
    fn new(root: &Joints) -> JointTree {
        JointTree { nodes: vec![*root], parents: vec![0], costs: vec![0.0] }
    }

    fn nearest(&self, to: &Joints) -> usize {
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

    fn add(&mut self, joints: Joints, parent: usize) -> usize {
        self.costs.push(self.costs[parent] + joint_distance(&self.nodes[parent], &joints));
        self.nodes.push(joints);
        self.parents.push(parent);
        self.nodes.len() - 1
    }

    /// The configurations from the root to a node.
    fn branch(&self, mut node: usize) -> Vec<Joints> {
        let mut all = vec![self.nodes[node]];
        while node != 0 {
            node = self.parents[node];
            all.push(self.nodes[node]);
        }
        all.reverse();
        all
    }

    /// Grows towards a configuration; gives the new node if the path to it is free.
    fn grow(&mut self, space: &ArmSpace, to: &Joints) -> Option<usize> {
        let near = self.nearest(to);
        let new = towards(&self.nodes[near], to);
        space.is_free_between(&self.nodes[near], &new).then(|| self.add(new, near))
    }
}

fn towards(from: &Joints, to: &Joints) -> Joints {
    let far = joint_distance(from, to);
    if far <= GROWS_RAD { *to } else { between(from, to, GROWS_RAD / far) }
}

/// The first path that a tree from the start finds, within `samples` samples.
pub fn rrt(
    space: &ArmSpace,
    start: &Joints,
    goal: &Joints,
    samples: usize,
    draw: &mut dyn FnMut() -> f64,
) -> Option<ArmWay> {
    let mut tree = JointTree::new(start);
    for _ in 0..samples {
        let to = if draw() < TO_GOAL { *goal } else { space.configuration(draw) };
        let Some(new) = tree.grow(space, &to) else { continue };
        if tree.nodes[new] == *goal {
            return space.check(tree.branch(new));
        }
    }
    None
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

/// The shortest path that a tree from the start finds after `samples` samples, rewired with each one.
pub fn rrt_star(
    space: &ArmSpace,
    start: &Joints,
    goal: &Joints,
    samples: usize,
    draw: &mut dyn FnMut() -> f64,
) -> Option<ArmWay> {
    let mut tree = JointTree::new(start);
    let mut reaching: Vec<usize> = Vec::new();
    for _ in 0..samples {
        let to = if draw() < TO_GOAL { *goal } else { space.configuration(draw) };
        let near = tree.nearest(&to);
        let new = towards(&tree.nodes[near], &to);
        if !space.is_free(&new) || (new == *goal && reaching.iter().any(|r| tree.parents[*r] == near)) {
            continue;
        }
        let radius = star_radius(space, tree.nodes.len());
        let mut around: Vec<(f64, usize)> = (0..tree.nodes.len())
            .map(|k| (joint_distance(&tree.nodes[k], &new), k))
            .filter(|(far, k)| *far <= radius || *k == near)
            .collect();
        around.sort_by(|a, b| (tree.costs[a.1] + a.0).total_cmp(&(tree.costs[b.1] + b.0)));
        let parent = around.iter().find(|(_, k)| space.is_free_between(&tree.nodes[*k], &new));
        let Some(parent) = parent.map(|p| p.1) else { continue };
        let added = tree.add(new, parent);
        if new == *goal {
            reaching.push(added);
            continue;
        }
        for (far, k) in around {
            let cost = tree.costs[added] + far;
            if cost + 1e-9 < tree.costs[k] && space.is_free_between(&new, &tree.nodes[k]) {
                tree.parents[k] = added;
                recost(&mut tree, k);
            }
        }
    }
    let best = reaching.into_iter().min_by(|a, b| tree.costs[*a].total_cmp(&tree.costs[*b]))?;
    space.check(tree.branch(best))
}

/// Updates the costs of a node that has a new parent, and of all its descendants.
fn recost(tree: &mut JointTree, changed: usize) {
    let mut open = vec![changed];
    while let Some(node) = open.pop() {
        let parent = tree.parents[node];
        tree.costs[node] = tree.costs[parent] + joint_distance(&tree.nodes[parent], &tree.nodes[node]);
        open.extend((1..tree.nodes.len()).filter(|k| tree.parents[*k] == node));
    }
}

/// The radius within which the tree is rewired: γ (ln n / n)^(1/6), at most three times the growth of a branch.
pub(super) fn star_radius(space: &ArmSpace, nodes: usize) -> f64 {
    let n = (nodes.max(2)) as f64;
    let volume: f64 = (0..6).map(|k| space.high_rad[k] - space.low_rad[k]).product();
    // The volume of the unit ball in six dimensions is π³/6.
    let gamma = 2.0 * libm::pow((1.0 + 1.0 / 6.0) * volume / (std::f64::consts::PI.powi(3) / 6.0), 1.0 / 6.0);
    (gamma * libm::pow(libm::log(n) / n, 1.0 / 6.0)).min(3.0 * GROWS_RAD)
}
