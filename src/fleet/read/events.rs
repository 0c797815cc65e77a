//! Events: changes of state that other systems follow, as facts tell them.
//!
//! Main types: [`FloorEvent`], [`EventKind`]; [`floor_event`] finds the event of a fact. Refuses: routes and grants,
//! which concern no other system, and to know the state before, which the store of events knows.

use super::robot_events::robot_change;
use crate::state::fact::{AreaFact, AssignmentFact, EncounterFact, Fact, FloorFact, JobFact, WorkerFact};
use crate::state::job::JobState;
use crate::state::note::{EventDetails, FloorNote, ReplanCause};
use giveway_floor::id::{RobotId, WorkerId};
use giveway_floor::time::Time;
use giveway_people::human::Mover;

/// What an event is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum EventKind {
    /// An event about a job.
    Job,
    /// An event about a robot.
    Robot,
    /// An event about the whole fleet.
    Fleet,
    /// An event about a station.
    Station,
    /// An event about a worker.
    Worker,
    /// An event about a worker's assignment.
    Assignment,
    /// An event about a closed area.
    Closure,
    /// An event about an alarm.
    Alarm,
    /// A robot came close to a worker.
    Encounter,
    /// A robot got another route because of a worker, a closure, a broken robot or an obstruction.
    RobotReplanned,
    /// A worker left the path.
    WorkerDeviated,
    /// A worker is most probably going somewhere else than before.
    WorkerGoal,
}

impl EventKind {
    /// All kinds of events.
    pub const ALL: [EventKind; 12] = [
        EventKind::Job,
        EventKind::Robot,
        EventKind::Fleet,
        EventKind::Station,
        EventKind::Worker,
        EventKind::Assignment,
        EventKind::Closure,
        EventKind::Alarm,
        EventKind::Encounter,
        EventKind::RobotReplanned,
        EventKind::WorkerDeviated,
        EventKind::WorkerGoal,
    ];

    /// The word for the kind.
    pub fn word(self) -> &'static str {
        match self {
            EventKind::Job => "job",
            EventKind::Robot => "robot",
            EventKind::Fleet => "fleet",
            EventKind::Station => "station",
            EventKind::Worker => "worker",
            EventKind::Assignment => "assignment",
            EventKind::Closure => "closure",
            EventKind::Alarm => "alarm",
            EventKind::Encounter => "encounter",
            EventKind::RobotReplanned => "robot_replanned",
            EventKind::WorkerDeviated => "worker_deviated",
            EventKind::WorkerGoal => "worker_goal",
        }
    }

    /// Whether such events are successive states of their subject, so that each names the state before.
    pub fn has_states(self) -> bool {
        use EventKind::{Encounter, RobotReplanned, WorkerDeviated, WorkerGoal};
        !matches!(self, Encounter | RobotReplanned | WorkerDeviated | WorkerGoal)
    }

    /// The kind of this word.
    pub fn of_word(word: &str) -> Option<EventKind> {
        EventKind::ALL.into_iter().find(|kind| kind.word() == word)
    }
}

/// Something that happened, for other systems.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FloorEvent {
    /// What the event is about.
    pub kind: EventKind,
    /// The number of the event's subject; nothing for the fleet, and for encounters, which have none.
    pub subject: Option<u64>,
    /// The subject's state since the event, in a word.
    pub new: &'static str,
    /// The robot concerned.
    pub robot: Option<RobotId>,
    /// The worker concerned.
    pub worker: Option<WorkerId>,
    /// When it happened, if the fact says so; otherwise the time of the step counts.
    pub at: Option<Time>,
    /// Further details of the event.
    pub details: Option<EventDetails>,
}

impl FloorEvent {
    fn of(kind: EventKind, subject: Option<u64>, new: &'static str) -> FloorEvent {
        FloorEvent { kind, subject, new, robot: None, worker: None, at: None, details: None }
    }

    fn with_worker(self, worker: Option<WorkerId>) -> FloorEvent {
        FloorEvent { worker, ..self }
    }
}

/// The event that other systems are told for a fact, if any.
pub fn floor_event(fact: &Fact) -> Option<FloorEvent> {
    use EventKind::{Assignment, Closure, Encounter, Fleet, Job, Robot, Station, Worker};
    if let Some((robot, change)) = robot_change(fact) {
        let event = match robot {
            Some(robot) => FloorEvent {
                robot: Some(robot),
                ..FloorEvent::of(Robot, Some(robot.0.into()), change.word())
            },
            None => FloorEvent::of(Fleet, None, change.word()),
        };
        return Some(event);
    }
    let worker = |worker: &WorkerId, new| {
        FloorEvent::of(Worker, Some(u64::from(worker.0)), new).with_worker(Some(*worker))
    };
    Some(match fact {
        Fact::Job(JobFact::Accepted { job, .. }) => {
            FloorEvent::of(Job, Some(job.0), JobState::Waiting.word())
        }
        Fact::Job(JobFact::Progressed { job, state, .. }) => {
            FloorEvent { robot: state.robot(), ..FloorEvent::of(Job, Some(job.0), state.word()) }
        }
        Fact::Job(JobFact::Served { job, tasked: (robot, _), .. }) => {
            let state = JobState::Carrying { robot: *robot };
            FloorEvent { robot: Some(*robot), ..FloorEvent::of(Job, Some(job.0), state.word()) }
        }
        Fact::Job(JobFact::LineChanged { job, .. }) => FloorEvent::of(Job, Some(job.0), "line"),
        Fact::Job(
            JobFact::Prioritised { job, .. } | JobFact::Changed { job, .. } | JobFact::Chosen { job, .. },
        ) => FloorEvent::of(Job, Some(job.0), JobState::Waiting.word()),
        Fact::Floor(FloorFact::StationPaused { station, .. }) => {
            FloorEvent::of(Station, Some(station.0.into()), "paused")
        }
        Fact::Floor(FloorFact::StationResumed { station, .. }) => {
            FloorEvent::of(Station, Some(station.0.into()), "resumed")
        }
        Fact::Floor(FloorFact::Evacuated { .. }) => FloorEvent::of(Fleet, None, "evacuation_began"),
        Fact::Floor(FloorFact::EvacuationEnded { .. }) => FloorEvent::of(Fleet, None, "evacuation_ended"),
        // A worker who is forgotten makes no event.
        Fact::Worker(WorkerFact::Registered { name, .. }) if name.is_empty() => return None,
        Fact::Worker(WorkerFact::Registered { worker: w, .. }) => worker(w, "registered"),
        Fact::Worker(WorkerFact::Noted { worker: w, .. }) => worker(w, "on_floor"),
        Fact::Worker(WorkerFact::Narrowed { worker: w, .. }) => worker(w, "lost_near"),
        Fact::Worker(WorkerFact::Cleared { worker: w, .. }) => worker(w, "left"),
        Fact::Worker(WorkerFact::Moves { worker: w, mover, .. }) => worker(w, moved(mover)),
        Fact::Encounter(EncounterFact::Deviated { worker: w, .. }) => {
            FloorEvent { kind: EventKind::WorkerDeviated, ..worker(w, "deviated") }
        }
        Fact::Noted(note) => of_note(note),
        Fact::Assignment(AssignmentFact::Assigned { assignment, worker, .. }) => {
            FloorEvent::of(Assignment, Some(assignment.0), "waiting").with_worker(*worker)
        }
        Fact::Assignment(AssignmentFact::Given { assignment, worker, .. }) => {
            FloorEvent::of(Assignment, Some(assignment.0), "given").with_worker(Some(*worker))
        }
        Fact::Assignment(AssignmentFact::Advanced { assignment, state, .. }) => {
            FloorEvent::of(Assignment, Some(assignment.0), state.word())
        }
        Fact::Area(AreaFact::Closed { closure, .. }) => FloorEvent::of(Closure, Some(closure.0), "closed"),
        Fact::Area(AreaFact::Reopened { closure, .. }) => {
            FloorEvent::of(Closure, Some(closure.0), "reopened")
        }
        Fact::Encounter(EncounterFact::Met(e)) => FloorEvent {
            robot: Some(e.robot),
            at: Some(e.ended),
            ..FloorEvent::of(Encounter, None, e.reaction.word()).with_worker(Some(e.worker))
        },
        _ => return None,
    })
}

/// What became of a worker who moves as this from now on.
fn moved(mover: &Mover) -> &'static str {
    if *mover == Mover::OnFoot { "on_foot" } else { "in_vehicle" }
}

/// The event of something noted for the record.
fn of_note(note: &FloorNote) -> FloorEvent {
    match note {
        FloorNote::Replanned { robot, cause, was, now, at } => {
            let by = if let ReplanCause::Worker(worker) = cause { Some(*worker) } else { None };
            let details = EventDetails::Replanned { cause: *cause, was: was.clone(), now: now.clone() };
            FloorEvent {
                robot: Some(*robot),
                worker: by,
                at: Some(*at),
                details: Some(details),
                ..FloorEvent::of(EventKind::RobotReplanned, Some(robot.0.into()), cause.word())
            }
        }
        FloorNote::Goal { worker, place, percent, at } => FloorEvent {
            worker: Some(*worker),
            at: Some(*at),
            details: Some(EventDetails::Goal { place: *place, percent: *percent }),
            ..FloorEvent::of(EventKind::WorkerGoal, Some(worker.0.into()), "goal")
        },
    }
}

/// An event as it is stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EventRow {
    /// The number of the event; later events have greater numbers.
    pub seq: i64,
    /// When the event happened.
    pub at: Time,
    /// What the event is about.
    pub kind: EventKind,
    /// The number of the event's subject.
    pub subject: Option<u64>,
    /// The state before the event; nothing if none is known.
    pub old: Option<String>,
    /// The state since the event.
    pub new: String,
    /// The robot concerned.
    pub robot: Option<RobotId>,
    /// The worker concerned.
    pub worker: Option<WorkerId>,
    /// The text of an alarm, or the name of a station that the map no longer has.
    pub text: Option<String>,
    /// The customer's reference of a job.
    pub reference: Option<String>,
    /// Further details of the event.
    pub details: Option<EventDetails>,
}

/// Which events to read: events of some kinds, after a number.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EventQuery {
    /// Only events of these kinds; of all kinds if there are none.
    pub kinds: Vec<EventKind>,
    /// Only events after this number.
    pub after: i64,
    /// How many events at most.
    pub limit: u32,
}

/// Which events are still stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EventSpan {
    /// The number before the first event that is stored; 0 if none was deleted.
    pub before: i64,
    /// The number of the last event that there was; 0 before the first.
    pub last: i64,
}

impl EventSpan {
    /// Whether a reader who has seen everything up to this number misses nothing.
    pub fn follows(&self, after: i64) -> bool {
        (self.before..=self.last).contains(&after)
    }
}
