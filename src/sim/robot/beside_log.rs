//! Log of robots beside the line: where they were, and how often scanners stopped robots.
//!
//! Main type: [`BesideLog`]. Refuses: to judge; the laws do.

use crate::robot::RobotBody;
use giveway_floor::geometry::{Point, Pose};
use giveway_floor::id::RobotId;
use giveway_floor::time::Time;
use giveway_people::local::LocalMethod;

/// How robots steer beside the line, and the log of it.
#[derive(Debug)]
pub(crate) struct BesideLog {
    /// The method of the robots' local planner.
    pub method: LocalMethod,
    /// Poses of robots beside the line at each instant since the last step.
    poses: Vec<(RobotId, Pose)>,
    /// How often robots' own scanners stopped them while they drove, on the line or beside it.
    own_stops: u64,
}

impl BesideLog {
    /// An empty log.
    pub fn new(method: LocalMethod) -> BesideLog {
        BesideLog { method, poses: Vec::new(), own_stops: 0 }
    }

    /// Begins another step.
    pub fn clear(&mut self) {
        self.poses.clear();
    }

    /// Poses of robots beside the line at each instant of this step.
    pub fn poses(&self) -> &[(RobotId, Pose)] {
        &self.poses
    }

    /// How often robots' own scanners stopped them while they drove.
    pub fn own_stops(&self) -> u64 {
        self.own_stops
    }

    /// Records a robot's pose, if it is beside the line.
    pub fn note(&mut self, body: &RobotBody) {
        if body.beside.steers() {
            self.poses.push((body.id, body.pose));
        }
    }

    /// Lets a robot's scanner look for people; counts if it stops the robot.
    pub fn scan(&mut self, body: &mut RobotBody, now: Time, half_m: f64, people: &[Point]) {
        let was_guarded = body.is_guarded();
        body.scan(now, half_m, people);
        self.own_stops += u64::from(body.is_guarded() && !was_guarded && body.speed_mps > 0.0);
    }
}
