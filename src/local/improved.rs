//! The improved dynamic window: where a person will be, instead of an inflated obstacle; speeds within safe spaces.
//!
//! Main type: [`ImprovedWeights`]; main function: [`ImprovedWeights::cost`]. Source: Ye, Guo, Guo and Luo (2024),
//! section 3.3: only one short step is ever decided. What comes after it is looked at in a few plain ways (turn on or
//! head for the goal at once; keep the speed, gain speed, brake), and the cheapest counts. Costs are seconds. A way
//! behind a person wins where it is cheaper; nothing else makes the robot choose it. Refuses: to be sure of a forecast:
//! each part of it counts with its probability.

use super::drive::{DriveLimits, DriveState, Twist, aim};
use super::spaces::{AHEAD_STEP_S, AHEAD_STEPS, NearPerson, Spaces};
use crate::geometry::{Point, Pose, Vector};

/// Figures of the improved method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImprovedWeights {
    /// What a metre of detour costs beside the time that it takes, seconds.
    pub detour_s_per_m: f64,
    /// What a second within a person's safe space costs, seconds.
    pub near_s_per_s: f64,
    /// What turning costs, seconds per radian per second: it keeps ways smooth.
    pub turn_s_per_rps: f64,
    /// How sharply the edge of a safe space is drawn where it is known exactly, metres.
    pub edge_m: f64,
}

impl Default for ImprovedWeights {
    fn default() -> ImprovedWeights {
        ImprovedWeights { detour_s_per_m: 1.0, near_s_per_s: 3.0, turn_s_per_rps: 0.02, edge_m: 0.1 }
    }
}

/// For so long a turn may be kept before the robot heads for its goal, seconds.
const KEPT_S: [f64; 2] = [0.4, 1.2];
/// The angle to the goal is taken away in about this time, seconds.
const AIM_S: f64 = 0.5;

/// What becomes of the speed after the step that is decided.
#[derive(Clone, Copy)]
enum Then {
    Keep,
    Gain,
    Brake,
}

/// What all ways from here have in common.
#[derive(Clone, Copy)]
pub(super) struct Outlook<'a> {
    pub limits: &'a DriveLimits,
    pub spaces: &'a Spaces,
    pub state: &'a DriveState,
    pub goal: Point,
    pub people: &'a [NearPerson<'a>],
}

impl ImprovedWeights {
    /// What it costs to drive so, seconds.
    pub(super) fn cost(&self, look: &Outlook<'_>, twist: Twist) -> f64 {
        let turning = self.turn_s_per_rps * twist.turn_rps.abs();
        let ways =
            KEPT_S.into_iter().flat_map(|kept| [Then::Keep, Then::Gain, Then::Brake].map(|t| (kept, t)));
        let costs = ways.map(|(kept_s, then)| self.way(look, twist, kept_s, then));
        turning + costs.fold(f64::INFINITY, f64::min)
    }

    fn way(&self, look: &Outlook<'_>, first: Twist, kept_s: f64, then: Then) -> f64 {
        let (mut pose, mut twist) = (look.state.pose, first);
        let (mut near_s, mut driven_m, mut passed_s) = (0.0, 0.0, 0.0);
        let left_before = (look.goal - pose.at).norm();
        for k in 0..AHEAD_STEPS {
            let left = (look.goal - pose.at).norm();
            if k > 0 {
                twist = self.next(look, twist, pose, left, then, passed_s >= kept_s - 1e-9);
            }
            // The last step ends at the goal.
            let dt =
                if twist.speed_mps * AHEAD_STEP_S > left { left / twist.speed_mps } else { AHEAD_STEP_S };
            pose = twist.moved(pose, dt);
            driven_m += twist.speed_mps * dt;
            passed_s += dt;
            near_s += dt * self.nearness(look, pose, twist, k);
            if dt < AHEAD_STEP_S {
                break;
            }
        }
        let left = (look.goal - pose.at).norm();
        let detour = (driven_m + left - left_before).max(0.0);
        passed_s + left / look.limits.speed_mps + self.detour_s_per_m * detour + self.near_s_per_s * near_s
    }

    /// Speed and turn rate of the next step.
    fn next(
        &self,
        look: &Outlook<'_>,
        now: Twist,
        pose: Pose,
        left_m: f64,
        then: Then,
        heads: bool,
    ) -> Twist {
        let limits = look.limits;
        let speed_mps = match then {
            Then::Keep => now.speed_mps,
            Then::Gain => (now.speed_mps + limits.accel_mps2 * AHEAD_STEP_S).min(limits.speed_mps),
            Then::Brake => (now.speed_mps - limits.brake_mps2 * AHEAD_STEP_S).max(0.0),
        };
        let speed_mps = speed_mps.min((2.0 * limits.brake_mps2 * left_m).sqrt());
        if !heads {
            return Twist { speed_mps, ..now };
        }
        let change = limits.turn_accel_rps2 * AHEAD_STEP_S;
        let wanted = aim(pose, look.goal) / AIM_S;
        let turn_rps = wanted.clamp(now.turn_rps - change, now.turn_rps + change);
        Twist { speed_mps, turn_rps: turn_rps.clamp(-limits.turn_rps, limits.turn_rps) }
    }

    /// How probably the robot is within somebody's safe space after step `k`: a number from 0 to about 1 for each.
    fn nearness(&self, look: &Outlook<'_>, pose: Pose, twist: Twist, k: usize) -> f64 {
        let ahead = Vector::new(libm::cos(pose.heading), libm::sin(pose.heading)) * twist.speed_mps;
        let after_s = AHEAD_STEP_S * (k + 1) as f64;
        let mut sum = 0.0;
        for person in look.people {
            let one = |at: Point, velocity: Vector, spread_m: f64| {
                let from_robot = at - pose.at;
                let inside = look.spaces.need_m(ahead, velocity, from_robot) - from_robot.norm();
                1.0 / (1.0 + libm::exp(-inside / (self.edge_m + 0.5 * spread_m)))
            };
            match person.ahead.get(k) {
                None => sum += one(person.at, Vector::zeros(), 0.0),
                Some(mixture) => {
                    for part in &mixture.parts {
                        let spread = (part.cov.trace() / 2.0).max(0.0).sqrt();
                        let velocity = (part.mean - person.at) / after_s;
                        sum += part.weight * one(part.mean, velocity, spread);
                    }
                }
            }
        }
        sum
    }
}
