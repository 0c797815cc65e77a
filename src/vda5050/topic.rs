//! Topics: `[prefix/]interface/majorVersion/manufacturer/serialNumber/topic`.
//!
//! Main types: [`Address`], [`TopicKind`]. Refuses: levels that a broker would take for wildcards or for two levels.

use crate::version::Version;
use std::fmt;

/// What a message is about: the last level of its topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum TopicKind {
    /// Master to robot: where to drive.
    Order,
    /// Master to robot: what to do at once.
    InstantActions,
    /// Master to robot, 3.0: areas with rules.
    ZoneSet,
    /// Master to robot, 3.0: answers to what the robot asks for.
    Responses,
    /// Robot to master: its state.
    State,
    /// Robot to master: where it is, often.
    Visualization,
    /// Robot, or the broker for it: whether it is connected. Retained.
    Connection,
    /// Robot to master: what it can do. Retained.
    Factsheet,
}

impl TopicKind {
    /// All kinds.
    pub const ALL: [TopicKind; 8] = [
        TopicKind::Order,
        TopicKind::InstantActions,
        TopicKind::ZoneSet,
        TopicKind::Responses,
        TopicKind::State,
        TopicKind::Visualization,
        TopicKind::Connection,
        TopicKind::Factsheet,
    ];

    /// The level of the topic.
    pub fn level(self) -> &'static str {
        match self {
            TopicKind::Order => "order",
            TopicKind::InstantActions => "instantActions",
            TopicKind::ZoneSet => "zoneSet",
            TopicKind::Responses => "responses",
            TopicKind::State => "state",
            TopicKind::Visualization => "visualization",
            TopicKind::Connection => "connection",
            TopicKind::Factsheet => "factsheet",
        }
    }

    /// Whether robots send these messages.
    pub fn is_from_robot(self) -> bool {
        matches!(
            self,
            TopicKind::State | TopicKind::Visualization | TopicKind::Connection | TopicKind::Factsheet
        )
    }

    /// Whether a version has such messages.
    pub fn is_in(self, version: Version) -> bool {
        version >= Version::V3_0 || !matches!(self, TopicKind::ZoneSet | TopicKind::Responses)
    }

    /// Whether the broker keeps the last of these messages.
    pub fn is_retained(self) -> bool {
        matches!(self, TopicKind::Connection | TopicKind::Factsheet)
    }
}

/// A robot's name in the world of VDA 5050.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Address {
    manufacturer: String,
    serial: String,
}

/// A text that cannot be part of a topic.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{part} is {text:?}, but must have 1 to 100 characters and none of / + # $")]
pub struct AddressError {
    /// Which part: manufacturer or serial number.
    pub part: &'static str,
    /// The text.
    pub text: String,
}

impl Address {
    /// The address of a robot.
    ///
    /// # Errors
    /// Which part cannot be a level of a topic.
    pub fn new(manufacturer: &str, serial: &str) -> Result<Address, AddressError> {
        for (part, text) in [("the manufacturer", manufacturer), ("the serial number", serial)] {
            if !is_level(text) {
                return Err(AddressError { part, text: text.chars().take(100).collect() });
            }
        }
        Ok(Address { manufacturer: manufacturer.to_owned(), serial: serial.to_owned() })
    }

    /// The manufacturer.
    pub fn manufacturer(&self) -> &str {
        &self.manufacturer
    }

    /// The serial number.
    pub fn serial(&self) -> &str {
        &self.serial
    }

    /// The robot's topic of a kind; `interface` may have several levels.
    pub fn topic(&self, interface: &str, version: Version, kind: TopicKind) -> String {
        format!(
            "{interface}/{}/{}/{}/{}",
            version.topic_level(),
            self.manufacturer,
            self.serial,
            kind.level()
        )
    }

    /// The robot, the level of its major version, and the kind of a topic; nothing if the topic has another form.
    pub fn of_topic<'t>(topic: &'t str, interface: &str) -> Option<(Address, &'t str, TopicKind)> {
        let rest = topic.strip_prefix(interface)?.strip_prefix('/')?;
        let mut levels = rest.split('/');
        let (version, manufacturer, serial, kind) =
            (levels.next()?, levels.next()?, levels.next()?, levels.next()?);
        let kind = TopicKind::ALL.into_iter().find(|k| k.level() == kind)?;
        let address = Address::new(manufacturer, serial).ok()?;
        levels.next().is_none().then_some((address, version, kind))
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.manufacturer, self.serial)
    }
}

fn is_level(text: &str) -> bool {
    let is_fine = |c: char| !c.is_control() && !matches!(c, '/' | '+' | '#' | '$');
    !text.trim().is_empty() && text.chars().count() <= 100 && text.chars().all(is_fine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_topic_is_read_as_it_was_written_also_with_a_prefix_of_several_levels() {
        let robot = Address::new("coaty", "a 1").expect("an address");
        for interface in ["uagv", "site/hall-2/vda5050"] {
            for (version, kind) in Version::ALL.into_iter().zip(TopicKind::ALL) {
                let topic = robot.topic(interface, version, kind);
                assert_eq!(
                    Address::of_topic(&topic, interface),
                    Some((robot.clone(), version.topic_level(), kind))
                );
            }
        }
        for other in
            ["uagv/v2/a/b", "uagv/v2/a/b/state/x", "uagv/v2/a//state", "other/v2/a/b/state", "uagv/v2/a/b/s"]
        {
            assert_eq!(Address::of_topic(other, "uagv"), None, "{other}");
        }
    }

    #[test]
    fn what_a_broker_would_take_for_something_else_is_no_address() {
        for text in ["", " ", "a/b", "a+", "#", "$SYS", "a\nb"] {
            assert!(Address::new(text, "b").is_err() && Address::new("a", text).is_err(), "{text:?}");
        }
        assert!(Address::new(&"x".repeat(101), "b").is_err());
    }
}
