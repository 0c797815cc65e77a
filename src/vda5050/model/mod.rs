//! The messages, without regard to the version in which they travel.
//!
//! Lengths are in metres, angles in radians, speeds in metres per second, shares from 0 to 1; positions are in the
//! frame of the map that they name. Main types: [`Header`], [`Message`] and those of the submodules. Refuses: fields
//! that neither this master nor this robot has a use for.

pub mod action;
pub mod answer;
pub mod error;
pub mod factsheet;
pub mod order;
pub mod state;
pub mod zone;

use action::Action;
use answer::Response;
use factsheet::Factsheet;
use order::Order;
use state::{ConnectionState, State, Visualization};
use zone::ZoneSet;

/// What every message begins with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    /// The number of the message among those of its topic.
    pub id: u32,
    /// When it was sent, by the sender's clock: ISO 8601, in UTC.
    pub timestamp: String,
    /// The version that the sender speaks, as it says.
    pub version: String,
    /// The robot's manufacturer.
    pub manufacturer: String,
    /// The robot's serial number.
    pub serial: String,
}

/// A message without its header.
#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    /// Where to drive.
    Order(Order),
    /// What to do at once.
    InstantActions(Vec<Action>),
    /// Areas with rules, 3.0.
    ZoneSet(ZoneSet),
    /// Answers to what the robot asks for, 3.0.
    Responses(Vec<Response>),
    /// A robot's state.
    State(Box<State>),
    /// Where a robot is.
    Visualization(Visualization),
    /// Whether a robot is connected.
    Connection(ConnectionState),
    /// What a robot can do.
    Factsheet(Box<Factsheet>),
}
