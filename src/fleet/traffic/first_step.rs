//! From between two nodes: to which of them should a robot go on? Both are first steps of a search.
//!
//! Main function: `better_direction`. Refuses: to turn a robot, and to know whether a person blocks either way.

use crate::state::floor::Floor;
use crate::traffic::plan::{WORTH, reached};
use crate::traffic::state::{Direction, Traffic};
use giveway_floor::id::RobotId;
use giveway_floor::time::{Span, Time};
use giveway_floor::timeline::Visit;

impl Traffic {
    /// The direction in which a robot that stands between two nodes gets to its next stop earlier; forward if both are
    /// about as good. Costs two searches.
    pub(crate) fn better_direction(&mut self, floor: Floor<'_>, robot: RobotId, now: Time) -> Direction {
        if floor.ledger.robots[robot].failed {
            // The robot can drive again, but the ledger learns that later in this step.
            return Direction::Forward;
        }
        let stages = floor.stages_left(robot);
        let chain = floor.ledger.chain(robot);
        let back = chain.get(chain.first()).cloned();
        let (Some(back), false) = (back, stages.is_empty()) else { return Direction::Forward };
        let to_go_m = (floor.place_of(robot) - floor.last_reached(robot)).norm();
        let drives = Span::from_secs_f64(to_go_m / floor.kinematics(robot).speed_mps);
        let heading = floor.scene.robot(robot).map_or(0.0, |seen| seen.pose.heading);
        let back = (Visit { arrive: now + drives, ..back }, heading);
        let forward = self.search(floor, robot, &stages, now).ok().map(|route| reached(&route));
        let backward = self.search_from(floor, robot, back, &stages, now).ok().map(|route| reached(&route));
        match (forward, backward) {
            (None, Some(_)) => Direction::Back,
            (Some(forward), Some(backward)) if backward + WORTH < forward => Direction::Back,
            _ => Direction::Forward,
        }
    }
}
