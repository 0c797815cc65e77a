//! Facts as they are written down: the versioned wire form of the journal.
//!
//! Main types: `Record` with [`VERSION`]; [`encode`] and [`decode`]. Field names are short and never reused
//! with another meaning: a journal outlives the program that wrote it. Refuses: to guess what a newer version means.

use super::people_record::{
    AssignmentRecord, AssignmentStateRecord, ClosureRecord, EncounterRecord, ReactionRecord,
};
use super::route_record::{BookingRecord, KeptRecord, MovedRecord};
use crate::fleet::{
    Booking, Fact, JobFailure, JobKind, JobRequest, JobState, Kept, Moved, Purpose, Task, USUAL_KIND,
};
use crate::id::{AssignmentId, ClosureId, JobId, NodeId, RackId, RobotId, StationId, WorkerId};
use crate::time::{Span, Time};
use serde::{Deserialize, Serialize};

/// The version that this program writes. It reads this one and all later ones up to its own.
///
/// It goes up when a record of an earlier version would be read with another meaning, or when a program that is out
/// there would misread a new one: from the first release on, each kind of fact and each field that is added makes a new
/// version. 1 was the form of databases with a row for each fact, which are refused.
pub const VERSION: i64 = 2;

/// The oldest version that this program reads.
const OLDEST: i64 = 2;

/// Why a record cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// It was written by a newer program.
    #[error(
        "it is in wire version {0}, this Giveway reads up to {VERSION}: use the newer Giveway that wrote it"
    )]
    Newer(i64),
    /// It was written by a program from before the first release.
    #[error("it is in wire version {0}, this Giveway reads from {OLDEST} on: take another --database")]
    Older(i64),
    /// It is damaged.
    #[error("it is damaged ({0}): restore the database from a backup")]
    Damaged(#[from] serde_json::Error),
}

/// The facts of one step as text: an array, so that a step is there whole or not at all.
pub fn encode(facts: &[Fact]) -> String {
    let records: Vec<Record> = facts.iter().map(Record::from).collect();
    serde_json::to_string(&records).expect("records have no maps with keys that are not text")
}

/// The facts of one step from text.
///
/// # Errors
/// Where it was written by a newer program, or is damaged.
pub fn decode(version: i64, text: &str) -> Result<Vec<Fact>, RecordError> {
    check_version(version)?;
    Ok(serde_json::from_str::<Vec<Record>>(text)?.into_iter().map(Fact::from).collect())
}

/// Whether this program reads this version.
pub(super) fn check_version(version: i64) -> Result<(), RecordError> {
    match version {
        OLDEST..=VERSION => Ok(()),
        older if older < OLDEST => Err(RecordError::Older(older)),
        newer => Err(RecordError::Newer(newer)),
    }
}

/// A fact.
#[derive(Serialize, Deserialize)]
#[serde(tag = "fact", rename_all = "snake_case")]
enum Record {
    Enlisted {
        robot: u32,
        name: String,
        #[serde(default = "usual_kind", skip_serializing_if = "is_usual_kind")]
        kind: String,
        node: u32,
        at: i64,
    },
    Accepted {
        job: u64,
        request: RequestRecord,
        at: i64,
    },
    Progressed {
        job: u64,
        state: StateRecord,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        tasked: Option<(u32, TaskRecord)>,
        at: i64,
    },
    Tasked {
        robot: u32,
        task: TaskRecord,
    },
    Routed {
        bookings: Vec<BookingRecord>,
    },
    Granted {
        robot: u32,
        serial: u64,
        at: i64,
    },
    Passed {
        robot: u32,
        serial: u64,
    },
    Acted {
        robot: u32,
        serial: u64,
    },
    Delayed {
        moved: Vec<MovedRecord>,
    },
    Recalled {
        robot: u32,
        serial: u64,
        recalls: u64,
        at: i64,
    },
    Cut {
        robots: Vec<KeptRecord>,
    },
    Placed {
        robot: u32,
        node: u32,
        serial: u64,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        cut: Vec<KeptRecord>,
        at: i64,
    },
    Failed {
        robot: u32,
        at: i64,
    },
    Repaired {
        robot: u32,
        at: i64,
    },
    Fenced {
        robot: u32,
        at: i64,
    },
    Hired {
        worker: u32,
        name: String,
        at: i64,
    },
    Assigned {
        assignment: u64,
        worker: u32,
        request: AssignmentRecord,
        at: i64,
    },
    Advanced {
        assignment: u64,
        state: AssignmentStateRecord,
        at: i64,
    },
    Closed {
        closure: u64,
        #[serde(flatten)]
        area: ClosureRecord,
    },
    Reopened {
        closure: u64,
        at: i64,
    },
    Halted {
        robot: Option<u32>,
        at: i64,
    },
    Released {
        robot: Option<u32>,
        at: i64,
    },
    StationPaused {
        station: u32,
        at: i64,
    },
    StationResumed {
        station: u32,
        at: i64,
    },
    Prioritised {
        job: u64,
        priority: u8,
        at: i64,
    },
    Encountered(EncounterRecord),
    Deviated {
        worker: u32,
        at: i64,
    },
    Interrupted {
        robot: u32,
        worker: u32,
        reaction: ReactionRecord,
        at: i64,
    },
    KeysExpired {
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        jobs: Vec<u64>,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        assignments: Vec<u64>,
    },
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum KindRecord {
    Deliver { rack: u32, station: u32, pick: Option<i64> },
    Return { rack: u32 },
    Relocate { rack: u32, node: u32 },
    Charge { robot: u32 },
    Park { robot: u32 },
    Go { robot: u32, node: u32 },
}

#[derive(Serialize, Deserialize)]
pub(super) struct RequestRecord {
    kind: KindRecord,
    priority: u8,
    deadline: Option<i64>,
    after: Vec<u64>,
    key: Option<String>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum StateRecord {
    Waiting,
    Assigned(u32),
    Carrying(u32),
    Picking(u32),
    Done,
    Cancelled,
    Failed(FailureRecord),
}

/// Why a job failed; also a column of the `jobs` table.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum FailureRecord {
    Predecessor(u64),
    Unreachable,
    StorageTaken(u32),
    Short,
    MapChanged,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum TaskRecord {
    Idle,
    Fetch { job: Option<u64>, rack: u32, node: u32 },
    Deliver { job: u64, rack: u32, station: u32, store: u32 },
    Store { job: Option<u64>, rack: u32, store: u32 },
    Move { job: Option<u64>, goal: u32, stay: u32, purpose: PurposeRecord },
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum PurposeRecord {
    Charge,
    Park,
    Go,
}

/// Robots from before there were kinds are of this one, and it is left out of what is written.
pub(super) fn usual_kind() -> String {
    USUAL_KIND.to_owned()
}

pub(super) fn is_usual_kind(kind: &String) -> bool {
    kind == USUAL_KIND
}

impl From<&Fact> for Record {
    fn from(fact: &Fact) -> Record {
        match fact {
            Fact::Registered { robot, name, kind, node, at } => Record::Enlisted {
                robot: robot.0,
                name: name.clone(),
                kind: kind.clone(),
                node: node.0,
                at: at.0,
            },
            Fact::Accepted { job, request, at } => {
                Record::Accepted { job: job.0, request: request.into(), at: at.0 }
            }
            Fact::Progressed { job, state, tasked, at } => Record::Progressed {
                job: job.0,
                state: (*state).into(),
                tasked: tasked.map(|(robot, task)| (robot.0, task.into())),
                at: at.0,
            },
            Fact::Tasked { robot, task } => Record::Tasked { robot: robot.0, task: (*task).into() },
            Fact::Routed { bookings } => {
                Record::Routed { bookings: bookings.iter().map(BookingRecord::from).collect() }
            }
            Fact::Granted { robot, serial, at } => {
                Record::Granted { robot: robot.0, serial: *serial, at: at.0 }
            }
            Fact::Passed { robot, serial } => Record::Passed { robot: robot.0, serial: *serial },
            Fact::Acted { robot, serial } => Record::Acted { robot: robot.0, serial: *serial },
            Fact::Delayed { moved } => {
                Record::Delayed { moved: moved.iter().map(MovedRecord::from).collect() }
            }
            Fact::Revoked { robot, serial, recalls, at } => {
                Record::Recalled { robot: robot.0, serial: *serial, recalls: *recalls, at: at.0 }
            }
            Fact::Truncated { robots } => Record::Cut { robots: kept_records(robots) },
            Fact::Placed { robot, node, serial, cut, at } => record_placed(*robot, *node, *serial, cut, *at),
            Fact::Failed { robot, at } => Record::Failed { robot: robot.0, at: at.0 },
            Fact::Repaired { robot, at } => Record::Repaired { robot: robot.0, at: at.0 },
            Fact::Fenced { robot, at } => Record::Fenced { robot: robot.0, at: at.0 },
            Fact::WorkerRegistered { worker, name, at } => {
                Record::Hired { worker: worker.0, name: name.clone(), at: at.0 }
            }
            Fact::Assigned { assignment, worker, request, at } => Record::Assigned {
                assignment: assignment.0,
                worker: worker.0,
                request: request.into(),
                at: at.0,
            },
            Fact::Advanced { assignment, state, at } => {
                Record::Advanced { assignment: assignment.0, state: (*state).into(), at: at.0 }
            }
            Fact::Closed { closure, area } => Record::Closed { closure: closure.0, area: area.into() },
            Fact::Reopened { closure, at } => Record::Reopened { closure: closure.0, at: at.0 },
            Fact::Halted { robot, at } => Record::Halted { robot: robot.map(|r| r.0), at: at.0 },
            Fact::Released { robot, at } => Record::Released { robot: robot.map(|r| r.0), at: at.0 },
            Fact::StationPaused { station, at } => Record::StationPaused { station: station.0, at: at.0 },
            Fact::StationResumed { station, at } => Record::StationResumed { station: station.0, at: at.0 },
            Fact::Prioritised { job, priority, at } => {
                Record::Prioritised { job: job.0, priority: *priority, at: at.0 }
            }
            Fact::Encountered(encounter) => Record::Encountered(encounter.into()),
            Fact::Deviated { worker, at } => Record::Deviated { worker: worker.0, at: at.0 },
            Fact::Interrupted { robot, worker, reaction, at } => Record::Interrupted {
                robot: robot.0,
                worker: worker.0,
                reaction: (*reaction).into(),
                at: at.0,
            },
            Fact::KeysExpired { jobs, assignments } => Record::KeysExpired {
                jobs: jobs.iter().map(|j| j.0).collect(),
                assignments: assignments.iter().map(|a| a.0).collect(),
            },
        }
    }
}

fn kept_records(robots: &[Kept]) -> Vec<KeptRecord> {
    robots.iter().map(KeptRecord::from).collect()
}

impl From<Record> for Fact {
    fn from(record: Record) -> Fact {
        match record {
            Record::Enlisted { robot, name, kind, node, at } => {
                Fact::Registered { robot: RobotId(robot), name, kind, node: NodeId(node), at: Time(at) }
            }
            Record::Accepted { job, request, at } => {
                Fact::Accepted { job: JobId(job), request: request.into(), at: Time(at) }
            }
            Record::Progressed { job, state, tasked, at } => Fact::Progressed {
                job: JobId(job),
                state: state.into(),
                tasked: tasked.map(|(robot, task)| (RobotId(robot), task.into())),
                at: Time(at),
            },
            Record::Tasked { robot, task } => Fact::Tasked { robot: RobotId(robot), task: task.into() },
            Record::Routed { bookings } => {
                Fact::Routed { bookings: bookings.into_iter().map(Booking::from).collect() }
            }
            Record::Granted { robot, serial, at } => {
                Fact::Granted { robot: RobotId(robot), serial, at: Time(at) }
            }
            Record::Passed { robot, serial } => Fact::Passed { robot: RobotId(robot), serial },
            Record::Acted { robot, serial } => Fact::Acted { robot: RobotId(robot), serial },
            Record::Delayed { moved } => {
                Fact::Delayed { moved: moved.into_iter().map(Moved::from).collect() }
            }
            Record::Recalled { robot, serial, recalls, at } => {
                Fact::Revoked { robot: RobotId(robot), serial, recalls, at: Time(at) }
            }
            Record::Cut { robots } => {
                Fact::Truncated { robots: robots.into_iter().map(Kept::from).collect() }
            }
            Record::Placed { robot, node, serial, cut, at } => placed(robot, node, serial, cut, at),
            Record::Failed { robot, at } => Fact::Failed { robot: RobotId(robot), at: Time(at) },
            Record::Repaired { robot, at } => Fact::Repaired { robot: RobotId(robot), at: Time(at) },
            Record::Fenced { robot, at } => Fact::Fenced { robot: RobotId(robot), at: Time(at) },
            Record::Hired { worker, name, at } => {
                Fact::WorkerRegistered { worker: WorkerId(worker), name, at: Time(at) }
            }
            Record::Assigned { assignment, worker, request, at } => Fact::Assigned {
                assignment: AssignmentId(assignment),
                worker: WorkerId(worker),
                request: request.into(),
                at: Time(at),
            },
            Record::Advanced { assignment, state, at } => {
                Fact::Advanced { assignment: AssignmentId(assignment), state: state.into(), at: Time(at) }
            }
            Record::Closed { closure, area } => {
                Fact::Closed { closure: ClosureId(closure), area: area.into() }
            }
            Record::Reopened { closure, at } => Fact::Reopened { closure: ClosureId(closure), at: Time(at) },
            Record::Halted { robot, at } => Fact::Halted { robot: robot.map(RobotId), at: Time(at) },
            Record::Released { robot, at } => Fact::Released { robot: robot.map(RobotId), at: Time(at) },
            Record::StationPaused { station, at } => {
                Fact::StationPaused { station: StationId(station), at: Time(at) }
            }
            Record::StationResumed { station, at } => {
                Fact::StationResumed { station: StationId(station), at: Time(at) }
            }
            Record::Prioritised { job, priority, at } => {
                Fact::Prioritised { job: JobId(job), priority, at: Time(at) }
            }
            Record::Encountered(encounter) => Fact::Encountered(encounter.into()),
            Record::Deviated { worker, at } => Fact::Deviated { worker: WorkerId(worker), at: Time(at) },
            Record::Interrupted { robot, worker, reaction, at } => interrupted(robot, worker, reaction, at),
            Record::KeysExpired { jobs, assignments } => keys_expired(jobs, assignments),
        }
    }
}

fn record_placed(robot: RobotId, node: NodeId, serial: u64, cut: &[Kept], at: Time) -> Record {
    let cut = cut.iter().map(KeptRecord::from).collect();
    Record::Placed { robot: robot.0, node: node.0, serial, cut, at: at.0 }
}

fn placed(robot: u32, node: u32, serial: u64, cut: Vec<KeptRecord>, at: i64) -> Fact {
    let cut = cut.into_iter().map(Kept::from).collect();
    Fact::Placed { robot: RobotId(robot), node: NodeId(node), serial, cut, at: Time(at) }
}

fn interrupted(robot: u32, worker: u32, reaction: ReactionRecord, at: i64) -> Fact {
    let (robot, worker) = (RobotId(robot), WorkerId(worker));
    Fact::Interrupted { robot, worker, reaction: reaction.into(), at: Time(at) }
}

fn keys_expired(jobs: Vec<u64>, assignments: Vec<u64>) -> Fact {
    let assignments = assignments.into_iter().map(AssignmentId).collect();
    Fact::KeysExpired { jobs: jobs.into_iter().map(JobId).collect(), assignments }
}

impl From<&JobRequest> for RequestRecord {
    fn from(r: &JobRequest) -> RequestRecord {
        let kind = match r.kind {
            JobKind::Deliver { rack, station, pick } => {
                KindRecord::Deliver { rack: rack.0, station: station.0, pick: pick.map(|p| p.0) }
            }
            JobKind::Return { rack } => KindRecord::Return { rack: rack.0 },
            JobKind::Relocate { rack, node } => KindRecord::Relocate { rack: rack.0, node: node.0 },
            JobKind::Charge { robot } => KindRecord::Charge { robot: robot.0 },
            JobKind::Park { robot } => KindRecord::Park { robot: robot.0 },
            JobKind::Go { robot, node } => KindRecord::Go { robot: robot.0, node: node.0 },
        };
        RequestRecord {
            kind,
            priority: r.priority,
            deadline: r.deadline.map(|t| t.0),
            after: r.after.iter().map(|j| j.0).collect(),
            key: r.key.clone(),
        }
    }
}

impl From<RequestRecord> for JobRequest {
    fn from(r: RequestRecord) -> JobRequest {
        let kind = match r.kind {
            KindRecord::Deliver { rack, station, pick } => {
                JobKind::Deliver { rack: RackId(rack), station: StationId(station), pick: pick.map(Span) }
            }
            KindRecord::Return { rack } => JobKind::Return { rack: RackId(rack) },
            KindRecord::Relocate { rack, node } => {
                JobKind::Relocate { rack: RackId(rack), node: NodeId(node) }
            }
            KindRecord::Charge { robot } => JobKind::Charge { robot: RobotId(robot) },
            KindRecord::Park { robot } => JobKind::Park { robot: RobotId(robot) },
            KindRecord::Go { robot, node } => JobKind::Go { robot: RobotId(robot), node: NodeId(node) },
        };
        JobRequest {
            kind,
            priority: r.priority,
            deadline: r.deadline.map(Time),
            after: r.after.into_iter().map(JobId).collect(),
            key: r.key,
        }
    }
}

impl From<JobState> for StateRecord {
    fn from(s: JobState) -> StateRecord {
        match s {
            JobState::Waiting => StateRecord::Waiting,
            JobState::Assigned { robot } => StateRecord::Assigned(robot.0),
            JobState::Carrying { robot } => StateRecord::Carrying(robot.0),
            JobState::Picking { robot } => StateRecord::Picking(robot.0),
            JobState::Done => StateRecord::Done,
            JobState::Cancelled => StateRecord::Cancelled,
            JobState::Failed(why) => StateRecord::Failed(why.into()),
        }
    }
}

impl From<StateRecord> for JobState {
    fn from(s: StateRecord) -> JobState {
        match s {
            StateRecord::Waiting => JobState::Waiting,
            StateRecord::Assigned(robot) => JobState::Assigned { robot: RobotId(robot) },
            StateRecord::Carrying(robot) => JobState::Carrying { robot: RobotId(robot) },
            StateRecord::Picking(robot) => JobState::Picking { robot: RobotId(robot) },
            StateRecord::Done => JobState::Done,
            StateRecord::Cancelled => JobState::Cancelled,
            StateRecord::Failed(why) => JobState::Failed(why.into()),
        }
    }
}

impl From<JobFailure> for FailureRecord {
    fn from(f: JobFailure) -> FailureRecord {
        match f {
            JobFailure::Predecessor(job) => FailureRecord::Predecessor(job.0),
            JobFailure::Unreachable => FailureRecord::Unreachable,
            JobFailure::Short => FailureRecord::Short,
            JobFailure::MapChanged => FailureRecord::MapChanged,
            JobFailure::StorageTaken(node) => FailureRecord::StorageTaken(node.0),
        }
    }
}

impl From<FailureRecord> for JobFailure {
    fn from(f: FailureRecord) -> JobFailure {
        match f {
            FailureRecord::Predecessor(job) => JobFailure::Predecessor(JobId(job)),
            FailureRecord::Unreachable => JobFailure::Unreachable,
            FailureRecord::Short => JobFailure::Short,
            FailureRecord::MapChanged => JobFailure::MapChanged,
            FailureRecord::StorageTaken(node) => JobFailure::StorageTaken(NodeId(node)),
        }
    }
}

/// A failure as text, for its own column.
pub(super) fn encode_failure(f: JobFailure) -> String {
    serde_json::to_string(&FailureRecord::from(f)).expect("failures have no maps")
}

/// A failure from its column.
pub(super) fn decode_failure(text: &str) -> Result<JobFailure, RecordError> {
    Ok(serde_json::from_str::<FailureRecord>(text)?.into())
}

impl From<Task> for TaskRecord {
    fn from(t: Task) -> TaskRecord {
        match t {
            Task::Idle => TaskRecord::Idle,
            Task::Fetch { job, rack, node } => {
                TaskRecord::Fetch { job: job.map(|j| j.0), rack: rack.0, node: node.0 }
            }
            Task::Deliver { job, rack, station, store } => {
                TaskRecord::Deliver { job: job.0, rack: rack.0, station: station.0, store: store.0 }
            }
            Task::Store { job, rack, store } => {
                TaskRecord::Store { job: job.map(|j| j.0), rack: rack.0, store: store.0 }
            }
            Task::Move { job, goal, stay, purpose } => TaskRecord::Move {
                job: job.map(|j| j.0),
                goal: goal.0,
                stay: stay.0,
                purpose: match purpose {
                    Purpose::Charge => PurposeRecord::Charge,
                    Purpose::Park => PurposeRecord::Park,
                    Purpose::Go => PurposeRecord::Go,
                },
            },
        }
    }
}

impl From<TaskRecord> for Task {
    fn from(t: TaskRecord) -> Task {
        match t {
            TaskRecord::Idle => Task::Idle,
            TaskRecord::Fetch { job, rack, node } => {
                Task::Fetch { job: job.map(JobId), rack: RackId(rack), node: NodeId(node) }
            }
            TaskRecord::Deliver { job, rack, station, store } => Task::Deliver {
                job: JobId(job),
                rack: RackId(rack),
                station: NodeId(station),
                store: NodeId(store),
            },
            TaskRecord::Store { job, rack, store } => {
                Task::Store { job: job.map(JobId), rack: RackId(rack), store: NodeId(store) }
            }
            TaskRecord::Move { job, goal, stay, purpose } => Task::Move {
                job: job.map(JobId),
                goal: NodeId(goal),
                stay: NodeId(stay),
                purpose: match purpose {
                    PurposeRecord::Charge => Purpose::Charge,
                    PurposeRecord::Park => Purpose::Park,
                    PurposeRecord::Go => Purpose::Go,
                },
            },
        }
    }
}
