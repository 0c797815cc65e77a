//! Kinds of robots that are added, as recordings have them.
//!
//! Main type: [`KindRow`]. Refuses: to round, and to leave out usual values: these may change, and a recording must
//! play again to the same digest.

use giveway_fleet::{Capabilities, Charging, FloorAction, ObeyedLimits, RobotKind};
use giveway_floor::geometry::Point;
use giveway_floor::route::Kinematics;
use giveway_floor::time::Span;
use giveway_floor::warehouse::Footprint;
use serde::{Deserialize, Serialize};

/// A kind of robots with all its figures; nothing for one without a bound.
#[derive(Serialize, Deserialize)]
pub(super) struct KindRow {
    name: String,
    /// Top speed and acceleration, each without and with a rack.
    speed: [f64; 2],
    accel: [f64; 2],
    turn: Option<f64>,
    /// Times for lift, clearance and reaction, microseconds.
    spans: [i64; 3],
    /// Critical, low, enough, full, hours of driving.
    battery: [f64; 5],
    opportunity: bool,
    footprints: [Option<OutlineRow>; 2],
    carries: Option<Vec<String>>,
    payload: Option<f64>,
    free: bool,
    /// Revocation, limits, driving back, nodes of a horizon; absent in recordings from before kinds could lack any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    can: Option<(bool, String, bool, usize)>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum OutlineRow {
    Square(f64),
    Circle(f64),
    /// Corners, and whether the outline turns with the robot.
    Polygon(Vec<[f64; 2]>, bool),
}

impl KindRow {
    /// The request of this row.
    pub fn action(self) -> FloorAction {
        FloorAction::PutKind(Box::new(self.into()))
    }
}

impl From<&RobotKind> for KindRow {
    fn from(kind: &RobotKind) -> KindRow {
        let (k, c) = (kind.kinematics, kind.charging);
        let bounded = |figure: f64| Some(figure).filter(|f| f.is_finite());
        KindRow {
            name: kind.name.clone(),
            speed: [k.speed_mps, k.speed_loaded_mps],
            accel: [k.accel_unloaded_mps2, k.accel_loaded_mps2],
            turn: bounded(k.turn_radps),
            spans: [k.lift.0, k.clearance.0, k.reaction.0],
            battery: [c.critical, c.low, c.enough, c.full, c.driving_h],
            opportunity: c.opportunity,
            footprints: kind.footprints.each_ref().map(|f| f.as_ref().map(OutlineRow::from)),
            carries: kind.carries.clone(),
            payload: bounded(kind.payload_kg),
            free: kind.free_navigation,
            can: Some(kind.capabilities)
                .filter(|c| *c != Capabilities::default())
                .map(|c| (c.revocation, c.limits.word().to_owned(), c.drives_back, c.horizon_nodes)),
        }
    }
}

impl From<KindRow> for RobotKind {
    fn from(row: KindRow) -> RobotKind {
        let ([lift, clearance, reaction], opportunity) = (row.spans.map(Span), row.opportunity);
        let [critical, low, enough, full, driving_h] = row.battery;
        RobotKind {
            name: row.name,
            kinematics: Kinematics {
                speed_mps: row.speed[0],
                speed_loaded_mps: row.speed[1],
                accel_unloaded_mps2: row.accel[0],
                accel_loaded_mps2: row.accel[1],
                turn_radps: row.turn.unwrap_or(f64::INFINITY),
                lift,
                clearance,
                reaction,
            },
            charging: Charging { critical, low, enough, full, opportunity, driving_h },
            footprints: row.footprints.map(|f| f.map(Footprint::from)),
            carries: row.carries,
            payload_kg: row.payload.unwrap_or(f64::INFINITY),
            free_navigation: row.free,
            capabilities: row.can.map_or_else(Capabilities::default, can),
        }
    }
}

/// What robots of a kind can do; an unknown word for limits means that they obey none.
fn can((revocation, limits, drives_back, horizon_nodes): (bool, String, bool, usize)) -> Capabilities {
    let limits = ObeyedLimits::of_word(&limits).unwrap_or(ObeyedLimits::Nothing);
    Capabilities { revocation, limits, drives_back, horizon_nodes }
}

impl From<&Footprint> for OutlineRow {
    fn from(f: &Footprint) -> OutlineRow {
        match f {
            Footprint::Square { side_m } => OutlineRow::Square(*side_m),
            Footprint::Circle { radius_m } => OutlineRow::Circle(*radius_m),
            Footprint::Polygon { corners, turns } => {
                OutlineRow::Polygon(corners.iter().map(|c| [c.x, c.y]).collect(), *turns)
            }
        }
    }
}

impl From<OutlineRow> for Footprint {
    fn from(row: OutlineRow) -> Footprint {
        match row {
            OutlineRow::Square(side_m) => Footprint::Square { side_m },
            OutlineRow::Circle(radius_m) => Footprint::Circle { radius_m },
            OutlineRow::Polygon(corners, turns) => {
                let corners = corners.into_iter().map(|[x, y]| Point::new(x, y)).collect();
                Footprint::Polygon { corners, turns }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kind_comes_back_with_every_figure() {
        let corners = [(0.3, 0.2), (-0.3, 0.2), (-0.3, -0.2)].map(|(x, y)| Point::new(x, y)).to_vec();
        let kind = RobotKind {
            name: "odd".into(),
            kinematics: Kinematics {
                turn_radps: f64::INFINITY,
                accel_loaded_mps2: 0.1 + 0.2,
                ..Kinematics::default()
            },
            footprints: [Some(Footprint::Polygon { corners, turns: true }), None],
            carries: Some(vec!["bin".into()]),
            payload_kg: 60.5,
            free_navigation: true,
            ..RobotKind::default()
        };
        for kind in [kind, RobotKind::default()] {
            let text = serde_json::to_string(&KindRow::from(&kind)).unwrap();
            let back: KindRow = serde_json::from_str(&text).unwrap();
            assert_eq!(RobotKind::from(back), kind, "{text}");
        }
    }
}
