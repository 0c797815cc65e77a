//! Where in a message something is, and the list of what was odd there.
//!
//! Main types: [`PayloadPath`], [`Notes`]. A path is put into words when something is odd.
//! Refuses:
//! more than a stated number of oddities.

use super::MOST_ODDITIES;
use super::oddity::Oddity;
use crate::version::Version;
use serde_json::Value;
use std::cell::{Cell, RefCell};
use std::fmt;

/// A place in a message.
#[derive(Clone, Copy)]
pub(super) enum PayloadPath<'s> {
    /// The message itself.
    Message,
    /// A field of an object.
    Field(&'s PayloadPath<'s>, &'static str),
    /// An element of a list.
    Item(&'s PayloadPath<'s>, usize),
}

impl fmt::Display for PayloadPath<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PayloadPath::Message => f.write_str("the message"),
            PayloadPath::Field(PayloadPath::Message, name) => f.write_str(name),
            PayloadPath::Field(object, name) => write!(f, "{object}.{name}"),
            PayloadPath::Item(list, index) => write!(f, "{list}[{index}]"),
        }
    }
}

/// What was odd so far.
pub(super) struct Notes {
    version: Cell<Version>,
    kept: RefCell<Vec<Oddity>>,
    beyond: Cell<usize>,
}

impl Notes {
    pub(super) fn new() -> Notes {
        Notes { version: Cell::new(Version::V2_1), kept: RefCell::default(), beyond: Cell::new(0) }
    }

    /// The version by whose names places are called.
    pub(super) fn version(&self) -> Version {
        self.version.get()
    }

    pub(super) fn set_version(&self, version: Version) {
        self.version.set(version);
    }

    /// Notes an oddity, which is put into words only if there is room for it.
    pub(super) fn add(&self, oddity: impl FnOnce(Version) -> Oddity) {
        let mut kept = self.kept.borrow_mut();
        if kept.len() < MOST_ODDITIES {
            kept.push(oddity(self.version.get()));
        } else {
            self.beyond.set(self.beyond.get().saturating_add(1));
        }
    }

    pub(super) fn into_oddities(self) -> Vec<Oddity> {
        let mut all = self.kept.into_inner();
        let count = self.beyond.get();
        if count > 0 {
            all.push(Oddity::Further { count });
        }
        all
    }
}

/// The form of a value, in words.
pub(super) fn form(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a text",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}
