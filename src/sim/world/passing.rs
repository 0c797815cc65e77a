//! Robots that pass people beside the line, in the simulated world: what they are told of people, and where they are.
//!
//! Adds to [`World`]. Refuses: to tell them where people truly are.

use super::World;
use giveway_fleet::Fleet;
use giveway_floor::geometry::Pose;
use giveway_floor::id::{Dense, RobotId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::Hull;

/// A robot is told of people this near, metres.
const TOLD_M: f64 = 12.0;

impl World {
    /// Tells robots that may leave the line what the fleet believes of the people near them.
    pub(super) fn show_people(&mut self, fleet: &Fleet, now: Time) {
        self.beside.clear();
        for robot in self.robots.iter_mut().filter(|r| !r.off && r.body.beside.may) {
            robot.body.beside.people = match robot.body.may_pass() {
                true => fleet.people_near(robot.body.pose.at, TOLD_M, now),
                false => Vec::new(),
            };
        }
    }

    /// Where robots were beside the line at each instant since the last step: for the laws.
    pub fn beside_line(&self) -> &[(RobotId, Pose)] {
        self.beside.poses()
    }

    /// What a robot takes of the floor at a pose.
    pub fn outline(&self, robot: RobotId, pose: Pose) -> Hull {
        self.robots[robot.ix()].body.footprint().at(pose)
    }

    /// Puts a robot so far aside, for tests of the laws.
    pub fn shift(&mut self, robot: RobotId, by: giveway_floor::geometry::Vector) {
        self.robots[robot.ix()].body.pose.at += by;
    }

    /// How often robots' own scanners stopped them while they drove.
    pub fn own_stops(&self) -> u64 {
        self.beside.own_stops()
    }
}
