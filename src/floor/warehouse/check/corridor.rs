//! Corridors of lanes: their widths, and things in their way.
//!
//! Main functions: [`widths`], [`clear_of_things`]. Refuses: corridors that run through racks, places where robots
//! stay, obstacles, or out of the floor on which people walk; a lane without a corridor may pass them as before.

use super::Findings;
use super::place::FindingPlace;
use crate::geometry::{Point, Segment, inside, runs_through};
use crate::id::LaneId;
use crate::warehouse::{CORRIDOR_MAX_M, Corridor, Footprint, Lane, NodeKind, Warehouse};

/// Overlap up to this is only touching, metres.
const TOUCH_M: f64 = 1e-6;

/// Reports invalid widths.
pub(super) fn widths(corridor: Corridor, place: &FindingPlace, found: &mut Findings) {
    for (side, width) in [("left", corridor.left_m), ("right", corridor.right_m)] {
        if !(0.0..=CORRIDOR_MAX_M).contains(&width) {
            let remedy = format!("give metres from 0 to {CORRIDOR_MAX_M}");
            found.add(place, format!("its corridor is {width} m wide on the {side}"), remedy);
        }
    }
}

/// Reports every lane with something in its corridor.
pub(in crate::warehouse) fn clear_of_things(w: &Warehouse) -> Result<(), Findings> {
    let mut found = Findings::default();
    for (id, lane) in w.lanes.pairs() {
        if let Some(corridor) = lane.corridor {
            one(w, id, lane, corridor, &mut found);
        }
    }
    found.into_result()
}

fn one(w: &Warehouse, id: LaneId, lane: &Lane, corridor: Corridor, found: &mut Findings) {
    let (a, b) = (&w.nodes[lane.a], &w.nodes[lane.b]);
    let place = FindingPlace::of(format!("lane {}–{}", a.name, b.name), [&a.name, &b.name]);
    let remedy = "make the corridor narrower on that side, or shorter by a node in between";
    let line = Segment { a: a.at, b: b.at };
    let square = Footprint::Square { side_m: w.footprint_m };
    let (on_line, free) = (square.driving(line), square.free(line, corridor));
    for other in w.conflicts(w.lane_resource(id)) {
        let Ok(n) = w.resource(*other) else { continue };
        let node = &w.nodes[n];
        let standing = square.standing(node.at);
        let open = matches!(node.kind, NodeKind::Aisle | NodeKind::Exit);
        if !open && free.overlaps(&standing, TOUCH_M) && !on_line.overlaps(&standing, TOUCH_M) {
            let what = if node.kind == NodeKind::Storage { "a rack" } else { "a robot" };
            found.add(&place, format!("its corridor runs through {what} at {}", node.name), remedy);
        }
    }
    let corners = corridor.corners(line, TOUCH_M);
    for (i, outline) in w.obstacles.iter().enumerate() {
        if overlaps(outline, &corners) {
            found.add(&place, format!("its corridor runs through outline {} of obstacles", i + 1), remedy);
        }
    }
    let on_floor = |p: &Point| w.walkable.iter().any(|outline| inside(outline, *p));
    if [a.at, b.at].iter().all(on_floor) && !corners.iter().all(on_floor) {
        found.add(&place, "its corridor leaves the floor on which people may walk", remedy);
    }
}

/// Whether an outline and a corridor share more than an edge.
fn overlaps(outline: &[Point], corners: &[Point; 4]) -> bool {
    let sides = (0..4).map(|i| Segment { a: corners[i], b: corners[(i + 1) % 4] });
    sides.into_iter().any(|side| runs_through(outline, side)) || outline.iter().any(|p| inside(corners, *p))
}
