//! The written form of what robots do at stops: part of the journal's wire form.
//!
//! Main type: [`ActRecord`]. Refuses: to stand alone; versions are `record`'s business.

use giveway_fleet::Act;
use giveway_floor::id::RackId;
use giveway_floor::time::Span;
use serde::{Deserialize, Serialize};

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum ActRecord {
    Lift(u32),
    Set(u32),
    Pick(i64),
    Arrive,
}

impl From<Act> for ActRecord {
    fn from(a: Act) -> ActRecord {
        match a {
            Act::Lift(rack) => ActRecord::Lift(rack.0),
            Act::Set(rack) => ActRecord::Set(rack.0),
            Act::Pick(span) => ActRecord::Pick(span.0),
            Act::Arrive => ActRecord::Arrive,
        }
    }
}

impl From<ActRecord> for Act {
    fn from(a: ActRecord) -> Act {
        match a {
            ActRecord::Lift(rack) => Act::Lift(RackId(rack)),
            ActRecord::Set(rack) => Act::Set(RackId(rack)),
            ActRecord::Pick(span) => Act::Pick(Span(span)),
            ActRecord::Arrive => Act::Arrive,
        }
    }
}
