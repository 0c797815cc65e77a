//! Facts: what happened and must not be forgotten. The ledger is a fold over them.
//!
//! Main type: [`Fact`]. Facts carry results (the chosen route, the time), never recipes: a better planner cannot
//! rewrite history. Refuses: observations (poses, battery), which are seen again after a restart.

use crate::cell::LineChange;
use crate::fleet::state::job::{JobKind, JobRequest, JobState, RobotChoice};
use crate::fleet::state::note::FloorNote;
use crate::fleet::state::recurring::RecurringClosure;
use crate::fleet::state::worker::{
    AssignmentRequest, AssignmentState, Closure, Encounter, LastPlace, Reaction,
};
use crate::id::{AssignmentId, ClosureId, JobId, NodeId, RackId, RobotId, SeriesId, StationId, WorkerId};
use crate::time::{Span, Time};
use crate::timeline::{Shift, Visit};

/// Something that happened.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Fact {
    /// A robot joined the fleet, standing on a node. Robots are numbered in order of joining.
    Registered {
        /// The new number.
        robot: RobotId,
        /// Its name.
        name: String,
        /// The name of its kind.
        kind: String,
        /// Where it stands.
        node: NodeId,
        /// When.
        at: Time,
    },
    /// A job was accepted. Jobs are numbered in order of acceptance.
    Accepted {
        /// The new number.
        job: JobId,
        /// What is wanted.
        request: JobRequest,
        /// When.
        at: Time,
    },
    /// A job came to another state, and the robot that serves it, or served it, to another task: one fact, so that
    /// the two never disagree.
    Progressed {
        /// Which.
        job: JobId,
        /// The new state.
        state: JobState,
        /// The robot whose task changes with it, and that task.
        tasked: Option<(RobotId, Task)>,
        /// When.
        at: Time,
    },
    /// A rack was served at a station and is wanted at another one: its robot goes there, and its job goes on.
    Served {
        /// The job.
        job: JobId,
        /// The robot, and its way to the next station.
        tasked: (RobotId, Task),
        /// When.
        at: Time,
    },
    /// An operator says which robots may do a job that no robot has.
    Chosen {
        /// The job.
        job: JobId,
        /// The robots.
        choice: RobotChoice,
        /// When.
        at: Time,
    },
    /// A robot has something else to do, on which no job's state depends.
    Tasked {
        /// Which.
        robot: RobotId,
        /// What.
        task: Task,
    },
    /// Robots hold new routes, all at once: several where they must make way for one another.
    Routed {
        /// The routes.
        bookings: Vec<Booking>,
    },
    /// A robot may drive up to and including this visit.
    Granted {
        /// Which.
        robot: RobotId,
        /// Serial number.
        serial: u64,
        /// When.
        at: Time,
    },
    /// A robot stands on, or has passed, this visit; everything before it is free again.
    Passed {
        /// Which.
        robot: RobotId,
        /// Serial number.
        serial: u64,
    },
    /// A robot did what it was to do at a stop.
    Acted {
        /// Which.
        robot: RobotId,
        /// Serial number of the stop.
        serial: u64,
    },
    /// Visits have other times now: a robot is late, and all robots that come after it are, too; or it goes on early.
    Retimed {
        /// The robots whose visits moved.
        moved: Vec<Moved>,
    },
    /// A robot stands and has forgotten what it was granted after this visit; that is only held now. The visit is the
    /// one that it reached last, or the next if it stands between the two.
    Revoked {
        /// Which.
        robot: RobotId,
        /// Serial number of the last visit that it keeps.
        serial: u64,
        /// How often it forgot what it was granted, by now.
        recalls: u64,
        /// When.
        at: Time,
    },
    /// These robots keep what they were granted, for ever for all we know, and nothing more.
    Truncated {
        /// Which, and what they keep.
        robots: Vec<KeptRoute>,
    },
    /// A robot does not work any more.
    Failed {
        /// Which.
        robot: RobotId,
        /// When.
        at: Time,
    },
    /// A robot works again.
    Repaired {
        /// Which.
        robot: RobotId,
        /// When.
        at: Time,
    },
    /// What is promised about a robot contradicts itself: it is treated as failed, whatever it reports, until a
    /// person releases it.
    Fenced {
        /// Which.
        robot: RobotId,
        /// When.
        at: Time,
    },
    /// A worker is known from now on, or, where the name is empty, no longer. Workers are numbered in order of joining;
    /// when there are as many numbers as there may be, those of workers who have gone are given again.
    WorkerRegistered {
        /// The number.
        worker: WorkerId,
        /// The name; empty where the place is free.
        name: String,
        /// When.
        at: Time,
    },
    /// A worker is on the floor.
    WorkerNoted {
        /// Which.
        worker: WorkerId,
        /// Where.
        place: LastPlace,
    },
    /// Somebody vouches for where a lost worker is.
    WorkerNarrowed {
        /// Which.
        worker: WorkerId,
        /// Where.
        place: LastPlace,
        /// Who says so.
        by: String,
        /// When.
        at: Time,
    },
    /// A worker has left the floor, or somebody vouches that nobody is where one was lost.
    WorkerCleared {
        /// Which.
        worker: WorkerId,
        /// Who says so; nobody where the headset signed off at a door.
        by: Option<String>,
        /// When.
        at: Time,
    },
    /// A worker is to do something. Assignments are numbered in order of acceptance.
    Assigned {
        /// The new number.
        assignment: AssignmentId,
        /// The worker; nobody where the nearest one who is free is to get it.
        worker: Option<WorkerId>,
        /// What.
        request: AssignmentRequest,
        /// When.
        at: Time,
    },
    /// An assignment that nobody had was given to a worker.
    Given {
        /// Which.
        assignment: AssignmentId,
        /// The worker.
        worker: WorkerId,
        /// When.
        at: Time,
    },
    /// An assignment came to another state.
    Advanced {
        /// Which.
        assignment: AssignmentId,
        /// The new state.
        state: AssignmentState,
        /// When.
        at: Time,
    },
    /// Robots keep out of an area. Closures are numbered in order of marking.
    Closed {
        /// The new number.
        closure: ClosureId,
        /// Where, when, why.
        area: Closure,
    },
    /// The closure has ended; robots may route through the area again.
    Reopened {
        /// Which.
        closure: ClosureId,
        /// When.
        at: Time,
    },
    /// An area is closed again and again. Recurring closures are numbered in order of marking.
    Recurs {
        /// The new number.
        series: SeriesId,
        /// Where, when, why.
        closure: RecurringClosure,
    },
    /// An occurrence of a recurring closure was announced, or passed over: this one is the next.
    Scheduled {
        /// Which.
        series: SeriesId,
        /// When the next one begins that is not announced; nothing where there is none.
        next: Option<Time>,
    },
    /// A closure recurs no more.
    SeriesEnded {
        /// Which.
        series: SeriesId,
        /// When.
        at: Time,
    },
    /// Everybody is to leave the building.
    Evacuated {
        /// When.
        at: Time,
    },
    /// People may come back, and robots go on.
    EvacuationEnded {
        /// When.
        at: Time,
    },
    /// One robot, or the whole fleet, is to stand.
    Halted {
        /// Which; nothing for all of them.
        robot: Option<RobotId>,
        /// When.
        at: Time,
    },
    /// It may go on.
    Released {
        /// Which; nothing for the whole fleet.
        robot: Option<RobotId>,
        /// When.
        at: Time,
    },
    /// Nobody picks at a station until further notice.
    StationPaused {
        /// Which.
        station: StationId,
        /// When.
        at: Time,
    },
    /// Picking at a station goes on.
    StationResumed {
        /// Which.
        station: StationId,
        /// When.
        at: Time,
    },
    /// A waiting job has another priority.
    Prioritised {
        /// Which.
        job: JobId,
        /// 0 to 9.
        priority: u8,
        /// When.
        at: Time,
    },
    /// A waiting job is another one in more than its priority.
    JobChanged {
        /// Which.
        job: JobId,
        /// What is wanted now.
        kind: JobKind,
        /// 0 to 9.
        priority: u8,
        /// When it should be done now.
        deadline: Option<Time>,
        /// When it was changed.
        at: Time,
    },
    /// A robot met a worker. For the record; nothing is promised by it.
    Encountered(Encounter),
    /// A worker left the path. For the record.
    Deviated {
        /// The worker.
        worker: WorkerId,
        /// When.
        at: Time,
    },
    /// A robot had to stop or to change its route because of a worker. For the record.
    Interrupted {
        /// Which.
        robot: RobotId,
        /// The worker because of whom.
        worker: WorkerId,
        /// What happened to it.
        reaction: Reaction,
        /// When.
        at: Time,
    },
    /// Customers' keys are forgotten: their jobs and assignments are over, and were accepted long ago.
    KeysExpired {
        /// The jobs that had them.
        jobs: Vec<JobId>,
        /// The assignments that had them.
        assignments: Vec<AssignmentId>,
    },
    /// A robot was found standing on a node that it did not hold: it holds that and nothing else from now on, and has
    /// no stops any more.
    Placed {
        /// Which.
        robot: RobotId,
        /// Where it stands.
        node: NodeId,
        /// Serial number of this visit; later than any that it had.
        serial: u64,
        /// Robots that were promised this place, or would have had to pass those: what they keep.
        cut: Vec<KeptRoute>,
        /// When.
        at: Time,
    },
    /// A robot goes to maintenance, or comes back. It stays behind the others: digests of recordings count them.
    Maintenance {
        /// Which.
        robot: RobotId,
        /// Since when; nothing where it works again.
        since: Option<Time>,
    },
    /// A robot is to leave the floor.
    Retired {
        /// Which.
        robot: RobotId,
        /// When.
        at: Time,
    },
    /// A robot has left the floor: it holds nothing any more.
    Left {
        /// Which.
        robot: RobotId,
        /// When.
        at: Time,
    },
    /// A robot that had left stands on the floor again.
    Returned {
        /// Which.
        robot: RobotId,
        /// The name of its kind.
        kind: String,
        /// Where it stands.
        node: NodeId,
        /// When.
        at: Time,
    },
    /// People took the rack off a robot that cannot drive, and set it down on a storage node. What the robot was to do
    /// with it is not done any more.
    RackTaken {
        /// The robot.
        robot: RobotId,
        /// The rack.
        rack: RackId,
        /// Where it stands now.
        node: NodeId,
        /// When.
        at: Time,
    },
    /// A line of the visit at which the job's rack stands has changed. It stays behind the others, as all that come
    /// later do: digests of recordings count them.
    LineChanged {
        /// The job.
        job: JobId,
        /// Which line of this visit, counted from 0.
        line: usize,
        /// What is said about it.
        change: LineChange,
        /// When.
        at: Time,
    },
    /// For the record.
    Noted(FloorNote),
}

/// Visits of one robot that have other times now.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Moved {
    /// Which robot.
    pub robot: RobotId,
    /// The visits that moved, in order.
    pub shifts: Vec<Shift>,
}

/// What a robot keeps of its route.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct KeptRoute {
    /// Which robot.
    pub robot: RobotId,
    /// One past the serial number of the last visit that stays.
    pub end: u64,
    /// Those that stay and have other times now, in order.
    pub shifts: Vec<Shift>,
}

/// The new route of one robot, after its visit `keep`.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Booking {
    /// Which robot.
    pub robot: RobotId,
    /// Serial number of the visit that stays.
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
    /// Serial number of the visit.
    pub serial: u64,
    /// What.
    pub act: Act,
}

/// What a robot is doing. `Idle → Fetch → Deliver → Store → Idle`; `Fetch → Store` for relocations; `Idle → Move
/// → Idle`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Task {
    /// Nothing: it stands where it may stay.
    Idle,
    /// It goes to a rack and lifts it.
    Fetch {
        /// The job; nothing where that is over, but the robot may drive to the rack and lift it already.
        job: Option<JobId>,
        /// The rack.
        rack: RackId,
        /// Where the rack stands.
        node: NodeId,
    },
    /// It carries a rack to a station; its route goes on to `store`.
    Deliver {
        /// The job.
        job: JobId,
        /// The rack.
        rack: RackId,
        /// Where the robot stands while a person picks.
        station: NodeId,
        /// The storage node reserved for the rack.
        store: NodeId,
    },
    /// It brings a rack to a storage node and sets it down.
    Store {
        /// The job that ends with it, unless it ended at the station.
        job: Option<JobId>,
        /// The rack.
        rack: RackId,
        /// The storage node.
        store: NodeId,
    },
    /// It goes somewhere without a rack, and on to `stay` where it cannot stay there.
    Move {
        /// The job, if a customer sent it.
        job: Option<JobId>,
        /// Where to.
        goal: NodeId,
        /// Where it stays in the end.
        stay: NodeId,
        /// What for.
        purpose: Purpose,
    },
}

/// Why a robot moves without a rack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Purpose {
    /// To charge.
    Charge,
    /// To be out of the way.
    Park,
    /// Because a customer said so.
    Go,
}

impl Task {
    /// To go to a node for no customer, and stay there.
    pub fn rest_at(stay: NodeId, purpose: Purpose) -> Task {
        Task::Move { job: None, goal: stay, stay, purpose }
    }

    /// The job behind it.
    pub fn job(&self) -> Option<JobId> {
        match *self {
            Task::Deliver { job, .. } => Some(job),
            Task::Fetch { job, .. } | Task::Store { job, .. } | Task::Move { job, .. } => job,
            Task::Idle => None,
        }
    }

    /// Whether this task asks for what a route has its robot do somewhere.
    pub fn asks_for(&self, act: Act) -> bool {
        match (act, *self) {
            (Act::Lift(rack), Task::Fetch { rack: wanted, .. }) => rack == wanted,
            (Act::Set(rack), Task::Store { rack: wanted, .. } | Task::Deliver { rack: wanted, .. }) => {
                rack == wanted
            }
            (Act::Pick(_), Task::Deliver { .. }) | (Act::Arrive, Task::Move { .. }) => true,
            (Act::Lift(_) | Act::Set(_) | Act::Pick(_) | Act::Arrive, _) => false,
        }
    }

    /// The rack that the robot carries while on this task.
    pub fn carried(&self) -> Option<RackId> {
        match *self {
            Task::Deliver { rack, .. } | Task::Store { rack, .. } => Some(rack),
            Task::Idle | Task::Fetch { .. } | Task::Move { .. } => None,
        }
    }

    /// The node on which the robot ends, and which no other robot may be promised.
    pub fn destination(&self) -> Option<NodeId> {
        match *self {
            Task::Idle => None,
            Task::Fetch { node, .. } => Some(node),
            Task::Deliver { store, .. } | Task::Store { store, .. } => Some(store),
            Task::Move { stay, .. } => Some(stay),
        }
    }
}

impl Fact {
    /// The one robot that it is about.
    pub(in crate::fleet) fn robot(&self) -> Option<RobotId> {
        match self {
            Fact::Registered { robot, .. }
            | Fact::Tasked { robot, .. }
            | Fact::Granted { robot, .. }
            | Fact::Passed { robot, .. }
            | Fact::Acted { robot, .. }
            | Fact::Revoked { robot, .. }
            | Fact::Placed { robot, .. }
            | Fact::Failed { robot, .. }
            | Fact::Repaired { robot, .. }
            | Fact::Fenced { robot, .. }
            | Fact::Maintenance { robot, .. }
            | Fact::Retired { robot, .. }
            | Fact::Left { robot, .. }
            | Fact::Returned { robot, .. }
            | Fact::RackTaken { robot, .. } => Some(*robot),
            Fact::Routed { bookings } if bookings.len() == 1 => Some(bookings[0].robot),
            _ => None,
        }
    }
}
