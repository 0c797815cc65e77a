//! Guidance on the wire: what a headset shows its worker, in words.
//!
//! Main function: [`guidance`]; main types: [`GuidanceDto`], and [`GuidanceKey`], whose changes are sent at once.
//! Refuses: to decide what workers are told.

use crate::dto::names::Names;
use crate::wire::sentence::SentenceSchema;
use crate::wire::text::{assignment_name, round3};
use crate::wire::words::{GuidanceReasonDto, GuidanceStateDto};
use giveway_fleet::{Guidance, GuidanceReason, GuidanceState, NearRobot};
use giveway_floor::geometry::{Point, wrap_angle};
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::guidance as say;
use giveway_floor::time::Time;
use serde::Serialize;
use utoipa::ToSchema;

/// The part of guidance whose changes are sent to the client at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GuidanceKey {
    /// The state of the worker's guidance.
    pub state: GuidanceState,
    reason: Option<GuidanceReason>,
    version: u64,
}

impl GuidanceKey {
    /// The key of this guidance, or of the absence of guidance.
    pub fn of(guidance: Option<&Guidance>) -> GuidanceKey {
        let of = |g: &Guidance| GuidanceKey { state: g.state, reason: g.reason, version: g.version };
        guidance.map_or(GuidanceKey { state: GuidanceState::Idle, reason: None, version: 0 }, of)
    }
}

/// What the wire form of guidance needs besides the guidance itself.
pub struct GuidanceContext<'a> {
    /// Names of robots.
    pub names: Names<'a>,
    /// Where the worker faces, radians.
    pub heading: Option<f64>,
    /// The current time.
    pub now: Time,
}

/// Guidance for a worker.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct GuidanceDto {
    /// The state of the worker's guidance.
    pub state: GuidanceStateDto,
    /// Why the worker is told this, in words.
    #[schema(value_type = Option<SentenceSchema>)]
    pub reason: Option<Sentence>,
    /// Why the worker is told this, for programs that have words of their own for it.
    pub cause: Option<GuidanceCauseDto>,
    /// The version of the path; it grows with every new path.
    pub version: u64,
    /// The path from the worker's place on, as points `[x, y]`, metres.
    pub path: Vec<[f64; 2]>,
    /// The next corner of the path, metres.
    pub next: Option<[f64; 2]>,
    /// Seconds to the end of the path at the worker's usual speed.
    pub eta_s: Option<f64>,
    /// How long the worker should wait, seconds.
    pub wait_s: Option<f64>,
    /// The assignment that the path serves.
    #[schema(example = "a3")]
    pub assignment: Option<String>,
    /// Whether the worker is at the assignment's place.
    pub arrived: bool,
    /// Robots near the worker, the nearest first.
    pub near: Vec<NearRobotDto>,
    /// The newest pose that this guidance takes into account.
    pub pose: Option<PoseRefDto>,
}

/// Why a worker is told something: the kind of reason, and what its sentence names.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
pub struct GuidanceCauseDto {
    /// The kind of reason.
    pub kind: GuidanceReasonDto,
    /// The robot that the reason is about.
    #[schema(example = "robot-3")]
    pub robot: Option<String>,
    /// Why the area that the reason is about is closed, in the supervisor's words.
    pub closure: Option<String>,
}

/// A robot near a worker.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct NearRobotDto {
    /// The robot.
    #[schema(example = "robot-3")]
    pub id: String,
    /// Distance from the worker, metres.
    pub distance: f64,
    /// Bearing from where the worker faces, radians, positive to the left; null if the heading is unknown.
    pub bearing: Option<f64>,
    /// Bearing from the map's x axis, radians, counter-clockwise.
    pub bearing_map: f64,
    /// Seconds until the robot is closest; null if it does not come closer.
    pub closest_s: Option<f64>,
    /// Speed of the robot, metres per second.
    pub speed: f64,
}

/// A reference to a pose that the headset sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
pub struct PoseRefDto {
    /// The epoch of the alignment to which the pose belongs.
    pub epoch: u32,
    /// The pose's number.
    pub seq: u64,
}

/// Guidance as a headset gets it, except for the pose that it takes into account.
pub fn guidance(told: Option<&Guidance>, beside: GuidanceContext<'_>) -> GuidanceDto {
    let Some(g) = told else {
        return GuidanceDto {
            state: GuidanceStateDto::Idle,
            reason: None,
            cause: None,
            version: 0,
            path: Vec::new(),
            next: None,
            eta_s: None,
            wait_s: None,
            assignment: None,
            arrived: false,
            near: Vec::new(),
            pose: None,
        };
    };
    let near = |r: &NearRobot| NearRobotDto {
        id: beside.names.robot(r.robot),
        distance: round3(r.distance_m),
        bearing: beside.heading.map(|h| round3(wrap_angle(r.bearing - h))),
        bearing_map: round3(r.bearing),
        closest_s: r.closest.map(|s| round3(s.as_secs_f64())),
        speed: round3(r.speed_mps),
    };
    GuidanceDto {
        state: g.state.into(),
        reason: g.reason.map(|r| reason(r, beside.names)),
        cause: g.reason.map(|r| cause(r, beside.names)),
        version: g.version,
        path: line(&g.path),
        next: g.next.map(corner),
        eta_s: g.eta.map(|t| round3((t - beside.now).as_secs_f64())),
        wait_s: g.wait.map(|t| round3((t - beside.now).as_secs_f64().max(0.0))),
        assignment: g.assignment.map(assignment_name),
        arrived: g.arrived,
        near: g.near.iter().map(near).collect(),
        pose: None,
    }
}

fn cause(reason: GuidanceReason, names: Names<'_>) -> GuidanceCauseDto {
    use GuidanceReason as Why;
    let (robot, closure) = match reason {
        Why::RobotComes(r)
        | Why::RobotInTheWay(r)
        | Why::RobotWaits(r)
        | Why::RobotPasses(r)
        | Why::RobotCrosses(r)
        | Why::PlaceUnsure(r) => (Some(names.robot(r)), None),
        Why::RoundClosure(c) | Why::LeavesClosure(c) | Why::PlaceClosed(c) => {
            (None, Some(names.why_closed(c)))
        }
        Why::LeftPath | Why::CutsOff | Why::Evacuation | Why::NoWay | Why::NotTracked => (None, None),
    };
    GuidanceCauseDto { kind: reason.into(), robot, closure }
}

pub(crate) fn reason(reason: GuidanceReason, names: Names<'_>) -> Sentence {
    use GuidanceReason as Why;
    match reason {
        Why::LeftPath => say::you_left_path(),
        Why::RobotComes(r) => say::robot_comes(names.robot(r)),
        Why::RobotInTheWay(r) => say::robot_blocks_path(names.robot(r)),
        Why::RobotWaits(r) => say::robot_waits_for_you(names.robot(r)),
        Why::RobotPasses(r) => say::robot_passes(names.robot(r)),
        Why::RobotCrosses(r) => say::robot_crosses(names.robot(r)),
        Why::PlaceUnsure(r) => say::place_unsure(names.robot(r)),
        Why::CutsOff => say::cuts_off(),
        Why::RoundClosure(c) => say::round_closure(names.why_closed(c)),
        Why::LeavesClosure(c) => say::leaves_closure(names.why_closed(c)),
        Why::PlaceClosed(c) => say::place_closed(names.why_closed(c)),
        Why::Evacuation => say::leave_building(),
        Why::NoWay => say::no_way(),
        Why::NotTracked => say::not_tracked(),
    }
}

fn corner(p: Point) -> [f64; 2] {
    [round3(p.x), round3(p.y)]
}

pub(crate) fn line(points: &[Point]) -> Vec<[f64; 2]> {
    points.iter().map(|p| corner(*p)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_fleet::{RobotView, View};
    use giveway_floor::id::RobotId;
    use giveway_floor::time::Span;

    #[test]
    fn a_robot_on_the_left_has_a_positive_bearing() {
        let map =
            giveway_floor::warehouse::formats::json::parse(include_str!("../../../maps/lab.json")).unwrap();
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
            arrived: false,
            near: vec![near],
        };
        let beside = |heading| GuidanceContext {
            names: Names { map: &map, view: &view },
            heading,
            now: Time(3_000_000),
        };
        let told_left = guidance(Some(&told), beside(Some(3.0)));
        let expected = std::f64::consts::TAU - 6.0;
        assert_eq!(told_left.near[0].bearing, Some(round3(expected)), "{told_left:?}");
        assert_eq!((told_left.eta_s, told_left.state), (Some(2.0), GuidanceStateDto::Stop));
        assert_eq!(told_left.wait_s, Some(1.5));
        assert_eq!(guidance(Some(&told), beside(None)).near[0].bearing, None);
        assert_eq!(guidance(None, beside(None)).state, GuidanceStateDto::Idle);
    }
}
