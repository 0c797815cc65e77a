//! What holds for whole messages: the schemas, reading back, recordings of robots, and bad input.
//!
//! Refuses: details of reading and writing, which are tested beside them.

mod fuzz;
mod leniency;
mod limits;
mod recordings;
mod round_trip;
mod said;
mod schemas;
mod strategies;

use crate::{Header, Message, Oddity, Read, TopicKind, Unreadable, read};
use serde_json::Value;

/// The kind of topic on which a message travels.
fn kind_of(message: &Message) -> TopicKind {
    match message {
        Message::Order(_) => TopicKind::Order,
        Message::InstantActions(_) => TopicKind::InstantActions,
        Message::ZoneSet(_) => TopicKind::ZoneSet,
        Message::Responses(_) => TopicKind::Responses,
        Message::State(_) => TopicKind::State,
        Message::Visualization(_) => TopicKind::Visualization,
        Message::Connection(_) => TopicKind::Connection,
        Message::Factsheet(_) => TopicKind::Factsheet,
    }
}

fn read_value(kind: TopicKind, value: &Value) -> Result<Read, Unreadable> {
    read(kind, value.to_string().as_bytes())
}

/// The oddities of a message, in words.
fn words(oddities: &[Oddity]) -> Vec<String> {
    oddities.iter().map(ToString::to_string).collect()
}

fn a_header(version: &str) -> Header {
    Header {
        id: 7,
        timestamp: "2026-11-30T12:00:00.00Z".to_owned(),
        version: version.to_owned(),
        manufacturer: "maker".to_owned(),
        serial: "r1".to_owned(),
    }
}
