//! The face of the rack at a station and the totes beside it, in the frame of the picker there.
//!
//! Main type: [`PickFace`]. In its frame the first coordinate is to the picker's right of the rack's middle, the second
//! from there towards the picker, the third above the floor; metres. Refuses: to know the picker.

use giveway_floor::geometry::{Point, Vector};
use giveway_floor::warehouse::{Cell, Place, RackType, SlotName};

/// A place in the frame of the face.
pub type FacePlace = nalgebra::Vector3<f64>;

/// Depth behind the face from which a hand is in a slot, metres.
const IN_SLOT_M: f64 = 0.02;
/// Distance from the middle of a tote's rim within which a hand is in the tote, metres on the floor …
const TOTE_M: f64 = 0.19;
/// … and the same below and above the rim.
const TOTE_BELOW_M: f64 = 0.35;
const TOTE_ABOVE_M: f64 = 0.12;
/// Distance on the picker's side of the opening within which a hand still counts as inside, metres.
const OUTSIDE_M: f64 = 0.02;
/// Distance before the face within which a hand may be warned, metres.
const NEAR_M: f64 = 0.15;
/// Height of a row without another one above or below it, metres.
const ROW_M: f64 = 0.35;

/// A rack's face with the totes beside it.
#[derive(Clone, Debug, PartialEq)]
pub struct PickFace {
    stands: Point,
    right: Vector,
    out: Vector,
    columns: u8,
    heights_m: Vec<f64>,
    width_m: f64,
    face_m: f64,
    /// Where the opening ends on the picker's side.
    opening_m: f64,
    totes: Vec<FacePlace>,
}

impl PickFace {
    /// The face of a rack of this type at a station whose robot stands at `stands`.
    pub fn new(cell: &Cell, stands: Point, rack: &RackType) -> PickFace {
        let [right, out] = cell.axes(stands);
        let mut face = PickFace {
            stands,
            right,
            out,
            columns: rack.columns,
            heights_m: rack.heights_m.clone(),
            width_m: rack.width_m,
            face_m: rack.face_m,
            opening_m: 0.0,
            totes: Vec::new(),
        };
        let farthest = cell.opening.outline.iter().map(|p| out.dot(&(p - stands)));
        face.opening_m = farthest.fold(rack.face_m, f64::max);
        face.totes = cell.totes.iter().map(|t| face.of(t.at)).collect();
        face
    }

    /// A place on the map in the frame of the face.
    pub fn of(&self, place: Place) -> FacePlace {
        let off = Point::new(place.x, place.y) - self.stands;
        FacePlace::new(off.dot(&self.right), off.dot(&self.out), place.z)
    }

    /// A direction on the map in the frame of the face.
    pub fn direction(&self, along: nalgebra::Vector3<f64>) -> FacePlace {
        let level = along.xy();
        FacePlace::new(level.dot(&self.right), level.dot(&self.out), along.z)
    }

    /// The place on the map of a place in the frame of the face.
    pub fn on_map(&self, at: FacePlace) -> Place {
        let floor = self.stands + self.right * at.x + self.out * at.y;
        Place::new(floor.x, floor.y, at.z)
    }

    /// Where the opening ends on the picker's side, metres from the rack's middle.
    pub fn opening_m(&self) -> f64 {
        self.opening_m
    }

    /// Width over all columns, metres.
    pub fn width_m(&self) -> f64 {
        self.width_m
    }

    /// From the middle of the rack to its face, metres.
    pub fn face_m(&self) -> f64 {
        self.face_m
    }

    /// For each row, the lowest first: height of the middle of its slots above the floor, metres.
    pub fn heights_m(&self) -> &[f64] {
        &self.heights_m
    }

    /// The middle of a slot's front.
    pub fn slot(&self, slot: SlotName) -> FacePlace {
        let column_m = self.width_m / f64::from(self.columns);
        let right_m = (f64::from(slot.column()) + 0.5) * column_m - self.width_m / 2.0;
        FacePlace::new(right_m, self.face_m, self.heights_m[usize::from(slot.row())])
    }

    /// All slots with the middles of their fronts, row by row.
    pub fn slots(&self) -> impl Iterator<Item = (SlotName, FacePlace)> {
        let rows = 0..self.heights_m.len() as u8;
        let names = rows.flat_map(move |row| (0..self.columns).map(move |c| SlotName::new(c, row)));
        names.map(|slot| (slot, self.slot(slot)))
    }

    /// Number of totes.
    pub fn totes(&self) -> usize {
        self.totes.len()
    }

    /// The middle of the rim of the tote with this number at the station.
    pub fn tote(&self, tote: usize) -> Option<FacePlace> {
        self.totes.get(tote).copied()
    }

    /// Depth of a place behind the face, metres; negative in front of it.
    pub fn depth_m(&self, at: FacePlace) -> f64 {
        self.face_m - at.y
    }

    /// The slot that contains a hand at this place.
    pub fn slot_at(&self, at: FacePlace) -> Option<SlotName> {
        (self.depth_m(at) > IN_SLOT_M).then(|| self.slot_before(at)).flatten()
    }

    /// The slot behind or before which a place is, at any distance from the face.
    pub fn slot_before(&self, at: FacePlace) -> Option<SlotName> {
        let column = ((at.x + self.width_m / 2.0) / self.width_m * f64::from(self.columns)).floor();
        if !(0.0..f64::from(self.columns)).contains(&column) {
            return None;
        }
        let off = |h: &f64| (at.z - h).abs();
        let (row, height) = self.heights_m.iter().enumerate().min_by(|a, b| off(a.1).total_cmp(&off(b.1)))?;
        (off(height) <= ROW_M / 2.0 + IN_SLOT_M).then(|| SlotName::new(column as u8, row as u8))
    }

    /// The tote that contains a hand at this place, or is just below it.
    pub fn tote_at(&self, at: FacePlace) -> Option<usize> {
        let off = |t: &FacePlace| (at - t).xy().norm();
        let (tote, rim) = self.totes.iter().enumerate().min_by(|a, b| off(a.1).total_cmp(&off(b.1)))?;
        let above = at.z - rim.z;
        (off(rim) <= TOTE_M && (-TOTE_BELOW_M..=TOTE_ABOVE_M).contains(&above)).then_some(tote)
    }

    /// Whether a hand at this place is just before a slot, in one, or in a tote.
    pub fn is_near(&self, at: FacePlace) -> bool {
        self.depth_m(at) > -NEAR_M || self.tote_at(at).is_some()
    }

    /// Whether a hand at this place is in the opening or beyond it, where the rack may not move.
    pub fn is_inside(&self, at: FacePlace) -> bool {
        self.outside_m(at) < 0.0 && self.is_beside_rack(at)
    }

    /// Distance of a place from the opening on the picker's side, metres; negative inside.
    pub fn outside_m(&self, at: FacePlace) -> f64 {
        at.y - (self.opening_m + OUTSIDE_M)
    }

    /// Whether a place is no farther to the side than an arriving or leaving rack can be.
    pub fn is_beside_rack(&self, at: FacePlace) -> bool {
        at.x.abs() < self.width_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::stations;

    fn faces() -> Vec<PickFace> {
        let w = stations();
        let rack = w.rack_types.iter().next().expect("racks have a type");
        let of = |s: &giveway_floor::warehouse::Station| {
            PickFace::new(s.cell.as_ref().expect("it has a cell"), w.nodes[s.node].at, rack)
        };
        w.stations.iter().map(of).collect()
    }

    #[test]
    fn the_middle_of_a_slot_is_where_the_map_has_it_and_a_hand_there_is_in_that_slot() {
        let w = stations();
        let rack = w.rack_types.iter().next().unwrap();
        for (station, face) in w.stations.iter().zip(faces()) {
            let cell = station.cell.as_ref().unwrap();
            for (slot, at) in face.slots() {
                let place = cell.place_of(w.nodes[station.node].at, rack, slot).unwrap();
                assert!((face.of(place) - at).norm() < 1e-9, "{slot}");
                let behind = at - FacePlace::new(0.0, 0.1, 0.0);
                assert_eq!((face.slot_at(behind), face.slot_at(at)), (Some(slot), None), "{slot}");
                assert!(face.is_inside(behind) && face.is_inside(at));
            }
        }
    }

    #[test]
    fn a_hand_over_a_tote_is_in_it_and_outside_of_the_opening() {
        for face in faces() {
            for tote in 0..3 {
                let rim = face.tote(tote).unwrap();
                assert_eq!(face.tote_at(rim + FacePlace::new(0.05, 0.05, -0.1)), Some(tote));
                assert_eq!(face.tote_at(rim + FacePlace::new(0.0, 0.0, 0.3)), None, "high above it");
                assert!(!face.is_inside(rim));
            }
            assert_eq!(face.tote(3), None);
        }
    }
}
