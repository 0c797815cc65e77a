//! Impossible hands: joints that form no hand, a hand out of the arm's reach, a hand that does not even tremble, and
//! hands that are mistaken for one another.
//!
//! Main type: [`JointGate`]. Such a hand counts as unseen, and the pose still counts. Refuses: hands with other numbers
//! of joints than WebXR's, which no part of the program reads.

use super::pose::{Hand, hand_points};
use super::swap::SwapWatch;
use crate::feed::intake::Senses;
use crate::feed::wire::HandsSaid;
use giveway_cell::HandPoints;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Place;

/// A hand farther than this from the head is beyond its owner's reach, metres.
const ARM_M: f64 = 1.4;
/// Measured hands tremble: a hand that has been exactly the same for this long is no longer tracked.
const FROZEN: Span = Span::from_secs(1);

/// The memory about one headset's hands.
#[derive(Clone, Debug, Default)]
pub struct JointGate {
    /// The position of each hand, and since when it has been exactly there.
    same: [Option<(HandPoints, Time)>; 2],
    /// Detects hands that are mistaken for each other.
    swaps: SwapWatch,
}

impl JointGate {
    /// Removes impossible hands from a pose. Returns how many there were.
    pub fn pass(
        &mut self,
        said: Option<&HandsSaid>,
        senses: &mut Senses,
        head: Place,
        (seen, received): (Time, Time),
    ) -> u64 {
        let given = said.map_or([false; 2], |said| [said.l.is_some(), said.r.is_some()]);
        for (i, hand) in senses.hands.iter_mut().enumerate() {
            let points = hand.as_ref().and_then(hand_points);
            let is_wrong = points.is_some_and(|points| {
                self.is_frozen(i, points, received)
                    || !points.is_sound()
                    || (points.palm - head).norm() > ARM_M
            });
            if points.is_none() {
                self.same[i] = None;
            }
            *hand = hand.take().filter(|_| !is_wrong);
        }
        let palm = |hand: &Option<Hand>| hand.as_ref().and_then(hand_points).map(|points| points.palm);
        if self.swaps.are_swapped([0, 1].map(|i| palm(&senses.hands[i])), seen) {
            senses.hands = [None, None];
        }
        (0..2).filter(|i| given[*i] && senses.hands[*i].is_none()).count() as u64
    }

    fn is_frozen(&mut self, hand: usize, points: HandPoints, received: Time) -> bool {
        match self.same[hand] {
            Some((before, since)) if before == points => received - since >= FROZEN,
            _ => {
                self.same[hand] = Some((points, received));
                false
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feed::wire::HandSaid;

    const HEAD: [f64; 3] = [1.0, 2.0, 1.6];

    /// A hand whose joints are all within a few centimetres.
    fn hand(at: [f64; 3]) -> Option<Vec<[f64; 4]>> {
        let joint = |i: u32| [at[0] + 0.005 * f64::from(i), at[1], at[2], 0.01];
        Some((0..25).map(joint).collect())
    }

    fn refused(gate: &mut JointGate, right: Option<Vec<[f64; 4]>>, ms: i64) -> (u64, bool) {
        let said = HandsSaid { l: None, r: right.clone().map(HandSaid::Joints) };
        let mut senses = Senses { hands: [None, right.filter(|r| r.len() <= 32)], ..Senses::default() };
        let at = Time(ms * 1000);
        let count = gate.pass(Some(&said), &mut senses, Place::from(HEAD), (at, at));
        (count, senses.hands[1].is_some())
    }

    #[test]
    fn hands_far_from_any_shoulder_of_too_many_joints_or_in_pieces_are_not_seen() {
        let mut gate = JointGate::default();
        assert_eq!(refused(&mut gate, hand([1.4, 2.2, 1.2]), 0), (0, true));
        assert_eq!(refused(&mut gate, hand([4.0, 2.0, 1.2]), 20), (1, false), "three metres away");
        let mut pieces = hand([1.4, 2.2, 1.2]).unwrap();
        pieces[9][0] += 0.5;
        assert_eq!(refused(&mut gate, Some(pieces), 40), (1, false));
        assert_eq!(refused(&mut gate, Some(vec![[1.0; 4]; 40]), 60), (1, false), "no hand has 40 joints");
        assert_eq!(refused(&mut gate, None, 80), (0, false), "a hand that is not seen is nothing wrong");
    }

    #[test]
    fn a_hand_that_is_exactly_the_same_for_a_second_is_not_seen_until_it_moves() {
        let mut gate = JointGate::default();
        for ms in (0..1000).step_by(20) {
            assert_eq!(refused(&mut gate, hand([1.4, 2.2, 1.2]), ms), (0, true), "{ms}");
        }
        assert_eq!(refused(&mut gate, hand([1.4, 2.2, 1.2]), 1000), (1, false));
        assert_eq!(refused(&mut gate, hand([1.4, 2.2, 1.2001]), 1020), (0, true));
    }

    #[test]
    fn neither_of_two_hands_that_change_places_at_once_is_seen_until_they_change_back() {
        let mut gate = JointGate::default();
        let mut seen = |left: f64, right: f64, ms: i64| {
            let hands = [left, right].map(|x| hand([x, 2.3, 1.2]));
            let [l, r] = hands.clone().map(|hand| hand.map(HandSaid::Joints));
            let mut senses = Senses { hands, ..Senses::default() };
            let (said, at) = (HandsSaid { l, r }, Time(ms * 1000));
            let count = gate.pass(Some(&said), &mut senses, Place::from(HEAD), (at, at));
            (count, senses.hands.map(|hand| hand.is_some()))
        };
        assert_eq!(seen(0.8, 1.3, 0), (0, [true; 2]));
        assert_eq!(seen(1.3, 0.8, 20), (2, [false; 2]));
        assert_eq!(seen(1.31, 0.81, 40), (2, [false; 2]));
        assert_eq!(seen(0.81, 1.31, 60), (0, [true; 2]));
        assert_eq!(seen(0.82, 4.0, 80), (1, [true, false]), "one that no arm reaches is left out alone");
    }
}
