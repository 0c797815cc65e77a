//! The shortest path on foot between two points.
//!
//! Main type: [`WalkPath`]. Refuses: to know who walks it, and when.

use super::{EdgeSet, Walkways};
use crate::geometry::Point;
use crate::id::{Dense, WalkNodeId};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Distance within which a path may leave the floor for the graph and come back, metres; farther if no node is so near.
const REACH_M: f64 = 2.5;

/// A path over the walkways.
#[derive(Clone, Debug, PartialEq)]
pub struct WalkPath {
    /// Nodes on the path; none if both ends see each other.
    pub nodes: Vec<WalkNodeId>,
    /// All points, including the ends.
    pub points: Vec<Point>,
    /// Length, metres.
    pub length_m: f64,
}

/// A node with the length of the path to it; the nearest first, then the lowest id.
#[derive(PartialEq)]
struct PathLabel(f64, WalkNodeId);

impl Eq for PathLabel {}

impl PartialOrd for PathLabel {
    fn partial_cmp(&self, other: &PathLabel) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for PathLabel {
    fn cmp(&self, other: &PathLabel) -> Ordering {
        other.0.total_cmp(&self.0).then(other.1.cmp(&self.1))
    }
}

impl Walkways {
    /// The nodes that a person can walk to straight from `p`, with their distances in metres: the nodes within a few
    /// metres, or farther if there are none.
    pub fn doorsteps(&self, p: Point, cut: &EdgeSet) -> Vec<(WalkNodeId, f64)> {
        let Some(p) = self.on_floor(p) else { return Vec::new() };
        for radius in [REACH_M, 4.0 * REACH_M] {
            let mut found = self.near(p, radius);
            found.retain(|(n, _)| !self.leads_past(p, self.nodes[*n].at, cut));
            if !found.is_empty() {
                return found;
            }
        }
        Vec::new()
    }

    /// The shortest path from one point to another without the cut edges; nothing if there is none.
    pub fn path(&self, from: Point, to: Point, cut: &EdgeSet) -> Option<WalkPath> {
        let (start, goal) = (self.on_floor(from)?, self.on_floor(to)?);
        if (goal - start).norm() <= REACH_M && self.sees_past(start, goal, cut) {
            let length_m = (goal - start).norm();
            return Some(WalkPath { nodes: Vec::new(), points: vec![from, to], length_m });
        }
        let last: Vec<(WalkNodeId, f64)> = self.doorsteps(to, cut);
        let mut length = vec![f64::INFINITY; self.nodes.len()];
        let mut before: Vec<Option<WalkNodeId>> = vec![None; self.nodes.len()];
        let mut queue = BinaryHeap::new();
        for (n, distance) in self.doorsteps(from, cut) {
            length[n.ix()] = distance;
            queue.push(PathLabel(distance, n));
        }
        let mut best: Option<PathLabel> = None;
        while let Some(PathLabel(so_far, n)) = queue.pop() {
            if best.as_ref().is_some_and(|b| b.0 <= so_far) {
                break;
            }
            if so_far > length[n.ix()] {
                continue;
            }
            if let Ok(k) = last.binary_search_by_key(&n, |(n, _)| *n) {
                let whole = PathLabel(so_far + last[k].1, n);
                best = best.into_iter().chain([whole]).max();
            }
            for &(e, next) in self.links(n).iter().filter(|(e, _)| !cut.contains(*e)) {
                let there = so_far + self.edges[e].length_m;
                if there < length[next.ix()] {
                    (length[next.ix()], before[next.ix()]) = (there, Some(n));
                    queue.push(PathLabel(there, next));
                }
            }
        }
        let PathLabel(length_m, end) = best?;
        let mut nodes: Vec<WalkNodeId> = std::iter::successors(Some(end), |n| before[n.ix()]).collect();
        nodes.reverse();
        let middle = nodes.iter().map(|n| self.nodes[*n].at);
        let points = std::iter::once(from).chain(middle).chain([to]).collect();
        Some(WalkPath { nodes, points, length_m })
    }
}
