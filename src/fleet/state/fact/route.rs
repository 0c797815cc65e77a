//! What happens to the routes of robots.
//!
//! Main type: [`RouteFact`], with [`Booking`], [`KeptRoute`] and [`Moved`], of which it is made. Refuses: why a route
//! changes.

use giveway_floor::id::{NodeId, RackId, RobotId};
use giveway_floor::time::{Span, Time};
use giveway_floor::timeline::{Shift, Visit};

/// Something that happened to routes.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[repr(isize)]
pub enum RouteFact {
    /// Robots hold new routes, all at once: several robots if they make way for one another.
    Routed {
        /// The routes.
        bookings: Vec<Booking>,
    } = 6,
    /// A robot may drive up to and including this visit.
    Granted {
        /// The robot.
        robot: RobotId,
        /// The serial number of the visit.
        serial: u64,
        /// Time of the fact.
        at: Time,
    } = 7,
    /// A robot stands on, or has passed, this visit; everything before it is free again.
    Passed {
        /// The robot.
        robot: RobotId,
        /// The serial number of the visit.
        serial: u64,
    } = 8,
    /// A robot finished its action at a stop.
    Acted {
        /// The robot.
        robot: RobotId,
        /// The serial number of the stop.
        serial: u64,
    } = 9,
    /// Visits have new times: a robot is late, and so are all robots behind it; or a robot goes on early.
    Retimed {
        /// The robots whose visits moved.
        moved: Vec<Moved>,
    } = 10,
    /// A robot stands and has forgotten what it was granted after this visit; the rest is only held now. The visit is
    /// the one that the robot reached last, or the next one if it stands between the two.
    Revoked {
        /// The robot.
        robot: RobotId,
        /// The serial number of the last visit that the robot keeps.
        serial: u64,
        /// How often the robot has forgotten what it was granted, by now.
        recalls: u64,
        /// Time of the fact.
        at: Time,
    } = 11,
    /// These robots keep what they were granted, for an unknown time, and nothing more.
    Truncated {
        /// The robots, and what they keep.
        robots: Vec<KeptRoute>,
    } = 12,
    /// A robot was found standing on a node that it did not hold: from now on it holds that node and nothing else, and
    /// has no stops.
    Placed {
        /// The robot.
        robot: RobotId,
        /// Where the robot stands.
        node: NodeId,
        /// The serial number of this visit, later than any that the robot had.
        serial: u64,
        /// What other robots keep that were promised this node, or would have had to pass such robots.
        cut: Vec<KeptRoute>,
        /// Time of the fact.
        at: Time,
    } = 40,
}

/// Visits of one robot that have new times.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Moved {
    /// The robot.
    pub robot: RobotId,
    /// The visits that moved, in order.
    pub shifts: Vec<Shift>,
}

/// What a robot keeps of its route.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct KeptRoute {
    /// The robot.
    pub robot: RobotId,
    /// One past the serial number of the last visit that stays.
    pub end: u64,
    /// The kept visits that have new times, in order.
    pub shifts: Vec<Shift>,
}

/// The new route of one robot, after its visit `keep`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Booking {
    /// The robot.
    pub robot: RobotId,
    /// The serial number of the visit that stays.
    pub keep: u64,
    /// The visit that stays, with its new departure.
    pub kept: Visit,
    /// The visits after the one that stays.
    pub visits: Vec<Visit>,
    /// Where the robot is to do something, by serial number.
    pub stops: Vec<Stop>,
}

/// What a robot does at a stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Act {
    /// Lifts the rack above the robot.
    Lift(RackId),
    /// Sets the robot's rack down.
    Set(RackId),
    /// Waits until the person at the station says that the pick has ended; planned to take this long.
    Pick(Span),
    /// Does nothing: the robot has arrived.
    Arrive,
}

/// A visit at which a robot does something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Stop {
    /// The serial number of the visit.
    pub serial: u64,
    /// What the robot does there.
    pub act: Act,
}

impl RouteFact {
    /// The robot whose route the fact is about; nothing if it may be about several.
    pub(crate) fn robot(&self) -> Option<RobotId> {
        match self {
            RouteFact::Granted { robot, .. }
            | RouteFact::Passed { robot, .. }
            | RouteFact::Acted { robot, .. }
            | RouteFact::Revoked { robot, .. }
            | RouteFact::Placed { robot, .. } => Some(*robot),
            RouteFact::Routed { bookings } => match bookings.as_slice() {
                [only] => Some(only.robot),
                _ => None,
            },
            RouteFact::Retimed { .. } | RouteFact::Truncated { .. } => None,
        }
    }
}
