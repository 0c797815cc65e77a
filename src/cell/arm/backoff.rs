//! After repeated protective stops an arm stands for a while, so that the person goes first.
//!
//! Main type: [`StopBackoff`]. A person does not reach past a moving arm, and an arm that leaves and comes back is
//! always moving: both would wait for ever. Refuses: to shorten what the arm's own stop asks for.

use super::kinematics::{Joints, joint_distance};

/// Number of stops in one stage after which the arm still continues at once.
const AT_ONCE: u32 = 2;
/// Number of cycles that the arm stands after the next stop; it doubles with each further stop …
const FIRST: u32 = 10;
/// … up to `FIRST` shifted by this number of bits: 8 s.
const DOUBLINGS: u32 = 3;

/// A stop counts if the arm has moved this far since the last one, radians: an arm that is standing anyway does not
/// wait longer because people pass it, but an arm that is held whenever it has just started does.
const MOVED_RAD: f64 = 0.005;

/// How long an arm stands after its own stop.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct StopBackoff {
    /// Where the arm was when its stop last held it at this stage.
    held_at: Option<Joints>,
    /// Number of stops since the stage began.
    stops: u32,
    /// Number of cycles for which the arm has yet to stand.
    waits: u32,
}

impl StopBackoff {
    /// Records that the arm's own stop holds it here.
    pub fn hold(&mut self, here: &Joints) {
        if self.held_at.is_some_and(|at| joint_distance(&at, here) < MOVED_RAD) {
            return;
        }
        self.held_at = Some(*here);
        self.stops += 1;
        if let Some(more) = self.stops.checked_sub(AT_ONCE + 1) {
            self.waits = FIRST << more.min(DOUBLINGS);
        }
    }

    /// Counts one cycle, held or not. Gives whether the arm must stand in it.
    pub fn waits(&mut self) -> bool {
        let is_to_stand = self.waits > 0;
        self.waits = self.waits.saturating_sub(1);
        is_to_stand
    }

    /// Records that the arm has made progress.
    pub fn got_on(&mut self) {
        *self = StopBackoff::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arm_stands_twice_as_long_after_each_further_stop_until_it_has_got_on() {
        let mut backoff = StopBackoff::default();
        let stand = |backoff: &mut StopBackoff, at: f64| {
            (0..3).for_each(|_| backoff.hold(&[at; 6]));
            (0..).take_while(|_| backoff.waits()).count()
        };
        let stood: Vec<usize> = (0..8).map(|k| stand(&mut backoff, f64::from(k % 2))).collect();
        assert_eq!(stood, [0, 0, 10, 20, 40, 80, 80, 80]);
        assert_eq!(stand(&mut backoff, 1.0), 0, "it has not moved since");
        backoff.got_on();
        assert_eq!(stand(&mut backoff, 1.0), 0);
    }

    #[test]
    fn an_arm_that_is_held_whenever_it_has_just_started_stands_longer_and_longer() {
        let mut backoff = StopBackoff::default();
        let mut stood = |k: u32| {
            backoff.hold(&[0.004 * f64::from(k); 6]);
            (0..).take_while(|_| backoff.waits()).count()
        };
        assert_eq!((0..6).map(&mut stood).collect::<Vec<usize>>(), [0, 0, 10, 20, 40, 80]);
    }
}
