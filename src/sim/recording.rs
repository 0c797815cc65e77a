//! Recordings: the inputs of every step, so that a run can be looked at again and stepped through again.
//!
//! Main types: [`Header`], [`Recorder`] (steps → lines), [`Playback`] (lines → steps). One JSON text per line:
//! the header, then a line per step, then the digest of all facts. What a robot says twice in the same words is
//! written once. Refuses: to record facts; they follow from the inputs, and the digest tells whether they still do.

use super::arm_row::ArmRow;
use super::hand_row::HandsRow;
use super::job_line::{ChangeLine, JobLine};
use super::said_row::Says;
use crate::fleet::{
    AssignmentRequest, Binds, ClientKey, Closure, Fault, Input, JobChange, JobRequest, LocalClock,
    Recurrence, RecurringClosure, Telemetry, USUAL_KIND, Weekdays,
};
use crate::geometry::{Point, Pose, Spot};
use crate::human::{Quality, Sighting, SourceId};
use crate::id::{
    AssignmentId, ClosureId, CustomerId, JobId, NodeId, RackId, RobotId, SeriesId, StationId, WorkerId,
};
use crate::time::{Span, Time, Window};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What stands in the first line.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// Version of the format; there is only 1.
    pub giveway_recording: u32,
    /// The scenario file's text.
    pub scenario: String,
    /// The map's text.
    pub map: String,
    /// The seed.
    pub seed: u64,
    /// What was learned about people, as text; absent where the built-in figures held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// What was learned of pickers, as text; absent where the built-in figures held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub picks: Option<String>,
}

/// A recording that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line} of the recording: {message}")]
pub struct Broken {
    /// Where.
    pub line: usize,
    /// What.
    pub message: String,
}

/// What a station says.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RecordingLine {
    t: i64,
    /// Robots that say something new.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    r: Vec<TelemetryRow>,
    /// Robots that say the same again, with the time they say it at where that is not `t`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    s: Vec<(u32, i64)>,
    /// Robots among those of `r` that have followed another number of recalls than before, with that number.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    c: BTreeMap<u32, u64>,
    /// Workers that were seen.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    w: Vec<SightingRow>,
    /// Everything else, in the order in which it came.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    i: Vec<Other>,
}

/// Robot, seen, x, y, heading, speed, reached, known, acted, rack, battery, what is wrong, limit.
type TelemetryRow =
    (u32, i64, f64, f64, f64, f64, u64, u64, Option<u64>, Option<u32>, f64, Wrong, Option<f64>);
/// What is wrong with a robot: `false` for nothing, `true` where it is broken, else the word of the fault.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Wrong {
    Broken(bool),
    Other(String),
}
/// Worker, seen, epoch, number, x, y, heading, accuracy, and quality (0 tracked, 1 emulated, 2 lost) with 4 for a tag
/// or 8 for a device that reports like a robot, and 16 where the epoch did not begin with marks.
type SightingRow = (u32, i64, u32, u64, f64, f64, Option<f64>, f64, u8);

/// What is closed again and again, times in microseconds; `from` and `until` are those of the first occurrence.
#[derive(Serialize, Deserialize)]
struct RecurLine {
    outline: Vec<(i64, i64)>,
    nodes: Vec<u32>,
    /// Of the first occurrence.
    from: i64,
    until: i64,
    reason: String,
    binds: String,
    every: i64,
    weekdays: u8,
    /// Ahead of UTC, before the first change of the clocks.
    utc_offset: i64,
    /// The time zone, and when its clocks change to which offset.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    zone: Option<(String, Vec<(i64, i64)>)>,
    /// When it recurs no more.
    last: i64,
    /// When the next occurrence begins, where that is not the first one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    next: Option<i64>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Other {
    #[serde(rename = "enlist")]
    Register(String, u32),
    /// Of a kind that is not the usual one.
    #[serde(rename = "enlist_as")]
    RegisterAs(String, u32, String),
    Maintain(u64, u32, bool),
    Retire(u64, u32),
    TakeRack(u64, u32, u32),
    Submit(JobLine),
    /// Token, and lines whose tokens mean nothing.
    SubmitBatch(u64, Vec<JobLine>),
    Cancel(u64, u64),
    #[serde(rename = "hire")]
    RegisterWorker(u64, String),
    ForgetWorker(u64, u32),
    Clear(u64, u32),
    ClearedBy(u64, u32, String),
    Narrow {
        token: u64,
        worker: u32,
        by: String,
        at: (i64, i64),
        within: i64,
    },
    SignedOff(u64, u32),
    Assign {
        token: u64,
        worker: Option<u32>,
        place: u32,
        stay: i64,
        what: String,
        key: Option<String>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        owner: Option<u64>,
    },
    Unassign(u64, u64),
    Finish(u64, u32, u64),
    Close {
        token: u64,
        outline: Vec<(i64, i64)>,
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        nodes: Vec<u32>,
        from: i64,
        until: i64,
        reason: String,
        /// From before people could be kept out: robots alone.
        #[serde(default = "robots", skip_serializing_if = "is_robots")]
        binds: String,
    },
    Reopen(u64, u64),
    Recur(u64, RecurLine),
    EndSeries(u64, u64),
    Evacuate(u64),
    EndEvacuation(u64),
    Halt(u64, Option<u32>),
    Release(u64, Option<u32>),
    /// From before more than the priority could be changed.
    Prioritise(u64, u64, u8),
    Change(u64, u64, ChangeLine),
    Reassign(u64, u64, Option<u32>),
    /// Token, station, what it says.
    Station(u64, u32, Says),
    Hands(HandsRow),
    /// Station, true end of the visit that is on.
    VisitEnds(u32, i64),
    Arm(ArmRow),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RecordingEnd {
    trace_hash: String,
}

/// Turns steps into lines.
#[derive(Debug, Default)]
pub struct Recorder {
    last: BTreeMap<RobotId, Telemetry>,
}

impl Recorder {
    /// The first line.
    pub fn header(header: &Header) -> String {
        to_line(header)
    }

    /// The line of one step.
    pub fn step(&mut self, now: Time, inputs: &[Input]) -> String {
        let mut line =
            RecordingLine { t: now.0, r: vec![], s: vec![], c: BTreeMap::new(), w: vec![], i: vec![] };
        for input in inputs {
            match input {
                Input::Telemetry(t) => {
                    let same = |o: &Telemetry| Telemetry { seen: t.seen, ..*o } == *t;
                    if self.last.get(&t.robot).is_some_and(same) {
                        line.s.push((t.robot.0, t.seen.0));
                    } else {
                        line.r.push(said(t));
                        let before = self.last.insert(t.robot, *t).map_or(0, |o| o.recalls);
                        if t.recalls != before {
                            line.c.insert(t.robot.0, t.recalls);
                        }
                    }
                }
                Input::Sighted(s) => line.w.push(sighted(s)),
                request => line.i.push(asked(request)),
            }
        }
        to_line(&line)
    }

    /// The last line.
    pub fn end(trace_hash: u64) -> String {
        to_line(&RecordingEnd { trace_hash: format!("{trace_hash:016x}") })
    }
}

fn to_line(value: &impl Serialize) -> String {
    let mut text = serde_json::to_string(value).expect("records hold nothing that JSON cannot");
    text.push('\n');
    text
}

fn said(t: &Telemetry) -> TelemetryRow {
    let (x, y) = (t.pose.at.x, t.pose.at.y);
    let rack = t.rack.map(|k| k.0);
    let seen = t.seen.0;
    (
        t.robot.0,
        seen,
        x,
        y,
        t.pose.heading,
        t.speed_mps,
        t.reached,
        t.known,
        t.acted,
        rack,
        t.battery,
        wrong(t.fault),
        t.limit_mps,
    )
}

fn wrong(fault: Option<Fault>) -> Wrong {
    match fault {
        None => Wrong::Broken(false),
        Some(Fault::Broken) => Wrong::Broken(true),
        Some(other) => Wrong::Other(other.word().to_owned()),
    }
}

/// A fault of a later version is at least one.
fn fault_of(wrong: &Wrong) -> Option<Fault> {
    match wrong {
        Wrong::Broken(broken) => broken.then_some(Fault::Broken),
        Wrong::Other(word) => Some(Fault::of_word(word).unwrap_or(Fault::Broken)),
    }
}

fn sighted(s: &Sighting) -> SightingRow {
    let quality = match s.quality {
        Quality::Tracked => 0,
        Quality::Emulated => 1,
        Quality::Lost => 2,
    };
    let quality = quality + 4 * s.source as u8 + if s.at_marks { 0 } else { 16 };
    (s.worker.0, s.seen.0, s.epoch, s.seq, s.at.x, s.at.y, s.heading, s.accuracy_m, quality)
}

fn asked(input: &Input) -> Other {
    match input {
        Input::Register { name, kind, node, .. } if kind == USUAL_KIND => {
            Other::Register(name.clone(), node.0)
        }
        Input::Register { name, kind, node, .. } => Other::RegisterAs(name.clone(), node.0, kind.clone()),
        Input::Maintain { token, robot, begins } => Other::Maintain(*token, robot.0, *begins),
        Input::Retire { token, robot } => Other::Retire(*token, robot.0),
        Input::TakeRack { token, rack, node } => Other::TakeRack(*token, rack.0, node.0),
        Input::Submit { token, request } => Other::Submit(JobLine::new(*token, request)),
        Input::SubmitBatch { token, requests } => {
            Other::SubmitBatch(*token, requests.iter().map(|request| JobLine::new(0, request)).collect())
        }
        Input::Cancel { token, job } => Other::Cancel(*token, job.0),
        Input::RegisterWorker { token, name } => Other::RegisterWorker(*token, name.clone()),
        Input::ForgetWorker { token, worker } => Other::ForgetWorker(*token, worker.0),
        Input::ClearWorker { token, worker, by } => Other::ClearedBy(*token, worker.0, by.clone()),
        Input::NarrowWorker { token, worker, by, at, within_mm } => {
            let (at, within) = ((at.x_mm, at.y_mm), *within_mm);
            Other::Narrow { token: *token, worker: worker.0, by: by.clone(), at, within }
        }
        Input::SignedOff { token, worker } => Other::SignedOff(*token, worker.0),
        Input::Assign { token, worker, request: r } => {
            let (what, key) = (r.what.clone(), r.key.as_ref().map(|key| key.text.clone()));
            let owner = r.key.as_ref().and_then(|key| key.owner).map(|owner| owner.0);
            let (worker, place, stay) = (worker.map(|w| w.0), r.place.0, r.stay.0);
            Other::Assign { token: *token, worker, place, stay, what, key, owner }
        }
        Input::Unassign { token, assignment } => Other::Unassign(*token, assignment.0),
        Input::Finish { token, worker, assignment } => Other::Finish(*token, worker.0, assignment.0),
        Input::Close { token, area } => Other::Close {
            token: *token,
            outline: area.outline.iter().map(|p| (p.x_mm, p.y_mm)).collect(),
            nodes: area.nodes.iter().map(|n| n.0).collect(),
            from: area.window.start().0,
            until: area.window.end().0,
            reason: area.reason.clone(),
            binds: area.binds.word().to_owned(),
        },
        Input::Reopen { token, closure } => Other::Reopen(*token, closure.0),
        Input::Recur { token, closure } => Other::Recur(*token, closure.into()),
        Input::EndSeries { token, series } => Other::EndSeries(*token, series.0),
        Input::Evacuate { token } => Other::Evacuate(*token),
        Input::EndEvacuation { token } => Other::EndEvacuation(*token),
        Input::Halt { token, robot } => Other::Halt(*token, robot.map(|r| r.0)),
        Input::Release { token, robot } => Other::Release(*token, robot.map(|r| r.0)),
        Input::Change { token, job, change } => Other::Change(*token, job.0, change.into()),
        Input::Reassign { token, job, robot } => Other::Reassign(*token, job.0, robot.map(|r| r.0)),
        Input::Station { token, station, order } => Other::Station(*token, station.0, (*order).into()),
        Input::Hands(seen) => Other::Hands(seen.into()),
        Input::Arm(said) => Other::Arm(said.into()),
        Input::VisitEnds { station, at } => Other::VisitEnds(station.0, at.0),
        Input::Telemetry(_) | Input::Sighted(_) => unreachable!("they have places of their own in a line"),
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

/// A line of a recording, read.
#[derive(Debug)]
pub enum Played {
    /// A step.
    Step(Time, Vec<Input>),
    /// The end, with the digest of all facts.
    End(u64),
}

/// Turns lines into steps.
#[derive(Debug)]
pub struct Playback {
    last: BTreeMap<RobotId, Telemetry>,
    line: usize,
}

impl Playback {
    /// Reads the first line.
    ///
    /// # Errors
    /// If it is no recording, or of another version.
    pub fn open(first: &str) -> Result<(Header, Playback), Broken> {
        let header: Header = serde_json::from_str(first)
            .map_err(|e| Broken { line: 1, message: format!("this is no recording: {e}") })?;
        if header.giveway_recording != 1 {
            let message = format!("version {} is not known, only 1 is", header.giveway_recording);
            return Err(Broken { line: 1, message });
        }
        Ok((header, Playback { last: BTreeMap::new(), line: 1 }))
    }

    /// Reads a further line.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn read(&mut self, text: &str) -> Result<Played, Broken> {
        self.line += 1;
        let broken = |message: String| Broken { line: self.line, message };
        if let Ok(end) = serde_json::from_str::<RecordingEnd>(text) {
            let hash = u64::from_str_radix(&end.trace_hash, 16).map_err(|e| broken(e.to_string()))?;
            return Ok(Played::End(hash));
        }
        let line: RecordingLine = serde_json::from_str(text).map_err(|e| broken(e.to_string()))?;
        let mut inputs: Vec<Input> = line.i.into_iter().map(other).collect();
        let before = |robot| self.last.get(&RobotId(robot)).map_or(0, |t| t.recalls);
        let recalls = |robot| line.c.get(&robot).copied().unwrap_or_else(|| before(robot));
        let mut seen: Vec<Telemetry> =
            line.r.into_iter().map(|s| (recalls(s.0), s)).map(|(n, s)| heard(s, n)).collect();
        for (robot, at) in line.s {
            let last = self.last.get(&RobotId(robot));
            let last = last.ok_or_else(|| broken(format!("robot {robot} repeats what it never said")))?;
            seen.push(Telemetry { seen: Time(at), ..*last });
        }
        self.last.extend(seen.iter().map(|t| (t.robot, *t)));
        inputs.extend(seen.into_iter().map(Input::Telemetry));
        inputs.extend(line.w.into_iter().map(|s| Input::Sighted(glimpsed(s))));
        Ok(Played::Step(Time(line.t), inputs))
    }
}

fn heard(s: TelemetryRow, recalls: u64) -> Telemetry {
    let (robot, seen, x, y, heading, speed_mps, reached, known, acted, rack, battery, fault, limit_mps) = s;
    Telemetry {
        robot: RobotId(robot),
        seen: Time(seen),
        pose: Pose { at: Point::new(x, y), heading },
        speed_mps,
        reached,
        known,
        acted,
        rack: rack.map(RackId),
        battery,
        fault: fault_of(&fault),
        limit_mps,
        recalls,
    }
}

fn glimpsed(s: SightingRow) -> Sighting {
    let (worker, seen, epoch, seq, x, y, heading, accuracy_m, quality) = s;
    let (source, at_marks) = (SourceId::ALL[usize::from(quality >> 2 & 3).min(2)], quality & 16 == 0);
    let quality = match quality & 3 {
        0 => Quality::Tracked,
        1 => Quality::Emulated,
        _ => Quality::Lost,
    };
    let (worker, seen, at) = (WorkerId(worker), Time(seen), Point::new(x, y));
    Sighting { worker, source, seen, epoch, at_marks, seq, at, mirror: None, heading, accuracy_m, quality }
}

/// A robot joins. The answer was given when this was recorded.
fn joins(name: String, kind: String, node: u32) -> Input {
    Input::Register { token: 0, name, kind, node: NodeId(node) }
}

fn other(o: Other) -> Input {
    match o {
        Other::Register(name, node) => joins(name, USUAL_KIND.to_owned(), node),
        Other::RegisterAs(name, node, kind) => joins(name, kind, node),
        Other::Maintain(token, robot, begins) => Input::Maintain { token, robot: RobotId(robot), begins },
        Other::Retire(token, robot) => Input::Retire { token, robot: RobotId(robot) },
        Other::TakeRack(token, rack, node) => {
            Input::TakeRack { token, rack: RackId(rack), node: NodeId(node) }
        }
        Other::Halt(token, robot) => Input::Halt { token, robot: robot.map(RobotId) },
        Other::Release(token, robot) => Input::Release { token, robot: robot.map(RobotId) },
        Other::Prioritise(token, job, priority) => {
            let change = JobChange { priority: Some(priority), ..JobChange::default() };
            Input::Change { token, job: JobId(job), change }
        }
        Other::Reassign(token, job, robot) => {
            Input::Reassign { token, job: JobId(job), robot: robot.map(RobotId) }
        }
        Other::Change(token, job, change) => Input::Change { token, job: JobId(job), change: change.into() },
        Other::Station(token, station, order) => {
            Input::Station { token, station: StationId(station), order: order.into() }
        }
        Other::Hands(row) => Input::Hands(row.into()),
        Other::Arm(row) => Input::Arm(row.into()),
        Other::VisitEnds(station, at) => Input::VisitEnds { station: StationId(station), at: Time(at) },
        Other::Cancel(token, job) => Input::Cancel { token, job: JobId(job) },
        Other::RegisterWorker(token, name) => Input::RegisterWorker { token, name },
        Other::ForgetWorker(token, worker) => Input::ForgetWorker { token, worker: WorkerId(worker) },
        Other::Clear(token, worker) => {
            Input::ClearWorker { token, worker: WorkerId(worker), by: String::new() }
        }
        Other::ClearedBy(token, worker, by) => Input::ClearWorker { token, worker: WorkerId(worker), by },
        Other::Narrow { token, worker, by, at: (x_mm, y_mm), within } => {
            let (worker, at) = (WorkerId(worker), Spot { x_mm, y_mm });
            Input::NarrowWorker { token, worker, by, at, within_mm: within }
        }
        Other::SignedOff(token, worker) => Input::SignedOff { token, worker: WorkerId(worker) },
        Other::Assign { token, worker, place, stay, what, key, owner } => {
            let key = key.map(|text| ClientKey { owner: owner.map(CustomerId), text });
            let request = AssignmentRequest { place: NodeId(place), stay: Span(stay), what, key };
            Input::Assign { token, worker: worker.map(WorkerId), request }
        }
        Other::Unassign(token, assignment) => Input::Unassign { token, assignment: AssignmentId(assignment) },
        Other::Finish(token, worker, assignment) => {
            Input::Finish { token, worker: WorkerId(worker), assignment: AssignmentId(assignment) }
        }
        Other::Close { token, outline, nodes, from, until, reason, binds } => {
            let outline = outline.into_iter().map(|(x_mm, y_mm)| Spot { x_mm, y_mm }).collect();
            let nodes = nodes.into_iter().map(NodeId).collect();
            let window = Window::new(Time(from), Time(until));
            let binds = Binds::of(&binds).unwrap_or_default();
            Input::Close { token, area: Closure { outline, nodes, window, reason, binds, series: None } }
        }
        Other::Recur(token, line) => Input::Recur { token, closure: line.into() },
        Other::EndSeries(token, series) => Input::EndSeries { token, series: SeriesId(series) },
        Other::Evacuate(token) => Input::Evacuate { token },
        Other::EndEvacuation(token) => Input::EndEvacuation { token },
        Other::Reopen(token, closure) => Input::Reopen { token, closure: ClosureId(closure) },
        Other::Submit(line) => Input::Submit { token: line.token, request: line.into() },
        Other::SubmitBatch(token, lines) => {
            Input::SubmitBatch { token, requests: lines.into_iter().map(JobRequest::from).collect() }
        }
    }
}
