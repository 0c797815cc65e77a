//! Recordings: the inputs of every step, so that a run can be viewed and stepped through again.
//!
//! Main types: [`Header`], [`Recorder`] (steps → lines), [`Playback`] (lines → steps). One JSON text per line: the
//! header, then a line per step, then the digest of all facts. A report that a robot repeats unchanged is written once.
//! Refuses: to record facts; they follow from the inputs, and the digest tells whether they still do.

mod arm_row;
mod hand_row;
mod job_line;
mod kind_row;
pub mod replay;
mod request_row;
mod said_row;

use self::request_row::RequestRow;
use giveway_fleet::{Fault, Input, Telemetry};
use giveway_floor::geometry::{Point, Pose};
use giveway_floor::id::{RackId, RobotId, WorkerId};
use giveway_floor::time::Time;
use giveway_people::human::{Quality, Sighting, SourceId};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Content of the first line.
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
    /// The learned model of people, as text; absent if the built-in one was used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// The learned model of pickers, as text; absent if the built-in one was used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub picks: Option<String>,
}

/// Error of a recording that cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line} of the recording: {message}")]
pub struct Broken {
    /// Number of the line.
    pub line: usize,
    /// What is wrong with the line.
    pub message: String,
}

/// The inputs of one step.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RecordingLine {
    t: i64,
    /// Reports of robots that changed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    r: Vec<TelemetryRow>,
    /// Robots whose report is unchanged, with its time if that is not `t`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    s: Vec<(u32, i64)>,
    /// Robots in `r` whose number of followed recalls changed, with that number.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    c: BTreeMap<u32, u64>,
    /// Workers that devices have seen.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    w: Vec<SightingRow>,
    /// All other inputs, in order of arrival.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    i: Vec<RequestRow>,
}

/// Robot, seen, x, y, heading, speed, reached, known, acted, rack, battery, what is wrong, limit.
type TelemetryRow =
    (u32, i64, f64, f64, f64, f64, u64, u64, Option<u64>, Option<u32>, f64, Wrong, Option<f64>);
/// The fault of a robot: `false` for none, `true` if it is broken, else the word of the fault.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Wrong {
    Broken(bool),
    Other(String),
}
/// Worker, seen, epoch, number, x, y, heading, accuracy, and quality (0 tracked, 1 emulated, 2 lost), plus 4 for a tag
/// or 8 for a device that reports like a robot, plus 16 if the epoch did not begin with marks.
type SightingRow = (u32, i64, u32, u64, f64, f64, Option<f64>, f64, u8);

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RecordingEnd {
    trace_hash: String,
}

/// Turns steps into lines.
#[derive(Debug, Default)]
pub struct Recorder {
    last: BTreeMap<RobotId, LastSaid>,
}

/// The last report of a robot.
#[derive(Debug)]
struct LastSaid {
    report: Telemetry,
    /// The time of the line in which the report was new.
    new_in: Time,
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
                // An overtaken report has no effect.
                Input::Telemetry(t)
                    if self.last.get(&t.robot).is_some_and(|said| t.seq <= said.report.seq) => {}
                Input::Telemetry(t) => {
                    // A repeated report is read as the robot's last one before this line, not as one within it.
                    let same = |said: &LastSaid| {
                        let before = Telemetry { seq: t.seq, seen: t.seen, ..said.report };
                        said.new_in != now && before == *t
                    };
                    if let Some(last) = self.last.get_mut(&t.robot).filter(|said| same(said)) {
                        last.report = *t;
                        line.s.push((t.robot.0, t.seen.0));
                        continue;
                    }
                    line.r.push(said(t));
                    let before = self.last.insert(t.robot, LastSaid { report: *t, new_in: now });
                    if t.recalls != before.map_or(0, |said| said.report.recalls) {
                        line.c.insert(t.robot.0, t.recalls);
                    }
                }
                Input::Link(robot, state) => line.i.push(RequestRow::link(*robot, state)),
                Input::Sighted(s) => line.w.push(sighted(s)),
                Input::Hands(seen) => line.i.push(RequestRow::Hands(seen.into())),
                Input::Arm(said) => line.i.push(RequestRow::Arm(said.into())),
                Input::VisitEnds { station, at } => line.i.push(RequestRow::VisitEnds(station.0, at.0)),
                Input::Ask { token, request } => line.i.push(RequestRow::of(*token, request)),
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

/// The fault of a row; an unknown word of a later version still counts as a fault.
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

/// One line of a recording after reading.
#[derive(Debug)]
pub enum Played {
    /// A step with its time and inputs.
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
    /// What is wrong with the line.
    pub fn read(&mut self, text: &str) -> Result<Played, Broken> {
        self.line += 1;
        let broken = |message: String| Broken { line: self.line, message };
        if let Ok(end) = serde_json::from_str::<RecordingEnd>(text) {
            let hash = u64::from_str_radix(&end.trace_hash, 16).map_err(|e| broken(e.to_string()))?;
            return Ok(Played::End(hash));
        }
        let line: RecordingLine = serde_json::from_str(text).map_err(|e| broken(e.to_string()))?;
        let mut inputs: Vec<Input> = line.i.into_iter().map(RequestRow::input).collect();
        let before = |robot| self.last.get(&RobotId(robot)).map_or(0, |t| t.recalls);
        let recalls = |robot| line.c.get(&robot).copied().unwrap_or_else(|| before(robot));
        let mut seen = Vec::with_capacity(line.s.len() + line.r.len());
        for (robot, at) in line.s {
            let last = self.last.get(&RobotId(robot));
            let last = last.ok_or_else(|| broken(format!("robot {robot} repeats what it never said")))?;
            seen.push(Telemetry { seen: Time(at), ..*last });
        }
        seen.extend(line.r.into_iter().map(|s| (recalls(s.0), s)).map(|(n, s)| heard(s, n)));
        for mut report in seen {
            report.seq = self.last.get(&report.robot).map_or(1, |last| last.seq + 1);
            self.last.insert(report.robot, report);
            inputs.push(Input::Telemetry(report));
        }
        inputs.extend(line.w.into_iter().map(|s| Input::Sighted(glimpsed(s))));
        Ok(Played::Step(Time(line.t), inputs))
    }
}

fn heard(s: TelemetryRow, recalls: u64) -> Telemetry {
    let (robot, seen, x, y, heading, speed_mps, reached, known, acted, rack, battery, fault, limit_mps) = s;
    Telemetry {
        robot: RobotId(robot),
        seq: 0,
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
