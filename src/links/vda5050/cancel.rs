//! Cancelling: asked for until no nodes are left and the robot stands.
//!
//! Main type: [`Cancel`]. Refuses: to take a robot's word for it, and to send anything more for a cancelled order.

use super::notice::Notice;
use super::order::{LegOrder, OrderLife, UpdateLife};
use super::session::{AskedAction, RobotSession};
use giveway_floor::time::{Span, Time};
use giveway_vda5050::ActionStatus;

pub(super) const CANCEL: &str = "cancelOrder";
/// A robot that drives on for this long after it said that it had cancelled its order has not.
const BRAKES: Span = Span::from_millis(1500);
/// A cancel that has not ended after this needs a person.
const ENDS: Span = Span::from_secs(20);

/// A cancel of an order.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cancel {
    pub asked: AskedAction,
    /// The revocation that it obeys, if it obeys one.
    pub number: Option<u64>,
    /// Since when the robot says that it is done.
    pub said: Option<Time>,
    /// Whether a false word, or none, was noticed.
    pub is_false: bool,
    pub is_late: bool,
}

impl RobotSession {
    /// Takes back what the robot was released and has not driven, if it stands where the fleet believes.
    pub(super) fn revoke(&mut self, now: Time, reached: u64, number: u64) {
        let knows = self.knows_what_was_ordered();
        let Some(progress) = &mut self.progress else { return };
        if progress.reached != reached || number != progress.recalls + 1 || !knows {
            return;
        }
        self.wanted = None;
        match &self.order {
            OrderLife::Idle => (progress.recalls, progress.known) = (number, reached),
            OrderLife::Has(_) => self.begin_cancel(now, Some(number)),
            OrderLife::Cancels { .. } => {
                if let OrderLife::Cancels { cancel, .. } = &mut self.order {
                    cancel.number = Some(number);
                }
            }
        }
    }

    /// How many revocations a drive must know of: one that is being obeyed counts, since the fleet repeats what it
    /// wanted before until it is.
    pub(super) fn least_recalls(&self) -> u64 {
        match &self.order {
            OrderLife::Cancels { cancel, .. } => cancel.number.unwrap_or(0),
            OrderLife::Idle | OrderLife::Has(_) => 0,
        }
    }

    /// Begins to cancel the order that the robot has.
    pub(super) fn begin_cancel(&mut self, now: Time, number: Option<u64>) {
        if let OrderLife::Has(leg) = std::mem::replace(&mut self.order, OrderLife::Idle) {
            let asked = self.ask(now, CANCEL);
            let cancel = Cancel { asked, number, said: None, is_false: false, is_late: false };
            self.order = OrderLife::Cancels { leg, cancel };
        }
    }

    /// Looks after a cancel. Gives whether one is going on.
    pub(super) fn mind_cancel(&mut self, now: Time) -> bool {
        let OrderLife::Cancels { cancel, .. } = &self.order else { return false };
        let cancel = cancel.clone();
        let heard = self.state.as_ref().filter(|(at, _)| *at >= cancel.asked.since);
        let is_over = heard.is_some_and(|(_, state)| state.nodes.is_empty() && state.edges.is_empty());
        if is_over && self.motion.stands() && !self.acts_on() {
            self.end_cancel(&cancel);
            return true;
        }
        let asked = self.ask_again(now, cancel.asked.clone(), CANCEL);
        let says = self.says_finished(&asked.id);
        let OrderLife::Cancels { cancel, .. } = &mut self.order else { return true };
        cancel.asked = asked;
        cancel.said = cancel.said.or(says.then_some(now));
        let goes_on = cancel.said.is_some_and(|said| now - said >= BRAKES);
        if goes_on && !std::mem::replace(&mut cancel.is_false, true) {
            self.claims_cancels = true;
            self.notice(Notice::FalseCancel);
        } else if goes_on {
            self.resume_claimed();
        } else if now - cancel.asked.since >= ENDS && !std::mem::replace(&mut cancel.is_late, true) {
            self.notice(Notice::NoCancel);
        }
        true
    }

    /// Whether the robot is at the action of the order that is cancelled: an order may have come late, and be carried
    /// out before the cancel is read. What such an action did counts.
    fn acts_on(&self) -> bool {
        let OrderLife::Cancels { leg: LegOrder { act: Some(act), .. }, .. } = &self.order else {
            return false;
        };
        let said = act.action.as_ref().and_then(|action| self.action_state(&action.id));
        said.is_some_and(|said| {
            matches!(said.status, ActionStatus::Initializing | ActionStatus::Running | ActionStatus::Paused)
        })
    }

    /// A robot that claims to have cancelled its order, and has driven all of it that was released, waits for the rest.
    /// It refuses other orders, so that it goes on by this one; what was taken back is taken back all the same.
    fn resume_claimed(&mut self) {
        let (Some((_, state)), Some(progress)) = (&self.state, &mut self.progress) else { return };
        let OrderLife::Cancels { leg, cancel } = &self.order else { return };
        let drives = state.nodes.iter().any(|n| n.released) || state.edges.iter().any(|e| e.released);
        let reached = leg.serial(state.last_sequence);
        if state.order != leg.id || drives || reached != progress.reached || !self.motion.stands() {
            return;
        }
        (progress.known, progress.recalls) = (reached, cancel.number.unwrap_or(progress.recalls));
        let nodes = leg.nodes[..=(reached - leg.first) as usize].to_vec();
        let (base, known, sent) = (reached, reached, UpdateLife::Taken);
        // The number of an update that was lost is not used again for another one.
        let update = leg.update.max(state.update);
        let (announces, complaints) = (!state.nodes.is_empty(), state.errors.clone());
        let leg =
            LegOrder { base, known, update, sent, nodes, announces, complaints, act: None, ..leg.clone() };
        self.order = OrderLife::Has(leg);
    }

    fn end_cancel(&mut self, cancel: &Cancel) {
        self.order = OrderLife::Idle;
        let Some(progress) = &mut self.progress else { return };
        progress.known = progress.reached;
        if let Some(number) = cancel.number {
            progress.recalls = number;
        }
    }
}
