//! What becomes of an action that failed and may be tried again, 3.0: it is tried once more, then given up.
//!
//! Main type: [`RetryLife`]; main function: `mind_retry`. Refuses: to wait for ever for a robot that neither tries
//! again nor gives up.

use super::acts::LegAct;
use super::notice::Notice;
use super::order::{LegOrder, OrderLife};
use super::session::{AskedAction, RobotSession};
use giveway_floor::time::{Span, Time};
use giveway_vda5050::{ActionState, ActionStatus, Parameter};

pub(super) const RETRY: &str = "retry";
pub(super) const SKIP_RETRY: &str = "skipRetry";
/// A robot that says that it tries again does so within this.
const BEGINS: Span = Span::from_secs(1);
/// A robot that has neither tried again nor given up after this does neither.
const ENDS: Span = Span::from_secs(20);

/// How far it is with an action that failed and may be tried again.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) enum RetryLife {
    /// It has not failed.
    #[default]
    None,
    /// The robot was told to try again. `over` is since when it says that it was told; `began` whether it was seen to
    /// try.
    Asked { asked: AskedAction, over: Option<Time>, began: bool },
    /// The robot was told to give it up, for which it had this reason.
    Skips { asked: AskedAction, words: String },
}

impl RetryLife {
    /// The robot's words about why the action failed, before it was told to give it up.
    pub fn words(&self) -> Option<&str> {
        match self {
            RetryLife::None | RetryLife::Asked { .. } => None,
            RetryLife::Skips { words, .. } => Some(words),
        }
    }
}

impl RobotSession {
    /// Looks after an action at the end of the order that may be tried again.
    pub(super) fn mind_retry(&mut self, now: Time) {
        let OrderLife::Has(LegOrder { act: Some(act), .. }) = &self.order else { return };
        let status =
            act.action.as_ref().and_then(|action| self.action_state(&action.id)).map(|said| said.status);
        if act.retry == RetryLife::None && status != Some(ActionStatus::Retriable) {
            return;
        }
        let LegAct { serial, retry, action: Some(action), .. } = act.clone() else { return };
        let Some(said) = self.action_state(&action.id).cloned() else { return };
        let is_retriable = said.status == ActionStatus::Retriable;
        let next = match retry {
            RetryLife::None if is_retriable => self.try_again(now, &action.id),
            RetryLife::Asked { asked, over, .. } if !is_retriable => {
                RetryLife::Asked { asked, over, began: true }
            }
            RetryLife::Asked { asked, over, began } => self.follow_retry(now, &said, (asked, over, began)),
            RetryLife::Skips { asked, words } if is_retriable => {
                if now - asked.since >= ENDS {
                    return self.fail(serial, Notice::ActionFailed { action: action.kind, words });
                }
                let asked = self.ask_again_with(now, asked, SKIP_RETRY, about(&action.id));
                RetryLife::Skips { asked, words }
            }
            other => other,
        };
        if let OrderLife::Has(LegOrder { act: Some(act), .. }) = &mut self.order {
            act.retry = next;
        }
    }

    fn try_again(&mut self, now: Time, action: &str) -> RetryLife {
        RetryLife::Asked { asked: self.ask_with(now, RETRY, about(action)), over: None, began: false }
    }

    /// The robot was told to try again, and its action may be tried again: for the second time, or still.
    fn follow_retry(
        &mut self,
        now: Time,
        said: &ActionState,
        (asked, over, began): (AskedAction, Option<Time>, bool),
    ) -> RetryLife {
        let status = self.action_state(&asked.id).map(|retry| retry.status);
        let over = over.or(status.is_some_and(ActionStatus::is_over).then_some(now));
        let is_refused = status == Some(ActionStatus::Failed);
        let had_time = over.is_some_and(|over| now - over >= BEGINS) || now - asked.since >= ENDS;
        if began || is_refused || had_time {
            let words = said.result.clone().unwrap_or_else(|| "no reason given".to_owned());
            return RetryLife::Skips { asked: self.ask_with(now, SKIP_RETRY, about(&said.id)), words };
        }
        let asked = self.ask_again_with(now, asked, RETRY, about(&said.id));
        RetryLife::Asked { asked, over, began }
    }
}

fn about(action: &str) -> Vec<Parameter> {
    vec![Parameter { key: "actionId".to_owned(), value: action.into() }]
}
