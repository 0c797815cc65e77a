//! The written form of kinds of robots: beside the map, since which holds exclude one another follows from them, and
//! whole, where a kind was added while the fleet worked.
//!
//! Main functions: `write`, `read`, `outlines`; main type: [`RobotKindRecord`]. Refuses: to write beside the map what
//! holds do not depend on.

use giveway_fleet::{Capabilities, Charging, ObeyedLimits, RobotKind};
use giveway_floor::geometry::Point;
use giveway_floor::route::Kinematics;
use giveway_floor::time::Span;
use giveway_floor::warehouse::{Body, Footprint, Warehouse};
use serde::{Deserialize, Serialize};

/// A kind: name, outlines without and with a rack unless they are the map's square, types of loads, payload.
#[derive(Serialize, Deserialize)]
struct BodyRecord {
    kind: String,
    footprints: [Option<FootprintRecord>; 2],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    carries: Option<Vec<String>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    payload_kg: Option<f64>,
}

#[derive(Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum FootprintRecord {
    Square(f64),
    Circle(f64),
    Polygon(Vec<[f64; 2]>, bool),
}

/// An added kind: all its figures, so that defaults may change. Nothing where a figure has no bound.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct RobotKindRecord {
    name: String,
    speed_mps: f64,
    speed_loaded_mps: f64,
    accel_unloaded_mps2: f64,
    accel_loaded_mps2: f64,
    turn_radps: Option<f64>,
    /// Microseconds.
    lift: i64,
    clearance: i64,
    reaction: i64,
    battery: BatteryRecord,
    footprints: [Option<FootprintRecord>; 2],
    #[serde(default, skip_serializing_if = "Option::is_none")]
    carries: Option<Vec<String>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    payload_kg: Option<f64>,
    free_navigation: bool,
    #[serde(default, skip_serializing_if = "is_usual")]
    capabilities: CapabilityRecord,
}

/// What robots of a kind can do.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
struct CapabilityRecord {
    revocation: bool,
    limits: String,
    drives_back: bool,
    horizon_nodes: usize,
}

impl Default for CapabilityRecord {
    fn default() -> CapabilityRecord {
        Capabilities::default().into()
    }
}

fn is_usual(record: &CapabilityRecord) -> bool {
    *record == CapabilityRecord::default()
}

impl From<Capabilities> for CapabilityRecord {
    fn from(c: Capabilities) -> CapabilityRecord {
        let Capabilities { revocation, limits, drives_back, horizon_nodes } = c;
        CapabilityRecord { revocation, limits: limits.word().to_owned(), drives_back, horizon_nodes }
    }
}

impl From<CapabilityRecord> for Capabilities {
    fn from(r: CapabilityRecord) -> Capabilities {
        let CapabilityRecord { revocation, limits, drives_back, horizon_nodes } = r;
        // A word of a later version: assume that the robot obeys no limits.
        let limits = ObeyedLimits::of_word(&limits).unwrap_or(ObeyedLimits::Nothing);
        Capabilities { revocation, limits, drives_back, horizon_nodes }
    }
}

/// When robots of a kind charge.
#[derive(Clone, Serialize, Deserialize)]
struct BatteryRecord {
    critical: f64,
    low: f64,
    enough: f64,
    full: f64,
    opportunity: bool,
    driving_h: f64,
}

impl From<&RobotKind> for RobotKindRecord {
    fn from(kind: &RobotKind) -> RobotKindRecord {
        let RobotKind { kinematics: k, charging, .. } = kind;
        let Charging { critical, low, enough, full, opportunity, driving_h } = *charging;
        let bounded = |figure: f64| Some(figure).filter(|f| f.is_finite());
        RobotKindRecord {
            name: kind.name.clone(),
            speed_mps: k.speed_mps,
            speed_loaded_mps: k.speed_loaded_mps,
            accel_unloaded_mps2: k.accel_unloaded_mps2,
            accel_loaded_mps2: k.accel_loaded_mps2,
            turn_radps: bounded(k.turn_radps),
            lift: k.lift.0,
            clearance: k.clearance.0,
            reaction: k.reaction.0,
            battery: BatteryRecord { critical, low, enough, full, opportunity, driving_h },
            footprints: kind.footprints.each_ref().map(|f| f.as_ref().map(FootprintRecord::from)),
            carries: kind.carries.clone(),
            payload_kg: bounded(kind.payload_kg),
            free_navigation: kind.free_navigation,
            capabilities: kind.capabilities.into(),
        }
    }
}

impl From<RobotKindRecord> for RobotKind {
    fn from(r: RobotKindRecord) -> RobotKind {
        let BatteryRecord { critical, low, enough, full, opportunity, driving_h } = r.battery;
        RobotKind {
            name: r.name,
            kinematics: Kinematics {
                speed_mps: r.speed_mps,
                speed_loaded_mps: r.speed_loaded_mps,
                accel_unloaded_mps2: r.accel_unloaded_mps2,
                accel_loaded_mps2: r.accel_loaded_mps2,
                turn_radps: r.turn_radps.unwrap_or(f64::INFINITY),
                lift: Span(r.lift),
                clearance: Span(r.clearance),
                reaction: Span(r.reaction),
            },
            charging: Charging { critical, low, enough, full, opportunity, driving_h },
            footprints: r.footprints.map(|f| f.map(Footprint::from)),
            carries: r.carries,
            payload_kg: r.payload_kg.unwrap_or(f64::INFINITY),
            free_navigation: r.free_navigation,
            capabilities: r.capabilities.into(),
        }
    }
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

/// Kinds from text; nothing for a text that was not written by `write`.
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
