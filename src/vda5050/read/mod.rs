//! Reads messages of robots and masters, however they are spelled.
//!
//! Main function: [`read()`]; main types: [`Read`], [`Oddity`], [`Unreadable`]. Unknown fields are ignored; what is
//! missing, misspelled or impossible becomes an oddity and the careful value, unless a guess would do harm. A field
//! that is `null` or has a wrong form is missing. The work grows with the payload's size alone, within [`MOST_BYTES`],
//! [`MOST_PARTS`], [`LONGEST_LIST`], [`LONGEST_TEXT`] and [`MOST_ODDITIES`]. Refuses: to check what a message says
//! against other messages.

mod answer;
mod factsheet;
mod object;
mod oddity;
mod order;
mod parse;
mod place;
mod state;

pub use oddity::{Oddity, Unreadable};

use crate::model::{Header, Message};
use crate::topic::TopicKind;
use crate::version::Version;
use crate::vocabulary::names;
use object::ObjectReader;
use place::Notes;

/// The longest payload that is read, bytes.
pub const MOST_BYTES: usize = 1 << 20;

/// The most objects and lists of a payload that is read: each takes several hundred bytes of memory.
pub const MOST_PARTS: usize = 50_000;

/// The most elements of a list that are kept.
pub const LONGEST_LIST: usize = 10_000;

/// The most characters of a text that are kept.
pub const LONGEST_TEXT: usize = 1_000;

/// The most oddities that are told of one message; one more says how many there are beyond.
pub const MOST_ODDITIES: usize = 100;

/// The greatest magnitude of a number that is taken for a length, a speed, a mass or an angle.
pub const GREATEST_NUMBER: f64 = 1e9;

/// A message that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Read {
    /// What the message begins with.
    pub header: Header,
    /// What the message says.
    pub message: Message,
    /// What was odd about it; empty if it is as the standard wants it.
    pub oddities: Vec<Oddity>,
}

/// Reads a message of a topic.
///
/// # Errors
/// Why the payload cannot be read: it is too large, no JSON object, or lacks something that cannot be guessed.
pub fn read(kind: TopicKind, payload: &[u8]) -> Result<Read, Unreadable> {
    let notes = Notes::new();
    let fields = parse::object(payload, &notes)?;
    let top = ObjectReader::message(&fields, &notes);
    let header = header(&top);
    // Oddities are told by the names of the version that the sender speaks, or of the middle one if it does not say.
    notes.set_version(Version::of_text(&header.version).unwrap_or(Version::V2_1));
    let message = match kind {
        TopicKind::Order => Message::Order(order::order(&top)?),
        TopicKind::InstantActions => Message::InstantActions(order::instant_actions(&top)?),
        TopicKind::State => Message::State(Box::new(state::state(&top)?)),
        TopicKind::Visualization => Message::Visualization(state::visualization(&top)),
        TopicKind::Connection => Message::Connection(state::connection(&top)?),
        TopicKind::Factsheet => Message::Factsheet(Box::new(factsheet::factsheet(&top))),
        TopicKind::ZoneSet => Message::ZoneSet(answer::zone_set(&top)?),
        TopicKind::Responses => Message::Responses(answer::responses(&top)?),
    };
    Ok(Read { header, message, oddities: notes.into_oddities() })
}

fn header(top: &ObjectReader<'_>) -> Header {
    Header {
        id: top.count_or_zero(&names::HEADER_ID),
        timestamp: top.text_or_empty(&names::TIMESTAMP),
        version: top.text_or_empty(&names::VERSION),
        manufacturer: top.text_or_empty(&names::MANUFACTURER),
        serial: top.text_or_empty(&names::SERIAL),
    }
}
