//! Arm paths from two wavefronts over one set of samples: bidirectional fast marching trees (Starek et al. 2015).
//!
//! Main function: [`bfmt_star`]. Numbers come from the caller; work is bounded by counted samples. Refuses: paths that
//! were not checked, and clocks.

use giveway_cell::arm::{ArmSpace, ArmWay, Joints, joint_distance};

/// A wave from one end of the path.
struct Wave {
    parents: Vec<Option<usize>>,
    costs: Vec<f64>,
    is_open: Vec<bool>,
    is_unvisited: Vec<bool>,
}

impl Wave {
    fn new(count: usize, root: usize) -> Wave {
        let mut wave = Wave {
            parents: vec![None; count],
            costs: vec![f64::INFINITY; count],
            is_open: vec![false; count],
            is_unvisited: vec![true; count],
        };
        (wave.costs[root], wave.is_open[root], wave.is_unvisited[root]) = (0.0, true, false);
        wave
    }

    /// The open sample of least cost.
    fn front(&self) -> Option<usize> {
        let open = (0..self.costs.len()).filter(|k| self.is_open[*k]);
        open.min_by(|a, b| self.costs[*a].total_cmp(&self.costs[*b]))
    }

    fn branch(&self, mut node: usize) -> Vec<usize> {
        let mut all = vec![node];
        while let Some(parent) = self.parents[node] {
            node = parent;
            all.push(node);
        }
        all
    }
}

/// The path over `samples` free samples, grown in turns from both ends until the waves meet.
pub fn bfmt_star(
    space: &ArmSpace,
    start: &Joints,
    goal: &Joints,
    samples: usize,
    draw: &mut dyn FnMut() -> f64,
) -> Option<ArmWay> {
    let mut nodes = vec![*start, *goal];
    // Some samples are not free: at most three times as many are drawn as are wanted.
    for _ in 0..3 * samples {
        let q = space.configuration(draw);
        if space.is_free(&q) {
            nodes.push(q);
        }
        if nodes.len() >= samples + 2 {
            break;
        }
    }
    let near = neighbours(&nodes, 18);
    let mut waves = [Wave::new(nodes.len(), 0), Wave::new(nodes.len(), 1)];
    let mut turn = 0;
    let mut best: Option<(f64, usize)> = None;
    while waves[0].front().is_some() || waves[1].front().is_some() {
        let Some(z) = waves[turn].front() else {
            turn = 1 - turn;
            continue;
        };
        if best.is_some_and(|(cost, _)| waves[turn].costs[z] * 2.0 > cost) {
            break;
        }
        expand(space, &nodes, &near, &mut waves[turn], z);
        for k in std::iter::once(z).chain(near[z].iter().copied()) {
            let cost = waves[0].costs[k] + waves[1].costs[k];
            if cost.is_finite() && best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, k));
            }
        }
        turn = 1 - turn;
    }
    let (_, met) = best?;
    let mut way: Vec<usize> = waves[0].branch(met);
    way.reverse();
    way.extend(waves[1].branch(met).into_iter().skip(1));
    space.check(way.into_iter().map(|k| nodes[k]).collect())
}

/// One step of the march: joins unvisited samples near the front to their best open neighbour where that path is free.
fn expand(space: &ArmSpace, nodes: &[Joints], near: &[Vec<usize>], wave: &mut Wave, z: usize) {
    let mut opened = Vec::new();
    for x in near[z].iter().copied() {
        if !wave.is_unvisited[x] {
            continue;
        }
        let open = near[x].iter().copied().filter(|y| wave.is_open[*y]);
        let cost = |y: &usize| wave.costs[*y] + joint_distance(&nodes[*y], &nodes[x]);
        let Some(y) = open.min_by(|a, b| cost(a).total_cmp(&cost(b))) else { continue };
        if space.is_free_between(&nodes[y], &nodes[x]) {
            let reached = cost(&y);
            (wave.costs[x], wave.parents[x]) = (reached, Some(y));
            wave.is_unvisited[x] = false;
            opened.push(x);
        }
    }
    wave.is_open[z] = false;
    opened.into_iter().for_each(|x| wave.is_open[x] = true);
}

/// For each sample its `count` nearest ones, and the samples that it is among the nearest of.
fn neighbours(nodes: &[Joints], count: usize) -> Vec<Vec<usize>> {
    let mut near: Vec<Vec<usize>> = vec![Vec::new(); nodes.len()];
    for (k, q) in nodes.iter().enumerate() {
        let square = |o: &Joints| (0..6).map(|i| (q[i] - o[i]) * (q[i] - o[i])).sum::<f64>();
        let others = nodes.iter().enumerate().filter(|(other, _)| *other != k);
        let mut all: Vec<(f64, usize)> = others.map(|(other, o)| (square(o), other)).collect();
        if all.len() > count {
            all.select_nth_unstable_by(count, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            all.truncate(count);
        }
        for (_, other) in all {
            near[k].push(other);
            near[other].push(k);
        }
    }
    near.iter_mut().for_each(|of| {
        of.sort_unstable();
        of.dedup();
    });
    near
}
