//! The traditional dynamic window: a person is an inflated obstacle at the present position.
//!
//! Main type: [`TraditionalWeights`]; main function: [`TraditionalWeights::value`]. Source: Fox, Burgard and Thrun
//! (1997), equations 13 to 15, with the obstacle of Ye et al. (2024), section 3.3: speeds are bounded by motor and
//! braking only. Refuses: where people will be.

use super::drive::{DriveLimits, DriveState, Twist, aim};
use super::spaces::NearPerson;
use crate::aware::safe_space::ARM_SPAN_M;
use giveway_floor::geometry::Point;

/// Weights of the traditional method. The built-in ones served it best (`docs/corridors.md`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraditionalWeights {
    /// Weight of the heading to the goal at the end of the time looked ahead.
    pub heading: f64,
    /// Weight of the distance from people.
    pub clearance: f64,
    /// Weight of the speed.
    pub speed: f64,
    /// How far ahead the method looks, seconds.
    pub ahead_s: f64,
    /// Inflation of a person's place besides the robot's own circle, metres.
    pub inflated_m: f64,
    /// A greater distance than this has no further value, metres.
    pub enough_m: f64,
}

impl Default for TraditionalWeights {
    fn default() -> TraditionalWeights {
        TraditionalWeights {
            heading: 0.73,
            clearance: 0.41,
            speed: 2.57,
            ahead_s: 1.72,
            inflated_m: 1.65,
            enough_m: 2.9,
        }
    }
}

/// Interval between two checks on an arc, seconds.
const STEP_S: f64 = 0.2;

impl TraditionalWeights {
    /// Equal weights, and a person as wide as the reach of the arms (Ye et al.): the method without tuning.
    pub const EQUAL: TraditionalWeights = TraditionalWeights {
        heading: 1.0,
        clearance: 1.0,
        speed: 1.0,
        ahead_s: 2.0,
        inflated_m: ARM_SPAN_M / 2.0,
        enough_m: 1.5,
    };

    /// The value of a motion; nothing if the robot could not come to rest before an inflated person.
    pub(super) fn value(
        &self,
        limits: &DriveLimits,
        circle_m: f64,
        state: &DriveState,
        twist: Twist,
        goal: Point,
        people: &[NearPerson<'_>],
    ) -> Option<f64> {
        let stop_s = limits.period_s + limits.stop_s(twist.speed_mps) / 2.0;
        // Inside an inflated place, a motion that leads out of it is as good as free.
        let radius =
            |p: &NearPerson<'_>| (circle_m + self.inflated_m).min((p.at - state.pose.at).norm() - 1e-3);
        let mut clearance = self.enough_m;
        let steps = (self.ahead_s.max(stop_s) / STEP_S).ceil() as usize;
        for k in 1..=steps {
            let t = STEP_S * k as f64;
            let at = twist.moved(state.pose, t).at;
            for p in people {
                let gap = (p.at - at).norm() - radius(p);
                if t < stop_s + STEP_S && gap <= 0.0 && twist.speed_mps > 0.0 {
                    return None;
                }
                if t <= self.ahead_s + 1e-9 {
                    clearance = clearance.min(gap.max(0.0));
                }
            }
        }
        let end = twist.moved(state.pose, self.ahead_s.min(2.0 * limits.period_s + stop_s));
        let heading = 1.0 - aim(end, goal).abs() / std::f64::consts::PI;
        let speed = twist.speed_mps / limits.speed_mps;
        Some(self.heading * heading + self.clearance * clearance / self.enough_m + self.speed * speed)
    }
}
