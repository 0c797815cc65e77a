//! A picking station as a work cell: where the picker stands, through which opening hands reach, where totes stand, and
//! where each slot of the rack at the station is.
//!
//! Main types: [`Cell`], [`RackType`], [`SlotName`]. Refuses: to know what is in a slot, and what must be picked.

mod slot;

pub use slot::{COLUMNS_MAX, ROWS_MAX, SlotName, SlotNameError};

use crate::geometry::{Point, Vector};

/// A place in space: x and y as on the map, z above the floor, metres.
pub type Place = nalgebra::Point3<f64>;

/// The work cell of a station.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Where the picker stands: corners of an outline on the floor, metres. No robot drives there.
    pub workplace: Vec<Point>,
    /// The opening between workplace and rack.
    pub opening: CellOpening,
    /// Where picked pieces are put.
    pub totes: Vec<Tote>,
    /// A robot arm beside the picker.
    pub arm: Option<ArmMount>,
}

/// The opening through which hands reach to a rack.
#[derive(Clone, Debug, PartialEq)]
pub struct CellOpening {
    /// Corners of the opening's outline on the floor, metres.
    pub outline: Vec<Point>,
    /// Height of the opening's lower edge above the floor, metres.
    pub from_m: f64,
    /// Height of the opening's upper edge above the floor, metres.
    pub to_m: f64,
}

/// A place for picked pieces.
#[derive(Clone, Debug, PartialEq)]
pub struct Tote {
    /// Name of the tote, unique in the station.
    pub name: String,
    /// The middle of the tote's rim.
    pub at: Place,
}

/// Where a robot arm is mounted.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmMount {
    /// The middle of the arm's base.
    pub base: Place,
    /// Direction that the arm's zero position faces, radians.
    pub heading: f64,
    /// The kind of arm.
    pub kind: String,
}

/// How the bins of a rack are arranged, as its picker sees them.
#[derive(Clone, Debug, PartialEq)]
pub struct RackType {
    /// Unique name.
    pub name: String,
    /// Number of columns; all are equally wide.
    pub columns: u8,
    /// For each row, the lowest first: height of the middle of its bins above the floor, metres.
    pub heights_m: Vec<f64>,
    /// Width over all columns, metres.
    pub width_m: f64,
    /// Distance from the middle of the rack to its face, metres.
    pub face_m: f64,
}

impl RackType {
    /// Whether the type has this slot.
    pub fn has(&self, slot: SlotName) -> bool {
        slot.column() < self.columns && usize::from(slot.row()) < self.heights_m.len()
    }

    /// All slots, row by row, the lowest row first and the leftmost slot of each first.
    pub fn slots(&self) -> impl Iterator<Item = SlotName> {
        let columns = self.columns;
        (0..self.heights_m.len() as u8).flat_map(move |row| (0..columns).map(move |c| SlotName::new(c, row)))
    }
}

impl CellOpening {
    /// The middle of the opening's outline.
    pub(super) fn middle(&self) -> Point {
        let sum: Vector = self.outline.iter().map(|p| p.coords).sum();
        Point::from(sum / self.outline.len() as f64)
    }
}

impl Cell {
    /// Where a slot is while its rack stands at the station, whose robot stands at `stands`: the middle of the bin's
    /// front. The rack's face is turned to the opening, and columns count from the picker's left. `None` if the type
    /// does not have the slot.
    pub fn place_of(&self, stands: Point, rack: &RackType, slot: SlotName) -> Option<Place> {
        if !rack.has(slot) {
            return None;
        }
        let [right, to_picker] = self.axes(stands);
        let column_m = rack.width_m / f64::from(rack.columns);
        let left_m = rack.width_m / 2.0 - (f64::from(slot.column()) + 0.5) * column_m;
        let at = stands + to_picker * rack.face_m - right * left_m;
        Some(Place::new(at.x, at.y, rack.heights_m[usize::from(slot.row())]))
    }

    /// Unit vectors to the right of a person looking at the rack at `stands`, and from the rack to that person.
    pub fn axes(&self, stands: Point) -> [Vector; 2] {
        // A validated cell's opening is not where the robot stands.
        let to_picker = (self.opening.middle() - stands).normalize();
        // The picker looks the other way, with the left hand a quarter turn counter-clockwise from there.
        [Vector::new(-to_picker.y, to_picker.x), to_picker]
    }

    /// How far a place is to the right of the rack's position, as seen by a picker looking at the rack, and how far
    /// from it towards the picker; metres.
    pub fn beside(&self, stands: Point, place: Place) -> [f64; 2] {
        let [right, to_picker] = self.axes(stands);
        let off = Point::new(place.x, place.y) - stands;
        [off.dot(&right), off.dot(&to_picker)]
    }

    /// The tote with this name.
    pub fn tote_named(&self, name: &str) -> Option<&Tote> {
        self.totes.iter().find(|t| t.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(opening: [[f64; 2]; 4]) -> Cell {
        let outline = opening.map(|[x, y]| Point::new(x, y)).to_vec();
        let opening = CellOpening { outline, from_m: 0.2, to_m: 2.0 };
        Cell { workplace: Vec::new(), opening, totes: Vec::new(), arm: None }
    }

    fn rack() -> RackType {
        let heights_m = vec![0.4, 0.8, 1.2];
        RackType { name: "shelf".into(), columns: 4, heights_m, width_m: 0.8, face_m: 0.4 }
    }

    fn slot(name: &str) -> SlotName {
        name.parse().unwrap()
    }

    #[test]
    fn the_first_slot_is_the_leftmost_of_the_lowest_row_for_who_looks_at_the_rack() {
        // The picker stands south of the rack and looks north: left is west.
        let south = cell([[-0.5, -0.6], [0.5, -0.6], [0.5, -0.5], [-0.5, -0.5]]);
        let at = |name| south.place_of(Point::new(0.0, 0.0), &rack(), slot(name)).unwrap();
        let near = |a: Place, b: [f64; 3]| (a - Place::from(b)).norm() < 1e-9;
        assert!(near(at("A1"), [-0.3, -0.4, 0.4]), "{}", at("A1"));
        assert!(near(at("D1"), [0.3, -0.4, 0.4]), "{}", at("D1"));
        assert!(near(at("B3"), [-0.1, -0.4, 1.2]), "{}", at("B3"));
        // A picker east of it looks west: left is south.
        let east = cell([[0.5, -0.5], [0.6, -0.5], [0.6, 0.5], [0.5, 0.5]]);
        let at = |name| east.place_of(Point::new(0.0, 0.0), &rack(), slot(name)).unwrap();
        assert!(near(at("A1"), [0.4, -0.3, 0.4]), "{}", at("A1"));
        assert!(near(at("D2"), [0.4, 0.3, 0.8]), "{}", at("D2"));
    }

    #[test]
    fn what_is_beside_the_picker_is_on_the_side_that_the_picker_sees() {
        let south = cell([[-0.5, -0.6], [0.5, -0.6], [0.5, -0.5], [-0.5, -0.5]]);
        let near = |a: [f64; 2], b: [f64; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
        assert!(near(south.beside(Point::origin(), Place::new(0.8, -1.2, 0.9)), [0.8, 1.2]), "east is right");
        let east = cell([[0.5, -0.5], [0.6, -0.5], [0.6, 0.5], [0.5, 0.5]]);
        assert!(near(east.beside(Point::origin(), Place::new(1.2, 0.8, 0.9)), [0.8, 1.2]), "north is right");
    }

    #[test]
    fn a_type_has_the_slots_that_it_lists_and_no_others() {
        let rack = rack();
        let all: Vec<SlotName> = rack.slots().collect();
        assert_eq!(all.len(), 12);
        assert_eq!((all[0], all[3], all[4], all[11]), (slot("A1"), slot("D1"), slot("A2"), slot("D3")));
        assert!(all.iter().all(|s| rack.has(*s)));
        let none = cell([[0.0, 1.0]; 4]);
        for missing in ["E1", "A4", "Z20"] {
            assert_eq!(none.place_of(Point::origin(), &rack, slot(missing)), None, "{missing}");
        }
    }
}
