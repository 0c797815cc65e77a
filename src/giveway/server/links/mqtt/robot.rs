//! One listed robot: its session, the numbers of its messages, and what was said.
//!
//! Main type: [`RobotHere`]. Refuses: to send anything itself.

use giveway_api::{NoticedOfRobot, SaidMessage};
use giveway_fleet::Ledger;
use giveway_floor::id::RobotId;
use giveway_floor::time::Time;
use giveway_floor::warehouse::Warehouse;
use giveway_links::vda5050::{Notice, RobotSession, RobotTold};
use giveway_site::{InstantKey, ListedRobot, RobotLinkSettings, SpeltDeviation};
use giveway_vda5050::{Header, TopicKind, Version, write};
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

/// Notices kept of each robot.
const NOTICES: usize = 50;
/// Messages kept of each robot, both ways.
const MESSAGES: usize = 200;
/// Of a longer message this many bytes are kept.
const LONGEST: usize = 8_192;

/// A listed robot.
pub struct RobotHere {
    pub listed: ListedRobot,
    pub session: RobotSession,
    /// Its number, once it has joined.
    pub number: Option<RobotId>,
    pub asked_to_join: Option<Time>,
    /// Whether it may join again after it has left the floor: somebody has registered it anew.
    pub returns: bool,
    pub noticed: VecDeque<(Time, Notice)>,
    pub said: VecDeque<SaidMessage>,
    /// How its kind spells what the published 2.0 spells otherwise.
    spelling: (InstantKey, SpeltDeviation),
    /// The number of the next message of each kind.
    next: BTreeMap<TopicKind, u32>,
}

impl RobotHere {
    /// A robot of which nothing was heard yet, or that speaks another version than was thought.
    pub fn new(
        listed: ListedRobot,
        version: Version,
        settings: RobotLinkSettings,
        (map, boot): (Arc<Warehouse>, u64),
    ) -> RobotHere {
        let spelling = (settings.instant_key, settings.deviation_key);
        let session = RobotSession::new(version, settings, map, boot);
        let (next, noticed, said) = Default::default();
        RobotHere {
            listed,
            session,
            number: None,
            asked_to_join: None,
            returns: false,
            noticed,
            said,
            spelling,
            next,
        }
    }

    /// The same robot in another session. What was said is kept, and the numbers of messages go on.
    pub fn begin_again(self, version: Version) -> RobotHere {
        RobotHere { session: self.session.begin_again(version), number: None, asked_to_join: None, ..self }
    }

    /// The text of a message for the robot.
    pub fn text_of(&mut self, now: Time, told: &RobotTold) -> String {
        let version = self.session.version();
        let next = self.next.entry(told.kind).or_default();
        let header = Header {
            id: *next,
            timestamp: timestamp(now),
            version: version.text().to_owned(),
            manufacturer: self.listed.address.manufacturer().to_owned(),
            serial: self.listed.address.serial().to_owned(),
        };
        *next = next.wrapping_add(1);
        let mut text = write(&header, &told.message, version);
        match told.kind {
            TopicKind::InstantActions => name_actions(&mut text, self.spelling.0),
            TopicKind::Order if self.spelling.1 == SpeltDeviation::Published => spell_deviations(&mut text),
            _ => {}
        }
        let text = text.to_string();
        self.keep(now, true, told.kind, &text);
        text
    }

    /// Keeps a message among the last ones.
    pub fn keep(&mut self, at: Time, is_to_robot: bool, kind: TopicKind, text: &str) {
        if self.said.len() >= MESSAGES {
            self.said.pop_front();
        }
        let text = text[..text.floor_char_boundary(LONGEST)].to_owned();
        self.said.push_back(SaidMessage { at, is_to_robot, topic: kind.level().to_owned(), text });
    }

    /// Keeps a notice among the last ones.
    pub fn note(&mut self, at: Time, notice: Notice) {
        tracing::warn!(robot = self.listed.name, "{}", notice.said());
        if self.noticed.len() >= NOTICES {
            self.noticed.pop_front();
        }
        self.noticed.push_back((at, notice));
    }

    /// Whether the robot has left the floor and nobody has registered it anew.
    pub fn has_left(&self, ledger: &Ledger) -> bool {
        let is_gone = || ledger.robots.iter().any(|r| r.name == self.listed.name && r.is_gone());
        self.number.is_none() && !self.returns && is_gone()
    }

    /// What was noticed, in words.
    pub fn notices(&self) -> Vec<NoticedOfRobot> {
        let row = |(at, notice): &(Time, Notice)| NoticedOfRobot {
            at: *at,
            said: notice.said(),
            is_false_claim: notice.is_lie(),
        };
        self.noticed.iter().map(row).collect()
    }
}

/// Gives instant actions the key that a kind reads. All texts but the first have `actions`.
fn name_actions(text: &mut serde_json::Value, key: InstantKey) {
    let Some(fields) = text.as_object_mut() else { return };
    let Some(actions) = fields.get("actions").cloned() else { return };
    if key != InstantKey::Actions {
        fields.insert("instantActions".to_owned(), actions);
    }
    if key == InstantKey::InstantActions {
        fields.remove("actions");
    }
}

/// Spells allowed deviations as 2.0 was published.
fn spell_deviations(text: &mut serde_json::Value) {
    let nodes = text.get_mut("nodes").and_then(serde_json::Value::as_array_mut);
    for node in nodes.into_iter().flatten() {
        let place = node.get_mut("nodePosition").and_then(serde_json::Value::as_object_mut);
        if let Some(place) = place
            && let Some(deviation) = place.remove("allowedDeviationXY")
        {
            place.insert("allowedDeviationXy".to_owned(), deviation);
        }
    }
}

/// A time as messages have it: ISO 8601 in UTC, with milliseconds.
fn timestamp(now: Time) -> String {
    let at = jiff::Timestamp::from_microsecond(now.0).unwrap_or(jiff::Timestamp::UNIX_EPOCH);
    format!("{at:.3}")
}
