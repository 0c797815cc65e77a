//! Arm paths from one tree that grows at random: RRT (LaValle 1998), RRT* (Karaman and Frazzoli 2011).
//!
//! Main functions: [`rrt`], [`rrt_star`]. Numbers come from the caller; work is bounded by counted samples. Refuses:
//! paths that were not checked, and clocks.

use giveway_cell::arm::{ArmSpace, ArmWay, GROWS_RAD, JointTree, Joints, joint_distance, towards};

/// Share of samples that are the goal.
const TO_GOAL: f64 = 0.05;

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
fn star_radius(space: &ArmSpace, nodes: usize) -> f64 {
    let n = (nodes.max(2)) as f64;
    let volume: f64 = (0..6).map(|k| space.high_rad[k] - space.low_rad[k]).product();
    // The volume of the unit ball in six dimensions is π³/6.
    let gamma = 2.0 * libm::pow((1.0 + 1.0 / 6.0) * volume / (std::f64::consts::PI.powi(3) / 6.0), 1.0 / 6.0);
    (gamma * libm::pow(libm::log(n) / n, 1.0 / 6.0)).min(3.0 * GROWS_RAD)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::marching::bfmt_star;
    use giveway_cell::arm::{ArmKind, Capsule};
    use nalgebra::{Isometry3, Point3};

    const START: Joints = [-0.8, -1.3, 1.7, -1.97, -1.57, 0.0];
    const GOAL: Joints = [0.8, -1.3, 1.7, -1.97, -1.57, 0.0];

    /// A space with a post between start and goal.
    fn space() -> ArmSpace {
        let post =
            Capsule { a: Point3::new(-0.45, -0.1, 0.0), b: Point3::new(-0.45, -0.1, 0.5), radius_m: 0.06 };
        ArmSpace {
            kind: ArmKind::collaborative().clone(),
            base: Isometry3::identity(),
            obstacles: vec![post],
            floor_m: 0.0,
            low_rad: [-2.6, -2.8, -2.4, -3.0, -2.2, -2.0],
            high_rad: [2.6, -0.3, 2.4, 1.0, 2.2, 2.0],
        }
    }

    fn drawing(seed: u64) -> impl FnMut() -> f64 {
        let mut k = seed;
        move || {
            k = k.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (k >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    type Planner = fn(&ArmSpace, &Joints, &Joints, usize, &mut dyn FnMut() -> f64) -> Option<ArmWay>;
    const PLANNERS: [(Planner, usize); 3] = [(rrt, 3000), (rrt_star, 800), (bfmt_star, 800)];

    #[test]
    fn every_planner_finds_a_way_round_a_post_that_touches_nothing() {
        let space = space();
        assert!(space.is_free(&START) && space.is_free(&GOAL));
        assert!(!space.is_free_between(&START, &GOAL), "the post is in the way");
        for (n, (plan, samples)) in PLANNERS.into_iter().enumerate() {
            let way = plan(&space, &START, &GOAL, samples, &mut drawing(7)).unwrap_or_else(|| panic!("{n}"));
            let all = way.configurations();
            assert_eq!((all[0], all[all.len() - 1]), (START, GOAL), "{n}");
            let steps = (way.length_rad() / 0.01) as usize;
            for k in 0..=steps {
                let q = way.at_rad(way.length_rad() * k as f64 / steps as f64);
                let links = space.kind.capsules(&space.kind.pose(&space.base, &q), 0.0);
                assert!(links.iter().all(|l| l.distance_m(&space.obstacles[0]) > 0.0), "{n} at {k}");
            }
        }
    }

    #[test]
    fn the_same_numbers_make_the_same_way() {
        let space = space();
        for (plan, samples) in PLANNERS {
            let way = || plan(&space, &START, &GOAL, samples, &mut drawing(3));
            assert_eq!(way(), way());
        }
    }

    #[test]
    fn no_planner_finds_a_way_to_where_the_arm_cannot_be() {
        let mut space = space();
        let at = space.kind.pose(&space.base, &GOAL).points[3];
        space.obstacles.push(Capsule { a: at, b: at, radius_m: 0.05 });
        for (plan, samples) in PLANNERS {
            assert_eq!(plan(&space, &START, &GOAL, samples / 4, &mut drawing(5)), None);
        }
    }
}
