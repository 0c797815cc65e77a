//! How a robot drives: the limits of its motors and brakes, and the motion from a speed and a turn rate.
//!
//! Main types: [`DriveState`], [`DriveLimits`], [`Twist`], [`SpeedWindow`] (the speeds that can be reached by the next
//! tick). Refuses: slipping wheels, and driving backwards.

use giveway_floor::geometry::{Point, Pose, Vector, wrap_angle};

/// A speed and a turn rate.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Twist {
    /// Forward speed, metres per second, never negative.
    pub speed_mps: f64,
    /// Turn rate, anticlockwise, radians per second.
    pub turn_rps: f64,
}

/// A robot's pose and motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveState {
    /// Position and heading.
    pub pose: Pose,
    /// Speed and turn rate.
    pub twist: Twist,
}

/// Limits of a robot's motors and brakes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveLimits {
    /// Greatest speed, metres per second.
    pub speed_mps: f64,
    /// Greatest acceleration, metres per second squared.
    pub accel_mps2: f64,
    /// Greatest deceleration, metres per second squared.
    pub brake_mps2: f64,
    /// Greatest turn rate, radians per second.
    pub turn_rps: f64,
    /// Greatest change of the turn rate, radians per second squared.
    pub turn_accel_rps2: f64,
    /// Time from a person being seen to the brakes, seconds: T_r of Ye et al. (2024).
    pub react_s: f64,
    /// Time from one choice to the next, seconds.
    pub period_s: f64,
}

/// Number of speeds evaluated in a tick.
pub(super) const SPEEDS: usize = 5;
/// Number of turn rates evaluated besides straight on and straight to the goal; odd, so that the present one is
/// included.
pub(super) const TURNS: usize = 9;

/// The speeds and turn rates that can be reached by the next tick (Fox et al. 1997, section IV-A).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SpeedWindow {
    speeds_mps: (f64, f64),
    turns_rps: (f64, f64),
    straight_rps: f64,
}

impl DriveLimits {
    /// Speeds and turn rates that can be reached by the next tick, and from which the robot still stops within `left_m`
    /// metres. `aim_rad` is the angle from its heading to the goal.
    pub(super) fn window(&self, now: Twist, left_m: f64, aim_rad: f64) -> SpeedWindow {
        let dt = self.period_s;
        // One more period at that speed, then braking (v dt + v² / 2b = left).
        let b = self.brake_mps2;
        let in_time = -b * dt + ((b * dt) * (b * dt) + 2.0 * b * left_m.max(0.0)).sqrt();
        let low = (now.speed_mps - b * dt).max(0.0);
        let high = (now.speed_mps + self.accel_mps2 * dt).min(self.speed_mps).min(in_time.max(low));
        let turn = self.turn_accel_rps2 * dt;
        let bound = |w: f64| w.clamp(-self.turn_rps, self.turn_rps);
        let turns = (bound(now.turn_rps - turn), bound(now.turn_rps + turn));
        let straight = (aim_rad / dt).clamp(turns.0, turns.1);
        SpeedWindow { speeds_mps: (low, high), turns_rps: turns, straight_rps: straight }
    }

    /// The motion if nothing else is left: the robot brakes on its present arc.
    pub fn braked(&self, now: Twist) -> Twist {
        let speed_mps = (now.speed_mps - self.brake_mps2 * self.period_s).max(0.0);
        if speed_mps <= 0.0 {
            return Twist::default();
        }
        Twist { speed_mps, turn_rps: now.turn_rps * speed_mps / now.speed_mps }
    }

    /// Braking time from a speed, seconds: T_s of Ye et al. (2024).
    pub fn stop_s(&self, speed_mps: f64) -> f64 {
        speed_mps / self.brake_mps2
    }
}

impl SpeedWindow {
    /// All motions to evaluate: at most [`SPEEDS`] × ([`TURNS`] + 2).
    pub(super) fn twists(self) -> impl Iterator<Item = Twist> {
        let between =
            |(low, high): (f64, f64), i: usize, n: usize| low + (high - low) * i as f64 / (n - 1) as f64;
        let (low, high) = self.turns_rps;
        let special = [0.0_f64.clamp(low, high), self.straight_rps];
        (0..SPEEDS).flat_map(move |i| {
            let speed_mps = between(self.speeds_mps, i, SPEEDS);
            let turns = (0..TURNS).map(move |j| between((low, high), j, TURNS)).chain(special);
            turns.map(move |turn_rps| Twist { speed_mps, turn_rps })
        })
    }
}

impl Twist {
    /// The pose after `t` seconds of this motion: on an arc of a circle, or straight on.
    pub fn moved(self, from: Pose, t: f64) -> Pose {
        let turned = self.turn_rps * t;
        let (along, across) = if turned.abs() < 1e-6 {
            (1.0, 0.5 * turned)
        } else {
            (libm::sin(turned) / turned, (1.0 - libm::cos(turned)) / turned)
        };
        let way = self.speed_mps * t;
        let (sin, cos) = (libm::sin(from.heading), libm::cos(from.heading));
        let step = Vector::new(cos * along - sin * across, sin * along + cos * across) * way;
        Pose { at: from.at + step, heading: wrap_angle(from.heading + turned) }
    }
}

/// The angle from a robot's heading to a place, radians in `(-π, π]`.
pub(super) fn aim(pose: Pose, at: Point) -> f64 {
    let way = at - pose.at;
    wrap_angle(libm::atan2(way.y, way.x) - pose.heading)
}

#[cfg(test)]
mod tests {
    use super::*;

    pub const LIMITS: DriveLimits = DriveLimits {
        speed_mps: 1.0,
        accel_mps2: 0.8,
        brake_mps2: 0.8,
        turn_rps: 1.2,
        turn_accel_rps2: 2.5,
        react_s: 0.3,
        period_s: 0.1,
    };

    #[test]
    fn an_arc_is_the_sum_of_many_short_straight_pieces() {
        let from = Pose { at: Point::new(1.0, 2.0), heading: 0.7 };
        for turn_rps in [-1.1, 0.0, 1e-9, 0.4] {
            let twist = Twist { speed_mps: 0.9, turn_rps };
            let (mut pose, n) = (from, 100_000);
            for _ in 0..n {
                let dt = 1.5 / f64::from(n);
                let heading = pose.heading + turn_rps * dt / 2.0;
                pose.at += Vector::new(heading.cos(), heading.sin()) * (0.9 * dt);
                pose.heading += turn_rps * dt;
            }
            let arc = twist.moved(from, 1.5);
            assert!((arc.at - pose.at).norm() < 1e-6, "{turn_rps}: {arc:?} and {pose:?}");
            assert!((arc.heading - pose.heading).abs() < 1e-6);
        }
    }

    #[test]
    fn the_window_holds_what_motor_and_brakes_can_do_in_a_tick_and_no_more() {
        let now = Twist { speed_mps: 0.5, turn_rps: 1.1 };
        let all: Vec<Twist> = LIMITS.window(now, 10.0, 0.0).twists().collect();
        assert_eq!(all.len(), SPEEDS * (TURNS + 2));
        let extent = |f: fn(&Twist) -> f64| {
            let values = all.iter().map(f);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)))
        };
        let (speeds, turns) = (extent(|t| t.speed_mps), extent(|t| t.turn_rps));
        assert!((speeds.0 - 0.42).abs() < 1e-12 && (speeds.1 - 0.58).abs() < 1e-12, "{speeds:?}");
        assert!((turns.0 - 0.85).abs() < 1e-12 && (turns.1 - 1.2).abs() < 1e-12, "{turns:?}");
    }

    #[test]
    fn a_robot_comes_to_rest_at_its_goal_and_not_behind_it() {
        let (mut speed, mut x) = (1.0, 0.0);
        for _ in 0..200 {
            let all = LIMITS.window(Twist { speed_mps: speed, turn_rps: 0.0 }, 3.0 - x, 0.0).twists();
            speed = all.map(|t| t.speed_mps).fold(0.0, f64::max);
            x += speed * LIMITS.period_s;
        }
        assert!((2.95..=3.0 + 1e-9).contains(&x), "{x}");
    }

    #[test]
    fn braking_keeps_to_the_arc() {
        let now = Twist { speed_mps: 0.8, turn_rps: 0.4 };
        let braked = LIMITS.braked(now);
        assert!((braked.speed_mps - 0.72).abs() < 1e-12);
        assert!((braked.turn_rps / braked.speed_mps - 0.5).abs() < 1e-12, "the same curvature");
        assert_eq!(LIMITS.braked(Twist { speed_mps: 0.05, turn_rps: 1.0 }), Twist::default());
    }
}
