//! Rows of a recording for requests and observations that have no field of their own in a line.
//!
//! Main type: [`RequestRow`]. It reads older spellings and never writes them. Refuses: to know who gets a reply: in
//! playback there is no requester.

use super::arm_row::ArmRow;
use super::hand_row::HandsRow;
use super::job_line::{ChangeLine, JobLine};
use super::kind_row::KindRow;
use super::said_row::Says;
use giveway_fleet::{
    Asker, AssignmentRequest, Binds, ClientKey, Closure, FloorAction, Input, JobAction, JobChange,
    JobRequest, LinkReach, LinkState, LocalClock, ObeyedLimits, Recurrence, RecurringClosure, Request,
    RobotAction, Token, USUAL_KIND, Weekdays, WorkerAction,
};
use giveway_floor::geometry::Spot;
use giveway_floor::id::{
    AssignmentId, ClosureId, CustomerId, JobId, NodeId, RackId, RobotId, SeriesId, StationId, WorkerId,
};
use giveway_floor::text::Sentence;
use giveway_floor::time::{Span, Time, Window};
use giveway_people::human::{Mover, Vehicle};
use serde::{Deserialize, Serialize};

/// Number of low bits of a token; the asker is above them.
const ASKER_BITS: u32 = 56;

/// A request, with its token first.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum RequestRow {
    #[serde(rename = "enlist")]
    Register(String, u32),
    /// Registers a robot of a kind other than the usual one.
    #[serde(rename = "enlist_as")]
    RegisterAs(String, u32, String),
    /// Registers a robot of any kind, with the name of its link.
    #[serde(rename = "enlist_at")]
    RegisterAt(String, u32, String, String),
    /// Robot, whether it is connected, how many visits it holds, why it takes no orders.
    Link(u32, bool, Option<usize>, Option<String>),
    /// Robot, whether messages get through, how many visits it holds, why it takes no orders, the most that it obeys
    /// of speed limits, and the stop at which it failed.
    Linked(u32, String, Option<usize>, Option<String>, String, Option<u64>),
    Maintain(u64, u32, bool),
    Retire(u64, u32),
    TakeRack(u64, u32, u32),
    Submit(JobLine),
    /// Token, and job lines whose own tokens are ignored.
    SubmitBatch(u64, Vec<JobLine>),
    Cancel(u64, u64),
    #[serde(rename = "hire")]
    RegisterWorker(u64, String),
    /// Token, worker, the figures of the worker's vehicle in whole millimetres.
    MoveAs(u64, u32, Option<[i64; 6]>),
    ForgetWorker(u64, u32),
    Clear(u64, u32),
    ClearedBy(u64, u32, String),
    Narrow(NarrowRow),
    SignedOff(u64, u32),
    Assign(AssignRow),
    Unassign(u64, u64),
    Finish(u64, u32, u64),
    Close(CloseRow),
    Reopen(u64, u64),
    Recur(u64, RecurLine),
    EndSeries(u64, u64),
    Evacuate(u64),
    EndEvacuation(u64),
    Halt(u64, Option<u32>),
    Release(u64, Option<u32>),
    PutKind(u64, KindRow),
    RemoveKind(u64, String),
    /// From versions in which only the priority could be changed.
    Prioritise(u64, u64, u8),
    Change(u64, u64, ChangeLine),
    Reassign(u64, u64, Option<u32>),
    /// Token, station, the station's request.
    Station(u64, u32, Says),
    Hands(HandsRow),
    /// Station, true end of the current visit.
    VisitEnds(u32, i64),
    Arm(ArmRow),
}

/// A statement about where a lost worker is.
#[derive(Serialize, Deserialize)]
pub(super) struct NarrowRow {
    token: u64,
    worker: u32,
    by: String,
    at: (i64, i64),
    within: i64,
}

/// An assignment for a worker.
#[derive(Serialize, Deserialize)]
pub(super) struct AssignRow {
    token: u64,
    worker: Option<u32>,
    place: u32,
    stay: i64,
    what: String,
    key: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    owner: Option<u64>,
}

/// An area that is closed; times in microseconds.
#[derive(Serialize, Deserialize)]
pub(super) struct CloseRow {
    token: u64,
    outline: Vec<(i64, i64)>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    nodes: Vec<u32>,
    from: i64,
    until: i64,
    reason: String,
    /// Absent in recordings from before people could be kept out: only robots are.
    #[serde(default = "robots", skip_serializing_if = "is_robots")]
    binds: String,
}

/// A recurring closure, times in microseconds; `from` and `until` are those of the first occurrence.
#[derive(Serialize, Deserialize)]
pub(super) struct RecurLine {
    outline: Vec<(i64, i64)>,
    nodes: Vec<u32>,
    /// Beginning of the first occurrence.
    from: i64,
    until: i64,
    reason: String,
    binds: String,
    every: i64,
    weekdays: u8,
    /// Offset ahead of UTC before the clocks first change.
    utc_offset: i64,
    /// The time zone, and when its clocks change to which offset.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    zone: Option<(String, Vec<(i64, i64)>)>,
    /// End of the recurrence.
    last: i64,
    /// Beginning of the next occurrence, if that is not the first one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    next: Option<i64>,
}

/// A token as recordings write it: the asker in the top eight bits.
fn number_of(token: Token) -> u64 {
    u64::from(token.asker.0) << ASKER_BITS | token.number
}

/// The token of a number. Recordings of earlier versions have other bits in place of the asker; replies in playback
/// reach no requester.
fn token_of(number: u64) -> Token {
    Token { asker: Asker((number >> ASKER_BITS) as u8), number: number & ((1 << ASKER_BITS) - 1) }
}

impl RequestRow {
    /// The row of a request.
    pub fn of(token: Token, request: &Request) -> RequestRow {
        let token = number_of(token);
        match request {
            Request::Job(action) => asked_of_job(token, action),
            Request::Robot(action) => asked_of_robot(token, action),
            Request::Station(station, order) => RequestRow::Station(token, station.0, (*order).into()),
            Request::Worker(action) => asked_of_worker(token, action),
            Request::Floor(action) => asked_of_floor(token, action),
        }
    }

    /// The row for the state of a robot's link.
    pub fn link(robot: RobotId, state: &LinkState) -> RequestRow {
        let LinkState { reach, capacity, ref refuses, limits, failed_stop } = *state;
        let refuses = refuses.as_ref().map(Sentence::kept);
        match (reach, limits, failed_stop) {
            (LinkReach::ByReports | LinkReach::Lost, ObeyedLimits::Speeds, None) => {
                RequestRow::Link(robot.0, reach.is_up(), capacity, refuses)
            }
            _ => {
                let [reach, limits] = [reach.word(), limits.word()].map(str::to_owned);
                RequestRow::Linked(robot.0, reach, capacity, refuses, limits, failed_stop)
            }
        }
    }

    /// The input of this row.
    pub fn input(self) -> Input {
        let ask = |token, request| Input::ask(token_of(token), request);
        match self {
            RequestRow::Register(name, node) => joins((name, USUAL_KIND.to_owned(), None), node),
            RequestRow::RegisterAs(name, node, kind) => joins((name, kind, None), node),
            RequestRow::RegisterAt(name, node, kind, link) => joins((name, kind, Some(link)), node),
            RequestRow::Link(robot, connected, capacity, refuses) => {
                linked(robot, (reach_before(connected), capacity, refuses), (ObeyedLimits::Speeds, None))
            }
            RequestRow::Linked(robot, reach, capacity, refuses, limits, failed_stop) => {
                linked(robot, (reach_of(&reach), capacity, refuses), (limits_of(&limits), failed_stop))
            }
            RequestRow::Maintain(token, robot, begins) => ask(token, maintained(robot, begins).into()),
            RequestRow::Retire(token, robot) => ask(token, RobotAction::Retire(RobotId(robot)).into()),
            RequestRow::TakeRack(token, rack, node) => {
                ask(token, RobotAction::TakeRack { rack: RackId(rack), node: NodeId(node) }.into())
            }
            RequestRow::Halt(token, robot) => ask(token, FloorAction::Halt(robot.map(RobotId)).into()),
            RequestRow::Release(token, robot) => ask(token, FloorAction::Release(robot.map(RobotId)).into()),
            RequestRow::PutKind(token, row) => ask(token, row.action().into()),
            RequestRow::RemoveKind(token, name) => ask(token, FloorAction::RemoveKind(name).into()),
            RequestRow::Prioritise(token, job, priority) => {
                let change = JobChange { priority: Some(priority), ..JobChange::default() };
                ask(token, JobAction::Change(JobId(job), change).into())
            }
            RequestRow::Reassign(token, job, robot) => {
                ask(token, JobAction::Reassign(JobId(job), robot.map(RobotId)).into())
            }
            RequestRow::Change(token, job, change) => {
                ask(token, JobAction::Change(JobId(job), change.into()).into())
            }
            RequestRow::Station(token, station, order) => {
                ask(token, Request::Station(StationId(station), order.into()))
            }
            RequestRow::Hands(row) => Input::Hands(row.into()),
            RequestRow::Arm(row) => Input::Arm(row.into()),
            RequestRow::VisitEnds(station, at) => {
                Input::VisitEnds { station: StationId(station), at: Time(at) }
            }
            RequestRow::Cancel(token, job) => ask(token, JobAction::Cancel(JobId(job)).into()),
            RequestRow::RegisterWorker(token, name) => ask(token, WorkerAction::Register(name).into()),
            RequestRow::MoveAs(token, worker, figures) => ask(token, moves_as(worker, figures).into()),
            RequestRow::ForgetWorker(token, worker) => ask(token, forgotten(worker).into()),
            RequestRow::Clear(token, worker) => ask(token, cleared(worker, String::new()).into()),
            RequestRow::ClearedBy(token, worker, by) => ask(token, cleared(worker, by).into()),
            RequestRow::Narrow(row) => ask(row.token, row.action().into()),
            RequestRow::SignedOff(token, worker) => {
                ask(token, WorkerAction::SignOff(WorkerId(worker)).into())
            }
            RequestRow::Assign(row) => ask(row.token, row.action().into()),
            RequestRow::Unassign(token, id) => ask(token, WorkerAction::Unassign(AssignmentId(id)).into()),
            RequestRow::Finish(token, worker, assignment) => {
                ask(token, WorkerAction::Finish(WorkerId(worker), AssignmentId(assignment)).into())
            }
            RequestRow::Close(row) => ask(row.token, FloorAction::Close(row.into()).into()),
            RequestRow::Recur(token, line) => ask(token, FloorAction::Recur(line.into()).into()),
            RequestRow::EndSeries(token, series) => {
                ask(token, FloorAction::EndSeries(SeriesId(series)).into())
            }
            RequestRow::Evacuate(token) => ask(token, FloorAction::Evacuate.into()),
            RequestRow::EndEvacuation(token) => ask(token, FloorAction::EndEvacuation.into()),
            RequestRow::Reopen(token, closure) => ask(token, FloorAction::Reopen(ClosureId(closure)).into()),
            RequestRow::Submit(line) => ask(line.token, JobAction::Submit(line.into()).into()),
            RequestRow::SubmitBatch(token, lines) => {
                let requests = lines.into_iter().map(JobRequest::from).collect();
                ask(token, JobAction::SubmitBatch(requests).into())
            }
        }
    }
}

/// Begins or ends maintenance of a robot.
fn maintained(robot: u32, begins: bool) -> RobotAction {
    let robot = RobotId(robot);
    if begins { RobotAction::BeginMaintenance(robot) } else { RobotAction::EndMaintenance(robot) }
}

/// A worker who gets into a vehicle with these figures, or off one.
fn moves_as(worker: u32, figures: Option<[i64; 6]>) -> WorkerAction {
    let vehicle = figures.and_then(Vehicle::of_whole_mm);
    WorkerAction::MoveAs(WorkerId(worker), vehicle.map_or(Mover::OnFoot, Mover::Vehicle))
}

/// A worker who is forgotten.
fn forgotten(worker: u32) -> WorkerAction {
    WorkerAction::Forget(WorkerId(worker))
}

/// A person's statement that the belief about a worker is wrong.
fn cleared(worker: u32, by: String) -> WorkerAction {
    WorkerAction::Clear { worker: WorkerId(worker), by }
}

/// What a robot obeys of limits; nothing, if a later version has written a word that this one does not know.
fn limits_of(word: &str) -> ObeyedLimits {
    ObeyedLimits::of_word(word).unwrap_or(ObeyedLimits::Nothing)
}

/// Whether messages get through, in the words of older recordings.
fn reach_before(connected: bool) -> LinkReach {
    if connected { LinkReach::ByReports } else { LinkReach::Lost }
}

/// Whether messages get through; they do not, if a later version has written a word that this one does not know.
fn reach_of(word: &str) -> LinkReach {
    LinkReach::of_word(word).unwrap_or(LinkReach::Lost)
}

/// The input for the state of a robot's link.
fn linked(
    robot: u32,
    (reach, capacity, refuses): (LinkReach, Option<usize>, Option<String>),
    (limits, failed_stop): (ObeyedLimits, Option<u64>),
) -> Input {
    let refuses = refuses.map(|kept| Sentence::read(&kept));
    Input::Link(RobotId(robot), LinkState { reach, capacity, refuses, limits, failed_stop })
}

/// Registers a robot. The reply was given when this was recorded.
fn joins((name, kind, link): (String, String, Option<String>), node: u32) -> Input {
    Input::ask(0, RobotAction::Register { name, kind, node: NodeId(node), link })
}

fn asked_of_job(token: u64, action: &JobAction) -> RequestRow {
    match action {
        JobAction::Submit(request) => RequestRow::Submit(JobLine::new(token, request)),
        JobAction::SubmitBatch(requests) => {
            RequestRow::SubmitBatch(token, requests.iter().map(|request| JobLine::new(0, request)).collect())
        }
        JobAction::Cancel(job) => RequestRow::Cancel(token, job.0),
        JobAction::Change(job, change) => RequestRow::Change(token, job.0, change.into()),
        JobAction::Reassign(job, robot) => RequestRow::Reassign(token, job.0, robot.map(|r| r.0)),
    }
}

fn asked_of_robot(token: u64, action: &RobotAction) -> RequestRow {
    match action {
        RobotAction::Register { name, kind, node, link: Some(link) } => {
            RequestRow::RegisterAt(name.clone(), node.0, kind.clone(), link.clone())
        }
        RobotAction::Register { name, kind, node, link: None } if kind == USUAL_KIND => {
            RequestRow::Register(name.clone(), node.0)
        }
        RobotAction::Register { name, kind, node, link: None } => {
            RequestRow::RegisterAs(name.clone(), node.0, kind.clone())
        }
        RobotAction::BeginMaintenance(robot) => RequestRow::Maintain(token, robot.0, true),
        RobotAction::EndMaintenance(robot) => RequestRow::Maintain(token, robot.0, false),
        RobotAction::Retire(robot) => RequestRow::Retire(token, robot.0),
        RobotAction::TakeRack { rack, node } => RequestRow::TakeRack(token, rack.0, node.0),
    }
}

fn asked_of_worker(token: u64, action: &WorkerAction) -> RequestRow {
    match action {
        WorkerAction::Register(name) => RequestRow::RegisterWorker(token, name.clone()),
        WorkerAction::MoveAs(worker, Mover::OnFoot) => RequestRow::MoveAs(token, worker.0, None),
        WorkerAction::MoveAs(worker, Mover::Vehicle(vehicle)) => {
            RequestRow::MoveAs(token, worker.0, Some(vehicle.whole_mm()))
        }
        WorkerAction::Forget(worker) => RequestRow::ForgetWorker(token, worker.0),
        WorkerAction::Clear { worker, by } => RequestRow::ClearedBy(token, worker.0, by.clone()),
        WorkerAction::Narrow { worker, by, at, within_mm } => RequestRow::Narrow(NarrowRow {
            token,
            worker: worker.0,
            by: by.clone(),
            at: (at.x_mm, at.y_mm),
            within: *within_mm,
        }),
        WorkerAction::SignOff(worker) => RequestRow::SignedOff(token, worker.0),
        WorkerAction::Assign { worker, request: r } => RequestRow::Assign(AssignRow {
            token,
            worker: worker.map(|w| w.0),
            place: r.place.0,
            stay: r.stay.0,
            what: r.what.clone(),
            key: r.key.as_ref().map(|key| key.text.clone()),
            owner: r.key.as_ref().and_then(|key| key.owner).map(|owner| owner.0),
        }),
        WorkerAction::Unassign(assignment) => RequestRow::Unassign(token, assignment.0),
        WorkerAction::Finish(worker, assignment) => RequestRow::Finish(token, worker.0, assignment.0),
    }
}

fn asked_of_floor(token: u64, action: &FloorAction) -> RequestRow {
    match action {
        FloorAction::Close(area) => RequestRow::Close(CloseRow {
            token,
            outline: area.outline.iter().map(|p| (p.x_mm, p.y_mm)).collect(),
            nodes: area.nodes.iter().map(|n| n.0).collect(),
            from: area.window.start().0,
            until: area.window.end().0,
            reason: area.reason.clone(),
            binds: area.binds.word().to_owned(),
        }),
        FloorAction::Reopen(closure) => RequestRow::Reopen(token, closure.0),
        FloorAction::Recur(closure) => RequestRow::Recur(token, closure.into()),
        FloorAction::EndSeries(series) => RequestRow::EndSeries(token, series.0),
        FloorAction::Evacuate => RequestRow::Evacuate(token),
        FloorAction::EndEvacuation => RequestRow::EndEvacuation(token),
        FloorAction::Halt(robot) => RequestRow::Halt(token, robot.map(|r| r.0)),
        FloorAction::Release(robot) => RequestRow::Release(token, robot.map(|r| r.0)),
        FloorAction::PutKind(kind) => RequestRow::PutKind(token, (&**kind).into()),
        FloorAction::RemoveKind(name) => RequestRow::RemoveKind(token, name.clone()),
    }
}

impl NarrowRow {
    fn action(self) -> WorkerAction {
        let (x_mm, y_mm) = self.at;
        let (worker, at) = (WorkerId(self.worker), Spot { x_mm, y_mm });
        WorkerAction::Narrow { worker, by: self.by, at, within_mm: self.within }
    }
}

impl AssignRow {
    fn action(self) -> WorkerAction {
        let owner = self.owner.map(CustomerId);
        let key = self.key.map(|text| ClientKey { owner, text });
        let (place, stay) = (NodeId(self.place), Span(self.stay));
        let request = AssignmentRequest { place, stay, what: self.what, key };
        WorkerAction::Assign { worker: self.worker.map(WorkerId), request }
    }
}

impl From<CloseRow> for Closure {
    fn from(row: CloseRow) -> Closure {
        Closure {
            outline: row.outline.into_iter().map(|(x_mm, y_mm)| Spot { x_mm, y_mm }).collect(),
            nodes: row.nodes.into_iter().map(NodeId).collect(),
            window: Window::new(Time(row.from), Time(row.until)),
            reason: row.reason,
            binds: Binds::of(&row.binds).unwrap_or_default(),
            series: None,
        }
    }
}

impl From<&RecurringClosure> for RecurLine {
    fn from(closure: &RecurringClosure) -> RecurLine {
        let RecurringClosure { area, recurrence, .. } = closure;
        RecurLine {
            outline: area.outline.iter().map(|p| (p.x_mm, p.y_mm)).collect(),
            nodes: area.nodes.iter().map(|n| n.0).collect(),
            from: area.window.start().0,
            until: area.window.end().0,
            reason: area.reason.clone(),
            binds: area.binds.word().to_owned(),
            every: recurrence.every.0,
            weekdays: recurrence.weekdays.0,
            utc_offset: recurrence.clock.offset.0,
            zone: recurrence.clock.zone.clone().map(|zone| {
                (zone, recurrence.clock.changes.iter().map(|(from, offset)| (from.0, offset.0)).collect())
            }),
            last: recurrence.until.0,
            next: closure.next.map(|t| t.0),
        }
    }
}

impl From<RecurLine> for RecurringClosure {
    fn from(line: RecurLine) -> RecurringClosure {
        let area = Closure {
            outline: line.outline.into_iter().map(|(x_mm, y_mm)| Spot { x_mm, y_mm }).collect(),
            nodes: line.nodes.into_iter().map(NodeId).collect(),
            window: Window::new(Time(line.from), Time(line.until)),
            reason: line.reason,
            binds: Binds::of(&line.binds).unwrap_or_default(),
            series: None,
        };
        let (zone, changes) = line.zone.map_or((None, Vec::new()), |(zone, changes)| (Some(zone), changes));
        let changes = changes.into_iter().map(|(from, offset)| (Time(from), Span(offset))).collect();
        let recurrence = Recurrence {
            every: Span(line.every),
            weekdays: Weekdays(line.weekdays),
            clock: LocalClock { zone, offset: Span(line.utc_offset), changes },
            until: Time(line.last),
        };
        let recurring = RecurringClosure::new(area, recurrence);
        match line.next {
            Some(next) => recurring.not_before(Time(next)),
            None => recurring,
        }
    }
}

fn robots() -> String {
    Binds::Robots.word().to_owned()
}

fn is_robots(binds: &String) -> bool {
    binds == Binds::Robots.word()
}
