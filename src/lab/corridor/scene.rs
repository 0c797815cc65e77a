//! Scenes: a robot on a corridor of a map, its goal, and a worker who crosses its path or walks along it.
//!
//! Main types: [`CorridorScene`], [`SceneKind`], [`WorkerWalk`]. The first three kinds are the published ones (Ye et
//! al. 2024, table 3): about five metres from start to goal, a worker of low speed who crosses the path. The others are
//! aisles of 10 to 16 m. Refuses: workers who know of the robot.

use giveway_floor::geometry::{Point, Segment, Vector};
use giveway_floor::warehouse::{Corridor, Draft, DraftLane, DraftNode, Footprint, Hull, Users};
use giveway_people::local::DriveLimits;
use giveway_sim::random::Stream;

/// Kinds of scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SceneKind {
    /// Published: 4.9 m, a slow worker straight across.
    CaseOne,
    /// Published: 4.9 m, a worker who crosses at an angle.
    CaseTwo,
    /// Published: 5 m, a faster worker who comes at an angle towards the robot.
    CaseThree,
    /// An aisle that a worker crosses at any angle.
    Crossing,
    /// An aisle with a slower worker ahead who walks the same way.
    Along,
    /// An aisle with a worker who comes the other way.
    Against,
    /// An aisle with a worker who stands beside the line, and stays.
    Standing,
}

impl SceneKind {
    /// The published kinds.
    pub const CASES: [SceneKind; 3] = [SceneKind::CaseOne, SceneKind::CaseTwo, SceneKind::CaseThree];
    /// The other kinds.
    pub const AISLES: [SceneKind; 4] =
        [SceneKind::Crossing, SceneKind::Along, SceneKind::Against, SceneKind::Standing];

    /// The kind's name in reports.
    pub fn name(self) -> &'static str {
        match self {
            SceneKind::CaseOne => "case_1",
            SceneKind::CaseTwo => "case_2",
            SceneKind::CaseThree => "case_3",
            SceneKind::Crossing => "crossing",
            SceneKind::Along => "along",
            SceneKind::Against => "against",
            SceneKind::Standing => "standing",
        }
    }

    /// Whether the worker crosses the robot's line.
    fn crosses(self) -> bool {
        !matches!(self, SceneKind::Along | SceneKind::Against | SceneKind::Standing)
    }
}

/// The walk of a worker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkerWalk {
    /// Start of the walk.
    pub start: Point,
    /// Direction of the walk, radians.
    pub heading: f64,
    /// Speed, metres per second.
    pub speed_mps: f64,
    /// When the worker suddenly turns, seconds, and by how much, radians.
    pub turn: Option<(f64, f64)>,
}

/// Everything given before a robot starts. The robot starts at the origin and faces along x.
#[derive(Clone, Debug)]
pub struct CorridorScene {
    /// Position of the goal along x, metres.
    pub length_m: f64,
    /// Limits of the robot's motors and brakes.
    pub limits: DriveLimits,
    /// The robot's footprint.
    pub footprint: Footprint,
    /// The line of the lane, longer than the robot's path.
    pub lane: Segment,
    /// The lane's corridor.
    pub corridor: Corridor,
    /// The floor that the robot may use while it holds the lane, by the map.
    pub floor: Hull,
    /// The worker's walk.
    pub walk: WorkerWalk,
    /// Whether the worker crosses the robot's line.
    pub crosses: bool,
}

/// Lanes begin before the start and end beyond the goal, metres.
const BEYOND_M: f64 = 1.0;

impl CorridorScene {
    /// A random scene of a kind. Everything that the kind leaves open is drawn.
    pub fn drawn(kind: SceneKind, dice: &mut Stream) -> CorridorScene {
        let (length_m, speed_mps, width) = match kind {
            SceneKind::CaseOne | SceneKind::CaseTwo => (4.9, 0.6, (3.0, 3.0)),
            SceneKind::CaseThree => (5.0, 0.6, (3.0, 3.0)),
            _ => (dice.between(10.0, 16.0), 1.2, (dice.between(2.0, 2.5), dice.between(2.0, 2.5))),
        };
        let side = if dice.happens_of(0.5) { 1.0 } else { -1.0 };
        let degrees = |low: f64, high: f64, dice: &mut Stream| dice.between(low, high).to_radians();
        let (angle, walking) = match kind {
            SceneKind::CaseOne => (degrees(80.0, 100.0, dice), dice.between(0.5, 0.65)),
            SceneKind::CaseTwo => (degrees(55.0, 75.0, dice), dice.between(0.6, 0.8)),
            SceneKind::CaseThree => (degrees(115.0, 140.0, dice), dice.between(0.7, 1.0)),
            SceneKind::Crossing => (degrees(30.0, 150.0, dice), dice.between(0.4, 1.5)),
            SceneKind::Along => (degrees(-5.0, 5.0, dice), dice.between(0.3, 0.7)),
            SceneKind::Against => (degrees(175.0, 185.0, dice), dice.between(0.5, 1.4)),
            SceneKind::Standing => (degrees(0.0, 180.0, dice), 0.0),
        };
        let heading = angle * side;
        let start = match kind {
            SceneKind::Along => Point::new(dice.between(3.0, 5.0), dice.between(-1.0, 1.0)),
            SceneKind::Against => Point::new(length_m + dice.between(-1.0, 1.0), dice.between(-1.2, 1.2)),
            SceneKind::Standing => {
                Point::new(length_m * dice.between(0.4, 0.6), side * dice.between(0.8, 1.3))
            }
            _ => {
                let late_s = dice.between(-1.0, 1.0);
                before_the_meeting(length_m * dice.between(0.4, 0.6), speed_mps, late_s, heading, walking)
            }
        };
        let turns = kind != SceneKind::Standing && !SceneKind::CASES.contains(&kind) && dice.happens_of(0.2);
        let (when, by) = (dice.between(2.0, 8.0), dice.between(-1.2, 1.2));
        let walk = WorkerWalk { start, heading, speed_mps: walking, turn: turns.then_some((when, by)) };
        CorridorScene::new(length_m, speed_mps, width, walk, kind.crosses())
    }

    /// A worker who crosses an aisle of 12 m in its middle at an angle and a speed, `late_s` seconds after the robot.
    pub fn crossing(angle: f64, walking_mps: f64, late_s: f64) -> CorridorScene {
        let start = before_the_meeting(6.0, 1.2, late_s, angle, walking_mps);
        let walk = WorkerWalk { start, heading: angle, speed_mps: walking_mps, turn: None };
        CorridorScene::new(12.0, 1.2, (2.0, 2.0), walk, true)
    }

    fn new(
        length_m: f64,
        speed_mps: f64,
        (left_m, right_m): (f64, f64),
        walk: WorkerWalk,
        crosses: bool,
    ) -> Self {
        let limits = DriveLimits {
            speed_mps,
            accel_mps2: 0.8,
            brake_mps2: 0.8,
            turn_rps: 1.2,
            turn_accel_rps2: 2.5,
            react_s: 0.3,
            period_s: 0.1,
        };
        let corners = [(-0.35, -0.28), (0.35, -0.28), (0.35, 0.28), (-0.35, 0.28)];
        let corners = corners.map(|(x, y)| Point::new(x, y)).to_vec();
        let footprint = Footprint::Polygon { corners, turns: true };
        let corridor = Corridor { left_m, right_m };
        let lane = Segment { a: Point::new(-BEYOND_M, 0.0), b: Point::new(length_m + BEYOND_M, 0.0) };
        let floor = floor(lane, corridor, &footprint);
        CorridorScene { length_m, limits, footprint, lane, corridor, floor, walk, crosses }
    }

    /// The line that the robot drives if nobody is in its way.
    pub fn line(&self) -> Segment {
        Segment { a: Point::origin(), b: Point::new(self.length_m, 0.0) }
    }
}

/// Where a worker starts who reaches a place on the robot's line `late_s` after the robot.
fn before_the_meeting(at_m: f64, speed_mps: f64, late_s: f64, heading: f64, walking_mps: f64) -> Point {
    let robot_s = at_m / speed_mps + speed_mps / (2.0 * 0.8);
    let way = Vector::new(heading.cos(), heading.sin()) * walking_mps * (robot_s + late_s);
    Point::new(at_m, 0.0) - way
}

/// The floor that a robot with this outline may use on a lane with this corridor, computed by a map.
fn floor(lane: Segment, corridor: Corridor, footprint: &Footprint) -> Hull {
    let node = |name: &str, x: f64| DraftNode { name: name.into(), at: Point::new(x, 0.0) };
    let (low, high) = (lane.a.x, lane.b.x);
    let lane = |a: &str, b: &str| DraftLane::both_ways(a, b, Users::ALL);
    let draft = Draft {
        name: "corridor".into(),
        footprint_m: 0.9,
        nodes: vec![node("p", low - 2.0), node("a", low), node("b", high), node("q", high + 2.0)],
        lanes: vec![DraftLane { corridor: Some(corridor), ..lane("a", "b") }, lane("p", "a"), lane("b", "q")],
        parking: vec!["p".into(), "q".into()],
        ..Draft::default()
    };
    let map = draft.build().expect("a lane with room on both sides and places to stay at its ends");
    let lane = map.lanes.ids().next().expect("it has lanes");
    map.taken(footprint, map.lane_resource(lane))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn workers_who_cross_are_on_the_line_about_when_the_robot_would_be_there() {
        for kind in SceneKind::CASES.into_iter().chain([SceneKind::Crossing]) {
            for run in 0..20 {
                let scene = CorridorScene::drawn(kind, &mut Stream::new(1, 2, run));
                let WorkerWalk { start, heading, speed_mps, .. } = scene.walk;
                let after_s = -start.y / (heading.sin() * speed_mps);
                let x = start.x + heading.cos() * speed_mps * after_s;
                let robot_s = x / scene.limits.speed_mps + scene.limits.speed_mps / 1.6;
                assert!((0.39..0.61).contains(&(x / scene.length_m)), "{kind:?} {x}");
                assert!((after_s - robot_s).abs() < 1.01, "{kind:?}: {after_s} and {robot_s}");
            }
        }
    }
}
