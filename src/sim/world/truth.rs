//! What is true of the floor, for the laws: where robots are, whether they touch, and how their links are.
//!
//! Refuses: to be seen by the fleet.

use super::World;
use giveway_fleet::Telemetry;
use giveway_floor::geometry::Point;
use giveway_floor::id::{Dense, RobotId};

impl World {
    /// Where each robot truly is.
    pub fn places(&self) -> impl Iterator<Item = (RobotId, Point)> {
        self.robots.iter().filter(|r| !r.off).map(|r| (r.body.id, r.body.pose.at))
    }

    /// Whether the outlines of two robots truly overlap by more than `slack_m`.
    pub fn overlap(&self, a: RobotId, b: RobotId, slack_m: f64) -> bool {
        let [a, b] = [a, b].map(|robot| &self.robots[robot.ix()].body);
        a.footprint().at(a.pose).overlaps(&b.footprint().at(b.pose), slack_m)
    }

    /// Whether the link of a robot is up.
    pub fn is_connected(&self, robot: RobotId) -> bool {
        self.robots[robot.ix()].trouble.is_connected()
    }

    /// Whether the link of a robot takes orders for it.
    pub fn takes_orders(&self, robot: RobotId) -> bool {
        self.robots[robot.ix()].trouble.takes_orders()
    }

    /// Where each robot truly is, its speed, and the serial number of the last visit that it knows: for the laws.
    pub fn truth(&self) -> impl Iterator<Item = (RobotId, Telemetry)> {
        self.robots.iter().filter(|r| !r.off).map(|r| (r.body.id, r.body.report(self.now)))
    }
}
