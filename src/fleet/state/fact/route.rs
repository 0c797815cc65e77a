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
    /// Robots hold new routes, all at once: several where they must make way for one another.
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
        /// When it happened.
        at: Time,
    } = 7,
    /// A robot stands on, or has passed, this visit; everything before it is free again.
    Passed {
        /// The robot.
        robot: RobotId,
        /// The serial number of the visit.
        serial: u64,
    } = 8,
    /// A robot did what it was to do at a stop.
    Acted {
        /// The robot.
        robot: RobotId,
        /// The serial number of the stop.
        serial: u64,
    } = 9,
    /// Visits have other times now: a robot is late, and all robots that come after it are, too; or it goes on early.
    Retimed {
        /// The robots whose visits moved.
        moved: Vec<Moved>,
    } = 10,
    /// A robot stands and has forgotten what it was granted after this visit; that is only held now. The visit is the
    /// one that it reached last, or the next if it stands between the two.
    Revoked {
        /// The robot.
        robot: RobotId,
        /// The serial number of the last visit that it keeps.
        serial: u64,
        /// How often it forgot what it was granted, by now.
        recalls: u64,
        /// When it happened.
        at: Time,
    } = 11,
    /// These robots keep what they were granted, for ever for all we know, and nothing more.
    Truncated {
        /// The robots, and what they keep.
        robots: Vec<KeptRoute>,
    } = 12,
    /// A robot was found standing on a node that it did not hold: it holds that and nothing else from now on, and has
    /// no stops any more.
    Placed {
        /// The robot.
        robot: RobotId,
        /// Where it stands.
        node: NodeId,
        /// The serial number of this visit; later than any that it had.
        serial: u64,
        /// Robots that were promised this place, or would have had to pass those: what they keep.
        cut: Vec<KeptRoute>,
        /// When it happened.
        at: Time,
    } = 40,
}

/// Visits of one robot that have other times now.
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
    /// Those that stay and have other times now, in order.
    pub shifts: Vec<Shift>,
}

/// The new route of one robot, after its visit `keep`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Booking {
    /// The robot.
    pub robot: RobotId,
    /// The serial number of the visit that stays.
    pub keep: u64,
    /// That visit, with its new departure.
    pub kept: Visit,
    /// The visits after it.
    pub visits: Vec<Visit>,
    /// Where it is to do something, by serial number.
    pub stops: Vec<Stop>,
}

/// What a robot does at a stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Act {
    /// Lifts the rack above it.
    Lift(RackId),
    /// Sets its rack down.
    Set(RackId),
    /// Waits until the person at the station says that the pick has ended; planned to take so long.
    Pick(Span),
    /// Nothing: it has arrived.
    Arrive,
}

/// A visit at which a robot does something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Stop {
    /// The serial number of the visit.
    pub serial: u64,
    /// What.
    pub act: Act,
}

impl RouteFact {
    /// The one robot whose route it is about; nothing where it may be about several.
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
