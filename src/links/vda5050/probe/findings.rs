//! What a probe found, and its form as JSON.
//!
//! Main type: [`ProbeFindings`]. Refuses: to tell what was not tried; it says so.

use super::course::DeviationSpelling;
use giveway_vda5050::{
    Address, ConnectionState, ErrorLevel, Factsheet, OperatingMode, State, TopicKind, Version,
};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// Fields of a message's header.
const HEADER_FIELDS: usize = 5;
/// A base that bounds how far a robot drives on that hears no pause, metres.
const SHORT_BASE_M: f64 = 1.5;

/// The key under which instant actions are sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeySpelling {
    /// `actions`.
    Actions,
    /// `instantActions`.
    InstantActions,
    /// Both.
    Both,
}

/// What a factsheet is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FactsheetWorth {
    /// Everything that the schema wants is there.
    Valid,
    /// Something is missing or of a wrong form.
    Invalid,
    /// It has a header and nothing else.
    Empty,
}

/// What a robot made of a pause while it stood.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IdlePause {
    /// Its state says that it is paused.
    Obeyed,
    /// It says FINISHED, and its states have no `paused`.
    Said,
    /// It says FINISHED, and that it is not paused.
    Claimed,
    /// It says FAILED.
    Refused,
    /// It says nothing.
    Silent,
}

/// What a robot made of a pause or a cancel on its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveAnswer {
    /// It braked at once.
    AtOnce,
    /// It stopped at the next node.
    AtNodes,
    /// It heard it when it stood at its goal.
    Late,
    /// It said that it had, and drove on.
    Claims,
    /// Nothing.
    None,
}

/// What a robot made of an action that does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActionAnswer {
    /// It refused it, as it should.
    Refused,
    /// It said that it had done it.
    Claims,
    /// It ended the order and said nothing of the action.
    Silent,
    /// It did not end.
    Unfinished,
}

/// What a robot made of a cancel without an order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CancelAnswer {
    /// FAILED, as it should.
    Failed,
    /// An error and no action state.
    ErrorOnly,
    /// FINISHED.
    SaidDone,
    /// Nothing.
    Silent,
}

/// What a robot made of an order that it got twice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RepeatAnswer {
    /// Nothing, as it should.
    Safe,
    /// An error.
    Error,
    /// An error of level FATAL.
    Fatal,
}

/// What a probe found.
#[derive(Clone, Debug)]
pub struct ProbeFindings {
    pub(super) address: Address,
    /// The version that the robot speaks.
    pub version: Option<Version>,
    pub(super) other_version: Option<String>,
    pub(super) connection: Option<ConnectionState>,
    /// The last factsheet, and what it is worth.
    pub sheet: Option<(Factsheet, FactsheetWorth)>,
    /// The key of instant actions that the robot reads; nothing if it answers none.
    pub key: Option<KeySpelling>,
    pub(super) deviation: Option<DeviationSpelling>,
    pub(super) idle_pause: Option<IdlePause>,
    /// Whether the robot says that it is still paused after it was to go on.
    pub(super) stays_paused: bool,
    pub(super) idle_cancel: Option<CancelAnswer>,
    /// What the robot makes of a pause on its way; nothing if it was not tried.
    pub pause: Option<DriveAnswer>,
    /// What the robot makes of a cancel on its way; nothing if it was not tried.
    pub cancel: Option<DriveAnswer>,
    /// What the robot makes of an action that does not exist; nothing if it was not tried.
    pub actions: Option<ActionAnswer>,
    /// What the robot makes of an order that it gets twice; nothing if it was not tried.
    pub repeat: Option<RepeatAnswer>,
    /// The robot's words when it refused an order to where it stands.
    pub(super) refused_order: Option<String>,
    pub(super) drives: Option<bool>,
    pub(super) is_too_near: bool,
    /// Whether the robot answers at the end.
    pub alive: bool,
    pub(super) unreadable: BTreeSet<&'static str>,
    pub(super) said: SaidFlags,
}

/// What was ever seen in the robot's states.
#[derive(Clone, Debug, Default)]
pub(super) struct SaidFlags {
    pub states: u32,
    pub map: Option<String>,
    pub localized: bool,
    pub paused: bool,
    pub driving: bool,
    pub loads: bool,
    pub mode: Option<OperatingMode>,
    /// Types of the errors that stand at the end.
    pub errors: Vec<String>,
}

impl KeySpelling {
    /// All, in the order in which they are tried.
    pub const ALL: [KeySpelling; 3] = [KeySpelling::Actions, KeySpelling::InstantActions, KeySpelling::Both];

    /// Gives instant actions this key.
    pub(super) fn spell(self, text: &mut Value) {
        let Some(fields) = text.as_object_mut() else { return };
        let Some(actions) = fields.get("actions").cloned() else { return };
        if self != KeySpelling::Actions {
            fields.insert("instantActions".to_owned(), actions);
        }
        if self == KeySpelling::InstantActions {
            fields.remove("actions");
        }
    }

    fn word(self) -> &'static str {
        match self {
            KeySpelling::Actions => "actions",
            KeySpelling::InstantActions => "instantActions",
            KeySpelling::Both => "both",
        }
    }
}

impl RepeatAnswer {
    /// The answer whose worst error has this level.
    pub(super) fn of(level: Option<ErrorLevel>) -> RepeatAnswer {
        match level {
            None => RepeatAnswer::Safe,
            Some(ErrorLevel::Fatal) => RepeatAnswer::Fatal,
            Some(_) => RepeatAnswer::Error,
        }
    }
}

impl DriveAnswer {
    fn word(self) -> &'static str {
        match self {
            DriveAnswer::AtOnce => "at once",
            DriveAnswer::AtNodes => "at nodes",
            DriveAnswer::Late => "late",
            DriveAnswer::Claims => "claims",
            DriveAnswer::None => "none",
        }
    }
}

impl ProbeFindings {
    pub(super) fn new(address: Address) -> ProbeFindings {
        ProbeFindings {
            address,
            version: None,
            other_version: None,
            connection: None,
            sheet: None,
            key: None,
            deviation: None,
            idle_pause: None,
            stays_paused: false,
            idle_cancel: None,
            pause: None,
            cancel: None,
            actions: None,
            repeat: None,
            refused_order: None,
            drives: None,
            is_too_near: false,
            alive: false,
            unreadable: BTreeSet::new(),
            said: SaidFlags::default(),
        }
    }

    pub(super) fn note_unreadable(&mut self, kind: TopicKind) {
        self.unreadable.insert(kind.level());
    }

    pub(super) fn note_sheet(&mut self, sheet: Factsheet, fields: usize, is_whole: bool) {
        let worth = match (fields > HEADER_FIELDS, is_whole) {
            (false, _) => FactsheetWorth::Empty,
            (true, true) => FactsheetWorth::Valid,
            (true, false) => FactsheetWorth::Invalid,
        };
        self.sheet = Some((sheet, worth));
    }

    pub(super) fn note_state(&mut self, state: &State) {
        self.said.states += 1;
        self.said.mode = Some(state.mode);
        self.said.paused |= state.paused.is_some();
        self.said.driving |= state.driving;
        self.said.loads |= state.loads.is_some();
        if let Some(position) = &state.position {
            self.said.localized |= position.localized;
            self.said.map = Some(position.map.clone());
        }
    }

    pub(super) fn note_end(&mut self, state: Option<&State>) {
        let errors = state.map(|state| state.errors.as_slice()).unwrap_or_default();
        let kinds: BTreeSet<String> = errors.iter().map(|error| error.kind.clone()).collect();
        self.said.errors = kinds.into_iter().collect();
    }

    /// Whether anything was heard of the robot.
    pub fn is_heard(&self) -> bool {
        self.said.states > 0 || self.connection.is_some()
    }

    /// What a pause does, as far as it was tried: a robot that does not pause while it stands does not on its way.
    pub(super) fn pause_word(&self) -> &'static str {
        match (self.pause, self.idle_pause) {
            (Some(answer), _) => answer.word(),
            (None, Some(IdlePause::Refused | IdlePause::Silent | IdlePause::Claimed)) => "none",
            (None, _) => "not tried",
        }
    }

    /// Everything as JSON.
    pub fn to_json(&self) -> Value {
        let worth = self.sheet.as_ref().map(|(_, worth)| match worth {
            FactsheetWorth::Valid => "valid",
            FactsheetWorth::Invalid => "invalid",
            FactsheetWorth::Empty => "empty",
        });
        let actions = self.actions.map(|answer| match answer {
            ActionAnswer::Refused => "refused",
            ActionAnswer::Claims => "claims",
            ActionAnswer::Silent => "silent",
            ActionAnswer::Unfinished => "unfinished",
        });
        let repeat = self.repeat.map(|answer| match answer {
            RepeatAnswer::Safe => "safe",
            RepeatAnswer::Error => "error",
            RepeatAnswer::Fatal => "fatal",
        });
        let reconnect = match self.connection {
            _ if self.said.states == 0 => "not tried",
            Some(ConnectionState::Online) => "not tried",
            Some(_) | None => "unannounced",
        };
        let not_tried = "not tried";
        json!({
            "robot": self.address.to_string(),
            "version": self.version.map(Version::text),
            "factsheet": worth.unwrap_or("none"),
            "quirks": self.quirks(),
            "pause": self.pause_word(),
            "cancel": self.cancel.map_or(not_tried, DriveAnswer::word),
            "actions": actions.unwrap_or(not_tried),
            "repeat": repeat.unwrap_or(not_tried),
            "reconnect": reconnect,
            "alive": self.alive,
            "kind": self.kind(),
            "ask": self.questions(),
        })
    }

    /// What the robot does otherwise than the standard, as far as it was seen.
    fn quirks(&self) -> Map<String, Value> {
        let mut quirks = Map::new();
        let mut add = |key: &str, word: Option<&str>| {
            if let Some(word) = word {
                quirks.insert(key.to_owned(), json!(word));
            }
        };
        add("instant_actions_key", self.key.map(KeySpelling::word));
        add(
            "deviation_key",
            match (self.deviation, self.drives) {
                (Some(DeviationSpelling::Published), _) => Some("allowedDeviationXy"),
                (Some(_), _) => Some("allowedDeviationXY"),
                (None, Some(true)) => Some("none"),
                (None, _) => None,
            },
        );
        let has_states = self.said.states > 0;
        add("localized", (has_states && !self.said.localized).then_some("never"));
        add("paused", (has_states && !self.said.paused).then_some("absent"));
        add("driving", (self.drives == Some(true) && !self.said.driving).then_some("never"));
        add("loads", (has_states && !self.said.loads).then_some("absent"));
        add(
            "idle_pause",
            self.idle_pause.map(|answer| match answer {
                IdlePause::Obeyed => "obeyed",
                IdlePause::Said => "said",
                IdlePause::Claimed => "claimed",
                IdlePause::Refused => "failed",
                IdlePause::Silent => "silent",
            }),
        );
        add(
            "idle_cancel",
            self.idle_cancel.map(|answer| match answer {
                CancelAnswer::Failed => "failed",
                CancelAnswer::ErrorOnly => "error only",
                CancelAnswer::SaidDone => "finished",
                CancelAnswer::Silent => "silent",
            }),
        );
        if !self.said.errors.is_empty() {
            quirks.insert("errors_stand".to_owned(), json!(self.said.errors));
        }
        quirks
    }

    /// The kind of the robot for a file of robots.
    fn kind(&self) -> Value {
        let (mut fleet, mut link, mut quirks) = (Map::new(), Map::new(), Map::new());
        if let Some((sheet, _)) = &self.sheet {
            let mut add = |key: &str, figure: Option<f64>, most: f64| {
                if let Some(figure) = figure.filter(|figure| (0.1..=most).contains(figure)) {
                    fleet.insert(key.to_owned(), json!(figure));
                }
            };
            add("speed_mps", sheet.speed_mps, 5.0);
            add("accel_unloaded_mps2", sheet.accel_mps2, 5.0);
            add("accel_loaded_mps2", sheet.accel_mps2, 5.0);
            if let Some((length, width)) = sheet.length_m.zip(sheet.width_m) {
                let (x, y) = (length / 2.0, width / 2.0);
                if [x, y].iter().all(|half| (0.025..=10.0).contains(half)) {
                    fleet.insert(
                        "footprint".to_owned(),
                        json!({"polygon_m": [[x, y], [-x, y], [-x, -y], [x, -y]]}),
                    );
                }
            }
        }
        if let Some(map) = &self.said.map {
            link.insert("maps".to_owned(), json!({map: {}}));
        }
        if matches!(self.pause_word(), "none" | "late" | "at nodes") {
            link.insert("longest_base_m".to_owned(), json!(SHORT_BASE_M));
        }
        if let Some(key) = self.key {
            quirks.insert("instant_actions_key".to_owned(), json!(key.word()));
        }
        if self.deviation == Some(DeviationSpelling::Published) {
            quirks.insert("deviation_key".to_owned(), json!("allowedDeviationXy"));
        }
        if matches!(self.repeat, Some(RepeatAnswer::Error | RepeatAnswer::Fatal)) {
            quirks.insert("repeat".to_owned(), json!("never"));
        }
        if self.said.states > 0 && !self.said.localized {
            quirks.insert("localized".to_owned(), json!("ignored"));
        }
        link.insert("quirks".to_owned(), Value::Object(quirks));
        json!({"fleet": fleet, "link": link})
    }
}
