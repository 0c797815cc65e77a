//! The probe: finds out what is special about a robot before it joins, from what it answers.
//!
//! Main types: [`RobotProbe`] (messages and times in, messages and findings out), [`ProbeFindings`] (what was found, as
//! JSON and in words). Sends one instant action a message, since two of them kill some robots. Refuses: to move a robot
//! unless a place to drive to is given, and to ask for an action that moves or handles anything.

mod course;
mod findings;
mod questions;
mod said;
mod stage;
#[cfg(test)]
mod tests;

pub use findings::{FactsheetWorth, ProbeFindings};
pub use stage::ProbeStage;

use crate::vda5050::contact::ON_NODE_M;
use findings::{KeySpelling, RepeatAnswer};
use giveway_floor::geometry::Point;
use giveway_floor::time::{Span, Time};
use giveway_vda5050::{
    Action, Address, BlockingType, Header, Message, Order, TopicKind, Version, read, write,
};
use said::RobotSaid;
use serde_json::Value;
use std::collections::BTreeMap;

/// A state is asked for this often while the robot does something.
const ASKS: Span = Span::from_millis(400);

/// A message of the probe.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeMessage {
    /// Its topic.
    pub kind: TopicKind,
    /// The version in its topic and header.
    pub version: Version,
    /// The JSON text.
    pub payload: Vec<u8>,
}

/// A probe of one robot.
#[derive(Debug)]
pub struct RobotProbe {
    address: Address,
    /// Where the robot is to drive, in its own map; nothing if it is not to move.
    goal: Option<Point>,
    /// What the ids of this probe begin with: no two probes send the same.
    run: String,
    ids: u32,
    next: BTreeMap<TopicKind, u32>,
    version: Option<Version>,
    said: RobotSaid,
    stage: ProbeStage,
    since: Time,
    begun: Option<Time>,
    /// The action or order that the stage is about.
    asked: String,
    /// The last order, to be sent again.
    order: Option<Order>,
    state_asked: Time,
    /// Where the robot stood before it was moved.
    home: Option<Point>,
    course: course::DriveCourse,
    findings: ProbeFindings,
    timestamp: String,
    out: Vec<ProbeMessage>,
}

impl RobotProbe {
    /// A probe of a robot. `run` is part of all ids and must be new each time.
    pub fn new(address: Address, goal: Option<Point>, run: &str) -> RobotProbe {
        RobotProbe {
            findings: ProbeFindings::new(address.clone()),
            address,
            goal,
            run: run.to_owned(),
            ids: 0,
            next: BTreeMap::new(),
            version: None,
            said: RobotSaid::default(),
            stage: ProbeStage::Listens,
            since: Time::ZERO,
            begun: None,
            asked: String::new(),
            order: None,
            state_asked: Time::ZERO,
            home: None,
            course: course::DriveCourse::default(),
            timestamp: String::new(),
            out: Vec::new(),
        }
    }

    /// Takes a message of the robot; `level` is the level of its topic that names the major version.
    pub fn hear(&mut self, now: Time, level: &str, kind: TopicKind, payload: &[u8]) {
        let Ok(said) = read(kind, payload) else {
            self.findings.note_unreadable(kind);
            return;
        };
        match Version::of_text(&said.header.version) {
            Some(version) if version.topic_level() == level => {
                self.version.get_or_insert(version);
                self.findings.version.get_or_insert(version);
            }
            _ => self.findings.other_version = Some(said.header.version.clone()),
        }
        match said.message {
            Message::Connection(connection) => self.findings.connection = Some(connection),
            Message::Factsheet(sheet) => {
                let keys = serde_json::from_slice::<Value>(payload).ok();
                let fields = keys.as_ref().and_then(Value::as_object).map_or(0, serde_json::Map::len);
                self.findings.note_sheet(*sheet, fields, said.oddities.is_empty());
            }
            Message::State(state) => {
                self.findings.note_state(&state);
                self.said.take_state(now, state);
            }
            Message::Visualization(seen) => self.said.take_pose(now, seen.position.as_ref()),
            Message::Order(_) | Message::InstantActions(_) | Message::ZoneSet(_) | Message::Responses(_) => {}
        }
    }

    /// Goes on, and returns what to send. `timestamp` is the time as messages have it.
    pub fn tick(&mut self, now: Time, timestamp: &str) -> Vec<ProbeMessage> {
        timestamp.clone_into(&mut self.timestamp);
        if self.begun.is_none() {
            (self.begun, self.since, self.state_asked) = (Some(now), now, now);
        }
        if let Some(next) = self.look(now) {
            self.enter(now, next);
        }
        if self.stage.needs_states() && now - self.state_asked >= ASKS {
            self.state_asked = now;
            let id = self.new_id();
            self.send_instant("stateRequest", &id);
        }
        std::mem::take(&mut self.out)
    }

    /// What the probe is doing.
    pub fn stage(&self) -> ProbeStage {
        self.stage
    }

    /// Whether the probe is over.
    pub fn is_over(&self) -> bool {
        self.stage == ProbeStage::Over
    }

    /// What was found.
    pub fn findings(&self) -> &ProbeFindings {
        &self.findings
    }

    fn new_id(&mut self) -> String {
        self.ids += 1;
        format!("probe-{}-{}", self.run, self.ids)
    }

    /// Asks for an instant action, which the stage is about from now on.
    fn instant(&mut self, kind: &str) {
        self.asked = self.new_id();
        let id = self.asked.clone();
        self.send_instant(kind, &id);
    }

    fn send_instant(&mut self, kind: &str, id: &str) {
        let (kind, id) = (kind.to_owned(), id.to_owned());
        let action =
            Action { kind, id, blocking: BlockingType::None, parameters: Vec::new(), retriable: false };
        let key = self.findings.key.unwrap_or(KeySpelling::Both);
        self.send(TopicKind::InstantActions, &Message::InstantActions(vec![action]), |text| key.spell(text));
    }

    /// Sends an order, which the stage is about from now on.
    fn send_order(&mut self, order: Order) {
        self.asked.clone_from(&order.id);
        let spelling = self.course.spelling;
        self.send(TopicKind::Order, &Message::Order(order.clone()), |text| spelling.spell(text));
        self.order = Some(order);
    }

    fn send(&mut self, kind: TopicKind, message: &Message, spell: impl FnOnce(&mut Value)) {
        let version = self.version.unwrap_or(Version::V2_0);
        let next = self.next.entry(kind).or_default();
        let header = Header {
            id: *next,
            timestamp: self.timestamp.clone(),
            version: version.text().to_owned(),
            manufacturer: self.address.manufacturer().to_owned(),
            serial: self.address.serial().to_owned(),
        };
        *next = next.wrapping_add(1);
        let mut text = write(&header, message, version);
        spell(&mut text);
        self.out.push(ProbeMessage { kind, version, payload: text.to_string().into_bytes() });
    }

    /// Whether the robot is within reach of a place.
    fn is_at(&self, place: Point) -> bool {
        self.said.place().is_some_and(|here| (here - place).norm() <= ON_NODE_M)
    }

    /// What the robot's answer to a repeated order was.
    fn note_repeat(&mut self) {
        let worst = self.said.new_errors().iter().map(|error| error.level).max();
        self.findings.repeat = Some(RepeatAnswer::of(worst));
    }
}
