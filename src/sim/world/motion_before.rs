//! A robot's motion at the beginning of a step, to tell what it has done since.
//!
//! Main type: [`MotionBefore`]. Refuses: to say why it moved.

use crate::robot::RobotBody;
use giveway_floor::geometry::Pose;

/// A robot that moved or turned by less than this stood still, metres or radians.
const STANDS: f64 = 1e-6;

/// A robot at the beginning of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotionBefore {
    pose: Pose,
    speed_mps: f64,
}

impl MotionBefore {
    /// The robot's present state.
    pub fn of(robot: &RobotBody) -> MotionBefore {
        MotionBefore { pose: robot.pose, speed_mps: robot.speed_mps }
    }

    /// Whether the robot has moved or turned since, other than to brake.
    pub fn has_moved(&self, robot: &RobotBody) -> bool {
        let (to, turned) = (robot.pose.at - self.pose.at, robot.pose.heading - self.pose.heading);
        let brakes = robot.speed_mps < self.speed_mps - STANDS;
        !brakes && (to.norm() > STANDS || turned.abs() > STANDS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_fleet::RobotKind;
    use giveway_floor::id::{BodyId, RobotId};
    use giveway_floor::warehouse::lab;

    #[test]
    fn a_robot_that_drives_or_turns_has_moved_and_one_that_stands_or_brakes_has_not() {
        let w = lab();
        let (node, place) = w.nodes.pairs().next().expect("the laboratory has nodes");
        let has_moved = |change: fn(&mut RobotBody)| {
            let footprints = [false, true].map(|loaded| w.footprint(BodyId(0), loaded).clone());
            let kind = RobotKind::default();
            let mut robot = RobotBody::new(RobotId(0), node, place.at, 1.0, (&kind, footprints));
            robot.speed_mps = 0.5;
            let before = MotionBefore::of(&robot);
            change(&mut robot);
            before.has_moved(&robot)
        };
        assert!(!has_moved(|_| {}));
        assert!(has_moved(|robot| robot.pose.at.x += 0.05));
        assert!(has_moved(|robot| robot.pose.heading += 0.05));
        assert!(!has_moved(|robot| (robot.pose.at.x, robot.speed_mps) = (robot.pose.at.x + 0.05, 0.4)));
    }
}
