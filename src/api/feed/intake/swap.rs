//! Hands that are mistaken for each other: the left hand jumps to where the right one was, and the right one to where
//! the left one was.
//!
//! Main type: [`SwapWatch`]. Pure. Refuses: to say which hand is which; crossing hands are where arms can have moved
//! them, and are no swap.

use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Place;

/// The top speed of a hand, metres per second.
const FASTEST_MPS: f64 = 3.5;
/// The least error of a hand's position, metres.
const ERR_M: f64 = 0.05;
/// Hands closer than this may be mistaken for each other without harm, metres.
const APART_M: f64 = 0.2;
/// Observations older than this say nothing about the present.
const GAP: Span = Span::from_millis(450);
/// Hands that have kept their new names for this long have their right names.
const SETTLED: Span = Span::from_millis(500);

/// The memory about two hands.
#[derive(Clone, Debug, Default)]
pub struct SwapWatch {
    /// The positions of the left and the right hand when both were last seen, and the time.
    last: Option<([Place; 2], Time)>,
    /// Since when the hands have had each other's names.
    since: Option<Time>,
}

impl SwapWatch {
    /// Whether the hands have each other's names now, as far as both were seen: until they change back, or have
    /// continued so for half a second. An observation older than the latest one changes nothing.
    pub fn are_swapped(&mut self, hands: [Option<Place>; 2], seen: Time) -> bool {
        let was = self.since.filter(|since| seen - *since < SETTLED);
        let both = hands[0].zip(hands[1]).map(|(left, right)| [left, right]);
        let newer = both.filter(|_| self.last.is_none_or(|(_, then)| seen > then));
        let change =
            newer.zip(self.last).is_some_and(|(now, (before, then))| exchanged(before, now, seen - then));
        self.since = if change { was.is_none().then_some(seen) } else { was };
        self.last = newer.map(|now| (now, seen)).or(self.last);
        self.since.is_some()
    }
}

/// Whether neither hand can have reached its new position from its own old one, but each can from the other's.
fn exchanged(before: [Place; 2], now: [Place; 2], gap: Span) -> bool {
    let reach_m = FASTEST_MPS * gap.as_secs_f64() + ERR_M;
    let can = |from: usize, to: usize| (now[to] - before[from]).norm() <= reach_m;
    let apart = |[left, right]: [Place; 2]| (right - left).norm() >= APART_M;
    gap <= GAP && apart(before) && apart(now) && !can(0, 0) && !can(1, 1) && can(0, 1) && can(1, 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both hands on a line in front of a person, by how far to the right they are.
    fn swapped(watch: &mut SwapWatch, left: f64, right: f64, ms: i64) -> bool {
        let at = |x: f64| Some(Place::new(x, 0.4, 1.2));
        watch.are_swapped([at(left), at(right)], Time(ms * 1000))
    }

    #[test]
    fn hands_that_change_places_at_once_are_swapped_until_they_change_back() {
        let mut watch = SwapWatch::default();
        assert!(!swapped(&mut watch, -0.2, 0.2, 0));
        for ms in [20, 40, 60] {
            assert!(swapped(&mut watch, 0.21, -0.19, ms), "{ms}");
        }
        for ms in [80, 100] {
            assert!(!swapped(&mut watch, -0.2, 0.2, ms), "{ms}");
        }
        assert!(swapped(&mut watch, 0.2, -0.2, 120), "and again");
    }

    #[test]
    fn hands_that_keep_their_new_names_for_half_a_second_have_their_right_names() {
        let mut watch = SwapWatch::default();
        assert!(!swapped(&mut watch, -0.2, 0.2, 0));
        for ms in (20..520).step_by(20) {
            assert!(swapped(&mut watch, 0.2, -0.2, ms), "{ms}");
        }
        for ms in (520..700).step_by(20) {
            assert!(!swapped(&mut watch, 0.2, -0.2, ms), "{ms}");
        }
        assert!(swapped(&mut watch, -0.2, 0.2, 700), "changing back is another swap");
    }

    #[test]
    fn hands_that_cross_are_not_swapped_however_fast_arms_are() {
        for mps in [0.2, 1.0, 3.0] {
            for step_ms in [16, 33, 50, 100] {
                let mut watch = SwapWatch::default();
                for ms in (0..4000).step_by(step_ms) {
                    let x = (mps * ms as f64 / 1000.0 - 0.4).min(0.4);
                    assert!(!swapped(&mut watch, x, -x, ms), "{mps} m/s every {step_ms} ms, at {ms}");
                }
            }
        }
    }

    #[test]
    fn one_hand_that_jumps_and_hands_that_were_not_seen_for_a_while_are_no_swap() {
        let mut watch = SwapWatch::default();
        assert!(!swapped(&mut watch, -0.2, 0.2, 0));
        assert!(!swapped(&mut watch, 0.2, 0.25, 20), "the right one has stayed");
        assert!(!swapped(&mut watch, -0.2, 0.2, 40));
        assert!(!swapped(&mut watch, 0.2, -0.2, 500), "in this time they can have crossed");
        assert!(!swapped(&mut watch, -0.2, 0.2, 480), "late");
        assert!(!swapped(&mut watch, 0.2, -0.2, 520));
    }

    #[test]
    fn of_swapped_hands_neither_can_be_told_from_the_other_where_one_alone_is_seen() {
        let mut watch = SwapWatch::default();
        assert!(!swapped(&mut watch, -0.2, 0.2, 0));
        assert!(swapped(&mut watch, 0.2, -0.2, 20));
        let left = [Some(Place::new(0.2, 0.4, 1.2)), None];
        assert!(watch.are_swapped(left, Time(40_000)));
        assert!(!watch.are_swapped(left, Time(520_000)), "half a second later");
    }
}
