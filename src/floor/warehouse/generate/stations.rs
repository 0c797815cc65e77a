//! A hall whose four picking stations are work cells.
//!
//! Main function: [`stations`]. Refuses: parameters.

use super::Blocks;
use crate::geometry::{Point, Vector};
use crate::id::NodeId;
use crate::time::Span;
use crate::warehouse::cell::{ArmMount, Cell, CellOpening, Place, RackType, Tote};
use crate::warehouse::{Draft, Warehouse};

/// Distance from the rack's position to the middle of the opening, metres.
const OPENING_M: f64 = 0.6;
/// Distances from the rack's position to the beginning and the end of the workplace, metres.
const WORKPLACE_M: [f64; 2] = [0.9, 1.9];
/// Half of the width of opening and workplace, metres.
const HALF_M: f64 = 0.6;
/// Height of totes and of the arm's table, metres.
const TABLE_M: f64 = 0.85;
/// Stations with an arm beside the picker.
const WITH_ARM: [&str; 2] = ["S1", "S2"];

/// A hall for 24 robots: 16 blocks of eight storage places, two stations in the west (`S1`, `S2`) and two in the east,
/// each with a workplace and three totes. Racks are shelves of four columns and five rows.
pub fn stations() -> Warehouse {
    let blocks = Blocks {
        name: "stations".into(),
        groups: (1, 1),
        blocks: (4, 4),
        block_length: 4,
        stations_west: 2,
        stations_east: 2,
        queue: 3,
        // The average of the simulated pickers in the shipped scenario, with a button for each line.
        pick: Span::from_secs(25),
        chargers: 12,
        parking: 24,
        fill: 0.85,
        road_m: 1.0,
    };
    let mut draft = blocks.draft();
    for (bay, station) in [("W1", "S1"), ("W2", "S2"), ("E1", "S3"), ("E2", "S4")] {
        rename(&mut draft, bay, station);
    }
    furnish(&mut draft);
    draft.build().expect("the shipped map is well-formed, a test builds it")
}

/// Renames a station bay and its nodes.
fn rename(draft: &mut Draft, bay: &str, station: &str) {
    let renamed = |name: &mut String| {
        let rest = name.strip_prefix(bay).filter(|rest| rest.is_empty() || rest.starts_with('.'));
        if let Some(rest) = rest {
            *name = format!("{station}{rest}");
        }
    };
    draft.nodes.iter_mut().for_each(|n| renamed(&mut n.name));
    draft.lanes.iter_mut().for_each(|l| [&mut l.from, &mut l.to].into_iter().for_each(renamed));
    for s in &mut draft.stations {
        [&mut s.name, &mut s.node].into_iter().chain(&mut s.queue).for_each(renamed);
    }
}

/// Gives each station its cell and each rack its slots.
fn furnish(draft: &mut Draft) {
    let shelf = shelf();
    draft.racks.iter_mut().for_each(|rack| rack.rack_type = Some(shelf.name.clone()));
    draft.rack_types.push(shelf);
    let at = |name: &str| draft.nodes.iter().find(|n| n.name == name).expect("stations have nodes").at;
    let cells: Vec<Cell> = draft
        .stations
        .iter()
        .map(|s| {
            let (stands, waits) = (at(&s.node), at(&s.queue[0]));
            cell(stands, (stands - waits).normalize(), WITH_ARM.contains(&s.name.as_str()))
        })
        .collect();
    draft.stations.iter_mut().zip(cells).for_each(|(s, cell)| s.cell = Some(cell));
}

/// A building with a work cell at every station, an arm at the first few of them, and slots in every rack: for benches.
pub fn with_cells(warehouse: &Warehouse, arms: usize) -> Warehouse {
    let mut furnished = warehouse.clone();
    let shelf = furnished.rack_types.push(shelf());
    furnished.racks.iter_mut().for_each(|rack| rack.rack_type = Some(shelf));
    for (i, station) in furnished.stations.iter_mut().enumerate() {
        let at = |node: NodeId| warehouse.nodes[node].at;
        let waits = station.queue.first().map_or(at(station.node) - Vector::y(), |queue| at(*queue));
        let outward = (at(station.node) - waits).normalize();
        station.cell = Some(cell(at(station.node), outward, i < arms));
    }
    furnished
}

/// The racks of the map, as their picker sees them.
fn shelf() -> RackType {
    RackType {
        name: "shelf".into(),
        columns: 4,
        heights_m: vec![0.4, 0.75, 1.1, 1.45, 1.8],
        width_m: 0.88,
        face_m: 0.44,
    }
}

/// The cell of a station whose rack stands at `stands`, `outward` of the hall.
fn cell(stands: Point, outward: Vector, has_arm: bool) -> Cell {
    // As seen by a picker looking at the rack.
    let right = Vector::new(-outward.y, outward.x);
    let point = |out_m: f64, right_m: f64| stands + outward * out_m + right * right_m;
    let rectangle = |near_m: f64, far_m: f64| {
        vec![point(near_m, -HALF_M), point(near_m, HALF_M), point(far_m, HALF_M), point(far_m, -HALF_M)]
    };
    let place = |out_m: f64, right_m: f64| {
        let p = point(out_m, right_m);
        Place::new(p.x, p.y, TABLE_M)
    };
    let tote = |name: &str, out_m, right_m| Tote { name: name.into(), at: place(out_m, right_m) };
    let base = place(WORKPLACE_M[0], HALF_M + 0.3);
    Cell {
        workplace: rectangle(WORKPLACE_M[0], WORKPLACE_M[1]),
        opening: CellOpening {
            outline: rectangle(OPENING_M - 0.02, OPENING_M + 0.02),
            from_m: 0.2,
            to_m: 2.0,
        },
        totes: vec![tote("A", 0.9, -0.72), tote("B", 1.3, -0.75), tote("C", 1.3, 0.75)],
        arm: has_arm.then(|| ArmMount { base, heading: (-outward.y).atan2(-outward.x), kind: "ur10".into() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warehouse::{room_for, summary};

    #[test]
    fn four_stations_are_cells_two_with_an_arm_and_24_robots_have_room() {
        let w = stations();
        let names: Vec<&str> = w.stations.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(names, ["S1", "S2", "S3", "S4"]);
        let cells: Vec<&Cell> = w.stations.iter().map(|s| s.cell.as_ref().expect("a cell")).collect();
        assert_eq!(cells.iter().filter(|c| c.arm.is_some()).count(), 2);
        assert!(w.racks.iter().all(|r| r.rack_type.is_some()));
        room_for(&w, 24).expect("24 robots have room");
        assert!(summary(&w).racks > 100);
    }

    #[test]
    fn pickers_reach_every_slot_and_every_tote() {
        let w = stations();
        let shelf = w.rack_types.iter().next().unwrap();
        for s in w.stations.iter() {
            let (cell, stands) = (s.cell.as_ref().unwrap(), w.nodes[s.node].at);
            let corners = cell.workplace.iter().map(|p| p.coords).sum::<Vector>() / 4.0;
            let picker = Place::new(corners.x, corners.y, 1.2);
            for slot in shelf.slots() {
                let at = cell.place_of(stands, shelf, slot).unwrap();
                assert!((at - picker).norm() < 1.4, "{} {slot}: {}", s.name, (at - picker).norm());
            }
            assert!(cell.totes.iter().all(|t| (t.at - picker).norm() < 1.2), "{}", s.name);
        }
    }
}
