//! What goes into a step and what comes out of it.
//!
//! Main types: [`Input`], [`Command`], [`Step`]. Refuses: to say how any of it travels.

use crate::state::fact::{Act, Fact};
use crate::state::fault::Fault;
use crate::state::link::LinkState;
use crate::state::request::{Reply, Request, Token};
use crate::state::worker::Guidance;
use giveway_cell::HandsSeen;
use giveway_cell::arm::{ArmOrder, ArmSaid};
use giveway_floor::geometry::Pose;
use giveway_floor::id::{NodeId, RackId, RobotId, StationId, WorkerId};
use giveway_floor::time::Time;
use giveway_floor::timeline::Reserved;
use giveway_floor::warehouse::SlotName;
use giveway_people::human::Sighting;
use std::ops::Range;

/// A robot slower than this stands, metres per second.
const STANDS_MPS: f64 = 0.01;

/// An observation or a request from outside.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// A robot says how it is.
    Telemetry(Telemetry),
    /// A link says how it is with a robot there.
    Link(RobotId, LinkState),
    /// A worker was seen.
    Sighted(Sighting),
    /// The hands of a person in a workplace were seen.
    Hands(HandsSeen),
    /// A robot arm at a work cell says how it is.
    Arm(ArmSaid),
    /// The true end of the visit that is on at a station: when the hand will be out for the last time. Only
    /// experiments know it ([`giveway_cell::Flow::Known`]).
    VisitEnds {
        /// Where.
        station: StationId,
        /// When.
        at: Time,
    },
    /// A request.
    Ask {
        /// Comes back with the reply.
        token: Token,
        /// What.
        request: Request,
    },
}

impl Input {
    /// A request under a token; a number alone is one of a client.
    pub fn ask(token: impl Into<Token>, request: impl Into<Request>) -> Input {
        Input::Ask { token: token.into(), request: request.into() }
    }
}

/// How a robot is. Observations of one robot may be late, repeated, out of order or wrongly dated: `seen` orders them
/// as far as the robot's clock goes on evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Telemetry {
    /// The robot.
    pub robot: RobotId,
    /// The robot's link numbers the reports of a robot in the order in which it made them, also past its restarts. One
    /// with a number that is not above the newest was overtaken, or came twice.
    pub seq: u64,
    /// When this was so, by the robot's clock; in what the fleet keeps, by the fleet's own.
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
    /// What is wrong with it, if anything is.
    pub fault: Option<Fault>,
    /// The limit of its speed that it was told last, metres per second; 0 is a stop.
    pub limit_mps: Option<f64>,
    /// How many revocations it has obeyed.
    pub recalls: u64,
}

impl Telemetry {
    /// Whether it obeys no order until a person helps: it is broken, stopped or driven by hand, or its battery is flat.
    pub fn cannot_drive(&self) -> bool {
        self.fault.is_some_and(Fault::is_immobile) || self.battery <= 0.0
    }

    /// Whether it does not move.
    pub fn stands(&self) -> bool {
        self.speed_mps < STANDS_MPS
    }
}

/// An order to a robot.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Drive along these waypoints, in order. Waypoints that the robot knows already are repeated until it says so.
    /// If the first one is later than all it knows, the robot takes that for where it stands, provided that it knows
    /// no way to drive and is at that node: it was pushed there. A robot that does not stand on the way to the
    /// next waypoint takes none on. A robot that stands between two nodes and knows no waypoint drives back if the
    /// order ends with the visit that it reached last, and turns round again only when it stands.
    Drive {
        /// The proof that they are held and granted.
        grant: Reserved,
        /// Where, and what to do there.
        waypoints: Vec<Waypoint>,
        /// How many revocations came before. A robot that has obeyed more of them ignores the order: it is older.
        recalls: u64,
        /// The nodes that are planned after those, and may change: as many as the robot's kind wants to know. They are
        /// not granted.
        horizon: Vec<NodeId>,
    },
    /// If the robot stands, and this is the last visit whose centre it reached, it forgets all waypoints, stays where
    /// it is, on a node or between two, and says so by the number of revocations that it has obeyed. Else it goes on
    /// as before.
    Revoke {
        /// Serial number of the visit.
        reached: u64,
        /// Which revocation this is: one more than those that the robot has obeyed.
        number: u64,
    },
    /// Drive no faster than this from now on, metres per second; 0 is a stop, nothing lifts the limit.
    Limit(Option<f64>),
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
    /// Whom the robot may pass on the way there within the corridor of the lane; nothing where it keeps to the line.
    pub passes: Option<WorkerId>,
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
    /// Stops, slow-downs and their ends. They leave at once: they take no hold from any robot.
    pub urgent: Vec<(RobotId, Command)>,
    /// What workers are told, where it changed. It leaves at once.
    pub guidance: Vec<(WorkerId, Guidance)>,
    /// Warnings for people at work cells. They leave at once.
    pub warnings: Vec<CellWarning>,
    /// Trajectories for robot arms. They leave at once: each is of a second at most, and the arm's own stop holds it.
    pub arms: Vec<ArmOrder>,
    /// Which facts requests caused themselves, in order. What the fleet decided because of them is not among these.
    pub caused: Vec<CausedFacts>,
}

/// A person at a work cell is about to pick or put a piece where it does not belong, or has done so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellWarning {
    /// Where.
    pub station: StationId,
    /// Whose hand, as observations of hands have it.
    pub person: u32,
    /// What is wrong.
    pub wrong: WrongReach,
    /// When the hand was seen that was judged.
    pub seen: Time,
}

/// Where a hand is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WrongReach {
    /// It goes to this slot, which is not the lit one.
    Slot(SlotName),
    /// It put a piece into this tote, by its number at the station, which is not that of its line.
    Tote(usize),
}

/// Facts that one request caused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CausedFacts {
    /// The token of the request.
    pub token: Token,
    /// Their places among the facts of the step, counted from 0.
    pub facts: Range<usize>,
}
