//! Simulated robots that pass people beside the line: what the fleet tells them of people, and where they are.
//!
//! Adds to [`World`]. Refuses: to tell robots where people truly are.

use super::World;
use giveway_fleet::ForeseenPerson;
use giveway_floor::geometry::{Point, Pose};
use giveway_floor::id::{Dense, RobotId};
use giveway_floor::warehouse::Hull;

impl World {
    /// Robots that may leave the line now, or by an order under way, with their positions: the fleet tells them what it
    /// believes of people near them.
    pub fn robots_beside(&self) -> Vec<(RobotId, Point)> {
        let able = self.robots.iter().filter(|r| !r.off && r.body.beside.may);
        let may = able.filter(|r| r.body.may_pass() || !r.orders.is_empty());
        may.map(|r| (r.body.id, r.body.pose.at)).collect()
    }

    /// Tells robots of people near them.
    pub fn foretell(&mut self, near: Vec<(RobotId, Vec<ForeseenPerson>)>) {
        for (robot, people) in near {
            self.robots[robot.ix()].body.beside.people = people;
        }
    }

    /// Robots that may not leave the line forget what they were told of people.
    pub(super) fn show_people(&mut self) {
        self.beside.clear();
        for robot in self.robots.iter_mut().filter(|r| !r.off && r.body.beside.may && !r.body.may_pass()) {
            robot.body.beside.people = Vec::new();
        }
    }

    /// Where robots were beside the line at each instant since the last step: for the laws.
    pub fn beside_line(&self) -> &[(RobotId, Pose)] {
        self.beside.poses()
    }

    /// A robot's outline at a pose.
    pub fn outline(&self, robot: RobotId, pose: Pose) -> Hull {
        self.robots[robot.ix()].body.footprint().at(pose)
    }

    /// Shifts a robot sideways, for tests of the laws.
    pub fn shift(&mut self, robot: RobotId, by: giveway_floor::geometry::Vector) {
        self.robots[robot.ix()].body.pose.at += by;
    }

    /// How often robots' own scanners stopped them while they drove.
    pub fn own_stops(&self) -> u64 {
        self.beside.own_stops()
    }
}
