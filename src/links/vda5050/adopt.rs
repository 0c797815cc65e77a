//! Orders of an earlier process: what a robot has of them, and how it goes on after them.
//!
//! Main function: `RobotSession::adopt`. Refuses: to send an update of such an order where another way is left, since
//! one with the same number may still be on its way.

use super::order::{LegOrder, OrderLife, TAKES, UpdateLife, first_of};
use super::session::{EXPIRES, RobotSession, WantedDrive};
use giveway_floor::time::{Span, Time};

impl RobotSession {
    /// Takes an order of an earlier process for its own, if a state shows that the robot has or had one. What that
    /// process sent last may reach the robot later than the first question of this one, so that each state is looked at
    /// until this process has sent something itself.
    pub(super) fn adopt(&mut self, now: Time) {
        let Some(granted) = self.adopts else { return };
        if !self.has_answered {
            return if self.first_asked.is_none() { self.request_state(now) } else { self.look_again(now) };
        }
        let (Some((_, state)), Some(progress)) = (&self.state, &mut self.progress) else { return };
        let drives = state.nodes.iter().any(|node| node.released);
        let is_news = match &self.order {
            OrderLife::Idle => drives || progress.acted.is_none(),
            OrderLife::Has(leg) => leg.id != state.order && drives || state.update > leg.update,
            OrderLife::Cancels { .. } => false,
        };
        let Some(first) = first_of(&state.order).filter(|_| is_news) else { return };
        // The robot may say any number.
        let reached = first.saturating_add(u64::from(state.last_sequence / 2));
        if !(progress.reached..=granted).contains(&reached) {
            return;
        }
        let left = state.nodes.iter().filter(|node| node.released).map(|node| node.sequence).max();
        let base = left.map_or(reached, |sequence| first + u64::from(sequence / 2)).clamp(reached, granted);
        (progress.reached, progress.known) = (reached, base);
        self.order = OrderLife::Has(LegOrder {
            id: state.order.clone(),
            first,
            update: state.update,
            base,
            known: base,
            sent: UpdateLife::Taken,
            nodes: vec![None; (base + 1).saturating_sub(first) as usize],
            announces: state.nodes.iter().any(|node| !node.released),
            act: None,
            before: None,
            complaints: Vec::new(),
            message: None,
        });
    }

    /// Whether no order of an earlier process can be unknown: there was none, or a state has come that answers this
    /// process.
    pub(super) fn knows_what_was_ordered(&self) -> bool {
        self.adopts.is_none() || self.has_answered
    }

    /// Whether the robot said its last state after this session had asked for one: it lists what it was asked, or had
    /// time to answer. An earlier state may be older than the last order of an earlier process.
    pub(super) fn is_answer(&self) -> bool {
        let Some((heard, state)) = &self.state else { return false };
        let mut listed = state.actions.iter().chain(&state.instant_actions);
        let lists = listed.any(|action| boot_of(&action.id) == Some(self.boot));
        lists || self.first_asked.is_some_and(|asked| *heard >= asked + TAKES)
    }

    /// The robot has driven what an earlier process ordered. If that process announced more, the robot waits for it:
    /// such an order is cancelled first.
    pub(super) fn go_on_from_adopted(&mut self, now: Time, wanted: &WantedDrive, acts: bool) {
        let OrderLife::Has(leg) = &self.order else { return };
        if leg.announces && self.claims_cancels {
            self.continue_adopted(now, wanted);
        } else if leg.announces {
            self.begin_cancel(now, None);
        } else if self.has_driven_all() && acts {
            self.act_where_it_stands(now, wanted);
        } else if self.has_driven_all() {
            self.order = OrderLife::Idle;
        }
    }

    /// Continues the order of an earlier process of a robot that only claims to cancel, once nothing that the earlier
    /// process sent can be on its way any more. The update's number is one that no process has used.
    fn continue_adopted(&mut self, now: Time, wanted: &WantedDrive) {
        const BEYOND: Span = Span::from_secs(1);
        let is_settled = self.first_asked.is_some_and(|asked| now - asked >= EXPIRES + BEYOND);
        let (Some(end), OrderLife::Has(leg)) =
            (self.base_end(wanted).filter(|_| is_settled), &mut self.order)
        else {
            return;
        };
        leg.update = leg.update.max(number_of(self.boot));
        self.send_update(now, wanted, end);
    }
}

/// When the process began that gave an id of ours.
fn boot_of(id: &str) -> Option<u64> {
    id.strip_prefix("gw-")?.split('-').next()?.parse().ok()
}

/// A number of updates that grows from process to process: tenths of a second since 2026.
fn number_of(boot_ms: u64) -> u32 {
    const BEGIN_MS: u64 = 1_767_225_600_000;
    u32::try_from(boot_ms.saturating_sub(BEGIN_MS) / 100).unwrap_or(u32::MAX)
}
