//! Which resources cannot be held by two robots at once, computed from the robots' footprint.
//!
//! A robot with its rack takes a square of side `footprint_m` along the map's axes; a lane takes the area that this
//! square sweeps, and its corridor if it has one. Two resources are in conflict if these areas overlap. Refuses:
//! hand-written exceptions.

use super::footprint::{Footprint, Hull};
use super::{Lane, Node};
use crate::geometry::{Segment, axis_distance, axis_distance_of_segments, axis_distance_to_segment};
use crate::id::{Dense, IdVec, LaneId, NodeId, ResourceId};
use smallvec::SmallVec;
use std::collections::BTreeMap;

/// Squares that touch do not overlap; this absorbs the rounding of decimal coordinates (metres).
pub(super) const TOUCH: f64 = 1e-6;

type ResourceConflicts = IdVec<ResourceId, SmallVec<[ResourceId; 2]>>;

/// All conflicts, symmetric, sorted, without pairs of a lane and its end node and without pairs of lanes that share an
/// end: those already exclude each other by their nodes.
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
    let corridor = |i: usize| i.checked_sub(nodes.len()).and_then(|l| lanes[LaneId::at(l)].corridor);
    let square = Footprint::Square { side_m: footprint_m };
    let taken = |i: usize| match corridor(i) {
        Some(corridor) => square.free(shapes[i], corridor),
        None => square.driving(shapes[i]),
    };
    // Most things have no corridor, and few hulls are asked for.
    let wide: BTreeMap<usize, Hull> =
        (0..shapes.len()).filter(|i| corridor(*i).is_some()).map(|i| (i, taken(i))).collect();
    let overlaps = |i: usize, j: usize| match (wide.get(&i), wide.get(&j)) {
        (None, None) => overlap(shapes[i], shapes[j], reach),
        (Some(a), Some(b)) => a.overlaps(b, TOUCH),
        (Some(a), None) => a.overlaps(&taken(j), TOUCH),
        (None, Some(b)) => taken(i).overlaps(b, TOUCH),
    };
    let widths: Vec<f64> = (0..shapes.len()).map(|i| corridor(i).map_or(0.0, |c| c.widest_m())).collect();
    for (i, j) in close_pairs(&shapes, &widths, footprint_m.max(0.1)) {
        let share = ends(i).iter().any(|n| ends(j).contains(n));
        if !share && overlaps(i, j) {
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

/// Pairs `(i, j)`, `i < j`, that come near one cell of a coarse grid, within `margin` and their own width; each pair
/// once.
fn close_pairs(shapes: &[Segment], widths: &[f64], margin: f64) -> Vec<(usize, usize)> {
    let mut grid: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
    for (i, (s, width)) in shapes.iter().zip(widths).enumerate() {
        for cell in cells_near(*s, 4.0 * margin, margin + width) {
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

/// The cells of a grid of pitch `cell` that `s` comes near, within `margin`, column by column, so that a long slanted
/// lane takes cells along itself and not all of its bounding box.
fn cells_near(s: Segment, cell: f64, margin: f64) -> impl Iterator<Item = (i64, i64)> {
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
                assert_eq!(close_pairs(&[s, beside], &[0.0; 2], 0.9), [(0, 1)], "{p} beside {s:?}");
            }
        }
    }

    #[test]
    fn a_long_slanted_lane_takes_few_cells() {
        let s = Segment { a: Point::new(0.0, 0.0), b: Point::new(700.0, 700.0) };
        assert!(cells_near(s, 3.6, 0.9).count() < 1_000);
    }

    #[test]
    fn a_corridor_is_in_conflict_with_all_that_its_floor_overlaps() {
        let node = |x: f64, y: f64| Node {
            name: format!("{x},{y}"),
            at: Point::new(x, y),
            kind: crate::warehouse::NodeKind::Aisle,
        };
        let nodes: IdVec<NodeId, Node> =
            vec![node(0.0, 0.0), node(10.0, 0.0), node(5.0, 2.4), node(5.0, -2.4), node(5.0, 40.0)].into();
        let lane = |corridor| Lane {
            a: NodeId(0),
            b: NodeId(1),
            both: true,
            length_m: 10.0,
            speed_limit_mps: None,
            users: crate::warehouse::Users::ALL,
            kinds: None,
            corridor,
        };
        let conflicts = |corridor: Option<(f64, f64)>| {
            let corridor = corridor.map(|(left_m, right_m)| crate::warehouse::Corridor { left_m, right_m });
            let lanes: IdVec<LaneId, Lane> = vec![lane(corridor)].into();
            between(&nodes, &lanes, 0.9)[ResourceId(5)].to_vec()
        };
        assert_eq!(conflicts(None), []);
        assert_eq!(conflicts(Some((1.9, 1.9))), [], "1.9 m and half of 0.9 m are less than 2.4 m");
        assert_eq!(conflicts(Some((2.0, 0.6))), [ResourceId(2)], "the one on the left");
        assert_eq!(conflicts(Some((0.6, 2.0))), [ResourceId(3)], "the one on the right");
        assert_eq!(conflicts(Some((2.0, 2.0))), [ResourceId(2), ResourceId(3)]);
    }
}
