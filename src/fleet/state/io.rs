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
    /// A robot reports its state.
    Telemetry(Telemetry),
    /// A link reports its state for a robot.
    Link(RobotId, LinkState),
    /// A worker was seen.
    Sighted(Sighting),
    /// The hands of a person in a workplace were seen.
    Hands(HandsSeen),
    /// A robot arm at a work cell says how it is.
    Arm(ArmSaid),
    /// The true end of the visit in progress at a station: when the hand will be out for the last time. Only
    /// experiments know it ([`giveway_cell::Flow::Known`]).
    VisitEnds {
        /// The station.
        station: StationId,
        /// When the visit ends.
        at: Time,
    },
    /// A request.
    Ask {
        /// The token that comes back with the reply.
        token: Token,
        /// What is asked for.
        request: Request,
    },
}

impl Input {
    /// A request under a token; a bare number is a client's token.
    pub fn ask(token: impl Into<Token>, request: impl Into<Request>) -> Input {
        Input::Ask { token: token.into(), request: request.into() }
    }
}

/// The state of a robot. Observations of one robot may be late, repeated, out of order or wrongly dated: `seq` orders
/// them, and `seen` dates them as far as the robot's clock runs evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Telemetry {
    /// The robot.
    pub robot: RobotId,
    /// The number of the report. A robot's link numbers its reports in the order in which the robot made them, also
    /// past its restarts. A report whose number is not above the newest was overtaken, or came twice.
    pub seq: u64,
    /// When the report was made: by the robot's clock, or by the fleet's own in what the fleet keeps.
    pub seen: Time,
    /// Where the robot is.
    pub pose: Pose,
    /// How fast the robot drives, metres per second.
    pub speed_mps: f64,
    /// Serial number of the last visit whose centre the robot has reached.
    pub reached: u64,
    /// Serial number of the last visit that the robot has been told of.
    pub known: u64,
    /// Serial number of the last stop at which the robot is done.
    pub acted: Option<u64>,
    /// The rack on the robot.
    pub rack: Option<RackId>,
    /// Charge, 0 to 1.
    pub battery: f64,
    /// What is wrong with the robot, if anything is.
    pub fault: Option<Fault>,
    /// The speed limit that the robot was last told, metres per second; 0 is a stop.
    pub limit_mps: Option<f64>,
    /// How many revocations the robot has obeyed.
    pub recalls: u64,
}

impl Telemetry {
    /// Whether the robot obeys no order until a person helps: it is broken, stopped or driven by hand, or its battery
    /// is flat.
    pub fn cannot_drive(&self) -> bool {
        self.fault.is_some_and(Fault::is_immobile) || self.battery <= 0.0
    }

    /// Whether the robot does not move.
    pub fn stands(&self) -> bool {
        self.speed_mps < STANDS_MPS
    }
}

/// An order to a robot.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Drive along these waypoints, in order. Waypoints that the robot already knows are repeated until it confirms
    /// them. If the first waypoint is later than all that the robot knows, the robot takes it for where it stands,
    /// provided that it knows no way to drive and is at that node: it was pushed there. A robot that does not stand on
    /// the way to the next waypoint takes none on. A robot that stands between two nodes and knows no waypoint drives
    /// back if the order ends with the visit that it reached last, and turns round again only when it stands.
    Drive {
        /// The proof that the waypoints are held and granted.
        grant: Reserved,
        /// Where to drive, and what to do there.
        waypoints: Vec<Waypoint>,
        /// How many revocations came before the order. A robot that has obeyed more ignores the order, which is older.
        recalls: u64,
        /// The nodes that are planned after the waypoints, and may change: as many as the robot's kind wants to know.
        /// They are not granted.
        horizon: Vec<NodeId>,
    },
    /// If the robot stands, and this is the last visit whose centre it reached, it forgets all waypoints, stays where
    /// it is, on a node or between two, and confirms by the number of revocations that it has obeyed. Otherwise it goes
    /// on as before.
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
    /// Serial number of the visit.
    pub serial: u64,
    /// The node to drive to.
    pub node: NodeId,
    /// What to do at the node before driving on.
    pub act: Option<Act>,
    /// The worker whom the robot may pass on the way there within the lane's corridor; nothing if it keeps to the line.
    pub passes: Option<WorkerId>,
}

/// What one step did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Step {
    /// What happened, in order. Facts are durable before grants and replies leave.
    pub facts: Vec<Fact>,
    /// Orders to robots. They leave once the facts are durable.
    pub commands: Vec<(RobotId, Command)>,
    /// Answers to requests. They leave once the facts are durable.
    pub replies: Vec<Reply>,
    /// Stops, slow-downs and their ends. They leave at once: they take no hold from any robot.
    pub urgent: Vec<(RobotId, Command)>,
    /// Robots that obey no limit and would have to stand now: no order that still waits may reach them, since an order
    /// that a robot does not know is the only one that can be taken back.
    pub held_back: Vec<RobotId>,
    /// New guidance for workers, where it changed. It leaves at once.
    pub guidance: Vec<(WorkerId, Guidance)>,
    /// Warnings for people at work cells. They leave at once.
    pub warnings: Vec<CellWarning>,
    /// Trajectories for robot arms. They leave at once: each lasts a second at most, and the arm's own stop holds the
    /// arm.
    pub arms: Vec<ArmOrder>,
    /// Which facts requests caused directly, in order. What the fleet decided because of them is not among these.
    pub caused: Vec<CausedFacts>,
}

/// A person at a work cell is about to pick or put a piece where it does not belong, or has done so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellWarning {
    /// The station.
    pub station: StationId,
    /// The person whose hand it is, numbered as in observations of hands.
    pub person: u32,
    /// What is wrong.
    pub wrong: WrongReach,
    /// When the judged hand was seen.
    pub seen: Time,
}

/// How a hand is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WrongReach {
    /// The hand goes to this slot, which is not the lit one.
    Slot(SlotName),
    /// The hand put a piece into this tote, by its number at the station, which is not the tote of its line.
    Tote(usize),
}

/// Facts that one request caused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CausedFacts {
    /// The token of the request.
    pub token: Token,
    /// The places of these facts among the facts of the step, counted from 0.
    pub facts: Range<usize>,
}
