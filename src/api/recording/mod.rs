//! Recordings: frames of a fleet on file, so that people can look again at what happened, say, at 14:07.
//!
//! Main types: [`Recording`] (frames and facts → lines), [`Mark`] (a bookmark), [`Sum`] (figures so far), [`Out`] (a
//! file of them), [`Folder`] (many, by time), [`Rotation`] (writes a folder). A recording is JSON lines, compressed
//! with gzip; docs/replay.md specifies the format. Patches are those of the thin live feed. Refuses: to compare frames
//! in a way of its own, and to delay the program that runs the fleet.

mod cells;
mod file;
mod folder;
mod mark;
mod pending;
mod rotation;
mod sum;

pub use file::{Out, is_reel, lines};
pub use folder::{Cut, Folder, PastSpan, Piece};
pub use mark::{Mark, MarkKind, Met, is_notable};
pub use rotation::{Limits, Rotation};
pub use sum::{RunningTotals, Sum, thinned};

use crate::dto::building::map_text;
use crate::live::{Frame, thin};
use crate::wire::text::round3;
use giveway_fleet::{Fact, FloorNote, ReplanCause};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use serde_json::json;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::Arc;
use sum::Counting;

/// Interval between frames.
pub const EVERY: Span = Span::from_millis(200);

/// Interval between key frames, seconds: seeking reads at most this much before the moment.
const KEY_EVERY_S: f64 = 10.0;

/// The most facts that wait for the next frame, which is delayed if the disk accepts nothing.
const MOST_WAITING: usize = 1000;

/// The shortest interval between two replan bookmarks of the same cause: beside people, robots are replanned all the
/// time.
const SAME_CAUSE: Span = Span::from_secs(30);

/// Turns frames and facts into lines.
pub struct Recording {
    map: Arc<Warehouse>,
    name: String,
    start: Option<Time>,
    last: Option<Arc<Frame>>,
    version: u64,
    keyed_s: f64,
    facts: Vec<Fact>,
    /// The causes of the latest replan bookmarks, and their times.
    causes: BTreeMap<ReplanCause, Time>,
    counting: Counting,
}

/// What one frame adds to a recording.
#[derive(Debug, Default)]
pub struct RecordedFrame {
    /// The frame's time, seconds from the start.
    pub at_s: f64,
    /// The lines, each with its line break.
    pub lines: String,
    /// The bookmarks among the lines.
    pub marks: Vec<Mark>,
    /// The sums among the lines.
    pub sums: Vec<Sum>,
}

impl Recording {
    /// A recording of this fleet. `start` is the time at which its seconds are zero; nothing in a simulation.
    pub fn new(map: Arc<Warehouse>, name: String, start: Option<Time>) -> Recording {
        let keyed_s = f64::NEG_INFINITY;
        let counting = Counting::default();
        let (facts, causes) = (Vec::new(), BTreeMap::new());
        Recording { map, name, start, last: None, version: 0, keyed_s, facts, causes, counting }
    }

    /// The first line of a file. The next frame will be a key frame.
    pub fn header(&mut self) -> String {
        self.keyed_s = f64::NEG_INFINITY;
        header(&self.name, self.start, Some(&self.map))
    }

    /// Notes a fact that may become a bookmark.
    pub fn note(&mut self, fact: &Fact) {
        if !is_notable(fact) || self.facts.len() >= MOST_WAITING {
            return;
        }
        if let Fact::Noted(FloorNote::Replanned { cause, at, .. }) = fact {
            self.causes.retain(|_, last| *at - *last < SAME_CAUSE);
            if self.causes.contains_key(cause) {
                return;
            }
            self.causes.insert(*cause, *at);
        }
        self.facts.push(fact.clone());
    }

    /// The lines of a frame; nothing if it is no newer than the one before.
    pub fn add(&mut self, frame: &Arc<Frame>) -> Option<RecordedFrame> {
        let at_s = frame.time_s;
        if self.last.as_ref().is_some_and(|last| last.time_s >= at_s) {
            return None;
        }
        let mut lines = String::new();
        let (mut marks, mut sums) = (Vec::new(), Vec::new());
        if let Some(last) = &self.last {
            let patch = thin::patch(last, frame, self.version);
            writeln!(lines, "{{\"at\":{at_s},\"patch\":{patch}}}").expect("texts take everything");
            marks = mark::between(last, frame);
            self.counting.go(last, frame);
        }
        self.version += 1;
        let is_keyed = at_s - self.keyed_s >= KEY_EVERY_S;
        lines += &cells::line(self.last.as_deref().filter(|_| !is_keyed), frame).unwrap_or_default();
        // The key frame comes in addition to the patch, so that a reader that plays on need not start anew.
        if is_keyed {
            let whole = frame.snapshot(self.version);
            writeln!(lines, "{{\"at\":{at_s},\"key\":{whole}}}").expect("texts take everything");
            self.keyed_s = at_s;
            let sum = self.counting.sum(frame);
            writeln!(lines, "{{\"at\":{at_s},\"sum\":{}}}", json!(sum.tally)).expect("texts take everything");
            sums.push(sum);
            lines += &pending::line(frame, &self.map);
        }
        let zero = self.start.unwrap_or(Time::ZERO);
        marks.extend(self.facts.drain(..).filter_map(|fact| mark::of(&fact, zero, frame)));
        for mark in &marks {
            writeln!(lines, "{{\"at\":{},\"mark\":{}}}", mark.at_s, json!(mark))
                .expect("texts take everything");
        }
        self.last = Some(frame.clone());
        Some(RecordedFrame { at_s, lines, marks, sums })
    }
}

/// The first line of a recording; without the map, it is for readers that have the map already.
fn header(name: &str, start: Option<Time>, map: Option<&Warehouse>) -> String {
    let start_s = start.map(|start| round3(start.as_secs_f64()));
    let map = map.map_or_else(|| "null".into(), map_text);
    format!("{{\"reel\":1,\"name\":{},\"start\":{},\"map\":{map}}}\n", json!(name), json!(start_s))
}

/// The time at the start of a line, and the rest of the line.
fn split(line: &str) -> Option<(f64, &str)> {
    let (at, rest) = line.strip_prefix("{\"at\":")?.split_once(',')?;
    Some((at.parse().ok()?, rest))
}

#[cfg(test)]
mod beside_tests;
#[cfg(test)]
mod tests;
