//! How near a robot may come to a person, by the actual speeds of both: safe spaces.
//!
//! Main types: [`NearPerson`]; main function: [`Spaces::need_m`]. Source: Ye, Guo, Guo and Luo (2024), equations 3 to
//! 8, with `v_w` and `v_r` as the text defines them: the speeds of the worker towards the robot and of the robot
//! towards the worker, not the 1.6 m/s of equation 4, which applies if a worker's speed is unknown. Refuses: walls.

use super::drive::DriveLimits;
use crate::aware::safe_space::{APART_M, ARM_SPAN_M, StoppingTimes};
use crate::human::{Mixture, WALK_MPS};
use giveway_floor::geometry::{Point, Vector};

/// Time from one moment of a forecast to the next, seconds.
pub const AHEAD_STEP_S: f64 = 0.4;
/// Number of forecast moments that are used: six seconds.
pub const AHEAD_STEPS: usize = 15;
/// Largest error of a person's measured speed, metres per second.
const SPEED_DOUBT_MPS: f64 = 0.1;

/// A person near a robot, as the fleet believes.
#[derive(Clone, Copy, Debug)]
pub struct NearPerson<'a> {
    /// The person's present position, metres.
    pub at: Point,
    /// The person's present velocity, metres per second.
    pub velocity: Vector,
    /// Forecasts of the person, the first [`AHEAD_STEP_S`] from now, and so on; at most [`AHEAD_STEPS`] are used.
    /// Without any the person is taken to stay.
    pub ahead: &'a [Mixture],
}

/// Safe spaces of one robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spaces {
    /// Radius of the circle around the robot, metres.
    pub circle_m: f64,
    /// Limits of the robot's motors and brakes.
    pub limits: DriveLimits,
}

impl Spaces {
    /// Least distance between the middles of a robot with this velocity and of a person at `from_robot` with that one,
    /// metres: arms and walking (equation 3), the robot's circle, the least distance, and the robot's stopping distance
    /// (equations 7 and 8).
    pub fn need_m(&self, robot: Vector, person: Vector, from_robot: Vector) -> f64 {
        let towards = from_robot / from_robot.norm().max(1e-9);
        let robot_mps = robot.dot(&towards).max(0.0);
        let person_mps = (SPEED_DOUBT_MPS - person.dot(&towards)).clamp(0.0, WALK_MPS);
        let times = StoppingTimes { react_s: self.limits.react_s, stop_s: self.limits.stop_s(robot.norm()) };
        let walked_m = person_mps * (times.react_s + times.stop_s);
        let driven_m = times.reacting_m(robot_mps) + times.stopping_m(robot_mps);
        ARM_SPAN_M / 2.0 + walked_m + self.circle_m + APART_M + driven_m
    }

    /// Whether a robot may move with this velocity: it is far enough from the person, or does not come nearer.
    pub fn allow(&self, robot: Vector, person: Vector, from_robot: Vector) -> bool {
        robot.dot(&from_robot) <= 1e-9 || from_robot.norm() >= self.need_m(robot, person, from_robot)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPACES: Spaces = Spaces {
        circle_m: 0.4,
        limits: DriveLimits {
            speed_mps: 1.0,
            accel_mps2: 0.8,
            brake_mps2: 0.5,
            turn_rps: 1.2,
            turn_accel_rps2: 2.5,
            react_s: 0.3,
            period_s: 0.1,
        },
    };

    #[test]
    fn a_worker_who_comes_as_fast_as_the_standard_says_asks_for_the_printed_safe_spaces() {
        let (robot, person, from_robot) =
            (Vector::new(1.0, 0.0), Vector::new(-1.6, 0.0), Vector::new(5.0, 0.0));
        let times = StoppingTimes { react_s: 0.3, stop_s: 2.0 };
        let printed = times.worker_m() + times.robot_m(1.0, 0.4);
        assert!((SPACES.need_m(robot, person, from_robot) - printed).abs() < 1e-12, "equations 4, 7 and 8");
    }

    #[test]
    fn behind_a_worker_who_walks_away_less_is_enough_than_in_front() {
        let robot = Vector::new(1.0, 0.0);
        let need = |person: Vector, from: Vector| SPACES.need_m(robot, person, from);
        let walks = Vector::new(0.0, 1.0);
        let (behind, before) = (need(walks, Vector::new(1.0, 1.0)), need(walks, Vector::new(1.0, -1.0)));
        assert!(behind + 1.0 < before, "{behind} and {before}");
    }

    #[test]
    fn a_robot_within_the_spaces_may_only_leave() {
        let still = Vector::zeros();
        let near = Vector::new(1.0, 0.0);
        assert!(!SPACES.allow(Vector::new(0.1, 0.0), still, near));
        assert!(SPACES.allow(Vector::new(-0.1, 0.0), still, near) && SPACES.allow(still, still, near));
        assert!(SPACES.allow(Vector::new(0.1, 0.0), still, near * 3.0));
    }
}
