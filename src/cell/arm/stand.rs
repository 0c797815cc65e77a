//! Since when an arm has not moved.
//!
//! Main type: [`ArmStand`]. Refuses: to ask for the reason.

use super::kinematics::{Joints, joint_distance};
use giveway_floor::time::Time;

/// An arm within this distance of where it stood still stands there, radians.
const MOVED_RAD: f64 = 0.02;

/// Where an arm came to a stand, and when.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ArmStand(Option<(Joints, Time)>);

impl ArmStand {
    /// Notes where the arm is now.
    pub fn see(&mut self, here: &Joints, now: Time) {
        if self.0.is_none_or(|(at, _)| joint_distance(&at, here) > MOVED_RAD) {
            self.0 = Some((*here, now));
        }
    }

    /// Since when the arm has not moved; nothing before its first report.
    pub fn since(&self) -> Option<Time> {
        self.0.map(|(_, since)| since)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arm_that_creeps_has_moved_and_one_that_trembles_has_not() {
        let mut stand = ArmStand::default();
        assert_eq!(stand.since(), None);
        for k in 0..10 {
            stand.see(&[0.005 * f64::from(k % 2); 6], Time(i64::from(k)));
        }
        assert_eq!(stand.since(), Some(Time(0)));
        for k in 10..20 {
            stand.see(&[0.005 * f64::from(k - 9); 6], Time(i64::from(k)));
        }
        assert!(stand.since() > Some(Time(10)));
    }
}
