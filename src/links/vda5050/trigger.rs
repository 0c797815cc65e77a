//! Waiting at a work cell, 3.0: the order ends with `waitForTrigger`, and the dismissal begins with `trigger`.
//!
//! Main functions: `wait_at_cell`, `mind_trigger`. A robot waits so if its factsheet offers both; others just stand at
//! the end of their order. Refuses: to send an order to a robot that still waits, which it would reject.

use super::session::RobotSession;
use giveway_floor::time::{Span, Time};
use giveway_vda5050::{Action, ActionScope, ActionState, ActionStatus, BlockingType, Parameter, Version};
use serde_json::json;

const WAIT: &str = "waitForTrigger";
pub(super) const TRIGGER: &str = "trigger";
/// A trigger that the robot refused is sent again after this.
const AGAIN: Span = Span::from_secs(2);

impl RobotSession {
    /// The action with which a robot waits at a work cell, if it offers that.
    pub(super) fn wait_at_cell(&self, id: String) -> Option<Action> {
        let offered = self.factsheet.as_ref().and_then(|sheet| sheet.actions.as_ref())?;
        let offers = |kind: &str, scope| offered.iter().any(|o| o.kind == kind && o.scopes.contains(&scope));
        let is_offered = offers(WAIT, ActionScope::Node) && offers(TRIGGER, ActionScope::AtOnce);
        (self.version >= Version::V3_0 && is_offered).then(|| Action {
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
            self.trigger = None;
            return false;
        };
        if matches!(waits, ActionStatus::Waiting) {
            self.look_again(now);
            return true;
        }
        let asked = match self.trigger.take() {
            None => self.ask(now, TRIGGER),
            Some(asked) if self.has_failed(&asked) && now - asked.last >= AGAIN => self.ask(now, TRIGGER),
            Some(asked) => self.ask_again(now, asked, TRIGGER),
        };
        self.trigger = Some(asked);
        true
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
