//! Waiting at a work cell, 3.0: the order ends with `waitForTrigger`, and the dismissal begins with `trigger`.
//!
//! Main functions: `wait_at_cell`, `mind_trigger`. A robot waits so if its factsheet offers both; others just stand at
//! the end of their order, and so does from then on one that took no trigger: a person has to press its button once.
//! Refuses: to send an order to a robot that still waits, which it would reject.

use super::session::{AskedAction, RobotSession};
use giveway_floor::time::{Span, Time};
use giveway_vda5050::{Action, ActionScope, ActionState, ActionStatus, BlockingType, Parameter, Version};
use serde_json::json;

const WAIT: &str = "waitForTrigger";
pub(super) const TRIGGER: &str = "trigger";
/// A trigger that the robot refused is sent again after this.
const AGAIN: Span = Span::from_secs(2);
/// A robot that was told so often, each time with a later state that shows nothing of it, needs a person.
const TIMES: u32 = 3;

/// What is known of triggers of a robot.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct TriggerLife {
    /// The trigger that was sent.
    asked: Option<AskedAction>,
    /// Whether the robot once took no trigger: it is not made to wait for one again.
    is_untaken: bool,
}

impl RobotSession {
    /// The action with which a robot waits at a work cell, if it offers that.
    pub(super) fn wait_at_cell(&self, id: String) -> Option<Action> {
        let offered = self.factsheet.as_ref().and_then(|sheet| sheet.actions.as_ref())?;
        let offers = |kind: &str, scope| offered.iter().any(|o| o.kind == kind && o.scopes.contains(&scope));
        let is_offered = offers(WAIT, ActionScope::Node) && offers(TRIGGER, ActionScope::AtOnce);
        let can_wait = self.version >= Version::V3_0 && is_offered && !self.trigger.is_untaken;
        can_wait.then(|| Action {
            kind: WAIT.to_owned(),
            id,
            blocking: BlockingType::Hard,
            parameters: vec![Parameter { key: "triggerType".to_owned(), value: json!(["FLEET_CONTROL"]) }],
            retriable: false,
        })
    }

    /// Dismisses a robot that waits at a work cell and is to go on. Gives whether an order has to wait for it.
    pub(super) fn mind_trigger(&mut self, now: Time) -> bool {
        let Some(waits) = self.waits_for_trigger().map(|said| said.status) else {
            self.trigger.asked = None;
            return false;
        };
        if matches!(waits, ActionStatus::Waiting) {
            self.look_again(now);
            return true;
        }
        let asked = match self.trigger.asked.take() {
            None => self.ask(now, TRIGGER),
            Some(asked) if self.has_failed(&asked) && now - asked.last >= AGAIN => {
                AskedAction { tries: asked.tries + 1, ..self.ask(now, TRIGGER) }
            }
            Some(asked) => self.ask_again(now, asked, TRIGGER),
        };
        self.trigger.is_untaken |= asked.tries > TIMES;
        self.trigger.asked = Some(asked);
        true
    }

    /// Whether the robot waits for a trigger that it does not take from here, so that a person has to press its button.
    pub(super) fn needs_button(&self) -> bool {
        self.trigger.is_untaken && self.waits_for_trigger().is_some()
    }

    /// What the robot says of its waiting, if it waits or will.
    fn waits_for_trigger(&self) -> Option<&ActionState> {
        let (_, state) = self.state.as_ref()?;
        let ours = |said: &&ActionState| {
            said.kind.as_deref() == Some(WAIT) && said.id.starts_with("gw-") && !said.status.is_over()
        };
        state.actions.iter().find(ours)
    }
}
