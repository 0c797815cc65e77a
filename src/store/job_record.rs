//! The written form of jobs and tasks: what is wanted, how far it is, and what a robot does for it.
//!
//! Main types: [`RequestRecord`], [`StateRecord`], [`TaskRecord`]. Refuses: to know of steps.

use super::line_record::OrderRecord;
use giveway_cell::OrderLine;
use giveway_fleet::{
    ClientKey, JobFailure, JobField, JobKind, JobParts, JobRequest, JobState, JobWord, Purpose, RobotChoice,
    Task, Visiting,
};
use giveway_floor::id::{CustomerId, JobId, NodeId, RackId, RobotId, StationId};
use giveway_floor::time::{Span, Time};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What is wanted: an object with one field, whose name is the word for the kind, and whose value has the parts by
/// their words.
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(try_from = "PartsByWord", into = "PartsByWord")]
pub(super) struct KindRecord(JobKind);

/// A station, and the duration of the pick.
pub(super) type StationRecord = (u32, Option<i64>);

/// Which robots may do a job; also a column of the `jobs` table.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum ChoiceRecord {
    Any,
    Except(u32, i64),
    Only(u32, i64),
}

#[derive(Serialize, Deserialize)]
pub(super) struct RequestRecord {
    kind: KindRecord,
    priority: u8,
    deadline: Option<i64>,
    after: Vec<u64>,
    key: Option<String>,
    /// The owner of the key.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    owner: Option<u64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    then: Vec<StationRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    reference: Option<String>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    labels: BTreeMap<String, String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    lines: Vec<Vec<OrderRecord>>,
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
    NoPlaceAside,
    MapChanged,
    RobotGone,
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

/// For the word of a kind, the words of its parts with their numbers.
type PartsByWord = BTreeMap<String, BTreeMap<String, Option<i64>>>;

impl From<KindRecord> for PartsByWord {
    fn from(KindRecord(kind): KindRecord) -> PartsByWord {
        let parts = kind.parts();
        let fields = kind.name().fields().iter();
        let by_word = fields.map(|field| (field.word().to_owned(), parts.number(*field))).collect();
        [(kind.word().to_owned(), by_word)].into()
    }
}

impl TryFrom<PartsByWord> for KindRecord {
    type Error = String;

    fn try_from(record: PartsByWord) -> Result<KindRecord, String> {
        let Some((word, by_word)) = record.into_iter().next() else {
            return Err("a job without a kind".into());
        };
        let name = JobWord::of_word(&word).ok_or_else(|| format!("no kind of job is called {word:?}"))?;
        let mut parts = JobParts::default();
        for (word, number) in by_word {
            if let (Some(field), Some(number)) = (JobField::of_word(&word), number) {
                parts = parts.with_number(field, number);
            }
        }
        let kind = name.with(parts);
        kind.map(KindRecord).map_err(|missing| format!("a {word} job without its {}", missing.word()))
    }
}

impl From<JobKind> for KindRecord {
    fn from(kind: JobKind) -> KindRecord {
        KindRecord(kind)
    }
}

impl From<KindRecord> for JobKind {
    fn from(KindRecord(kind): KindRecord) -> JobKind {
        kind
    }
}

impl From<&JobRequest> for RequestRecord {
    fn from(r: &JobRequest) -> RequestRecord {
        RequestRecord {
            kind: r.kind.into(),
            priority: r.priority,
            deadline: r.deadline.map(|t| t.0),
            after: r.after.iter().map(|j| j.0).collect(),
            key: r.key.as_ref().map(|key| key.text.clone()),
            owner: r.key.as_ref().and_then(|key| key.owner).map(|owner| owner.0),
            then: r.then.iter().map(visit_record).collect(),
            reference: r.reference.clone(),
            labels: r.labels.clone(),
            lines: r.lines.iter().map(|visit| visit.iter().map(OrderRecord::from).collect()).collect(),
        }
    }
}

pub(super) fn visit_record(v: &Visiting) -> StationRecord {
    (v.station.0, v.pick.map(|p| p.0))
}

pub(super) fn visiting((station, pick): StationRecord) -> Visiting {
    Visiting { station: StationId(station), pick: pick.map(Span) }
}

impl From<RobotChoice> for ChoiceRecord {
    fn from(choice: RobotChoice) -> ChoiceRecord {
        match choice {
            RobotChoice::Any => ChoiceRecord::Any,
            RobotChoice::Except(robot, until) => ChoiceRecord::Except(robot.0, until.0),
            RobotChoice::Only(robot, until) => ChoiceRecord::Only(robot.0, until.0),
        }
    }
}

impl From<ChoiceRecord> for RobotChoice {
    fn from(choice: ChoiceRecord) -> RobotChoice {
        match choice {
            ChoiceRecord::Any => RobotChoice::Any,
            ChoiceRecord::Except(robot, until) => RobotChoice::Except(RobotId(robot), Time(until)),
            ChoiceRecord::Only(robot, until) => RobotChoice::Only(RobotId(robot), Time(until)),
        }
    }
}

impl From<RequestRecord> for JobRequest {
    fn from(r: RequestRecord) -> JobRequest {
        JobRequest {
            kind: r.kind.into(),
            priority: r.priority,
            deadline: r.deadline.map(Time),
            after: r.after.into_iter().map(JobId).collect(),
            key: r.key.map(|text| ClientKey { owner: r.owner.map(CustomerId), text }),
            then: r.then.into_iter().map(visiting).collect(),
            reference: r.reference,
            labels: r.labels,
            lines: r.lines.into_iter().map(|v| v.into_iter().map(OrderLine::from).collect()).collect(),
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
            JobFailure::NoPlaceAside => FailureRecord::NoPlaceAside,
            JobFailure::MapChanged => FailureRecord::MapChanged,
            JobFailure::RobotGone => FailureRecord::RobotGone,
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
            FailureRecord::NoPlaceAside => JobFailure::NoPlaceAside,
            FailureRecord::MapChanged => JobFailure::MapChanged,
            FailureRecord::RobotGone => JobFailure::RobotGone,
            FailureRecord::StorageTaken(node) => JobFailure::StorageTaken(NodeId(node)),
        }
    }
}

/// A failure as text, for its own column.
pub(super) fn encode_failure(f: JobFailure) -> String {
    serde_json::to_string(&FailureRecord::from(f)).expect("failures have no maps")
}

/// A failure from its column.
pub(super) fn decode_failure(text: &str) -> Result<JobFailure, serde_json::Error> {
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

#[cfg(test)]
mod tests {
    use super::super::record;
    use super::*;
    use giveway_cell::{LineChange, PickedBy};
    use giveway_fleet::{Fact, JobFact};

    #[test]
    fn facts_of_jobs_and_order_lines_come_back_from_their_records() {
        let (job, robot, at) = (JobId(7), RobotId(2), Time(5));
        let task = Task::Deliver { job, rack: RackId(3), station: NodeId(4), store: NodeId(9) };
        let line = |slot: &str| OrderLine {
            slot: slot.parse().unwrap(),
            quantity: 2,
            tote: "B".into(),
            item: Some("screw \"ü\"".into()),
            by: PickedBy::Arm,
        };
        let kind = JobKind::Deliver { rack: RackId(3), station: StationId(1), pick: None };
        let then = vec![Visiting { station: StationId(0), pick: Some(Span(4)) }];
        let lines = vec![vec![line("C3"), line("A1")], Vec::new()];
        let request = JobRequest { then, lines, ..JobRequest::new(kind) };
        let changes = [LineChange::Done(2), LineChange::Short, LineChange::Undo];
        let mut facts = vec![
            Fact::Job(JobFact::Accepted { job, request, at }),
            Fact::Job(JobFact::Served { job, tasked: (robot, task), at }),
            Fact::Job(JobFact::Chosen { job, choice: RobotChoice::Only(robot, Time(9)), at }),
        ];
        facts.extend(changes.map(|change| Fact::Job(JobFact::LineChanged { job, line: 1, change, at })));
        let text = record::encode(&facts);
        assert_eq!(record::decode(record::VERSION, &text).unwrap(), facts, "{text}");
    }
}
