//! The robot's own protective stop: it knows nothing of planners and forecasts, and no planner knows of it.
//!
//! Main type: [`OwnStop`]. It brakes if, when braking now, a person who walks straight at the robot at 1.6 m/s could
//! touch it before it stands (ISO 13855, K = 1.6 m/s, all round). Refuses: to steer: it brakes on the present arc.

use giveway_floor::geometry::Point;
use giveway_people::human::{BODY_M, WALK_MPS};
use giveway_people::local::{DriveState, RobotOutline, Twist};

/// Time from a person in the field to the brakes, seconds.
const REACTS_S: f64 = 0.1;
/// Deceleration of the protective stop, metres per second squared.
const HARD_MPS2: f64 = 1.5;
/// Distance that is left, metres.
const ROOM_M: f64 = 0.05;
/// The robot goes on when its field has been clear for this long, seconds.
const RESTART_S: f64 = 0.5;

/// Whether a robot's own scanner holds it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OwnStop {
    /// Remaining time that the stop holds, seconds.
    holds_s: f64,
    /// How often the stop acted.
    pub stops: u32,
}

impl OwnStop {
    /// Checks the field; gives whether the robot is held for the next `dt` seconds.
    pub fn holds(&mut self, outline: &RobotOutline, state: &DriveState, person: Point, dt: f64) -> bool {
        if somebody(outline, state, person) {
            self.stops += u32::from(self.holds_s <= 0.0 && state.twist.speed_mps > 0.0);
            self.holds_s = RESTART_S;
        } else {
            self.holds_s -= dt;
        }
        self.holds_s > 0.0
    }
}

/// The next motion of a robot that is held.
pub(super) fn braked_hard(now: Twist, dt: f64) -> Twist {
    let speed_mps = (now.speed_mps - HARD_MPS2 * dt).max(0.0);
    if speed_mps <= 0.0 {
        return Twist::default();
    }
    Twist { speed_mps, turn_rps: now.turn_rps * speed_mps / now.speed_mps }
}

fn somebody(outline: &RobotOutline, state: &DriveState, person: Point) -> bool {
    const LOOKS: u32 = 6;
    let stop_s = state.twist.speed_mps / HARD_MPS2;
    (0..=LOOKS).any(|k| {
        let t = (REACTS_S + stop_s) * f64::from(k) / f64::from(LOOKS);
        let braking = (t - REACTS_S).max(0.0);
        // The same arc, but shorter: full speed for the time that covers the braking distance.
        let as_long_s = t.min(REACTS_S) + braking * (1.0 - braking / (2.0 * stop_s.max(1e-9)));
        let pose = state.twist.moved(state.pose, as_long_s);
        outline.gap_m(pose, person) < BODY_M + ROOM_M + WALK_MPS * t
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::geometry::{Pose, Vector};
    use giveway_floor::warehouse::Footprint;

    #[test]
    fn whoever_walks_straight_at_it_from_anywhere_does_not_touch_it_while_it_moves() {
        let outline = RobotOutline::of(&Footprint::Circle { radius_m: 0.4 });
        let dt = 0.02;
        for k in 0..24 {
            let angle = f64::from(k) * 0.2618;
            let twist = Twist { speed_mps: 1.2, turn_rps: 0.3 };
            let mut state = DriveState { pose: Pose { at: Point::origin(), heading: 0.0 }, twist };
            let mut person = Point::origin() + Vector::new(angle.cos(), angle.sin()) * 4.0;
            let mut own = OwnStop::default();
            for _ in 0..400 {
                let way = state.pose.at - person;
                person += way / way.norm() * (WALK_MPS * dt).min(way.norm());
                if own.holds(&outline, &state, person, dt) {
                    state.twist = braked_hard(state.twist, dt);
                }
                state.pose = state.twist.moved(state.pose, dt);
                let gap = outline.gap_m(state.pose, person) - BODY_M;
                assert!(gap > 0.0 || state.twist.speed_mps == 0.0, "{angle}: {gap} m");
                if state.twist.speed_mps == 0.0 {
                    break;
                }
            }
            // A person straight behind the robot may never reach it before it has left.
            assert!(own.stops >= 1 || k == 12, "{k}");
        }
    }
}
