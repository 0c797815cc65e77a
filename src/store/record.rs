//! Facts as they are written down: the versioned wire form of the journal.
//!
//! Main types: `Record` with [`VERSION`]; [`encode`] and [`decode`]. Field names are short and never reused
//! with another meaning: a journal outlives the program that wrote it. Refuses: to guess what a newer version means.

use super::job_record::{JobFactRecord, KindRecord, RequestRecord, StateRecord, TaskRecord};
use super::note_record::NoteRecord;
use super::people_record::{
    AssignmentRecord, AssignmentStateRecord, ClosureRecord, EncounterRecord, LastPlaceRecord, ReactionRecord,
    RecurringRecord,
};
use super::route_record::{BookingRecord, KeptRecord, MovedRecord};
use crate::fleet::{AssignmentRequest, Booking, Fact, JobKind, KeptRoute, Moved, Reaction, USUAL_KIND};
use crate::id::{AssignmentId, ClosureId, JobId, NodeId, RackId, RobotId, SeriesId, StationId, WorkerId};
use crate::time::Time;
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
    #[error("it is in wire version {0}, this Giveway reads {OLDEST} and later: use another --database")]
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
    OfJob(JobFactRecord),
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
    Maintenance {
        robot: u32,
        since: Option<i64>,
    },
    Retired {
        robot: u32,
        at: i64,
    },
    Left {
        robot: u32,
        at: i64,
    },
    Returned {
        robot: u32,
        kind: String,
        node: u32,
        at: i64,
    },
    RackTaken {
        robot: u32,
        rack: u32,
        node: u32,
        at: i64,
    },
    Hired {
        worker: u32,
        name: String,
        at: i64,
    },
    Assigned {
        assignment: u64,
        worker: Option<u32>,
        request: AssignmentRecord,
        at: i64,
    },
    Given {
        assignment: u64,
        worker: u32,
        at: i64,
    },
    Noted {
        worker: u32,
        place: LastPlaceRecord,
    },
    Narrowed {
        worker: u32,
        place: LastPlaceRecord,
        by: String,
        at: i64,
    },
    Cleared {
        worker: u32,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        by: Option<String>,
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
    Recurs {
        series: u64,
        closure: RecurringRecord,
    },
    Scheduled {
        series: u64,
        next: Option<i64>,
    },
    SeriesEnded {
        series: u64,
        at: i64,
    },
    Evacuated {
        at: i64,
    },
    EvacuationEnded {
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
    JobChanged {
        job: u64,
        kind: KindRecord,
        priority: u8,
        deadline: Option<i64>,
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
    FloorNoted(NoteRecord),
}

/// Robots from before there were kinds are of this one, and it is left out of what is written.
pub(super) fn usual_kind() -> String {
    USUAL_KIND.to_owned()
}

pub(super) fn is_usual_kind(kind: &String) -> bool {
    kind == USUAL_KIND
}

/// What is closed, what recurs, and evacuations.
fn of_closures(fact: &Fact) -> Record {
    match fact {
        Fact::Closed { closure, area } => Record::Closed { closure: closure.0, area: area.into() },
        Fact::Reopened { closure, at } => Record::Reopened { closure: closure.0, at: at.0 },
        Fact::Recurs { series, closure } => Record::Recurs { series: series.0, closure: closure.into() },
        Fact::Scheduled { series, next } => Record::Scheduled { series: series.0, next: next.map(|t| t.0) },
        Fact::SeriesEnded { series, at } => Record::SeriesEnded { series: series.0, at: at.0 },
        Fact::Evacuated { at } => Record::Evacuated { at: at.0 },
        Fact::EvacuationEnded { at } => Record::EvacuationEnded { at: at.0 },
        other => unreachable!("{other:?} is about no closure"),
    }
}

/// The same the other way.
fn about_closures(record: Record) -> Fact {
    match record {
        Record::Closed { closure, area } => Fact::Closed { closure: ClosureId(closure), area: area.into() },
        Record::Reopened { closure, at } => Fact::Reopened { closure: ClosureId(closure), at: Time(at) },
        Record::Recurs { series, closure } => {
            Fact::Recurs { series: SeriesId(series), closure: closure.into() }
        }
        Record::Scheduled { series, next } => {
            Fact::Scheduled { series: SeriesId(series), next: next.map(Time) }
        }
        Record::SeriesEnded { series, at } => Fact::SeriesEnded { series: SeriesId(series), at: Time(at) },
        Record::Evacuated { at } => Fact::Evacuated { at: Time(at) },
        Record::EvacuationEnded { at } => Fact::EvacuationEnded { at: Time(at) },
        _ => unreachable!("it is about no closure"),
    }
}

impl From<&Fact> for Record {
    fn from(fact: &Fact) -> Record {
        match fact {
            Fact::Registered { robot, name, kind, node, at } => {
                record_registered(*robot, (name, kind), *node, *at)
            }
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
            Fact::Retimed { moved } => {
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
            Fact::Maintenance { robot, since } => record_maintenance(*robot, *since),
            Fact::Retired { robot, at } => Record::Retired { robot: robot.0, at: at.0 },
            Fact::Left { robot, at } => Record::Left { robot: robot.0, at: at.0 },
            Fact::Returned { robot, kind, node, at } => record_returned(*robot, kind, *node, *at),
            Fact::RackTaken { robot, rack, node, at } => record_taken(*robot, *rack, *node, *at),
            Fact::WorkerRegistered { worker, name, at } => record_hired(*worker, name, *at),
            Fact::Assigned { assignment, worker, request, at } => {
                record_assigned(*assignment, *worker, request, *at)
            }
            Fact::Given { assignment, worker, at } => {
                Record::Given { assignment: assignment.0, worker: worker.0, at: at.0 }
            }
            Fact::Advanced { assignment, state, at } => {
                Record::Advanced { assignment: assignment.0, state: (*state).into(), at: at.0 }
            }
            Fact::Halted { robot, at } => Record::Halted { robot: robot.map(|r| r.0), at: at.0 },
            Fact::Released { robot, at } => Record::Released { robot: robot.map(|r| r.0), at: at.0 },
            Fact::StationPaused { station, at } => Record::StationPaused { station: station.0, at: at.0 },
            Fact::StationResumed { station, at } => Record::StationResumed { station: station.0, at: at.0 },
            Fact::Served { .. } | Fact::LineChanged { .. } | Fact::Chosen { .. } => {
                Record::OfJob(fact.into())
            }
            Fact::Prioritised { job, priority, at } => record_prioritised(*job, *priority, *at),
            Fact::JobChanged { job, kind, priority, deadline, at } => {
                record_job_changed(*job, *kind, (*priority, *deadline), *at)
            }
            Fact::Encountered(encounter) => Record::Encountered(encounter.into()),
            Fact::Deviated { worker, at } => Record::Deviated { worker: worker.0, at: at.0 },
            Fact::Interrupted { robot, worker, reaction, at } => {
                record_interrupted(*robot, *worker, *reaction, *at)
            }
            Fact::KeysExpired { jobs, assignments } => record_keys_expired(jobs, assignments),
            rest => of_places(rest),
        }
    }
}

fn record_assigned(id: AssignmentId, worker: Option<WorkerId>, r: &AssignmentRequest, at: Time) -> Record {
    Record::Assigned { assignment: id.0, worker: worker.map(|w| w.0), request: r.into(), at: at.0 }
}

/// Where workers are, what is noted, and what is closed.
fn of_places(fact: &Fact) -> Record {
    match fact {
        Fact::Noted(note) => Record::FloorNoted(note.into()),
        Fact::WorkerNoted { worker, place } => Record::Noted { worker: worker.0, place: (*place).into() },
        Fact::WorkerNarrowed { worker, place, by, at } => {
            Record::Narrowed { worker: worker.0, place: (*place).into(), by: by.clone(), at: at.0 }
        }
        Fact::WorkerCleared { worker, by, at } => {
            Record::Cleared { worker: worker.0, by: by.clone(), at: at.0 }
        }
        rest => of_closures(rest),
    }
}

fn record_interrupted(robot: RobotId, worker: WorkerId, reaction: Reaction, at: Time) -> Record {
    Record::Interrupted { robot: robot.0, worker: worker.0, reaction: reaction.into(), at: at.0 }
}

fn record_keys_expired(jobs: &[JobId], assignments: &[AssignmentId]) -> Record {
    let assignments = assignments.iter().map(|a| a.0).collect();
    Record::KeysExpired { jobs: jobs.iter().map(|j| j.0).collect(), assignments }
}

fn record_maintenance(robot: RobotId, since: Option<Time>) -> Record {
    Record::Maintenance { robot: robot.0, since: since.map(|t| t.0) }
}

fn record_returned(robot: RobotId, kind: &str, node: NodeId, at: Time) -> Record {
    Record::Returned { robot: robot.0, kind: kind.to_owned(), node: node.0, at: at.0 }
}

fn maintenance(robot: u32, since: Option<i64>) -> Fact {
    Fact::Maintenance { robot: RobotId(robot), since: since.map(Time) }
}

fn returned(robot: u32, kind: String, node: u32, at: i64) -> Fact {
    Fact::Returned { robot: RobotId(robot), kind, node: NodeId(node), at: Time(at) }
}

fn record_hired(worker: WorkerId, name: &str, at: Time) -> Record {
    Record::Hired { worker: worker.0, name: name.to_owned(), at: at.0 }
}

fn record_taken(robot: RobotId, rack: RackId, node: NodeId, at: Time) -> Record {
    Record::RackTaken { robot: robot.0, rack: rack.0, node: node.0, at: at.0 }
}

fn rack_taken(robot: u32, rack: u32, node: u32, at: i64) -> Fact {
    Fact::RackTaken { robot: RobotId(robot), rack: RackId(rack), node: NodeId(node), at: Time(at) }
}

fn kept(records: Vec<KeptRecord>) -> Vec<KeptRoute> {
    records.into_iter().map(KeptRoute::from).collect()
}

fn kept_records(robots: &[KeptRoute]) -> Vec<KeptRecord> {
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
                Fact::Retimed { moved: moved.into_iter().map(Moved::from).collect() }
            }
            Record::Recalled { robot, serial, recalls, at } => {
                Fact::Revoked { robot: RobotId(robot), serial, recalls, at: Time(at) }
            }
            Record::Cut { robots } => Fact::Truncated { robots: kept(robots) },
            Record::Placed { robot, node, serial, cut, at } => placed(robot, node, serial, cut, at),
            Record::Failed { robot, at } => Fact::Failed { robot: RobotId(robot), at: Time(at) },
            Record::Repaired { robot, at } => Fact::Repaired { robot: RobotId(robot), at: Time(at) },
            Record::Fenced { robot, at } => Fact::Fenced { robot: RobotId(robot), at: Time(at) },
            Record::Maintenance { robot, since } => maintenance(robot, since),
            Record::Retired { robot, at } => Fact::Retired { robot: RobotId(robot), at: Time(at) },
            Record::Left { robot, at } => Fact::Left { robot: RobotId(robot), at: Time(at) },
            Record::Returned { robot, kind, node, at } => returned(robot, kind, node, at),
            Record::RackTaken { robot, rack, node, at } => rack_taken(robot, rack, node, at),
            Record::Hired { worker, name, at } => {
                Fact::WorkerRegistered { worker: WorkerId(worker), name, at: Time(at) }
            }
            Record::Assigned { assignment, worker, request, at } => assigned(assignment, worker, request, at),
            Record::Given { assignment, worker, at } => given(assignment, worker, at),
            Record::Advanced { assignment, state, at } => {
                Fact::Advanced { assignment: AssignmentId(assignment), state: state.into(), at: Time(at) }
            }
            Record::Halted { robot, at } => Fact::Halted { robot: robot.map(RobotId), at: Time(at) },
            Record::Released { robot, at } => Fact::Released { robot: robot.map(RobotId), at: Time(at) },
            Record::StationPaused { station, at } => {
                Fact::StationPaused { station: StationId(station), at: Time(at) }
            }
            Record::StationResumed { station, at } => {
                Fact::StationResumed { station: StationId(station), at: Time(at) }
            }
            Record::OfJob(record) => record.into(),
            Record::Prioritised { job, priority, at } => {
                Fact::Prioritised { job: JobId(job), priority, at: Time(at) }
            }
            Record::JobChanged { job, kind, priority, deadline, at } => {
                job_changed(job, kind, (priority, deadline), at)
            }
            Record::Encountered(encounter) => Fact::Encountered(encounter.into()),
            Record::Deviated { worker, at } => Fact::Deviated { worker: WorkerId(worker), at: Time(at) },
            Record::Interrupted { robot, worker, reaction, at } => interrupted(robot, worker, reaction, at),
            Record::KeysExpired { jobs, assignments } => keys_expired(jobs, assignments),
            rest => about_places(rest),
        }
    }
}

fn about_places(record: Record) -> Fact {
    match record {
        Record::FloorNoted(note) => Fact::Noted(note.into()),
        Record::Noted { worker, place } => {
            Fact::WorkerNoted { worker: WorkerId(worker), place: place.into() }
        }
        Record::Narrowed { worker, place, by, at } => {
            Fact::WorkerNarrowed { worker: WorkerId(worker), place: place.into(), by, at: Time(at) }
        }
        Record::Cleared { worker, by, at } => {
            Fact::WorkerCleared { worker: WorkerId(worker), by, at: Time(at) }
        }
        rest => about_closures(rest),
    }
}

fn job_changed(job: u64, kind: KindRecord, (priority, deadline): (u8, Option<i64>), at: i64) -> Fact {
    let (kind, deadline) = (kind.into(), deadline.map(Time));
    Fact::JobChanged { job: JobId(job), kind, priority, deadline, at: Time(at) }
}

fn record_prioritised(job: JobId, priority: u8, at: Time) -> Record {
    Record::Prioritised { job: job.0, priority, at: at.0 }
}

fn record_job_changed(
    job: JobId,
    kind: JobKind,
    (priority, deadline): (u8, Option<Time>),
    at: Time,
) -> Record {
    let deadline = deadline.map(|t| t.0);
    Record::JobChanged { job: job.0, kind: kind.into(), priority, deadline, at: at.0 }
}

fn record_registered(robot: RobotId, (name, kind): (&str, &str), node: NodeId, at: Time) -> Record {
    Record::Enlisted { robot: robot.0, name: name.into(), kind: kind.into(), node: node.0, at: at.0 }
}

fn record_placed(robot: RobotId, node: NodeId, serial: u64, cut: &[KeptRoute], at: Time) -> Record {
    let cut = cut.iter().map(KeptRecord::from).collect();
    Record::Placed { robot: robot.0, node: node.0, serial, cut, at: at.0 }
}

fn placed(robot: u32, node: u32, serial: u64, cut: Vec<KeptRecord>, at: i64) -> Fact {
    let cut = cut.into_iter().map(KeptRoute::from).collect();
    Fact::Placed { robot: RobotId(robot), node: NodeId(node), serial, cut, at: Time(at) }
}

fn assigned(id: u64, worker: Option<u32>, request: AssignmentRecord, at: i64) -> Fact {
    let (assignment, worker) = (AssignmentId(id), worker.map(WorkerId));
    Fact::Assigned { assignment, worker, request: request.into(), at: Time(at) }
}

fn given(assignment: u64, worker: u32, at: i64) -> Fact {
    Fact::Given { assignment: AssignmentId(assignment), worker: WorkerId(worker), at: Time(at) }
}

fn interrupted(robot: u32, worker: u32, reaction: ReactionRecord, at: i64) -> Fact {
    let (robot, worker) = (RobotId(robot), WorkerId(worker));
    Fact::Interrupted { robot, worker, reaction: reaction.into(), at: Time(at) }
}

fn keys_expired(jobs: Vec<u64>, assignments: Vec<u64>) -> Fact {
    let assignments = assignments.into_iter().map(AssignmentId).collect();
    Fact::KeysExpired { jobs: jobs.into_iter().map(JobId).collect(), assignments }
}
