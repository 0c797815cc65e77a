//! Kinds of robots as they are written down beside the map: which holds exclude one another follows from them.
//!
//! Main functions: `write`, `read`, `outlines`. Refuses: to know of a kind what holds do not depend on; the scenario
//! has that.

use giveway_floor::geometry::Point;
use giveway_floor::warehouse::{Body, Footprint, Warehouse};
use serde::{Deserialize, Serialize};

/// A kind: name, outlines without and with a rack where they are not the map's square, types of loads, payload.
#[derive(Serialize, Deserialize)]
struct BodyRecord {
    kind: String,
    footprints: [Option<FootprintRecord>; 2],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    carries: Option<Vec<String>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    payload_kg: Option<f64>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum FootprintRecord {
    Square(f64),
    Circle(f64),
    Polygon(Vec<[f64; 2]>, bool),
}

/// The outlines of a kind as text.
pub(super) fn outlines(body: &Body) -> String {
    let footprints = body.footprints.each_ref().map(|f| f.as_ref().map(FootprintRecord::from));
    serde_json::to_string(&footprints).expect("records are JSON")
}

/// The kinds of a building as text.
pub(super) fn write(map: &Warehouse) -> String {
    let records: Vec<BodyRecord> = map.bodies().iter().map(BodyRecord::from).collect();
    serde_json::to_string(&records).expect("records are JSON")
}

/// Kinds from text; nothing where it is not one of ours.
pub(super) fn read(text: &str) -> Option<Vec<Body>> {
    let records: Vec<BodyRecord> = serde_json::from_str(text).ok()?;
    Some(records.into_iter().map(Body::from).collect())
}

impl From<&Body> for BodyRecord {
    fn from(b: &Body) -> BodyRecord {
        let footprints = b.footprints.each_ref().map(|f| f.as_ref().map(FootprintRecord::from));
        let payload_kg = Some(b.payload_kg).filter(|kg| kg.is_finite());
        BodyRecord { kind: b.kind.clone(), footprints, carries: b.carries.clone(), payload_kg }
    }
}

impl From<BodyRecord> for Body {
    fn from(r: BodyRecord) -> Body {
        let footprints = r.footprints.map(|f| f.map(Footprint::from));
        let payload_kg = r.payload_kg.unwrap_or(f64::INFINITY);
        Body { kind: r.kind, footprints, carries: r.carries, payload_kg }
    }
}

impl From<&Footprint> for FootprintRecord {
    fn from(f: &Footprint) -> FootprintRecord {
        match f {
            Footprint::Square { side_m } => FootprintRecord::Square(*side_m),
            Footprint::Circle { radius_m } => FootprintRecord::Circle(*radius_m),
            Footprint::Polygon { corners, turns } => {
                FootprintRecord::Polygon(corners.iter().map(|c| [c.x, c.y]).collect(), *turns)
            }
        }
    }
}

impl From<FootprintRecord> for Footprint {
    fn from(r: FootprintRecord) -> Footprint {
        match r {
            FootprintRecord::Square(side_m) => Footprint::Square { side_m },
            FootprintRecord::Circle(radius_m) => Footprint::Circle { radius_m },
            FootprintRecord::Polygon(corners, turns) => {
                let corners = corners.into_iter().map(|[x, y]| Point::new(x, y)).collect();
                Footprint::Polygon { corners, turns }
            }
        }
    }
}
