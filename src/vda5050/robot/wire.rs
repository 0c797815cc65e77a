//! A virtual robot with its messages as bytes: it reads as its quirks say, and writes headers.
//!
//! Main types: [`WireRobot`], [`WireMessage`]. Refuses: topics and their first levels, which belong to the line.

use super::embodied::EmbodiedRobot;
use super::link::GarbledMessage;
use super::quirks::{DeviationKey, FactsheetForm};
use super::setup::RobotSetup;
use super::{RobotMessage, VirtualRobot};
use crate::model::{Header, Message};
use crate::read::read;
use crate::topic::TopicKind;
use crate::version::Version;
use crate::write::write;
use serde_json::Value;
use std::collections::BTreeMap;

/// What a factsheet has beside the header.
const LOADS: &str = "loadSpecification";
const HEADER: [&str; 5] = ["headerId", "timestamp", "version", "manufacturer", "serialNumber"];

/// A virtual robot with its body, and its messages as they travel.
#[derive(Clone, Debug)]
pub struct WireRobot {
    /// The robot, to be set and asked between steps.
    pub body: EmbodiedRobot,
    /// The number of the next message of each topic.
    next: BTreeMap<TopicKind, u32>,
}

/// A message as it travels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WireMessage {
    /// The topic on which it is sent.
    pub kind: TopicKind,
    /// The JSON text.
    pub payload: Vec<u8>,
}

/// A message that arrived, as the robot reads it.
#[derive(Clone, Debug, PartialEq)]
pub enum ReadMessage {
    /// The robot understands it.
    Clear(Message),
    /// The robot does not understand it.
    Garbled(TopicKind, GarbledMessage),
}

impl WireRobot {
    /// A robot that is switched on where its setup says.
    pub fn new(setup: RobotSetup) -> WireRobot {
        WireRobot { body: EmbodiedRobot::new(setup), next: BTreeMap::new() }
    }

    /// What the robot was set up as.
    pub fn setup(&self) -> &RobotSetup {
        self.body.robot.setup()
    }

    /// The last will, which the broker sends for the robot when it is lost.
    pub fn will(&mut self, timestamp: &str) -> WireMessage {
        self.message(&VirtualRobot::will(), timestamp)
    }

    /// Moves the robot until a time in microseconds, lets it act on what it received, and returns what it says.
    /// `timestamp` is the time by its own clock, as messages have it.
    pub fn step(&mut self, now_us: i64, timestamp: &str, received: Vec<ReadMessage>) -> Vec<WireMessage> {
        let mut clear = Vec::new();
        for message in received {
            match message {
                ReadMessage::Clear(message) => clear.push(message),
                ReadMessage::Garbled(kind, why) => self.body.robot.receive_unreadable(kind, why),
            }
        }
        let said = self.body.step(now_us, &clear);
        said.iter().map(|said| self.message(said, timestamp)).collect()
    }

    /// Reads a message as the robot does: with the key of instant actions that it knows, the deviations that it can
    /// spell, and the versions that it accepts.
    pub fn read(&self, kind: TopicKind, payload: &[u8]) -> ReadMessage {
        match self.decode(kind, payload) {
            Ok(message) => ReadMessage::Clear(message),
            Err(why) => ReadMessage::Garbled(kind, why),
        }
    }

    fn decode(&self, kind: TopicKind, payload: &[u8]) -> Result<Message, GarbledMessage> {
        let quirks = self.setup().quirks;
        let mut value: Value = serde_json::from_slice(payload).map_err(|_| GarbledMessage::NotJson)?;
        let fields = value.as_object_mut().ok_or(GarbledMessage::WrongForm)?;
        if kind == TopicKind::InstantActions {
            let (has, has_instant) = (fields.contains_key("actions"), fields.contains_key("instantActions"));
            if !quirks.instant_actions_key.understands(has, has_instant) {
                return Err(GarbledMessage::WrongForm);
            }
        }
        if kind == TopicKind::Order {
            forget_deviations(&mut value, quirks.deviation_key);
        }
        let said = read(kind, value.to_string().as_bytes()).map_err(|_| GarbledMessage::WrongForm)?;
        let version = Version::of_text(&said.header.version).ok_or(GarbledMessage::WrongForm)?;
        match quirks.version_check.accepts(self.setup().version, version) {
            true => Ok(said.message),
            false => Err(GarbledMessage::WrongForm),
        }
    }

    fn message(&mut self, said: &RobotMessage, timestamp: &str) -> WireMessage {
        let RobotSetup { version, manufacturer, serial, quirks, .. } = self.body.robot.setup();
        let next = self.next.entry(said.topic).or_default();
        let header = Header {
            id: *next,
            timestamp: timestamp.to_owned(),
            version: version.text().to_owned(),
            manufacturer: manufacturer.clone(),
            serial: serial.clone(),
        };
        *next = next.wrapping_add(1);
        let mut text = write(&header, &said.message, *version);
        if let (TopicKind::Factsheet, Some(fields)) = (said.topic, text.as_object_mut()) {
            match quirks.factsheet_form {
                FactsheetForm::Whole => {}
                FactsheetForm::HeaderOnly => fields.retain(|key, _| HEADER.contains(&key.as_str())),
                FactsheetForm::LoadsAreNull => {
                    fields.insert(LOADS.to_owned(), Value::Null);
                }
            }
        }
        WireMessage { kind: said.topic, payload: text.to_string().into_bytes() }
    }
}

/// Takes the deviations out of an order that are spelled as the robot does not read them.
fn forget_deviations(order: &mut Value, reads: DeviationKey) {
    let other = match reads {
        DeviationKey::UpperCase => "allowedDeviationXy",
        DeviationKey::LowerCase => "allowedDeviationXY",
    };
    let nodes = order.get_mut("nodes").and_then(Value::as_array_mut).into_iter().flatten();
    for position in nodes.filter_map(|node| node.get_mut("nodePosition")?.as_object_mut()) {
        position.remove(other);
    }
}
