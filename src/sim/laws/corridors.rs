//! The law about the line: a robot that passes a person stays within its granted corridor, at every instant and with
//! all of its outline; any other robot stays on its line.
//!
//! Main type: [`CorridorLaws`]. Refuses: to judge robots that stand, and robots that people pushed or drive.

use super::violation::Violation;
use crate::world::World;
use giveway_fleet::{Fleet, OFF_ROUTE_M};
use giveway_floor::geometry::{Point, Pose, Segment};
use giveway_floor::id::RobotId;
use giveway_floor::warehouse::Hull;
use std::collections::{BTreeMap, BTreeSet};

/// Rounding allowed, metres.
const SLACK_M: f64 = 1e-3;

/// The floor granted to robots besides their lines, as of the last step, and the robots outside of it.
#[derive(Debug, Default)]
pub(super) struct CorridorLaws {
    granted: BTreeMap<RobotId, Hull>,
    outside: BTreeSet<RobotId>,
}

impl CorridorLaws {
    pub fn check(&mut self, world: &World, fleet: &Fleet) -> Vec<Violation> {
        let beside: Vec<(RobotId, Pose, Hull)> =
            world.beside_line().iter().map(|(r, pose)| (*r, *pose, world.outline(*r, *pose))).collect();
        let mut outside = self.outside_of_corridors(&beside);
        let steers: BTreeSet<RobotId> = beside.iter().map(|(r, ..)| *r).collect();
        for (robot, truth) in world.truth() {
            let is_judged = truth.speed_mps > 0.0 && truth.fault.is_none() && !steers.contains(&robot);
            if is_judged && !self.granted.contains_key(&robot) && is_off_line(fleet, robot, truth.pose.at) {
                outside.insert(robot);
            }
        }
        let granted = fleet.ledger().present().filter_map(|r| Some((r, fleet.passing_floor(r)?))).collect();
        let before = std::mem::replace(&mut self.granted, granted);
        // A robot that was fenced off while driving drives on to the end of its grant, whatever the ledger says.
        let is_fenced = |r: &RobotId| fleet.ledger().robots.get(*r).is_some_and(|r| r.fenced.is_some());
        for (robot, floor) in before.into_iter().filter(|(r, _)| is_fenced(r)) {
            self.granted.entry(robot).or_insert(floor);
        }
        // A robot that stays outside breaks the law once.
        let before = std::mem::replace(&mut self.outside, outside);
        self.outside.difference(&before).map(|r| Violation::LeftCorridor(*r)).collect()
    }

    /// Robots that were outside of their corridors, or beside the line without one.
    fn outside_of_corridors(&self, beside: &[(RobotId, Pose, Hull)]) -> BTreeSet<RobotId> {
        let is_outside = |robot: &RobotId, outline: &Hull| {
            self.granted.get(robot).is_none_or(|floor| !floor.holds(outline, SLACK_M))
        };
        beside.iter().filter(|(r, _, outline)| is_outside(r, outline)).map(|(r, ..)| *r).collect()
    }
}

/// Whether a place is off all lanes that a robot was granted.
fn is_off_line(fleet: &Fleet, robot: RobotId, at: Point) -> bool {
    let chain = fleet.ledger().chain(robot);
    let place = |s: u64| chain.get(s).map(|v| fleet.warehouse().nodes[v.node].at);
    let (first, granted) = (chain.first(), chain.granted());
    // The newest report may lag: the robot may still be on a lane that it has left by that report.
    let mut lanes = (first..granted).filter_map(|s| Some((place(s)?, place((s + 1).min(granted - 1))?)));
    lanes.all(|(a, b)| Segment { a, b }.distance_to(at) > OFF_ROUTE_M)
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::{Corridor, Footprint};

    #[test]
    fn a_robot_breaks_the_law_by_a_corner_outside_of_its_corridor_or_without_one() {
        let line = Segment { a: Point::origin(), b: Point::new(10.0, 0.0) };
        let robot = Footprint::Square { side_m: 0.9 };
        let floor = robot.free(line, Corridor { left_m: 2.0, right_m: 0.5 });
        let laws = CorridorLaws { granted: [(RobotId(0), floor)].into(), outside: BTreeSet::new() };
        let found = |id: u32, x: f64, y: f64| {
            let pose = Pose { at: Point::new(x, y), heading: 0.3 };
            !laws.outside_of_corridors(&[(RobotId(id), pose, robot.at(pose))]).is_empty()
        };
        assert!(!found(0, 5.0, 0.0) && !found(0, 5.0, 1.549), "within");
        assert!(found(0, 5.0, 1.56) && found(0, 5.0, -0.1), "outside by a corner");
        assert!(found(0, 10.3, 1.0), "beyond the end it is as wide as the line");
        assert!(found(1, 5.0, 0.0), "beside the line without a corridor");
    }
}
