//! The actions of the order that a virtual robot has: what it can do, when each begins, and what comes of it.
//!
//! Main types: [`ActionEntry`], [`ActionStage`]; main function: `work`. Source: VDA 5050 3.0, sections 6.2.2 and 6.6.9.
//! Refuses: to begin an action of a node that is not passed, or two that exclude each other.

use super::VirtualRobot;
use super::execution::PauseStage;
use super::quirks::{HandlingParameters, OrderActionHabit};
use super::setup::{ChargingPlaces, SECOND_US};
use crate::model::action::{Action, ActionState, ActionStatus, BlockingType};
use crate::model::state::{EStop, Load};
use serde_json::Value;

/// An action of the order.
#[derive(Clone, Debug)]
pub(super) struct ActionEntry {
    pub(super) action: Action,
    /// The key of the node or edge to which it belongs; 0 is nowhere.
    pub(super) key: u32,
    pub(super) stage: ActionStage,
    result: Option<&'static str>,
}

/// Where an action of an order is in its life.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ActionStage {
    /// Its node is not passed, its edge not entered.
    Announced,
    /// It waits for its turn.
    Due,
    /// It is prepared for so many microseconds.
    Preparing { left_us: i64 },
    /// It goes on for so many microseconds.
    Running { left_us: i64 },
    /// It goes on until a trigger comes.
    AwaitingTrigger,
    /// It failed, and a retry may come.
    Retriable,
    /// It is done.
    Finished,
    /// It failed.
    Failed,
}

/// Where an action is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ActionPlace {
    Node,
    Edge,
}

impl ActionStage {
    pub(super) fn is_over(self) -> bool {
        matches!(self, ActionStage::Finished | ActionStage::Failed)
    }

    fn is_in_progress(self) -> bool {
        !self.is_over() && !matches!(self, ActionStage::Announced | ActionStage::Due)
    }
}

impl ActionEntry {
    /// Whether the robot must stand for it now.
    pub(super) fn blocks_driving(&self) -> bool {
        self.stage != ActionStage::Announced && self.will_block_driving()
    }

    /// Whether the robot must stand for it, now or once it is there.
    pub(super) fn will_block_driving(&self) -> bool {
        let blocks = matches!(self.action.blocking, BlockingType::Soft | BlockingType::Hard);
        blocks && !self.stage.is_over()
    }

    fn is_exclusive(&self) -> bool {
        matches!(self.action.blocking, BlockingType::Single | BlockingType::Hard)
    }

    /// The state to report, given whether the robot is paused.
    pub(super) fn to_state(&self, is_paused: bool) -> ActionState {
        let status = match self.stage {
            ActionStage::Announced | ActionStage::Due => ActionStatus::Waiting,
            ActionStage::Preparing { .. } | ActionStage::Running { .. } if is_paused => ActionStatus::Paused,
            ActionStage::Preparing { .. } => ActionStatus::Initializing,
            ActionStage::Running { .. } | ActionStage::AwaitingTrigger => ActionStatus::Running,
            ActionStage::Retriable => ActionStatus::Retriable,
            ActionStage::Finished => ActionStatus::Finished,
            ActionStage::Failed => ActionStatus::Failed,
        };
        ActionState {
            id: self.action.id.clone(),
            kind: Some(self.action.kind.clone()),
            status,
            result: self.result.map(str::to_owned),
        }
    }

    fn end(&mut self, stage: ActionStage, result: Option<&'static str>) {
        self.stage = stage;
        self.result = result;
    }
}

/// The value of a parameter of an action.
pub(super) fn parameter<'a>(action: &'a Action, key: &str) -> Option<&'a Value> {
    action.parameters.iter().find(|parameter| parameter.key == key).map(|parameter| &parameter.value)
}

impl VirtualRobot {
    /// Whether the robot can do an action of an order, with its parameters.
    pub(super) fn can_do(&self, action: &Action, place: ActionPlace) -> bool {
        if self.setup.quirks.order_actions != OrderActionHabit::Done {
            return true;
        }
        let text = |key: &str| parameter(action, key).and_then(Value::as_str).unwrap_or("");
        let kind = action.kind.as_str();
        let is_vendors = self.setup.abilities.vendor_actions.contains(&action.kind);
        match kind {
            "pick" | "drop" => match self.setup.quirks.handling_parameters {
                HandlingParameters::Optional => true,
                HandlingParameters::FloorAndEpal => {
                    text("stationType").starts_with("floor") && text("loadType") == "EPAL"
                }
            },
            "finePositioning" | "detectObject" => true,
            "startCharging" | "stopCharging" | "waitForTrigger" => place == ActionPlace::Node,
            "clearInstantActions" => place == ActionPlace::Node && self.speaks_3_0(),
            _ if kind == self.position_action() => place == ActionPlace::Node,
            _ => is_vendors,
        }
    }

    /// The version's name of the action that sets the position.
    pub(super) fn position_action(&self) -> &'static str {
        if self.speaks_3_0() { "initializePosition" } else { "initPosition" }
    }

    /// Lists the actions of a node or an edge.
    pub(super) fn list_actions(&mut self, actions: &[Action], key: u32) {
        if self.setup.quirks.order_actions == OrderActionHabit::SkippedInSilence {
            return;
        }
        let announced = |action: &Action| ActionEntry {
            action: action.clone(),
            key,
            stage: ActionStage::Announced,
            result: None,
        };
        self.actions.extend(actions.iter().map(announced));
    }

    /// Gives the actions of one place to another.
    pub(super) fn move_actions(&mut self, from: u32, to: u32) {
        self.actions.iter_mut().filter(|entry| entry.key == from).for_each(|entry| entry.key = to);
    }

    /// The robot has passed a node or entered an edge: its actions are due.
    pub(super) fn trigger(&mut self, key: u32) {
        let is_there = |entry: &&mut ActionEntry| entry.key == key && entry.stage == ActionStage::Announced;
        self.actions.iter_mut().filter(is_there).for_each(|entry| entry.stage = ActionStage::Due);
    }

    /// The robot has left an edge: its actions end.
    pub(super) fn end_edge_actions(&mut self, key: u32) {
        for entry in self.actions.iter_mut().filter(|entry| entry.key == key && !entry.stage.is_over()) {
            if entry.stage == ActionStage::Due {
                entry.end(ActionStage::Failed, Some("the edge was left before the action's turn"));
            } else {
                entry.end(ActionStage::Finished, None);
            }
        }
    }

    /// Lets everything fail that is not over.
    pub(super) fn fail_actions(&mut self, why: &'static str) {
        for entry in self.actions.iter_mut().filter(|entry| !entry.stage.is_over()) {
            entry.end(ActionStage::Failed, Some(why));
        }
    }

    /// Ends all waiting for a trigger; whether there was any.
    pub(super) fn pull_trigger(&mut self) -> bool {
        let mut was_awaited = false;
        for entry in self.actions.iter_mut().filter(|entry| entry.stage == ActionStage::AwaitingTrigger) {
            entry.end(ActionStage::Finished, None);
            was_awaited = true;
        }
        was_awaited
    }

    /// Takes the decision about an action that is RETRIABLE; whether there is such an action.
    pub(super) fn decide_retry(&mut self, id: &str, is_again: bool) -> bool {
        let is_meant =
            |entry: &&mut ActionEntry| entry.action.id == id && entry.stage == ActionStage::Retriable;
        let Some(entry) = self.actions.iter_mut().find(is_meant) else { return false };
        if is_again {
            entry.end(ActionStage::Due, None);
        } else {
            entry.end(ActionStage::Failed, Some("the retry was skipped"));
        }
        true
    }

    /// Goes on with the actions for a time in microseconds, and begins those whose turn it is.
    pub(super) fn work(&mut self, elapsed_us: i64) {
        let is_halted = self.e_stop != EStop::None || self.pause != PauseStage::Off;
        if is_halted || !self.mode.takes_orders() {
            return;
        }
        for i in 0..self.actions.len() {
            match self.actions[i].stage {
                ActionStage::Preparing { left_us } if left_us <= elapsed_us => self.run(i),
                ActionStage::Preparing { left_us } => {
                    self.actions[i].stage = ActionStage::Preparing { left_us: left_us - elapsed_us };
                }
                ActionStage::Running { left_us } if left_us <= elapsed_us => self.complete(i),
                ActionStage::Running { left_us } => {
                    self.actions[i].stage = ActionStage::Running { left_us: left_us - elapsed_us };
                }
                _ => {}
            }
        }
        self.begin_due();
        if self.may_drive(self.now_us())
            && let Some(way) = self.order.edges.first().filter(|way| way.edge.released)
        {
            self.trigger(way.key);
            self.begin_due();
        }
    }

    /// Begins what is due, in order, as far as the blocking types allow.
    fn begin_due(&mut self) {
        while let Some(i) = self.actions.iter().position(|entry| entry.stage == ActionStage::Due) {
            let running = || self.actions.iter().filter(|entry| entry.stage.is_in_progress());
            let must_wait = if self.actions[i].is_exclusive() {
                running().next().is_some()
            } else {
                running().any(ActionEntry::is_exclusive)
            };
            if must_wait {
                break;
            }
            let is_handling = matches!(self.actions[i].action.kind.as_str(), "pick" | "drop");
            match self.setup.abilities.handling_prepare_us {
                left_us if is_handling && left_us > 0 => {
                    self.actions[i].stage = ActionStage::Preparing { left_us };
                }
                _ => self.run(i),
            }
        }
    }

    fn run(&mut self, i: usize) {
        let action = &self.actions[i].action;
        let abilities = &self.setup.abilities;
        let is_timed = self.setup.quirks.handling_parameters == HandlingParameters::FloorAndEpal;
        let asked_us = parameter(action, "duration")
            .and_then(Value::as_f64)
            .filter(|seconds| is_timed && (0.0..=3600.0).contains(seconds))
            .map(|seconds| (seconds * SECOND_US as f64) as i64);
        let left_us = match action.kind.as_str() {
            "waitForTrigger" => {
                self.actions[i].stage = ActionStage::AwaitingTrigger;
                return;
            }
            "pick" => asked_us.unwrap_or(abilities.lift_us),
            "drop" => asked_us.unwrap_or(abilities.set_us),
            "startCharging" | "stopCharging" | "clearInstantActions" => 0,
            kind if kind == self.position_action() => 0,
            _ => abilities.other_action_us,
        };
        if left_us <= 0 {
            self.complete(i);
        } else {
            self.actions[i].stage = ActionStage::Running { left_us };
        }
    }

    fn complete(&mut self, i: usize) {
        let action = self.actions[i].action.clone();
        let outcome = match action.kind.as_str() {
            "pick" => self.lift(&action),
            "drop" => self.set_down(),
            "startCharging" => self.start_charging(),
            "stopCharging" => {
                self.equipment.is_charging = false;
                Ok(())
            }
            "clearInstantActions" => {
                self.instants.clear_over();
                Ok(())
            }
            kind if kind == self.position_action() => self.take_position(&action),
            _ => Ok(()),
        };
        let can_retry = self.speaks_3_0() && action.retriable;
        match outcome {
            Ok(()) => self.actions[i].end(ActionStage::Finished, None),
            Err(why) if can_retry => self.actions[i].end(ActionStage::Retriable, Some(why)),
            Err(why) => self.actions[i].end(ActionStage::Failed, Some(why)),
        }
    }

    fn lift(&mut self, action: &Action) -> Result<(), &'static str> {
        if self.equipment.has_handling_fault {
            return Err("there is no load to pick");
        }
        if !self.equipment.loads.is_empty() {
            return Err("the robot carries a load already");
        }
        let text = |key: &str| parameter(action, key).and_then(Value::as_str).map(str::to_owned);
        let (id, kind) = (text("loadId"), text("loadType"));
        if self.setup.quirks.order_actions == OrderActionHabit::ClaimedNotDone {
            return Ok(());
        }
        self.equipment.nameless += u32::from(id.is_none());
        let id = id.unwrap_or_else(|| format!("load-{}", self.equipment.nameless));
        self.equipment.loads.push(Load { id: Some(id), kind });
        Ok(())
    }

    fn set_down(&mut self) -> Result<(), &'static str> {
        if self.setup.quirks.order_actions == OrderActionHabit::ClaimedNotDone {
            return Ok(());
        }
        if self.equipment.has_handling_fault {
            return Err("there is no room for the load");
        }
        self.equipment.loads.pop().map(|_| ()).ok_or("the robot carries no load")
    }

    /// Begins to charge, if the robot stands where it can.
    pub(super) fn start_charging(&mut self) -> Result<(), &'static str> {
        let is_there = match &self.setup.abilities.charging_places {
            ChargingPlaces::Anywhere => true,
            ChargingPlaces::Nodes(nodes) => nodes.contains(&self.last_node),
        };
        if !self.body.stands() {
            return Err("the robot drives");
        }
        if !is_there {
            return Err("there is no charger");
        }
        self.equipment.is_charging = true;
        Ok(())
    }

    /// Takes the position that an action gives for its own.
    pub(super) fn take_position(&mut self, action: &Action) -> Result<(), &'static str> {
        let number = |key: &str| parameter(action, key).and_then(Value::as_f64).filter(|n| n.is_finite());
        let text = |key: &str| parameter(action, key).and_then(Value::as_str);
        let (Some(x), Some(y), Some(theta), Some(map)) =
            (number("x"), number("y"), number("theta"), text("mapId"))
        else {
            return Err("a position needs x, y, theta and mapId");
        };
        if !self.body.stands() {
            return Err("the robot drives");
        }
        self.map = map.to_owned();
        if let Some(node) = text("lastNodeId") {
            self.last_node = node.to_owned();
        }
        (self.body.x, self.body.y, self.body.theta) = (x, y, theta);
        self.placed = Some((x, y, theta));
        self.is_localized = true;
        self.complain_of_localization();
        Ok(())
    }
}
