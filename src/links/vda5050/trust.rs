//! How far a robot is trusted: each false claim halves the base that it gets, and time without any restores it.
//!
//! Main type: [`Trust`]. Refuses: to let a robot's lies cost others anything but the room that it takes.

use super::session::RobotSession;
use giveway_floor::time::{Span, Time};

/// False claims that count at most: a base is at least a sixteenth of what the kind allows, and one node.
const MOST: u32 = 4;
/// A false claim is forgiven after this long without another.
const FORGIVES: Span = Span::from_secs(1800);

/// False claims of a robot that still count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Trust {
    pub false_claims: u32,
    /// When the last one was noticed, or one was forgiven last.
    since: Time,
}

impl Trust {
    /// A false claim was noticed.
    pub fn lose(&mut self, now: Time) {
        *self = Trust { false_claims: (self.false_claims + 1).min(MOST), since: now };
    }

    /// Time passes without any.
    pub fn regain(&mut self, now: Time) {
        if self.false_claims > 0 && now - self.since >= FORGIVES {
            *self = Trust { false_claims: self.false_claims - 1, since: now };
        }
    }
}

impl RobotSession {
    /// False claims that still count.
    pub fn false_claims(&self) -> u32 {
        self.trust.false_claims
    }

    /// The longest base that the robot gets, metres.
    pub fn longest_base_m(&self) -> f64 {
        self.settings.longest_base_m / f64::from(1_u32 << self.trust.false_claims)
    }

    /// How many visits are within the longest base, and one at least.
    pub(super) fn most_visits(&self) -> usize {
        ((self.longest_base_m() / self.shortest_m) as usize).max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn false_claims_add_up_to_four_and_are_forgiven_one_by_one() {
        let mut trust = Trust::default();
        let at = |minutes: i64| Time::ZERO + Span::from_secs(60 * minutes);
        for minute in 0..6 {
            trust.lose(at(minute));
        }
        let left = |trust: &mut Trust, minutes| {
            trust.regain(at(minutes));
            trust.false_claims
        };
        assert_eq!([34, 35, 64, 65, 95, 125, 999].map(|m| left(&mut trust, m)), [4, 3, 3, 2, 1, 0, 0]);
    }
}
