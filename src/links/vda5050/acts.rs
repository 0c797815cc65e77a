//! What a robot does at the end of an order: it lifts a rack, sets it down, or is just there.
//!
//! Main types: [`LegAct`], [`ActFailure`]. Refuses: to take the end of an order for the end of its action.

use super::notice::Notice;
use super::order::{LegOrder, OrderLife};
use super::retry::RetryLife;
use super::session::RobotSession;
use giveway_fleet::{Act, Waypoint};
use giveway_floor::id::RackId;
use giveway_floor::time::{Span, Time};
use giveway_site::ActionForm;
use giveway_vda5050::{Action, ActionStatus, Version};

/// A robot that stands at the end of its order and says nothing of its action for this long did not do it.
const SAYS: Span = Span::from_millis(1000);

/// What a robot does at the end of an order.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LegAct {
    /// The serial number of the visit.
    pub serial: u64,
    pub act: Act,
    /// The action; nothing if the robot has only to be there.
    pub action: Option<Action>,
    /// Since when the robot has been at the end of its order.
    pub there: Option<Time>,
    /// What became of it if it failed and may be tried again.
    pub retry: RetryLife,
}

/// An action that failed, in words: the robot waits for a person.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ActFailure {
    pub serial: u64,
    pub words: String,
}

/// How an action ended.
enum ActEnd {
    Done,
    Failed(Notice),
}

impl RobotSession {
    /// What the robot is to do at a visit, in an order.
    pub(super) fn leg_act(&self, order: &str, at: &Waypoint) -> Option<LegAct> {
        let act = at.act?;
        let id = format!("{order}-{}", at.serial);
        let handling = |form: &ActionForm, id| Action {
            kind: form.kind.clone(),
            id,
            blocking: form.blocking,
            parameters: form.parameters.clone(),
            retriable: self.version >= Version::V3_0,
        };
        let action = match act {
            Act::Lift(_) => Some(handling(&self.settings.lift, id)),
            Act::Set(_) => Some(handling(&self.settings.set, id)),
            Act::Pick(_) => self.wait_at_cell(id),
            Act::Arrive => None,
        };
        Some(LegAct { serial: at.serial, act, action, there: None, retry: RetryLife::None })
    }

    /// Notes in a state whether the robot is done at the end of its order.
    pub(super) fn note_act(&mut self, now: Time) {
        let (Some((_, state)), Some(leg), Some(progress)) =
            (&self.state, self.order.leg_mut(), &self.progress)
        else {
            return;
        };
        let at_end = state.order == leg.id && state.nodes.is_empty() && state.edges.is_empty();
        let Some(act) = &mut leg.act else { return };
        if !at_end || progress.reached != act.serial {
            act.there = None;
            return;
        }
        let there = *act.there.get_or_insert(now);
        let act = act.clone();
        match self.end_of(&act, now - there >= SAYS) {
            Some(ActEnd::Done) => self.finish(&act),
            // What is cancelled need not be done.
            Some(ActEnd::Failed(_)) if matches!(self.order, OrderLife::Cancels { .. }) => {}
            Some(ActEnd::Failed(notice)) => self.fail(act.serial, notice),
            None => {}
        }
    }

    /// The action at the end of the order has failed: the robot waits for a person.
    pub(super) fn fail(&mut self, serial: u64, notice: Notice) {
        let words = notice.said().to_string();
        self.notice(notice);
        self.order = OrderLife::Idle;
        if let Some(progress) = &mut self.progress {
            progress.failed = Some(ActFailure { serial, words });
        }
    }

    /// Asks a robot that is at the end of its order and has said nothing of its action: the next state may be far off.
    pub(super) fn ask_about_act(&mut self, now: Time) {
        let OrderLife::Has(LegOrder { act: Some(act), .. }) = &self.order else { return };
        // A robot that waits at a work cell may do so for long, and tells when it does not.
        let waits = matches!(act.act, Act::Pick(_))
            && act.action.as_ref().is_some_and(|action| self.action_state(&action.id).is_some());
        if !waits && act.there.is_some_and(|there| now - there >= SAYS) {
            self.look_again(now);
        }
    }

    /// How an action ended, if it has. `waited` says that the robot had time to say something of it.
    fn end_of(&self, act: &LegAct, waited: bool) -> Option<ActEnd> {
        let Some(action) = &act.action else { return Some(ActEnd::Done) };
        let (_, state) = self.state.as_ref()?;
        if matches!(act.act, Act::Pick(_)) {
            // A robot that does not wait has only to be there.
            let said = self.action_state(&action.id).map(|said| said.status.is_over());
            return said.unwrap_or(waited).then_some(ActEnd::Done);
        }
        let loads = state.loads.as_ref().map(|loads| !loads.is_empty());
        let wanted = matches!(act.act, Act::Lift(_));
        let kind = || action.kind.clone();
        match self.action_state(&action.id) {
            Some(said)
                if said.status == ActionStatus::Finished && loads.is_none_or(|loaded| loaded == wanted) =>
            {
                Some(ActEnd::Done)
            }
            // The load may be said one state later than the end.
            Some(said) if said.status == ActionStatus::Finished => {
                waited.then(|| ActEnd::Failed(Notice::FalseFinished { action: kind(), carries: !wanted }))
            }
            Some(said) if said.status == ActionStatus::Failed => {
                let words =
                    act.retry.words().or(said.result.as_deref()).unwrap_or("no reason given").to_owned();
                Some(ActEnd::Failed(Notice::ActionFailed { action: kind(), words }))
            }
            Some(_) => None,
            None if loads == Some(wanted) => Some(ActEnd::Done),
            None => waited.then(|| ActEnd::Failed(Notice::SilentAction { action: kind() })),
        }
    }

    /// Whether what the robot carries shows that an action was done.
    pub(super) fn shows_done(&self, act: &LegAct) -> bool {
        let loads = self.state.as_ref().and_then(|(_, state)| state.loads.as_ref());
        let handles = matches!(act.act, Act::Lift(_) | Act::Set(_));
        handles && loads.is_some_and(|loads| loads.is_empty() != matches!(act.act, Act::Lift(_)))
    }

    fn finish(&mut self, act: &LegAct) {
        match &mut self.order {
            OrderLife::Cancels { leg, .. } => leg.act = None,
            OrderLife::Idle | OrderLife::Has(_) => self.order = OrderLife::Idle,
        }
        let Some(progress) = &mut self.progress else { return };
        progress.acted = Some(act.serial);
        progress.rack = match act.act {
            Act::Lift(rack) => Some(rack),
            Act::Set(_) => None,
            Act::Pick(_) | Act::Arrive => progress.rack,
        };
    }

    /// The action that failed, in words: the robot waits for people.
    pub fn failure(&self) -> Option<&str> {
        self.progress.as_ref()?.failed.as_ref().map(|failed| failed.words.as_str())
    }

    /// A person has looked after a robot whose action failed or that refused orders, and it carries this now. What the
    /// fleet wanted before is not done any more: the job may be another robot's.
    pub fn settle(&mut self, rack: Option<RackId>) {
        self.rejected.0 = 0;
        self.wanted = None;
        if let Some(progress) = &mut self.progress {
            (progress.failed, progress.rack) = (None, rack);
        }
    }
}
