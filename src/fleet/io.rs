//! What goes into a step and what comes out of it.
//!
//! Main types: [`Input`], [`Command`], [`Reply`], [`Step`]. Refuses: to say how any of it travels.

use super::fact::{Act, Fact};
use super::job::JobRequest;
use crate::geometry::Pose;
use crate::id::{JobId, NodeId, RackId, RobotId};
use crate::time::Time;
use crate::timeline::Reserved;

/// An observation or a request from outside.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// A robot says how it is.
    Telemetry(Telemetry),
    /// A robot joins the fleet.
    Enlist {
        /// Its name.
        name: String,
        /// Where it stands.
        node: NodeId,
    },
    /// Somebody wants a job done.
    Submit {
        /// Comes back with the reply.
        token: u64,
        /// What.
        request: JobRequest,
    },
    /// Somebody does not want a job any more.
    Cancel {
        /// Comes back with the reply.
        token: u64,
        /// Which.
        job: JobId,
    },
}

/// How a robot is. Observations of one robot may be late, repeated or out of order; the newest by `seen` counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Telemetry {
    /// Who.
    pub robot: RobotId,
    /// When this was so.
    pub seen: Time,
    /// Where it is.
    pub pose: Pose,
    /// How fast it drives, metres per second.
    pub speed_mps: f64,
    /// Serial number of the last visit whose centre it has reached.
    pub reached: u64,
    /// Serial number of the last visit that it has been told of.
    pub known: u64,
    /// Serial number of the last stop at which it is done.
    pub acted: Option<u64>,
    /// The rack on it.
    pub rack: Option<RackId>,
    /// Charge, 0 to 1.
    pub battery: f64,
    /// Whether it cannot drive by itself.
    pub failed: bool,
}

/// An order to a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Command {
    /// Drive along these waypoints, in order. Waypoints that the robot knows already are repeated until it says so.
    Drive {
        /// The proof that they are held and granted.
        grant: Reserved,
        /// Where, and what to do there.
        waypoints: Vec<Waypoint>,
    },
}

/// One granted visit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Waypoint {
    /// Its serial number.
    pub serial: u64,
    /// Where.
    pub node: NodeId,
    /// What to do there before going on.
    pub act: Option<Act>,
}

/// The answer to a request. It may be sent once the facts of its step are durable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reply {
    /// The job is accepted, or was accepted before under the same key.
    Accepted {
        /// Of the request.
        token: u64,
        /// Its number.
        job: JobId,
        /// Whether it is new.
        new: bool,
    },
    /// The job is cancelled, now or before.
    Cancelled {
        /// Of the request.
        token: u64,
        /// Its number.
        job: JobId,
    },
    /// It cannot be.
    Refused {
        /// Of the request.
        token: u64,
        /// Why.
        why: Refusal,
    },
}

/// Why a request is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Refusal {
    /// No job has this number.
    UnknownJob(JobId),
    /// The job was over already.
    JobIsOver(JobId),
    /// A job cannot come after one that does not exist.
    UnknownPredecessor(JobId),
    /// There is no such rack, station, node or robot.
    UnknownPlace,
    /// Racks go onto storage nodes only.
    NotStorage(NodeId),
    /// The storage node has a rack, or is promised to one.
    StorageTaken(NodeId),
    /// A priority is a number from 0 to 9.
    Priority(u8),
    /// Too many jobs are waiting.
    TooMany(usize),
}

/// What one step did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Step {
    /// What happened, in order. Durable before grants and replies leave.
    pub facts: Vec<Fact>,
    /// Orders to robots. They leave once the facts are durable.
    pub commands: Vec<(RobotId, Command)>,
    /// Answers. They leave once the facts are durable.
    pub replies: Vec<Reply>,
}
