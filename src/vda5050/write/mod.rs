//! Writes messages as the official schema of a version wants them.
//!
//! Main function: [`write()`]. Which names and words a version has is data (`crate::vocabulary`); what it has no name
//! for is not written. A number that is not finite is left out, and so is the object that cannot be without it; angles
//! are brought to [-π, π], and magnitudes below 0 are written as 0. Refuses: to check orders, and to shorten texts.

mod answer;
mod factsheet;
mod object;
mod order;
mod state;

use crate::model::{Header, Message};
use crate::version::Version;
use crate::vocabulary::{names, words};
use object::ObjectWriter;
use serde_json::Value;

/// A message as a version has it. The header names that version, whatever version the given header names.
pub fn write(header: &Header, message: &Message, version: Version) -> Value {
    let mut top = ObjectWriter::new(version);
    top.put(&names::HEADER_ID, header.id);
    top.put(&names::TIMESTAMP, header.timestamp.as_str());
    top.put(&names::VERSION, version.text());
    top.put(&names::MANUFACTURER, header.manufacturer.as_str());
    top.put(&names::SERIAL, header.serial.as_str());
    match message {
        Message::Order(order) => order::order(&mut top, order),
        Message::InstantActions(actions) => order::instant_actions(&mut top, actions),
        Message::ZoneSet(set) => answer::zone_set(&mut top, set),
        Message::Responses(responses) => answer::responses(&mut top, responses),
        Message::State(state) => state::state(&mut top, state),
        Message::Visualization(visualization) => state::visualization(&mut top, visualization),
        Message::Connection(connection) => top.word(&names::CONNECTION, &words::CONNECTION, *connection),
        Message::Factsheet(sheet) => factsheet::factsheet(&mut top, sheet),
    }
    top.into_value()
}
