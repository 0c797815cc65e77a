//! Charging: begun at a charger where the robot has nothing to do; ended, and seen to have ended, before an order.
//!
//! Main type: [`ChargeLife`]. Refuses: to take a finished action for current.

use super::order::OrderLife;
use super::session::{AskedAction, RobotSession};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::NodeKind;

const START: &str = "startCharging";
const STOP: &str = "stopCharging";
/// An order to charge, or to end it, is given again after this.
const AGAIN: Span = Span::from_secs(10);
/// A robot that gets no current for this long after it was told to charge is not plugged in.
const PLUGS: Span = Span::from_secs(30);
/// A robot charged this far need not charge, as a share of 1.
const FULL: f64 = 0.99;

/// How far a robot is with charging.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ChargeLife {
    /// It is not charging, as far as is known.
    Off,
    /// It was told to charge.
    Begins(AskedAction),
    /// It gets current.
    Charges,
    /// It was told to end.
    Ends(AskedAction),
}

impl RobotSession {
    /// Lets a robot charge where it can and has nothing to do. Gives whether an order has to wait for it.
    pub(super) fn mind_charge(&mut self, now: Time) -> bool {
        let Some((_, state)) = &self.state else { return false };
        let (has_current, is_full) =
            (state.power.charging, state.power.charge.is_none_or(|charge| charge >= FULL));
        let rests = self.rests_on_charger();
        match self.charge.clone() {
            ChargeLife::Off if has_current => self.charge = ChargeLife::Charges,
            ChargeLife::Off if rests && !is_full => self.charge = ChargeLife::Begins(self.ask(now, START)),
            ChargeLife::Off => {}
            ChargeLife::Begins(_) if has_current => self.charge = ChargeLife::Charges,
            ChargeLife::Begins(_) if !rests => self.charge = ChargeLife::Off,
            ChargeLife::Begins(asked) => {
                if let Some(asked) = self.charge_again(now, asked, START) {
                    self.charge = ChargeLife::Begins(asked);
                }
            }
            ChargeLife::Charges if !has_current => self.charge = ChargeLife::Off,
            ChargeLife::Charges if !rests => self.charge = ChargeLife::Ends(self.ask(now, STOP)),
            ChargeLife::Charges => {}
            ChargeLife::Ends(_) if !has_current => self.charge = ChargeLife::Off,
            ChargeLife::Ends(asked) => {
                if let Some(asked) = self.charge_again(now, asked, STOP) {
                    self.charge = ChargeLife::Ends(asked);
                }
            }
        }
        matches!(self.charge, ChargeLife::Charges | ChargeLife::Ends(_)) && !rests
    }

    /// Whether a robot at a charger gets no current although it was told to charge.
    pub(super) fn is_unplugged(&self) -> bool {
        let heard = self.state.as_ref().map(|(at, _)| *at);
        match &self.charge {
            ChargeLife::Begins(asked) => heard.is_some_and(|at| at - asked.since >= PLUGS),
            ChargeLife::Off | ChargeLife::Charges | ChargeLife::Ends(_) => false,
        }
    }

    /// Whether the robot is at a charger and has nothing to drive.
    fn rests_on_charger(&self) -> bool {
        let (Some(wanted), Some(progress)) = (&self.wanted, &self.progress) else { return false };
        let driven = match &self.order {
            OrderLife::Idle => true,
            OrderLife::Has(leg) => leg.base == progress.reached,
            OrderLife::Cancels { .. } => false,
        };
        let [here] = &wanted.waypoints[..] else { return false };
        driven && here.serial == progress.reached && self.map.kind(here.node) == NodeKind::Charger
    }

    fn charge_again(&mut self, now: Time, mut asked: AskedAction, kind: &str) -> Option<AskedAction> {
        if now - asked.last < AGAIN {
            return None;
        }
        (asked.last, asked.tries) = (now, asked.tries + 1);
        self.instant(kind, &asked.id.clone(), Vec::new());
        Some(asked)
    }
}
