//! Which resources cannot be held by two robots at once, computed from the robots' footprint.
//!
//! A robot with its rack takes a square of side `footprint_m` along the map's axes; a lane takes what that
//! square sweeps. Two resources are in conflict where these overlap. Refuses: hand-written exceptions.

use super::{Lane, Node};
use crate::geometry::{Segment, axis_distance, axis_distance_of_segments, axis_distance_to_segment};
use crate::id::{Dense, IdVec, LaneId, NodeId, ResourceId};
use smallvec::SmallVec;
use std::collections::BTreeMap;

/// Squares that touch do not overlap; this absorbs the rounding of decimal coordinates (metres).
const TOUCH: f64 = 1e-6;

type Conflicts = IdVec<ResourceId, SmallVec<[ResourceId; 2]>>;

/// All conflicts, symmetric, sorted, without pairs of which one is an end node of the other and without
/// pairs of lanes that share an end: those exclude each other already by their nodes.
pub(super) fn between(
    nodes: &IdVec<NodeId, Node>,
    lanes: &IdVec<LaneId, Lane>,
    footprint_m: f64,
) -> Conflicts {
    let reach = footprint_m - TOUCH;
    let mut found = Conflicts::filled(SmallVec::new(), nodes.len() + lanes.len());
    let shapes: Vec<Segment> = (nodes.iter().map(|n| Segment { a: n.at, b: n.at }))
        .chain(lanes.iter().map(|l| Segment { a: nodes[l.a].at, b: nodes[l.b].at }))
        .collect();
    let ends = |i: usize| match i.checked_sub(nodes.len()) {
        None => [NodeId::at(i); 2],
        Some(l) => [lanes[LaneId::at(l)].a, lanes[LaneId::at(l)].b],
    };
    for (i, j) in close_pairs(&shapes, footprint_m.max(0.1)) {
        let share = ends(i).iter().any(|n| ends(j).contains(n));
        if !share && overlap(shapes[i], shapes[j], reach) {
            found[ResourceId::at(i)].push(ResourceId::at(j));
            found[ResourceId::at(j)].push(ResourceId::at(i));
        }
    }
    for list in found.iter_mut() {
        list.sort_unstable();
    }
    found
}

fn overlap(s: Segment, t: Segment, reach: f64) -> bool {
    let (point_s, point_t) = (s.a == s.b, t.a == t.b);
    let distance = match (point_s, point_t) {
        (true, true) => axis_distance(s.a, t.a),
        (true, false) => axis_distance_to_segment(s.a, t),
        (false, true) => axis_distance_to_segment(t.a, s),
        (false, false) => axis_distance_of_segments(s, t),
    };
    distance < reach
}

/// Pairs `(i, j)`, `i < j`, whose bounding boxes grown by `margin` share a cell of a coarse grid; each once.
fn close_pairs(shapes: &[Segment], margin: f64) -> Vec<(usize, usize)> {
    let cell = 4.0 * margin;
    let mut grid: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
    for (i, s) in shapes.iter().enumerate() {
        let low = |a: f64, b: f64| ((a.min(b) - margin) / cell).floor() as i64;
        let high = |a: f64, b: f64| ((a.max(b) + margin) / cell).floor() as i64;
        for x in low(s.a.x, s.b.x)..=high(s.a.x, s.b.x) {
            for y in low(s.a.y, s.b.y)..=high(s.a.y, s.b.y) {
                grid.entry((x, y)).or_default().push(i);
            }
        }
    }
    let mut pairs: Vec<(usize, usize)> = Vec::new();
    for members in grid.values() {
        for (k, &i) in members.iter().enumerate() {
            pairs.extend(members[k + 1..].iter().map(|&j| (i, j)));
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}
