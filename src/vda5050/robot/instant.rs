//! Instant actions of a virtual robot: what each does, and how it is listed.
//!
//! Main type: [`InstantList`]; main function: `take_instants`. Source: VDA 5050 3.0, sections 6.2.1 and 6.2.3. Refuses:
//! to do an action twice whose id it has seen: a transport may double messages.

use super::VirtualRobot;
use super::actions::parameter;
use super::execution::{OrderPhase, PauseStage};
use super::link::LinkStage;
use super::quirks::{
    CancelHabit, IdleCancel, InstantBatch, InstantHabit, InstantMemory, NumericParameters, PauseHabit,
    RepeatedPause,
};
use crate::model::action::{Action, ActionState, ActionStatus};
use crate::model::state::OperatingMode;
use crate::topic::TopicKind;
use serde_json::Value;
use std::collections::VecDeque;

/// The most instant actions that are listed, and whose ids are remembered; the oldest give way, so that no master can
/// fill a robot's memory.
const LISTED_MOST: usize = 256;
/// In how many states robot A lists a finished instant action.
const STATES_LISTED: u32 = 5;

/// Instant actions that a robot has received.
#[derive(Clone, Debug, Default)]
pub(super) struct InstantList {
    entries: Vec<InstantEntry>,
    seen: VecDeque<String>,
}

#[derive(Clone, Debug)]
struct InstantEntry {
    action: Action,
    stage: InstantStage,
    result: Option<&'static str>,
    /// In how many states it has been listed since it was over.
    listed: u32,
}

/// Where an instant action is in its life.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum InstantStage {
    Running,
    Finished,
    Failed,
}

/// What comes of an instant action when it arrives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum InstantOutcome {
    /// It ends when the robot has stopped.
    Running,
    /// It is done, or the robot says so.
    Finished,
    /// It cannot be done, for a reason that is an error.
    Refused(&'static str),
    /// It failed without an error, or with one that is reported already.
    Failed(&'static str),
    /// It is not listed at all: a quirk.
    Unlisted,
}

impl InstantList {
    /// The states to report.
    pub(super) fn to_states(&self) -> Vec<ActionState> {
        let state = |entry: &InstantEntry| ActionState {
            id: entry.action.id.clone(),
            kind: Some(entry.action.kind.clone()),
            status: match entry.stage {
                InstantStage::Running => ActionStatus::Running,
                InstantStage::Finished => ActionStatus::Finished,
                InstantStage::Failed => ActionStatus::Failed,
            },
            result: entry.result.map(str::to_owned),
        };
        self.entries.iter().map(state).collect()
    }

    /// Removes those that are over.
    pub(super) fn clear_over(&mut self) {
        self.entries.retain(|entry| entry.stage == InstantStage::Running);
    }

    /// A state was sent: the quirk of robot A counts.
    pub(super) fn count_state(&mut self) {
        for entry in self.entries.iter_mut().filter(|entry| entry.stage != InstantStage::Running) {
            entry.listed += 1;
        }
        self.entries.retain(|entry| entry.listed < STATES_LISTED);
    }

    /// Whether an id is new; it is remembered.
    fn is_new(&mut self, id: &str) -> bool {
        if self.seen.iter().any(|seen| seen == id) {
            return false;
        }
        self.seen.push_back(id.to_owned());
        if self.seen.len() > LISTED_MOST {
            self.seen.pop_front();
        }
        true
    }

    fn list(&mut self, action: Action, stage: InstantStage, result: Option<&'static str>) {
        if self.entries.len() >= LISTED_MOST {
            self.entries.remove(0);
        }
        self.entries.push(InstantEntry { action, stage, result, listed: 0 });
    }
}

impl VirtualRobot {
    /// Takes the instant actions of a message.
    pub(super) fn take_instants(&mut self, actions: Vec<Action>) {
        let ends_at_once = |action: &&Action| !matches!(action.kind.as_str(), "startPause" | "cancelOrder");
        if self.setup.quirks.instant_batch == InstantBatch::DiesOfTwo
            && actions.iter().filter(ends_at_once).count() > 1
        {
            self.link = LinkStage::Dead;
            self.outbox.clear();
            return;
        }
        self.reporting.must_say = true;
        let mut parameters = actions.iter().flat_map(|action| &action.parameters);
        if self.setup.quirks.numeric_parameters == NumericParameters::FatalParseError
            && parameters.any(|parameter| parameter.value.is_number())
        {
            self.complain_of_unreadable(TopicKind::InstantActions);
            return;
        }
        for action in actions {
            if self.instants.is_new(&action.id) {
                self.take_instant(action);
            }
        }
    }

    fn take_instant(&mut self, action: Action) {
        let outcome = match self.mode_forbids(&action) {
            Some(why) => InstantOutcome::Refused(why),
            None => self.obey(&action),
        };
        let (stage, result) = match outcome {
            InstantOutcome::Running => (InstantStage::Running, None),
            InstantOutcome::Finished => (InstantStage::Finished, None),
            InstantOutcome::Refused(why) => {
                self.complain_of_instant(&action, why);
                (InstantStage::Failed, Some(why))
            }
            InstantOutcome::Failed(why) => (InstantStage::Failed, Some(why)),
            InstantOutcome::Unlisted => return,
        };
        if stage != InstantStage::Failed {
            self.forgive_instant();
        }
        self.instants.list(action, stage, result);
    }

    fn mode_forbids(&self, action: &Action) -> Option<&'static str> {
        let is_question = matches!(action.kind.as_str(), "stateRequest" | "factsheetRequest");
        match self.mode {
            OperatingMode::Automatic | OperatingMode::SemiAutomatic => None,
            OperatingMode::Intervened if action.kind == "cancelOrder" => None,
            OperatingMode::Intervened => Some("a person has intervened, only cancelOrder is obeyed"),
            _ if is_question => None,
            _ => Some("the mode does not allow instant actions"),
        }
    }

    fn obey(&mut self, action: &Action) -> InstantOutcome {
        match action.kind.as_str() {
            "stateRequest" => InstantOutcome::Finished,
            "factsheetRequest" => {
                self.say_factsheet();
                InstantOutcome::Finished
            }
            "startPause" => self.obey_pause(),
            "cancelOrder" => self.obey_cancel(action),
            _ if self.setup.quirks.instant_actions == InstantHabit::Claimed => InstantOutcome::Finished,
            "stopPause" => {
                self.pause = PauseStage::Off;
                self.fail_running("startPause", "stopPause came before the robot stood");
                InstantOutcome::Finished
            }
            "startCharging" if self.order.released_left() > 0 => {
                InstantOutcome::Refused("the order still has a way to drive")
            }
            "startCharging" => outcome(self.start_charging()),
            "stopCharging" => {
                self.equipment.is_charging = false;
                InstantOutcome::Finished
            }
            "logReport" => InstantOutcome::Finished,
            kind if kind == self.position_action() => {
                if self.is_idle() {
                    outcome(self.take_position(action))
                } else {
                    InstantOutcome::Refused("the robot has an order")
                }
            }
            _ if self.speaks_3_0() => self.obey_3_0(action),
            _ => InstantOutcome::Refused("the robot does not know the action"),
        }
    }

    fn obey_3_0(&mut self, action: &Action) -> InstantOutcome {
        let text = |key| parameter(action, key).and_then(Value::as_str).unwrap_or("").to_owned();
        let (meant, set) = (text("actionId"), text("zoneSetId"));
        let (is_done, why) = match action.kind.as_str() {
            "clearInstantActions" => {
                self.instants.clear_over();
                (true, "")
            }
            "trigger" => (self.pull_trigger(), "no action waits for a trigger"),
            "enableZoneSet" => (self.enable_zone_set(&set), "there is no such zone set"),
            "deleteZoneSet" => (self.delete_zone_set(&set), "there is no such zone set that is not in force"),
            "retry" => (self.decide_retry(&meant, true), "no such action is RETRIABLE"),
            "skipRetry" => (self.decide_retry(&meant, false), "no such action is RETRIABLE"),
            _ => (false, "the robot does not know the action"),
        };
        if is_done { InstantOutcome::Finished } else { InstantOutcome::Refused(why) }
    }

    fn obey_pause(&mut self) -> InstantOutcome {
        if self.setup.quirks.pause == PauseHabit::FailsAndDrivesOn {
            return InstantOutcome::Failed("failed to run the action");
        }
        if self.is_paused() {
            return match self.setup.quirks.repeated_pause {
                RepeatedPause::Finished => InstantOutcome::Finished,
                RepeatedPause::Failed => InstantOutcome::Refused("the robot is paused already"),
            };
        }
        self.begin_pause();
        InstantOutcome::Running
    }

    fn obey_cancel(&mut self, action: &Action) -> InstantOutcome {
        let meant = parameter(action, "orderId").and_then(Value::as_str);
        let is_meant = meant.is_none_or(|id| id == self.order.id);
        let is_active = !self.is_idle() && self.order.phase != OrderPhase::Cleared;
        if is_active && is_meant {
            if self.setup.quirks.cancel == CancelHabit::ClaimsAndDrivesOn {
                return InstantOutcome::Finished;
            }
            self.begin_cancel();
            if self.setup.quirks.cancel == CancelHabit::AtOnceAndUnpauses {
                self.pause = PauseStage::Off;
            }
            return InstantOutcome::Running;
        }
        if self.setup.quirks.idle_cancel == IdleCancel::Finished {
            return InstantOutcome::Finished;
        }
        self.complain_of_cancel(action);
        if self.setup.quirks.idle_cancel == IdleCancel::ErrorOnly {
            return InstantOutcome::Unlisted;
        }
        InstantOutcome::Failed("there is no such order")
    }

    /// Finishes the running instant actions of a kind.
    pub(super) fn finish_running(&mut self, kind: &str) {
        self.end_running(kind, InstantStage::Finished, None);
    }

    fn fail_running(&mut self, kind: &str, why: &'static str) {
        self.end_running(kind, InstantStage::Failed, Some(why));
    }

    fn end_running(&mut self, kind: &str, stage: InstantStage, result: Option<&'static str>) {
        let is_meant =
            |entry: &&mut InstantEntry| entry.stage == InstantStage::Running && entry.action.kind == kind;
        for entry in self.instants.entries.iter_mut().filter(is_meant) {
            entry.stage = stage;
            entry.result = result;
        }
    }

    /// A new order was accepted: before 3.0 there is no other time to forget what is over.
    pub(super) fn forget_instants_at_order(&mut self) {
        if self.setup.quirks.instant_memory == InstantMemory::ByVersion && !self.speaks_3_0() {
            self.instants.clear_over();
        }
    }
}

fn outcome(result: Result<(), &'static str>) -> InstantOutcome {
    match result {
        Ok(()) => InstantOutcome::Finished,
        Err(why) => InstantOutcome::Refused(why),
    }
}
