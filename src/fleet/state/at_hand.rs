//! Which robot a step is dealing with, to be named if a contradiction ends the step.
//!
//! Main type: [`AtHand`]. It is a note about the step and no part of what the step decides, so queries may leave it,
//! too. Refuses: to be read by anything that decides.

use giveway_floor::id::RobotId;
use std::sync::atomic::{AtomicU32, Ordering};

/// Stands for no robot: no fleet has this many.
const NO_ROBOT: u32 = u32::MAX;

/// The robot that is being dealt with, if there is one. One thread runs a step; the number is atomic so that other
/// threads may look at the fleet between steps.
#[derive(Debug)]
pub struct AtHand(AtomicU32);

impl Default for AtHand {
    fn default() -> AtHand {
        AtHand(AtomicU32::new(NO_ROBOT))
    }
}

impl Clone for AtHand {
    fn clone(&self) -> AtHand {
        AtHand(AtomicU32::new(self.0.load(Ordering::Relaxed)))
    }
}

impl AtHand {
    /// Notes that this robot is being dealt with from now on.
    pub fn note(&self, robot: RobotId) {
        self.0.store(robot.0, Ordering::Relaxed);
    }

    /// Notes that no robot is being dealt with any more.
    pub fn clear(&self) {
        self.0.store(NO_ROBOT, Ordering::Relaxed);
    }

    /// The robot that is being dealt with, if there is one.
    pub fn robot(&self) -> Option<RobotId> {
        let number = self.0.load(Ordering::Relaxed);
        (number != NO_ROBOT).then_some(RobotId(number))
    }
}
