//! Work cells and types of racks in the map format.
//!
//! Main types: [`CellRecord`], [`RackTypeRecord`]. Refuses: to check them.

use super::json::{Corner, Number};
use crate::warehouse::cell::{ArmMount, Cell, CellOpening, Place, RackType, Tote};
use serde::{Deserialize, Serialize};

/// A place in space: `[x, y, z]`.
#[derive(Serialize, Deserialize, Clone, Copy)]
struct PlaceRecord(Number, Number, Number);

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CellRecord {
    workplace: Vec<Corner>,
    opening: OpeningRecord,
    totes: Vec<ToteRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    arm: Option<ArmRecord>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct OpeningRecord {
    outline: Vec<Corner>,
    from_m: Number,
    to_m: Number,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ToteRecord {
    id: String,
    at: PlaceRecord,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ArmRecord {
    base: PlaceRecord,
    #[serde(default = "zero")]
    heading_deg: Number,
    kind: String,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RackTypeRecord {
    id: String,
    columns: u8,
    heights_m: Vec<Number>,
    width_m: Number,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    face_m: Option<Number>,
}

fn zero() -> Number {
    Number(0.0)
}

impl From<PlaceRecord> for Place {
    fn from(PlaceRecord(x, y, z): PlaceRecord) -> Place {
        Place::new(x.0, y.0, z.0)
    }
}

impl From<&Place> for PlaceRecord {
    fn from(p: &Place) -> PlaceRecord {
        PlaceRecord(Number(p.x), Number(p.y), Number(p.z))
    }
}

impl CellRecord {
    /// The cell of the record, unchecked.
    pub fn cell(self) -> Cell {
        let OpeningRecord { outline, from_m, to_m } = self.opening;
        let arm = |a: ArmRecord| ArmMount {
            base: a.base.into(),
            heading: a.heading_deg.0.to_radians(),
            kind: a.kind,
        };
        Cell {
            workplace: Corner::outline(&self.workplace),
            opening: CellOpening { outline: Corner::outline(&outline), from_m: from_m.0, to_m: to_m.0 },
            totes: self.totes.into_iter().map(|t| Tote { name: t.id, at: t.at.into() }).collect(),
            arm: self.arm.map(arm),
        }
    }

    /// The record of a cell.
    pub fn of(cell: &Cell) -> CellRecord {
        let CellOpening { outline, from_m, to_m } = &cell.opening;
        let outline = Corner::of_outline(outline);
        // Degrees are written as they were read: to a thousand-millionth.
        let degrees = |radians: f64| Number((radians.to_degrees() * 1e9).round() / 1e9);
        let arm = |a: &ArmMount| ArmRecord {
            base: (&a.base).into(),
            heading_deg: degrees(a.heading),
            kind: a.kind.clone(),
        };
        CellRecord {
            workplace: Corner::of_outline(&cell.workplace),
            opening: OpeningRecord { outline, from_m: Number(*from_m), to_m: Number(*to_m) },
            totes: cell.totes.iter().map(|t| ToteRecord { id: t.name.clone(), at: (&t.at).into() }).collect(),
            arm: cell.arm.as_ref().map(arm),
        }
    }
}

impl RackTypeRecord {
    /// The type of the record, unchecked. By default its face is at the edge of the footprint.
    pub fn rack_type(self, footprint_m: f64) -> RackType {
        RackType {
            name: self.id,
            columns: self.columns,
            heights_m: self.heights_m.iter().map(|h| h.0).collect(),
            width_m: self.width_m.0,
            face_m: self.face_m.map_or(footprint_m / 2.0, |f| f.0),
        }
    }

    /// The record of a type.
    pub fn of(t: &RackType) -> RackTypeRecord {
        RackTypeRecord {
            id: t.name.clone(),
            columns: t.columns,
            heights_m: t.heights_m.iter().map(|h| Number(*h)).collect(),
            width_m: Number(t.width_m),
            face_m: Some(Number(t.face_m)),
        }
    }
}
