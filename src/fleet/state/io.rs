//! What goes into a step and what comes out of it.
//!
//! Main types: [`Input`], [`Command`], [`Reply`], [`Step`]. Refuses: to say how any of it travels.

use crate::cell::arm::{ArmOrder, ArmSaid};
use crate::cell::{HandsSeen, LineChange, LineOutcome, LineState};
use crate::fleet::state::fact::{Act, Fact};
use crate::fleet::state::fault::Fault;
use crate::fleet::state::job::{JobChange, JobRequest};
use crate::fleet::state::recurring::RecurringClosure;
use crate::fleet::state::refusal::Refusal;
use crate::fleet::state::worker::{AssignmentRequest, Closure, Guidance};
use crate::geometry::{Pose, Spot};
use crate::human::Sighting;
use crate::id::{AssignmentId, ClosureId, JobId, NodeId, RackId, RobotId, SeriesId, StationId, WorkerId};
use crate::time::Time;
use crate::timeline::Reserved;
use crate::warehouse::SlotName;
use std::ops::Range;

/// A robot slower than this stands, metres per second.
const STANDS_MPS: f64 = 0.01;

/// An observation or a request from outside.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// A robot says how it is.
    Telemetry(Telemetry),
    /// A robot joins the fleet.
    Register {
        /// Comes back with the reply.
        token: u64,
        /// Its name.
        name: String,
        /// The name of its kind, one of the settings.
        kind: String,
        /// Where it stands.
        node: NodeId,
    },
    /// A robot goes to maintenance, or comes back.
    Maintain {
        /// Comes back with the reply.
        token: u64,
        /// Which.
        robot: RobotId,
        /// Whether it goes.
        begins: bool,
    },
    /// A robot is to leave the floor.
    Retire {
        /// Comes back with the reply.
        token: u64,
        /// Which.
        robot: RobotId,
    },
    /// People took a rack off a robot that cannot drive, and set it down.
    TakeRack {
        /// Comes back with the reply.
        token: u64,
        /// Which.
        rack: RackId,
        /// The storage node where it stands now.
        node: NodeId,
    },
    /// A customer wants a job done.
    Submit {
        /// Comes back with the reply.
        token: u64,
        /// What.
        request: JobRequest,
    },
    /// A customer wants several jobs done. Each is accepted or refused for itself; the accepted ones are durable
    /// together.
    SubmitBatch {
        /// Comes back with the reply.
        token: u64,
        /// What, in this order.
        requests: Vec<JobRequest>,
    },
    /// A customer does not want a job any more.
    Cancel {
        /// Comes back with the reply.
        token: u64,
        /// Which.
        job: JobId,
    },
    /// A worker was seen.
    Sighted(Sighting),
    /// The hands of a person in a workplace were seen.
    Hands(HandsSeen),
    /// A robot arm at a work cell says how it is.
    Arm(ArmSaid),
    /// The true end of the visit that is on at a station: when the hand will be out for the last time. Only
    /// experiments know it ([`crate::cell::Flow::Known`]).
    VisitEnds {
        /// Where.
        station: StationId,
        /// When.
        at: Time,
    },
    /// A worker is to be known.
    RegisterWorker {
        /// Comes back with the reply.
        token: u64,
        /// The name; a known one is no second worker.
        name: String,
    },
    /// A worker is not to be known any more: the place is free for another one.
    ForgetWorker {
        /// Comes back with the reply.
        token: u64,
        /// The worker, who is not on the floor and has nothing to do.
        worker: WorkerId,
    },
    /// A worker has left the floor, or a supervisor vouches that nobody is where one was lost.
    ClearWorker {
        /// Comes back with the reply.
        token: u64,
        /// The worker.
        worker: WorkerId,
        /// Who says so.
        by: String,
    },
    /// A supervisor vouches for where a lost worker is.
    NarrowWorker {
        /// Comes back with the reply.
        token: u64,
        /// The worker.
        worker: WorkerId,
        /// Who says so.
        by: String,
        /// About where.
        at: Spot,
        /// How far from there at most, on foot, millimetres.
        within_mm: i64,
    },
    /// A worker's headset was taken off, or its page closed, on purpose.
    SignedOff {
        /// Comes back with the reply.
        token: u64,
        /// The worker.
        worker: WorkerId,
    },
    /// A customer wants a worker to do something.
    Assign {
        /// Comes back with the reply.
        token: u64,
        /// The worker; nothing for the nearest one who is free.
        worker: Option<WorkerId>,
        /// What.
        request: AssignmentRequest,
    },
    /// A customer does not want it any more.
    Unassign {
        /// Comes back with the reply.
        token: u64,
        /// Which.
        assignment: AssignmentId,
    },
    /// A worker is done with an assignment, and says so.
    Finish {
        /// Comes back with the reply.
        token: u64,
        /// The worker.
        worker: WorkerId,
        /// With which.
        assignment: AssignmentId,
    },
    /// Robots are to keep out of an area.
    Close {
        /// Comes back with the reply.
        token: u64,
        /// Where, when, why.
        area: Closure,
    },
    /// A closure is to end: robots may route through the area again.
    Reopen {
        /// Comes back with the reply.
        token: u64,
        /// Which.
        closure: ClosureId,
    },
    /// An area is to be closed again and again.
    Recur {
        /// Comes back with the reply.
        token: u64,
        /// Where, when, why.
        closure: RecurringClosure,
    },
    /// A closure is to recur no more, and its occurrences end.
    EndSeries {
        /// Comes back with the reply.
        token: u64,
        /// Which.
        series: SeriesId,
    },
    /// Everybody is to leave the building: robots clear the ways out, and stand.
    Evacuate {
        /// Comes back with the reply.
        token: u64,
    },
    /// The evacuation is over.
    EndEvacuation {
        /// Comes back with the reply.
        token: u64,
    },
    /// One robot, or the whole fleet, is to stand until it is released.
    Halt {
        /// Comes back with the reply.
        token: u64,
        /// Which; nothing for all of them.
        robot: Option<RobotId>,
    },
    /// It may go on.
    Release {
        /// Comes back with the reply.
        token: u64,
        /// Which; nothing for the whole fleet.
        robot: Option<RobotId>,
    },
    /// The person at a station says how it goes there.
    Station {
        /// Comes back with the reply.
        token: u64,
        /// Which.
        station: StationId,
        /// What.
        order: StationOrder,
    },
    /// A job that no robot has yet is to be another one.
    Change {
        /// Comes back with the reply.
        token: u64,
        /// Which.
        job: JobId,
        /// In what.
        change: JobChange,
    },
    /// An operator takes a job from its robot, or gives it to another one.
    Reassign {
        /// Comes back with the reply.
        token: u64,
        /// Which.
        job: JobId,
        /// The robot that is to do it; any other than the one that has it if absent.
        robot: Option<RobotId>,
    },
}

impl Input {
    /// The token under which a request is answered; observations have none.
    pub fn token(&self) -> Option<u64> {
        match self {
            Input::Telemetry(_)
            | Input::Sighted(_)
            | Input::Hands(_)
            | Input::Arm(_)
            | Input::VisitEnds { .. } => None,
            Input::Register { token, .. }
            | Input::Maintain { token, .. }
            | Input::Retire { token, .. }
            | Input::TakeRack { token, .. }
            | Input::Submit { token, .. }
            | Input::SubmitBatch { token, .. }
            | Input::Cancel { token, .. }
            | Input::RegisterWorker { token, .. }
            | Input::ForgetWorker { token, .. }
            | Input::ClearWorker { token, .. }
            | Input::NarrowWorker { token, .. }
            | Input::SignedOff { token, .. }
            | Input::Assign { token, .. }
            | Input::Unassign { token, .. }
            | Input::Finish { token, .. }
            | Input::Close { token, .. }
            | Input::Reopen { token, .. }
            | Input::Recur { token, .. }
            | Input::EndSeries { token, .. }
            | Input::Evacuate { token }
            | Input::EndEvacuation { token }
            | Input::Halt { token, .. }
            | Input::Release { token, .. }
            | Input::Station { token, .. }
            | Input::Change { token, .. }
            | Input::Reassign { token, .. } => Some(*token),
        }
    }
}

/// What a station says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StationOrder {
    /// The pick is done.
    Done,
    /// The pick has ended, but goods were missing.
    Short,
    /// Nobody picks until further notice.
    Pause,
    /// Picking goes on.
    Resume,
    /// The rack may leave: lines that are left are short.
    Release,
    /// About a line of the visit, counted from 0; of the one before, if its last line is not confirmed yet and no other
    /// rack is there.
    Line(usize, LineChange),
    /// About the line that was not confirmed when its rack left at the last grasp.
    Last(LineChange),
}

/// How a robot is. Observations of one robot may be late, repeated, out of order or wrongly dated: `seen` orders them
/// as far as the robot's clock goes on evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Telemetry {
    /// The robot.
    pub robot: RobotId,
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
    /// What became of several jobs, in their order.
    BatchTaken {
        /// Of the request.
        token: u64,
        /// The number of each and whether it is new, or why it is refused.
        results: Vec<Result<(JobId, bool), Refusal>>,
    },
    /// The job is cancelled, now or before.
    Cancelled {
        /// Of the request.
        token: u64,
        /// Its number.
        job: JobId,
    },
    /// The robot has joined, now or before.
    Registered {
        /// Of the request.
        token: u64,
        /// The number.
        robot: RobotId,
        /// Whether it is new.
        new: bool,
    },
    /// The worker is known, now or before.
    WorkerRegistered {
        /// Of the request.
        token: u64,
        /// The number.
        worker: WorkerId,
        /// Whether the worker is new.
        new: bool,
    },
    /// The assignment is accepted, or was accepted before under the same key.
    Assigned {
        /// Of the request.
        token: u64,
        /// Its number.
        assignment: AssignmentId,
        /// Whether it is new.
        new: bool,
    },
    /// The area is closed.
    Closed {
        /// Of the request.
        token: u64,
        /// Its number.
        closure: ClosureId,
    },
    /// The area is closed again and again.
    Recurs {
        /// Of the request.
        token: u64,
        /// Its number.
        series: SeriesId,
    },
    /// What was said about a line is noted.
    LineNoted {
        /// Of the request.
        token: u64,
        /// The job.
        job: JobId,
        /// The line's number in the visit, from 0.
        line: usize,
        /// Whether that changed anything: what was confirmed before is counted once.
        outcome: LineOutcome,
        /// How far the line is.
        state: LineState,
        /// Pieces in the tote.
        pieces: u32,
    },
    /// It is so: a worker is cleared, an assignment cancelled, an area open again, a robot halted or released, a job
    /// changed.
    Done {
        /// Of the request.
        token: u64,
    },
    /// It cannot be.
    Refused {
        /// Of the request.
        token: u64,
        /// Why.
        why: Refusal,
    },
}

impl Reply {
    /// The token of the request that it answers.
    pub fn token(&self) -> u64 {
        match *self {
            Reply::Accepted { token, .. }
            | Reply::BatchTaken { token, .. }
            | Reply::Cancelled { token, .. }
            | Reply::Registered { token, .. }
            | Reply::WorkerRegistered { token, .. }
            | Reply::Assigned { token, .. }
            | Reply::Closed { token, .. }
            | Reply::Recurs { token, .. }
            | Reply::LineNoted { token, .. }
            | Reply::Done { token }
            | Reply::Refused { token, .. } => token,
        }
    }
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
    pub token: u64,
    /// Their places among the facts of the step, counted from 0.
    pub facts: Range<usize>,
}
