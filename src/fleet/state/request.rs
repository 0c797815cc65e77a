//! What is asked of the fleet, and what it answers.
//!
//! Main types: [`Request`], nested by what it is about; [`Ask`], a request that knows what its answer looks like;
//! [`Reply`], an [`Answer`] or a [`Refusal`] under the [`Token`] of the request. Refuses: to say how any of it
//! travels.

use crate::state::job::{JobChange, JobRequest};
use crate::state::kind::RobotKind;
use crate::state::recurring::RecurringClosure;
use crate::state::refusal::Refusal;
use crate::state::worker::{AssignmentRequest, Closure};
use giveway_cell::{LineChange, LineOutcome, LineState};
use giveway_floor::geometry::Spot;
use giveway_floor::id::{
    AssignmentId, BodyId, ClosureId, JobId, NodeId, RackId, RobotId, SeriesId, StationId, WorkerId,
};
use giveway_people::human::Mover;

/// A source of requests: the driver gives each of its sources its own number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Asker(pub u8);

impl Asker {
    /// The clients of a server. All other numbers are up to the driver.
    pub const CLIENTS: Asker = Asker(0);
}

/// Identifies a request, so that the driver can hand the answer on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Token {
    /// Where the request comes from.
    pub asker: Asker,
    /// The number of the request among those of its source. Not unique if the source awaits no answers.
    pub number: u64,
}

impl From<u64> for Token {
    /// The token of a client's request.
    fn from(number: u64) -> Token {
        Token { asker: Asker::CLIENTS, number }
    }
}

/// Something asked of the fleet.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// A request about jobs.
    Job(JobAction),
    /// A request about robots, and racks on robots.
    Robot(RobotAction),
    /// The person at a station reports how picking goes there.
    Station(StationId, StationOrder),
    /// A request about workers and their assignments.
    Worker(WorkerAction),
    /// A request about the floor: areas, the building, and whether robots drive.
    Floor(FloorAction),
}

/// What customers and operators want of jobs.
#[derive(Clone, Debug, PartialEq)]
pub enum JobAction {
    /// A job is to be done.
    Submit(JobRequest),
    /// Several jobs are to be done. Each is accepted or refused by itself; the accepted ones are durable together.
    SubmitBatch(Vec<JobRequest>),
    /// A job is no longer wanted.
    Cancel(JobId),
    /// A job that no robot has yet is to be changed.
    Change(JobId, JobChange),
    /// A job is to be done by this robot or, if none is named, by any other than the one that has it.
    Reassign(JobId, Option<RobotId>),
}

/// What is to be done with a robot.
#[derive(Clone, Debug, PartialEq)]
pub enum RobotAction {
    /// A robot joins the fleet.
    Register {
        /// The robot's name.
        name: String,
        /// The name of the robot's kind, one of the ledger's.
        kind: String,
        /// Where the robot stands.
        node: NodeId,
        /// The name of the link over which the robot is reached; nothing if there is only one.
        link: Option<String>,
    },
    /// A robot goes to maintenance.
    BeginMaintenance(RobotId),
    /// A robot comes back from maintenance, or does not leave the floor after all.
    EndMaintenance(RobotId),
    /// A robot is to leave the floor.
    Retire(RobotId),
    /// People took a rack off a robot that cannot drive, and set it down.
    TakeRack {
        /// The rack.
        rack: RackId,
        /// The storage node where it stands now.
        node: NodeId,
    },
}

/// What a station reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StationOrder {
    /// The pick is done.
    Done,
    /// The pick has ended, but goods were missing.
    Short,
    /// Picking is paused until further notice.
    Pause,
    /// Picking goes on.
    Resume,
    /// The rack may leave: the lines that are left are short.
    Release,
    /// A report about a line of the visit, counted from 0; of the visit before, if its last line is not confirmed yet
    /// and no other rack is there.
    Line(usize, LineChange),
    /// A report about the line that was not confirmed when its rack left at the last grasp.
    Last(LineChange),
}

/// What is to be done about a worker, and what a worker is to do.
#[derive(Clone, Debug, PartialEq)]
pub enum WorkerAction {
    /// A worker of this name is to be known; a name that is known already makes no second worker.
    Register(String),
    /// A worker is on foot or in a vehicle from now on.
    MoveAs(WorkerId, Mover),
    /// A worker who is not on the floor and has nothing to do is to be forgotten: the place is free for another one.
    Forget(WorkerId),
    /// A worker has left the floor, or a supervisor vouches that no one is where a worker was lost.
    Clear {
        /// The worker.
        worker: WorkerId,
        /// The person who says so.
        by: String,
    },
    /// A supervisor vouches for where a lost worker is.
    Narrow {
        /// The worker.
        worker: WorkerId,
        /// The person who says so.
        by: String,
        /// About where the worker is.
        at: Spot,
        /// How far from there the worker is at most, on foot, millimetres.
        within_mm: i64,
    },
    /// A worker's headset was taken off, or its page closed, on purpose.
    SignOff(WorkerId),
    /// A worker is to do something.
    Assign {
        /// The worker; nothing for the nearest free one.
        worker: Option<WorkerId>,
        /// What the worker is to do.
        request: AssignmentRequest,
    },
    /// An assignment is no longer wanted.
    Unassign(AssignmentId),
    /// A worker reports an assignment as done.
    Finish(WorkerId, AssignmentId),
}

/// What is to hold on the floor.
#[derive(Clone, Debug, PartialEq)]
pub enum FloorAction {
    /// Robots are to keep out of an area.
    Close(Closure),
    /// A closure is to end: robots may route through the area again.
    Reopen(ClosureId),
    /// An area is to be closed again and again.
    Recur(RecurringClosure),
    /// A closure is to stop recurring, and its occurrences end.
    EndSeries(SeriesId),
    /// All people are to leave the building: robots clear the ways out, and stand.
    Evacuate,
    /// The evacuation is over.
    EndEvacuation,
    /// One robot, or the whole fleet, is to stand until it is released.
    Halt(Option<RobotId>),
    /// The robot, or the whole fleet, may go on.
    Release(Option<RobotId>),
    /// Robots of this kind may join; it replaces the added kind of the same name. The caller has checked that the floor
    /// was drawn for it ([`giveway_floor::warehouse::Warehouse::check_body`]), which takes too long for a step.
    PutKind(Box<RobotKind>),
    /// No robots of the added kind of this name may join any more.
    RemoveKind(String),
}

impl Request {
    /// Whether a person halts robots or releases them.
    pub fn is_by_hand(&self) -> bool {
        matches!(self, Request::Floor(FloorAction::Halt(_) | FloorAction::Release(_)))
    }
}

impl From<JobAction> for Request {
    fn from(action: JobAction) -> Request {
        Request::Job(action)
    }
}

impl From<RobotAction> for Request {
    fn from(action: RobotAction) -> Request {
        Request::Robot(action)
    }
}

impl From<WorkerAction> for Request {
    fn from(action: WorkerAction) -> Request {
        Request::Worker(action)
    }
}

impl From<FloorAction> for Request {
    fn from(action: FloorAction) -> Request {
        Request::Floor(action)
    }
}

/// Something that exists now, or did before: the same name or client key makes no second one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Made<Id> {
    /// The number of the job, robot, worker, assignment or kind.
    pub id: Id,
    /// Whether this request made it.
    pub new: bool,
}

/// What became of a report about a line of a visit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineNoted {
    /// The job.
    pub job: JobId,
    /// The line's number in the visit, from 0.
    pub line: usize,
    /// Whether the report changed anything: what was confirmed before is counted once.
    pub outcome: LineOutcome,
    /// How far the line has come.
    pub state: LineState,
    /// Pieces in the tote.
    pub pieces: u32,
}

/// A job that is accepted, or was before; or why it is refused.
pub type JobTaken = Result<Made<JobId>, Refusal>;

/// What the fleet answers if it does not refuse.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The request is fulfilled.
    Done,
    /// The job is accepted.
    Job(Made<JobId>),
    /// What became of several jobs, in their order.
    Jobs(Vec<JobTaken>),
    /// The robot has joined.
    Robot(Made<RobotId>),
    /// The worker is known.
    Worker(Made<WorkerId>),
    /// The assignment is accepted.
    Assignment(Made<AssignmentId>),
    /// The area is closed.
    Closure(ClosureId),
    /// The area is closed again and again.
    Series(SeriesId),
    /// The report about a line is noted.
    Line(LineNoted),
    /// Robots of the kind may join.
    Kind(Made<BodyId>),
}

/// The fleet's response to a request.
pub type Answered = Result<Answer, Refusal>;

/// The answer to a request. It may be sent once the facts of its step are durable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reply {
    /// The token of the request.
    pub token: Token,
    /// What came of the request.
    pub answer: Answered,
}

/// A request that knows the form of its answer.
#[derive(Clone, Debug)]
pub struct Ask<A> {
    /// What is asked.
    pub request: Request,
    read: fn(Answer) -> Option<A>,
}

impl<A> Ask<A> {
    fn new(request: impl Into<Request>, read: fn(Answer) -> Option<A>) -> Ask<A> {
        Ask { request: request.into(), read }
    }

    /// Reads the answer to this request; nothing if the answer has another form, which is a fault of the fleet.
    pub fn read(&self, answer: Answer) -> Option<A> {
        (self.read)(answer)
    }
}

/// Reads one variant of [`Answer`].
macro_rules! reads {
    ($variant:ident) => {
        |answer| if let Answer::$variant(it) = answer { Some(it) } else { None }
    };
}

impl Ask<Made<JobId>> {
    /// Asks for a job to be done.
    pub fn submit(request: JobRequest) -> Self {
        Ask::new(JobAction::Submit(request), reads!(Job))
    }
}

impl Ask<Vec<JobTaken>> {
    /// Asks for several jobs to be done.
    pub fn submit_batch(requests: Vec<JobRequest>) -> Self {
        Ask::new(JobAction::SubmitBatch(requests), reads!(Jobs))
    }
}

impl Ask<Made<RobotId>> {
    /// Asks for a robot to join the fleet.
    pub fn register_robot(name: String, kind: String, node: NodeId, link: Option<String>) -> Self {
        Ask::new(RobotAction::Register { name, kind, node, link }, reads!(Robot))
    }
}

impl Ask<Made<WorkerId>> {
    /// Asks for a worker to be known.
    pub fn register_worker(name: String) -> Self {
        Ask::new(WorkerAction::Register(name), reads!(Worker))
    }
}

impl Ask<Made<AssignmentId>> {
    /// Asks for a worker to do something.
    pub fn assign(worker: Option<WorkerId>, request: AssignmentRequest) -> Self {
        Ask::new(WorkerAction::Assign { worker, request }, reads!(Assignment))
    }
}

impl Ask<ClosureId> {
    /// Asks for robots to keep out of an area.
    pub fn close(area: Closure) -> Self {
        Ask::new(FloorAction::Close(area), reads!(Closure))
    }
}

impl Ask<SeriesId> {
    /// Asks for an area to be closed again and again.
    pub fn recur(closure: RecurringClosure) -> Self {
        Ask::new(FloorAction::Recur(closure), reads!(Series))
    }
}

impl Ask<Made<BodyId>> {
    /// Asks for robots of a kind to join from now on; the floor was drawn for the kind.
    pub fn put_kind(kind: RobotKind) -> Self {
        Ask::new(FloorAction::PutKind(Box::new(kind)), reads!(Kind))
    }
}

impl Ask<LineNoted> {
    /// Reports something about this line of the visit at a station, or about the last line of the visit before.
    pub fn line(station: StationId, line: Option<usize>, change: LineChange) -> Self {
        let order = line.map_or(StationOrder::Last(change), |line| StationOrder::Line(line, change));
        Ask::new(Request::Station(station, order), reads!(Line))
    }
}

/// Requests whose only answer is that they are fulfilled.
impl Ask<()> {
    fn done(request: impl Into<Request>) -> Self {
        Ask::new(request, |answer| matches!(answer, Answer::Done).then_some(()))
    }

    /// Asks for a job to be cancelled.
    pub fn cancel(job: JobId) -> Self {
        Ask::done(JobAction::Cancel(job))
    }

    /// Asks for a job that no robot has yet to be changed.
    pub fn change(job: JobId, change: JobChange) -> Self {
        Ask::done(JobAction::Change(job, change))
    }

    /// Asks for a job to be done by this robot or, without one, by any other than the one that has it.
    pub fn reassign(job: JobId, robot: Option<RobotId>) -> Self {
        Ask::done(JobAction::Reassign(job, robot))
    }

    /// Asks for a robot to go to maintenance.
    pub fn begin_maintenance(robot: RobotId) -> Self {
        Ask::done(RobotAction::BeginMaintenance(robot))
    }

    /// Asks for a robot to come back from maintenance.
    pub fn end_maintenance(robot: RobotId) -> Self {
        Ask::done(RobotAction::EndMaintenance(robot))
    }

    /// Asks for a robot to leave the floor.
    pub fn retire(robot: RobotId) -> Self {
        Ask::done(RobotAction::Retire(robot))
    }

    /// Reports that people took a rack off a robot and set it down.
    pub fn take_rack(rack: RackId, node: NodeId) -> Self {
        Ask::done(RobotAction::TakeRack { rack, node })
    }

    /// Reports something from a station; for a line, what became of the report does not matter.
    pub fn station(station: StationId, order: StationOrder) -> Self {
        let is_so = |answer| matches!(answer, Answer::Done | Answer::Line(_)).then_some(());
        Ask::new(Request::Station(station, order), is_so)
    }

    /// Asks for a worker to be forgotten.
    pub fn forget_worker(worker: WorkerId) -> Self {
        Ask::done(WorkerAction::Forget(worker))
    }

    /// Asks for a worker to count as on foot or in a vehicle.
    pub fn move_as(worker: WorkerId, mover: Mover) -> Self {
        Ask::done(WorkerAction::MoveAs(worker, mover))
    }

    /// Reports that a supervisor vouches that no one is where a worker was lost.
    pub fn clear_worker(worker: WorkerId, by: String) -> Self {
        Ask::done(WorkerAction::Clear { worker, by })
    }

    /// Reports that a supervisor vouches that a lost worker is within this many millimetres of a place, on foot.
    pub fn narrow_worker(worker: WorkerId, (at, within_mm): (Spot, i64), by: String) -> Self {
        Ask::done(WorkerAction::Narrow { worker, by, at, within_mm })
    }

    /// Reports that a worker's headset was taken off on purpose.
    pub fn sign_off(worker: WorkerId) -> Self {
        Ask::done(WorkerAction::SignOff(worker))
    }

    /// Asks for an assignment to be cancelled.
    pub fn unassign(assignment: AssignmentId) -> Self {
        Ask::done(WorkerAction::Unassign(assignment))
    }

    /// Reports that a worker is done with an assignment.
    pub fn finish(worker: WorkerId, assignment: AssignmentId) -> Self {
        Ask::done(WorkerAction::Finish(worker, assignment))
    }

    /// Asks for a closure to end.
    pub fn reopen(closure: ClosureId) -> Self {
        Ask::done(FloorAction::Reopen(closure))
    }

    /// Asks for a closure to recur no more.
    pub fn end_series(series: SeriesId) -> Self {
        Ask::done(FloorAction::EndSeries(series))
    }

    /// Asks for all people to leave the building.
    pub fn evacuate() -> Self {
        Ask::done(FloorAction::Evacuate)
    }

    /// Asks for the evacuation to end.
    pub fn end_evacuation() -> Self {
        Ask::done(FloorAction::EndEvacuation)
    }

    /// Asks for one robot, or the whole fleet, to stand.
    pub fn halt(robot: Option<RobotId>) -> Self {
        Ask::done(FloorAction::Halt(robot))
    }

    /// Asks for one robot, or the whole fleet, to be released.
    pub fn release(robot: Option<RobotId>) -> Self {
        Ask::done(FloorAction::Release(robot))
    }

    /// Asks for robots of an added kind to join no more.
    pub fn remove_kind(name: String) -> Self {
        Ask::done(FloorAction::RemoveKind(name))
    }
}
