//! Guidance as JSON: what a headset is told, in words.
//!
//! Main functions: [`guidance`]; main type: [`GuidanceKey`], which says when a client is told at once. Refuses: to
//! decide what workers are told.

use super::dto::Names;
use super::text::{assignment_name, round3};
use crate::fleet::{Guidance, GuidanceReason, GuidanceState, NearRobot};
use crate::geometry::{Point, wrap_angle};
use crate::time::Time;
use serde_json::{Value, json};

/// What makes a client be told at once when it changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GuidanceKey {
    /// How things stand.
    pub state: GuidanceState,
    reason: Option<GuidanceReason>,
    version: u64,
}

impl GuidanceKey {
    /// Of some guidance, or of none.
    pub fn of(guidance: Option<&Guidance>) -> GuidanceKey {
        let of = |g: &Guidance| GuidanceKey { state: g.state, reason: g.reason, version: g.version };
        guidance.map_or(GuidanceKey { state: GuidanceState::Idle, reason: None, version: 0 }, of)
    }
}

/// What is needed besides guidance to write it down.
pub struct GuidanceContext<'a> {
    /// Names of robots.
    pub names: Names<'a>,
    /// Where the worker faces, radians.
    pub heading: Option<f64>,
    /// Now.
    pub now: Time,
}

/// Guidance as a headset gets it.
pub fn guidance(told: Option<&Guidance>, beside: GuidanceContext<'_>) -> Value {
    let Some(g) = told else {
        return json!({
            "type": "guidance", "state": GuidanceState::Idle.word(), "reason": null, "version": 0, "path": [],
            "next": null, "eta_s": null, "assignment": null, "near": [],
        });
    };
    let near = |r: &NearRobot| {
        json!({
            "id": beside.names.robot(r.robot), "distance": round3(r.distance_m),
            "bearing": beside.heading.map(|h| round3(wrap_angle(r.bearing - h))),
            "bearing_map": round3(r.bearing), "closest_s": r.closest.map(|s| round3(s.as_secs_f64())),
            "speed": round3(r.speed_mps),
        })
    };
    json!({
        "type": "guidance", "state": g.state.word(), "reason": g.reason.map(|r| reason(r, beside.names)),
        "version": g.version, "path": line(&g.path), "next": g.next.map(corner),
        "eta_s": g.eta.map(|t| round3((t - beside.now).as_secs_f64())),
        "wait_s": g.wait.map(|t| round3((t - beside.now).as_secs_f64().max(0.0))),
        "assignment": g.assignment.map(assignment_name), "near": g.near.iter().map(near).collect::<Vec<_>>(),
    })
}

pub(super) fn reason(reason: GuidanceReason, names: Names<'_>) -> String {
    match reason {
        GuidanceReason::LeftPath => "you left the path".into(),
        GuidanceReason::RobotComes(r) => format!("{} is coming close: stand still", names.robot(r)),
        GuidanceReason::RobotInTheWay(r) => {
            format!("{} blocks the path and cannot move away", names.robot(r))
        }
        GuidanceReason::RobotWaits(r) => format!("{} waits for you: please make room", names.robot(r)),
        GuidanceReason::RobotPasses(r) => {
            format!("{} has waited for long: stay where you are until it has passed", names.robot(r))
        }
        GuidanceReason::RobotCrosses(r) => {
            format!("{} crosses your path: wait a moment, this way is still the fastest", names.robot(r))
        }
        GuidanceReason::PlaceUnsure(r) => format!(
            "{} waits because the headset knows badly where you are: stand still, and touch the marks again",
            names.robot(r)
        ),
        GuidanceReason::CutsOff => "you stand where robots have work: please make room".into(),
        GuidanceReason::RoundClosure(c) => {
            format!("the way leads round a closed area: {}", names.why_closed(c))
        }
        GuidanceReason::LeavesClosure(c) => {
            format!("this area is closed, leave it along the path: {}", names.why_closed(c))
        }
        GuidanceReason::PlaceClosed(c) => {
            format!("the place of your task is in a closed area, wait outside: {}", names.why_closed(c))
        }
        GuidanceReason::Evacuation => "the building is evacuated: leave by the door, and stay outside".into(),
        GuidanceReason::NoWay => "no path to the place is free".into(),
        GuidanceReason::NotTracked => {
            "the headset does not know where you are: stand still, and touch the marks again".into()
        }
    }
}

fn corner(p: Point) -> [f64; 2] {
    [round3(p.x), round3(p.y)]
}

pub(super) fn line(points: &[Point]) -> Vec<[f64; 2]> {
    points.iter().map(|p| corner(*p)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fleet::{RobotView, View};
    use crate::id::RobotId;
    use crate::time::Span;

    #[test]
    fn a_robot_on_the_left_has_a_positive_bearing() {
        let map = crate::warehouse::formats::json::parse(include_str!("../../maps/lab.json")).unwrap();
        let view = View { robots: Vec::<RobotView>::new(), ..View::default() };
        let near = NearRobot {
            robot: RobotId(0),
            distance_m: 2.0,
            bearing: -3.0,
            closest: Some(Span::from_millis(1500)),
            speed_mps: 1.0,
        };
        let told = Guidance {
            state: GuidanceState::Stop,
            reason: Some(GuidanceReason::NoWay),
            version: 4,
            path: vec![],
            next: None,
            eta: Some(Time(5_000_000)),
            wait: Some(Time(4_500_000)),
            assignment: None,
            near: vec![near],
        };
        let beside = |heading| GuidanceContext {
            names: Names { map: &map, view: &view },
            heading,
            now: Time(3_000_000),
        };
        let text = guidance(Some(&told), beside(Some(3.0)));
        let expected = std::f64::consts::TAU - 6.0;
        assert_eq!(text["near"][0]["bearing"], json!(round3(expected)), "{text}");
        assert_eq!((text["eta_s"].clone(), text["state"].clone()), (json!(2.0), json!("stop")));
        assert_eq!(text["wait_s"], json!(1.5));
        assert_eq!(guidance(Some(&told), beside(None))["near"][0]["bearing"], Value::Null);
        assert_eq!(guidance(None, beside(None))["state"], "idle");
    }
}
