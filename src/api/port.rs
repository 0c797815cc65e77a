//! What the API needs from the program that runs it: durable lists to read, a queue for requests, a clock, and the
//! fleet's view.
//!
//! Main types: [`Records`], [`QueuedRequest`], [`Question`], [`TokenPort`],
//! [`Moment`], [`SharedHistory`], [`Now`]. Refuses: to know what answers.

use super::audit::{AuditEntry, AuditQuery};
use super::caller::{NamedToken, TokenHash, WebSession};
use giveway_fleet::alarm::{Alarm, AlarmQuery};
use giveway_fleet::history::{History, LoopTimes};
use giveway_fleet::{
    Answered, Area, AssignmentQuery, AssignmentRow, Backlog, ClosingEffect, Closure, EncounterQuery,
    EncounterRow, EventQuery, EventRow, EventSpan, Expected, Fleet, JobQuery, JobRow, Listed, NodeOccupancy,
    Request, RobotEventQuery, RobotEventRow, RobotJobCounts, ShiftRows, View, Waiting,
};
use giveway_floor::id::{AssignmentId, JobId, RobotId};
use giveway_floor::time::{Span, Time};
use std::pin::Pin;
use std::sync::{Arc, Mutex};
use tokio::sync::{oneshot, watch};

/// An answer that comes later.
pub type Later<'a, T> = Pin<Box<dyn Future<Output = T> + Send + 'a>>;

/// Reads the clock of the program that runs the API.
pub type Now = Arc<dyn Fn() -> Time + Send + Sync>;

/// Durable lists. Errors are texts for people: what happened and what to do.
pub trait Records: Send + Sync {
    /// One job.
    fn job(&self, id: JobId) -> Later<'_, Result<Option<JobRow>, String>>;
    /// Some jobs, newest first.
    fn jobs(&self, filter: JobQuery) -> Later<'_, Result<Listed<JobRow, JobId>, String>>;
    /// One assignment.
    fn assignment(&self, id: AssignmentId) -> Later<'_, Result<Option<AssignmentRow>, String>>;
    /// Some assignments, newest first.
    fn assignments(
        &self,
        filter: AssignmentQuery,
    ) -> Later<'_, Result<Listed<AssignmentRow, AssignmentId>, String>>;
    /// Some alarms, active or past, newest first.
    fn alarms(&self, filter: AlarmQuery) -> Later<'_, Result<Vec<Alarm>, String>>;
    /// Some encounters, newest first.
    fn encounters(&self, filter: EncounterQuery) -> Later<'_, Result<Listed<EncounterRow, i64>, String>>;
    /// What happened to a robot, newest first.
    fn robot_events(&self, filter: RobotEventQuery) -> Later<'_, Result<Vec<RobotEventRow>, String>>;
    /// What became of the jobs of a robot.
    fn robot_jobs(&self, robot: RobotId) -> Later<'_, Result<RobotJobCounts, String>>;
    /// Some events, in order; none where a recording is shown.
    fn events(&self, _: EventQuery) -> Later<'_, Result<Vec<EventRow>, String>> {
        Box::pin(async { Ok(Vec::new()) })
    }
    /// What the lists say about the time from one moment to another; what is not over lasts until the last of these.
    fn shift(&self, between: (Time, Time), now: Time) -> Later<'_, Result<ShiftRows, String>>;
    /// Which events are kept.
    fn event_span(&self) -> Later<'_, Result<EventSpan, String>> {
        Box::pin(async { Ok(EventSpan::default()) })
    }
    /// Changes when there may be new events.
    fn events_changed(&self) -> watch::Receiver<()> {
        watch::channel(()).1
    }
    /// Who asked to change something, newest first; nobody where a recording is shown.
    fn audit(&self, _: AuditQuery) -> Later<'_, Result<Vec<AuditEntry>, String>> {
        Box::pin(async { Ok(Vec::new()) })
    }
    /// How often what was asked, as the audit has it, and done, from one moment to another; nothing where a recording
    /// is shown.
    fn acts(&self, _: (Time, Time)) -> Later<'_, Result<Vec<(String, u64)>, String>> {
        Box::pin(async { Ok(Vec::new()) })
    }
}

/// Keeps named tokens and sessions. What it answers is in force already. Errors are texts for people.
pub trait TokenPort: Send + Sync {
    /// All tokens, also those that no longer hold, in the order in which they were added.
    fn list(&self) -> Later<'_, Result<Vec<NamedToken>, String>>;
    /// Adds one whose number, and time of making, are not known yet; nothing where another one of its name holds.
    fn add(&self, new: NamedToken) -> Later<'_, Result<Option<NamedToken>, String>>;
    /// Revokes one. Whether there was such a one that was not revoked.
    fn revoke(&self, id: i64) -> Later<'_, Result<bool, String>>;
    /// Puts another token, known by its digest, in the place of one that holds; nothing where there is no such one.
    fn rotate(&self, id: i64, hash: TokenHash) -> Later<'_, Result<Option<NamedToken>, String>>;
    /// Begins a session.
    fn sign_in(&self, session: WebSession) -> Later<'_, Result<(), String>>;
    /// Ends one.
    fn sign_out(&self, hash: TokenHash) -> Later<'_, Result<(), String>>;
}

/// A request that is to be carried out once.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct KeyedRequest {
    /// Who asked; keys of different callers have nothing to do with one another.
    pub caller: String,
    /// The route.
    pub route: String,
    /// The key.
    pub key: String,
}

/// An answer that is kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeptAnswer {
    /// Its status.
    pub status: u16,
    /// Where what was made is.
    pub location: Option<String>,
    /// Its body, JSON.
    pub body: String,
}

/// What is known of a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum KnownRequest {
    /// Nothing: it is noted now that it has begun.
    New,
    /// It came before with another body.
    Other,
    /// It is being carried out.
    Running,
    /// It had begun when the server ended, or its answer was that nobody knows.
    Unknown,
    /// It came before, with this answer.
    Answered(KeptAnswer),
}

/// Keeps the answers to requests that are to be carried out once. Errors are texts for people.
pub trait AnswerPort: Send + Sync {
    /// What is known of a request whose body has this digest. If nothing is, it is noted that it begins.
    fn begin(
        &self,
        request: KeyedRequest,
        digest: String,
        now: Time,
    ) -> Later<'_, Result<KnownRequest, String>>;
    /// Keeps the answer of a request that began.
    fn finish(&self, request: KeyedRequest, answer: KeptAnswer) -> Later<'_, ()>;
    /// Forgets a request that came to nothing: it may be tried again.
    fn forget(&self, request: KeyedRequest) -> Later<'_, ()>;
    /// Leaves open what came of a request.
    fn leave(&self, request: &KeyedRequest);
}

/// A request on its way to the fleet.
#[derive(Debug)]
pub struct QueuedRequest {
    /// What is asked.
    pub request: Request,
    /// Who asks, and as what it is written down.
    pub by: Arc<AuditEntry>,
    /// Gets the answer once it is durable.
    pub reply: oneshot::Sender<Answered>,
}

/// What is too much to be in every view: the thread that owns the fleet works it out on request, from the fleet as it
/// is then. Questions change nothing, and a replay answers them, too.
#[derive(Debug)]
pub enum Question {
    /// Why a robot does not go on.
    Robot(RobotId, oneshot::Sender<WaitChain>),
    /// Why a job does not go on.
    Job(JobId, oneshot::Sender<WaitChain>),
    /// What closing an area would do.
    Closing(Closure, oneshot::Sender<AnswerAt<ClosingEffect>>),
    /// What holds the nodes of an area, for so long ahead.
    Occupancy(Area, Span, oneshot::Sender<AnswerAt<Result<Vec<NodeOccupancy>, usize>>>),
}

/// A wait chain, link by link.
pub type WaitChain = AnswerAt<Vec<Waiting>>;

/// An answer, and when it was so.
#[derive(Clone, Debug, PartialEq)]
pub struct AnswerAt<T> {
    /// When.
    pub at: Time,
    /// What.
    pub what: T,
}

impl Question {
    /// Answers it; a receiver that is gone is no error.
    pub fn answer(self, fleet: &Fleet, at: Time) {
        match self {
            Question::Robot(robot, reply) => {
                let _ = reply.send(AnswerAt { at, what: fleet.waits(robot, at) });
            }
            Question::Job(job, reply) => {
                let _ = reply.send(AnswerAt { at, what: fleet.job_waits(job, at) });
            }
            Question::Closing(area, reply) => {
                let _ = reply.send(AnswerAt { at, what: fleet.effect_of_closing(&area, at) });
            }
            Question::Occupancy(area, ahead, reply) => {
                let _ = reply.send(AnswerAt { at, what: fleet.occupancy(area, ahead, at) });
            }
        }
    }
}

/// How many questions may wait.
pub const QUESTIONS: usize = 64;

/// How many questions are answered between two steps: robots come first.
pub const QUESTIONS_AT_ONCE: usize = 4;

/// The fleet at one moment, with what the loop measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moment {
    /// The view.
    pub view: View,
    /// How many robots have said nothing yet, and may still: a robot that was switched off is known to be silent after
    /// a while. Nothing before the first view.
    pub unheard: Option<usize>,
    /// Seconds since the server started.
    pub time_s: f64,
    /// What the loop measured.
    pub measured: LoopFigures,
    /// Where people may be in the coming seconds, as it was half a second ago at most.
    pub forecasts: Arc<Vec<Expected>>,
    /// The first of the jobs that wait, as they were a second ago at most; nothing where no past is kept.
    pub backlog: Arc<Backlog>,
}

/// Figures of the loop over the last minutes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoopFigures {
    /// Racks served per hour, over the last ten minutes.
    pub deliveries_per_hour: f64,
    /// Length of a search for a route, median, microseconds.
    pub plan_us_p50: u64,
    /// The same, 99th percentile.
    pub plan_us_p99: u64,
    /// Step time, 99th percentile, microseconds.
    pub step_us_p99: u64,
}

/// Figures over time, which one task keeps and others read.
#[derive(Debug)]
pub struct SharedHistory {
    /// When the clock of the live feed was zero.
    pub started: Time,
    /// How the fleet deals with people, in a word.
    pub arm: &'static str,
    history: Mutex<History>,
}

impl SharedHistory {
    /// With what was kept of earlier runs.
    pub fn new(started: Time, arm: &'static str, history: History) -> SharedHistory {
        SharedHistory { started, arm, history: Mutex::new(history) }
    }

    /// Takes a view in.
    pub fn note(&self, view: &View, times: &LoopTimes) {
        self.history.lock().expect("nobody panics with this lock").note(view, times);
    }

    /// Looks at them.
    pub fn with<T>(&self, look: impl FnOnce(&History) -> T) -> T {
        look(&self.history.lock().expect("nobody panics with this lock"))
    }
}
