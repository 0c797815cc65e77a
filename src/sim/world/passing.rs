//! Robots that pass people beside the line, in the simulated world: what they are told of people, and where they are.
//!
//! Main type: [`BesideLog`]; adds to [`World`]. Refuses: to tell them where people truly are.

use super::World;
use crate::fleet::Fleet;
use crate::geometry::{Point, Pose};
use crate::id::{Dense, RobotId};
use crate::local::LocalMethod;
use crate::sim::robot::RobotBody;
use crate::time::Time;
use crate::warehouse::Hull;

/// A robot is told of people this near, metres.
const TOLD_M: f64 = 12.0;

/// How robots find their way beside the line, and what was noted of it.
#[derive(Debug)]
pub(super) struct BesideLog {
    pub method: LocalMethod,
    /// Where robots were beside the line at each instant since the last step.
    poses: Vec<(RobotId, Pose)>,
    /// How often robots' own scanners stopped them while they drove, on the line or beside it.
    own_stops: u64,
}

impl BesideLog {
    /// Nothing is noted yet.
    pub fn new(method: LocalMethod) -> BesideLog {
        BesideLog { method, poses: Vec::new(), own_stops: 0 }
    }

    /// Notes where a robot is, if it is beside the line.
    pub fn note(&mut self, body: &RobotBody) {
        if body.beside.steers() {
            self.poses.push((body.id, body.pose));
        }
    }

    /// A robot's scanner looks for people; whether it stops the robot is noted.
    pub fn scan(&mut self, body: &mut RobotBody, now: Time, half_m: f64, people: &[Point]) {
        let was_guarded = body.is_guarded();
        body.scan(now, half_m, people);
        self.own_stops += u64::from(body.is_guarded() && !was_guarded && body.speed_mps > 0.0);
    }
}

impl World {
    /// Tells robots that may leave the line what the fleet believes of the people near them.
    pub(super) fn show_people(&mut self, fleet: &Fleet, now: Time) {
        self.beside.poses.clear();
        for robot in self.robots.iter_mut().filter(|r| !r.off && r.body.beside.may) {
            robot.body.beside.people = match robot.body.may_pass() {
                true => fleet.people_near(robot.body.pose.at, TOLD_M, now),
                false => Vec::new(),
            };
        }
    }

    /// Where robots were beside the line at each instant since the last step: for the laws.
    pub fn beside_line(&self) -> &[(RobotId, Pose)] {
        &self.beside.poses
    }

    /// What a robot takes of the floor at a pose.
    pub fn outline(&self, robot: RobotId, pose: Pose) -> Hull {
        self.robots[robot.ix()].body.footprint().at(pose)
    }

    /// How often robots' own scanners stopped them while they drove.
    pub fn own_stops(&self) -> u64 {
        self.beside.own_stops
    }
}
