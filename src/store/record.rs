//! The written form of facts: the versioned wire form of the journal.
//!
//! Main types: `Record` with [`VERSION`]; [`encode`] and [`decode`]. Field names are short and never reused with
//! another meaning: a journal outlives the program that wrote it. Refuses: to guess the meaning of a newer version.

use super::written::Written;
use giveway_cell::LineChange;
use giveway_fleet::{
    AreaFact, AssignmentFact, AssignmentRequest, AssignmentState, Booking, Closure, Encounter, EncounterFact,
    Fact, FloorFact, FloorNote, JobFact, JobKind, JobRequest, JobState, KeptRoute, LastPlace, Moved,
    Reaction, RecurringClosure, RobotChoice, RobotFact, RobotKind, RouteFact, Task, USUAL_KIND, USUAL_LINK,
    WorkerFact,
};
use giveway_floor::id::{
    AssignmentId, ClosureId, JobId, NodeId, RackId, RobotId, SeriesId, StationId, WorkerId,
};
use giveway_floor::time::Time;
use giveway_people::human::Mover;
use serde::{Deserialize, Serialize};

/// The version that this program writes. It reads all versions from `OLDEST` to this one.
///
/// The version goes up when a record of an earlier version would be read with another meaning, or when a released
/// program would misread a new one: from the first release on, each added kind of fact and each added field makes a new
/// version. 1 was the form of databases with a row for each fact, which are refused; 3 has kinds of robots.
pub const VERSION: i64 = 3;

/// The oldest version that this program reads.
const OLDEST: i64 = 2;

/// Why a record cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The record was written by a newer program.
    #[error(
        "it is in wire version {0}, this Giveway reads up to {VERSION}: use the newer Giveway that wrote it"
    )]
    Newer(i64),
    /// The record was written by a program from before the first release.
    #[error("it is in wire version {0}, this Giveway reads {OLDEST} and later: use another --database")]
    Older(i64),
    /// The record is damaged.
    #[error("it is damaged ({0}): restore the database from a backup")]
    Damaged(#[from] serde_json::Error),
}

/// The facts of one step as text: an array, so that a step is there whole or not at all.
pub fn encode(facts: &[Fact]) -> String {
    let records: Vec<Record> = facts.iter().map(Record::from).collect();
    let text = serde_json::to_string(&records).expect("records have no maps with keys that are not text");
    debug_assert_eq!(
        decode(VERSION, &text).ok().as_deref(),
        Some(facts),
        "facts come back as they were: {text}"
    );
    text
}

/// The facts of one step from text.
///
/// # Errors
/// If it was written by a newer program, or is damaged.
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

/// Makes the written form of facts from the list of all kinds: for each the tag, the fact, and the fields, which have
/// the same names in both. A kind missing from the list does not compile, in either direction.
///
/// Facts in `rows` are an object whose field `fact` is the tag. Facts in `of_job` have the tag `of_job`, and their own
/// as `what`. The two that hold one record each have its fields beside the tag, and are in the macro itself.
macro_rules! records {
    (
        of_job { $($of_job:ident = $job_kind:ident { $($job_field:ident: $job_type:ty),* })* }
        rows { $($tag:ident = $about:ident($of:ident::$kind:ident) {
            $($(#[$attr:meta])* $field:ident: $type:ty),*
        })* }
    ) => {
        /// The written form of a fact.
        #[derive(Serialize, Deserialize)]
        #[serde(tag = "fact", rename_all = "snake_case")]
        enum Record {
            $($tag { $($(#[$attr])* $field: <$type as Written>::Form),* },)*
            OfJob(JobFactRecord),
            Encountered(<Encounter as Written>::Form),
            FloorNoted(<FloorNote as Written>::Form),
        }

        /// The written form of what happened to a job besides a change of state.
        #[derive(Serialize, Deserialize)]
        #[serde(tag = "what", rename_all = "snake_case")]
        enum JobFactRecord {
            $($of_job { $($job_field: <$job_type as Written>::Form),* },)*
        }

        impl From<&Fact> for Record {
            fn from(fact: &Fact) -> Record {
                match fact {
                    $(Fact::$about($of::$kind { $($field),* }) => Record::$tag { $($field: $field.write()),* },)*
                    $(Fact::Job(JobFact::$job_kind { $($job_field),* }) => {
                        Record::OfJob(JobFactRecord::$of_job { $($job_field: $job_field.write()),* })
                    })*
                    Fact::Encounter(EncounterFact::Met(encounter)) => Record::Encountered(encounter.write()),
                    Fact::Noted(note) => Record::FloorNoted(note.write()),
                }
            }
        }

        impl From<Record> for Fact {
            fn from(record: Record) -> Fact {
                match record {
                    $(Record::$tag { $($field),* } => {
                        Fact::$about($of::$kind { $($field: <$type>::read($field)),* })
                    })*
                    $(Record::OfJob(JobFactRecord::$of_job { $($job_field),* }) => {
                        Fact::Job(JobFact::$job_kind { $($job_field: <$job_type>::read($job_field)),* })
                    })*
                    Record::Encountered(encounter) => {
                        Fact::Encounter(EncounterFact::Met(Encounter::read(encounter)))
                    }
                    Record::FloorNoted(note) => Fact::Noted(FloorNote::read(note)),
                }
            }
        }
    };
}

records! {
    of_job {
        Served = Served { job: JobId, tasked: (RobotId, Task), at: Time }
        Chosen = Chosen { job: JobId, choice: RobotChoice, at: Time }
        Line = LineChanged { job: JobId, line: usize, change: LineChange, at: Time }
    }
    rows {
        Enlisted = Robot(RobotFact::Registered) {
            robot: RobotId,
            name: String,
            #[serde(default = "usual_kind", skip_serializing_if = "is_usual_kind")]
            kind: String,
            node: NodeId,
            at: Time
        }
        Tasked = Robot(RobotFact::Tasked) { robot: RobotId, task: Task }
        Failed = Robot(RobotFact::Failed) { robot: RobotId, at: Time }
        Repaired = Robot(RobotFact::Repaired) { robot: RobotId, at: Time }
        Fenced = Robot(RobotFact::Fenced) { robot: RobotId, at: Time }
        Maintenance = Robot(RobotFact::Maintenance) { robot: RobotId, since: Option<Time> }
        Retired = Robot(RobotFact::Retired) { robot: RobotId, at: Time }
        Left = Robot(RobotFact::Left) { robot: RobotId, at: Time }
        Returned = Robot(RobotFact::Returned) { robot: RobotId, kind: String, node: NodeId, at: Time }
        Linked = Robot(RobotFact::Linked) { robot: RobotId, link: String }
        RackTaken = Robot(RobotFact::RackTaken) { robot: RobotId, rack: RackId, node: NodeId, at: Time }

        Routed = Route(RouteFact::Routed) { bookings: Vec<Booking> }
        Granted = Route(RouteFact::Granted) { robot: RobotId, serial: u64, at: Time }
        Passed = Route(RouteFact::Passed) { robot: RobotId, serial: u64 }
        Acted = Route(RouteFact::Acted) { robot: RobotId, serial: u64 }
        Delayed = Route(RouteFact::Retimed) { moved: Vec<Moved> }
        Recalled = Route(RouteFact::Revoked) { robot: RobotId, serial: u64, recalls: u64, at: Time }
        Cut = Route(RouteFact::Truncated) { robots: Vec<KeptRoute> }
        Placed = Route(RouteFact::Placed) {
            robot: RobotId,
            node: NodeId,
            serial: u64,
            #[serde(default, skip_serializing_if = "Vec::is_empty")]
            cut: Vec<KeptRoute>,
            at: Time
        }

        Accepted = Job(JobFact::Accepted) { job: JobId, request: JobRequest, at: Time }
        Progressed = Job(JobFact::Progressed) {
            job: JobId,
            state: JobState,
            #[serde(default, skip_serializing_if = "Option::is_none")]
            tasked: Option<(RobotId, Task)>,
            at: Time
        }
        Prioritised = Job(JobFact::Prioritised) { job: JobId, priority: u8, at: Time }
        JobChanged = Job(JobFact::Changed) {
            job: JobId,
            kind: JobKind,
            priority: u8,
            deadline: Option<Time>,
            at: Time
        }

        Hired = Worker(WorkerFact::Registered) { worker: WorkerId, name: String, at: Time }
        Noted = Worker(WorkerFact::Noted) { worker: WorkerId, place: LastPlace }
        Narrowed = Worker(WorkerFact::Narrowed) { worker: WorkerId, place: LastPlace, by: String, at: Time }
        Cleared = Worker(WorkerFact::Cleared) {
            worker: WorkerId,
            #[serde(default, skip_serializing_if = "Option::is_none")]
            by: Option<String>,
            at: Time
        }
        MovesAs = Worker(WorkerFact::Moves) { worker: WorkerId, mover: Mover, at: Time }

        Assigned = Assignment(AssignmentFact::Assigned) {
            assignment: AssignmentId,
            worker: Option<WorkerId>,
            request: AssignmentRequest,
            at: Time
        }
        Given = Assignment(AssignmentFact::Given) { assignment: AssignmentId, worker: WorkerId, at: Time }
        Advanced = Assignment(AssignmentFact::Advanced) {
            assignment: AssignmentId,
            state: AssignmentState,
            at: Time
        }

        Closed = Area(AreaFact::Closed) {
            closure: ClosureId,
            #[serde(flatten)]
            area: Closure
        }
        Reopened = Area(AreaFact::Reopened) { closure: ClosureId, at: Time }
        Recurs = Area(AreaFact::Recurs) { series: SeriesId, closure: RecurringClosure }
        Scheduled = Area(AreaFact::Scheduled) { series: SeriesId, next: Option<Time> }
        SeriesEnded = Area(AreaFact::SeriesEnded) { series: SeriesId, at: Time }

        Evacuated = Floor(FloorFact::Evacuated) { at: Time }
        EvacuationEnded = Floor(FloorFact::EvacuationEnded) { at: Time }
        Halted = Floor(FloorFact::Halted) { robot: Option<RobotId>, at: Time }
        Released = Floor(FloorFact::Released) { robot: Option<RobotId>, at: Time }
        StationPaused = Floor(FloorFact::StationPaused) { station: StationId, at: Time }
        StationResumed = Floor(FloorFact::StationResumed) { station: StationId, at: Time }
        KeysExpired = Floor(FloorFact::KeysExpired) {
            #[serde(default, skip_serializing_if = "Vec::is_empty")]
            jobs: Vec<JobId>,
            #[serde(default, skip_serializing_if = "Vec::is_empty")]
            assignments: Vec<AssignmentId>
        }
        KindPut = Floor(FloorFact::KindPut) { kind: Box<RobotKind>, at: Time }
        KindRemoved = Floor(FloorFact::KindRemoved) { name: String, at: Time }

        Deviated = Encounter(EncounterFact::Deviated) { worker: WorkerId, at: Time }
        Interrupted = Encounter(EncounterFact::Interrupted) {
            robot: RobotId,
            worker: WorkerId,
            reaction: Reaction,
            at: Time
        }
    }
}

/// The link of robots from before links had names; it is left out of the written form.
pub(super) fn usual_link() -> String {
    USUAL_LINK.to_owned()
}

pub(super) fn is_usual_link(link: &String) -> bool {
    link == USUAL_LINK
}

/// The kind of robots from before there were kinds; it is left out of the written form.
pub(super) fn usual_kind() -> String {
    USUAL_KIND.to_owned()
}

pub(super) fn is_usual_kind(kind: &String) -> bool {
    kind == USUAL_KIND
}
