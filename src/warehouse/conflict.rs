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
pub(super) const TOUCH: f64 = 1e-6;

type ResourceConflicts = IdVec<ResourceId, SmallVec<[ResourceId; 2]>>;

/// All conflicts, symmetric, sorted, without pairs of which one is an end node of the other and without
/// pairs of lanes that share an end: those exclude each other already by their nodes.
pub(super) fn between(
    nodes: &IdVec<NodeId, Node>,
    lanes: &IdVec<LaneId, Lane>,
    footprint_m: f64,
) -> ResourceConflicts {
    let reach = footprint_m - TOUCH;
    let mut found = ResourceConflicts::filled(SmallVec::new(), nodes.len() + lanes.len());
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

/// Pairs `(i, j)`, `i < j`, that come near one cell of a coarse grid, within `margin`; each pair once.
fn close_pairs(shapes: &[Segment], margin: f64) -> Vec<(usize, usize)> {
    let mut grid: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
    for (i, s) in shapes.iter().enumerate() {
        for cell in cells_near(*s, margin) {
            grid.entry(cell).or_default().push(i);
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

/// The cells of a grid of pitch `4 * margin` that `s` comes near, column by column, so that a long slanted
/// lane takes cells along itself and not all of its bounding box.
fn cells_near(s: Segment, margin: f64) -> impl Iterator<Item = (i64, i64)> {
    let cell = 4.0 * margin;
    let of = move |v: f64| (v / cell).floor() as i64;
    let (left, right) = if s.a.x <= s.b.x { (s.a, s.b) } else { (s.b, s.a) };
    let y_at = move |x: f64| {
        let u = if right.x > left.x { ((x - left.x) / (right.x - left.x)).clamp(0.0, 1.0) } else { 0.0 };
        left.y + (right.y - left.y) * u
    };
    (of(left.x - margin)..=of(right.x + margin)).flat_map(move |column| {
        let (mut from, mut to) =
            (y_at(column as f64 * cell - margin), y_at((column + 1) as f64 * cell + margin));
        if right.x == left.x {
            (from, to) = (left.y, right.y);
        }
        let rows = of(from.min(to) - margin)..=of(from.max(to) + margin);
        rows.map(move |row| (column, row))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;

    #[test]
    fn near_things_share_a_cell_however_the_lane_slants() {
        let lane = |ax, ay, bx, by| Segment { a: Point::new(ax, ay), b: Point::new(bx, by) };
        let slanted = [lane(0.0, 0.0, 90.0, 31.0), lane(-5.0, 40.0, 3.0, -60.0), lane(7.0, 7.0, 7.0, -50.0)];
        for s in slanted {
            for step in 0..=200 {
                let p = s.point(f64::from(step) / 200.0) + nalgebra::Vector2::new(0.5, -0.5);
                let beside = Segment { a: p, b: p };
                assert_eq!(close_pairs(&[s, beside], 0.9), [(0, 1)], "{p} beside {s:?}");
            }
        }
    }

    #[test]
    fn a_long_slanted_lane_takes_few_cells() {
        let s = Segment { a: Point::new(0.0, 0.0), b: Point::new(700.0, 700.0) };
        assert!(cells_near(s, 0.9).count() < 1_000);
    }
}
