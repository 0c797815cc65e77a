//! Robots that leave the line of a lane to pass people: on which visits, within which corridor, and whether passing is
//! the cheapest choice.
//!
//! Main types: [`Passing`], [`RobotPassing`] (with what changes meanwhile), [`PassingStretch`] (the corridor),
//! [`HeldChoice`]; main function: [`cheapest`]. Lost at a restart: a robot that is off the line then is within what it
//! was granted, and goes back to the line by itself. Refuses: to look at people.

use crate::state::floor::Floor;
use crate::state::kind::RobotKind;
use giveway_floor::geometry::{Point, Segment, turn_between};
use giveway_floor::id::{NodeId, RobotId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{Corridor, Warehouse};
use giveway_people::aware::SLOW_MPS;
use giveway_people::local::DriveLimits;

/// How much better than waiting another choice has to be.
const WORTH: Span = Span::from_secs(1);
/// Lanes whose headings differ by less than this are one line, radians.
const STRAIGHT: f64 = 1e-3;
/// Top turning speed of robots beside the line, radians per second.
const TURN_RPS: f64 = 1.2;
/// Turning acceleration of robots beside the line, radians per second squared: they gain and lose the top turning speed
/// in about half a second.
const TURN_ACCEL_RPS2: f64 = 2.5;
/// Time from one choice of the local planner to the next, seconds; also how old what it sees may be.
const PERIOD_S: f64 = 0.1;

/// What lets a robot leave the line to pass a worker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Passing {
    /// The worker whom the robot passes.
    pub worker: WorkerId,
    /// Serial number of the visit from which on the robot may leave the line.
    pub from: u64,
    /// Serial number of the visit at which the robot is on the line again.
    pub to: u64,
    /// Since when the robot may pass the worker.
    pub since: Time,
}

/// What lets a robot pass a worker, with what changes meanwhile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RobotPassing {
    pub what: Passing,
    /// Since when there has been no room to pass; the robot stands.
    pub stands_since: Option<Time>,
}

/// Consecutive lanes that form one line with a corridor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassingStretch {
    pub line: Segment,
    /// The corridor in the robot's direction of travel; as narrow as that of the narrowest lane.
    pub corridor: Corridor,
}

/// What a robot does when people hold it up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeldChoice {
    /// The robot waits until the people have left.
    Wait,
    /// The robot takes another route.
    Reroute,
    /// The robot goes round the people within the corridor.
    Pass,
}

/// The cheapest choice, by when the robot reaches its next stop: if it waits, by another route, and by passing, as far
/// as the last two are possible.
pub(crate) fn cheapest(waits: Time, reroutes: Option<Time>, passes: Option<Time>) -> HeldChoice {
    let is_worth = |t: &Time| *t + WORTH < waits;
    match (reroutes.filter(is_worth), passes.filter(is_worth)) {
        (None, None) => HeldChoice::Wait,
        (Some(reroutes), Some(passes)) if passes < reroutes => HeldChoice::Pass,
        (Some(_), _) => HeldChoice::Reroute,
        (None, Some(_)) => HeldChoice::Pass,
    }
}

impl RobotKind {
    /// What the motors and brakes of a robot that leaves the line allow, at this speed at most.
    pub fn drive_limits(&self, loaded: bool, speed_mps: f64) -> DriveLimits {
        let k = &self.kinematics;
        DriveLimits {
            speed_mps: speed_mps.min(k.top_mps(loaded)),
            accel_mps2: k.accel_mps2(loaded),
            brake_mps2: k.accel_mps2(loaded),
            turn_rps: k.turn_radps.min(TURN_RPS),
            turn_accel_rps2: TURN_ACCEL_RPS2,
            react_s: k.reaction.as_secs_f64() + 2.0 * PERIOD_S,
            period_s: PERIOD_S,
        }
    }
}

impl PassingStretch {
    /// The stretch of a single lane from one node to the next, if the lane has a corridor.
    pub fn of_lane(warehouse: &Warehouse, from: NodeId, to: NodeId) -> Option<PassingStretch> {
        let (_, arc) = warehouse.out(from).find(|(_, arc)| arc.to == to)?;
        let lane = &warehouse.lanes[arc.lane];
        debug_assert!(lane.a == from || lane.b == from, "an arc is on its lane");
        let corridor = lane.corridor?;
        let corridor = if lane.a == from { corridor } else { corridor.reversed() };
        let at = |n| warehouse.nodes[n].at;
        Some(PassingStretch { line: Segment { a: at(from), b: at(to) }, corridor })
    }

    /// This stretch with the next lane, if that goes straight on.
    pub fn and(self, next: PassingStretch) -> Option<PassingStretch> {
        let is_straight = turn_between(self.line.heading(), next.line.heading()).abs() < STRAIGHT;
        let narrower = |f: fn(&Corridor) -> f64| f(&self.corridor).min(f(&next.corridor));
        let corridor = Corridor { left_m: narrower(|c| c.left_m), right_m: narrower(|c| c.right_m) };
        is_straight.then_some(PassingStretch { line: Segment { a: self.line.a, b: next.line.b }, corridor })
    }
}

impl Floor<'_> {
    /// The stretch that a robot drives from one visit to another, if all of these lanes are one line with a corridor.
    pub fn stretch(&self, robot: RobotId, from: u64, to: u64) -> Option<PassingStretch> {
        let chain = self.ledger.chain(robot);
        let lane =
            |s: u64| PassingStretch::of_lane(self.warehouse(), chain.get(s)?.node, chain.get(s + 1)?.node);
        let first = lane(from)?;
        (from + 1..to).try_fold(first, |all, s| all.and(lane(s)?))
    }

    /// What the motors and brakes of a robot that passes a person allow.
    pub fn passing_limits(&self, robot: RobotId) -> DriveLimits {
        self.kind(robot).drive_limits(self.ledger.rack_on(robot).is_some(), SLOW_MPS)
    }

    /// Whether a place is within the corridor of one of these lanes, if the robot can leave the line of a lane.
    pub fn is_within_corridor(&self, robot: RobotId, serials: std::ops::Range<u64>, at: Point) -> bool {
        if !self.kind(robot).free_navigation {
            return false;
        }
        serials.into_iter().filter_map(|s| self.stretch(robot, s, s + 1)).any(|lane| {
            let way = lane.line.b - lane.line.a;
            let (along, across) = (way.dot(&(at - lane.line.a)), way.perp(&(at - lane.line.a)) / way.norm());
            let reaches = (0.0..=way.norm_squared()).contains(&along);
            reaches && (-lane.corridor.right_m..=lane.corridor.left_m).contains(&across)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: f64) -> Time {
        Time::from_secs_f64(seconds)
    }

    #[test]
    fn a_robot_passes_where_that_is_earlier_than_waiting_and_going_another_way() {
        assert_eq!(cheapest(at(30.0), None, Some(at(20.0))), HeldChoice::Pass);
        assert_eq!(cheapest(at(30.0), Some(at(25.0)), Some(at(20.0))), HeldChoice::Pass);
    }

    #[test]
    fn it_waits_where_people_have_left_sooner() {
        assert_eq!(cheapest(at(15.0), None, Some(at(20.0))), HeldChoice::Wait);
        assert_eq!(cheapest(at(15.0), Some(at(18.0)), Some(at(20.0))), HeldChoice::Wait);
        assert_eq!(cheapest(at(20.5), Some(at(20.0)), Some(at(20.0))), HeldChoice::Wait, "hardly better");
    }

    #[test]
    fn it_takes_another_route_where_that_is_earlier_than_passing_or_there_is_no_room() {
        assert_eq!(cheapest(at(30.0), Some(at(18.0)), Some(at(20.0))), HeldChoice::Reroute);
        assert_eq!(cheapest(at(30.0), Some(at(20.0)), Some(at(20.0))), HeldChoice::Reroute, "as soon");
        assert_eq!(cheapest(at(30.0), Some(at(25.0)), None), HeldChoice::Reroute);
    }

    #[test]
    fn lanes_in_a_row_have_the_corridor_of_the_narrowest() {
        let lane = |a: (f64, f64), b: (f64, f64), left_m, right_m| PassingStretch {
            line: Segment { a: Point::new(a.0, a.1), b: Point::new(b.0, b.1) },
            corridor: Corridor { left_m, right_m },
        };
        let first = lane((0.0, 0.0), (3.0, 0.0), 2.0, 1.0);
        let both = first.and(lane((3.0, 0.0), (5.0, 0.0), 1.5, 3.0)).expect("straight on");
        assert_eq!(both, lane((0.0, 0.0), (5.0, 0.0), 1.5, 1.0));
        assert_eq!(first.and(lane((3.0, 0.0), (3.0, 2.0), 2.0, 2.0)), None, "a bend");
    }
}
