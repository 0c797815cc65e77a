//! The probability that a robot and a person meet, if the robot drives on.
//!
//! Main types: [`Swept`] (where a robot will be), main function: [`collision`]. It compares the robot's footprint,
//! widened by half a person or by the disc in which a vehicle
//! turns, with the forecast of the person's middle. Liu and Jebelli (2023) integrate the product of
//! two densities and compare it with 5 %; that is no probability and peaks at 9.4 % for two equal Gaussians. The
//! probability here is the mass of the forecast whose way the footprint crosses. Refuses: to take caution away; the
//! caller may use it only to brake.

use crate::human::{Mixture, Mover, PLACES};
use giveway_floor::geometry::{Point, Vector};
use giveway_floor::time::{Span, Time};
use smallvec::SmallVec;

/// A robot brakes if the probability of meeting a person is at least this (Liu and Jebelli 2023 tried 0.5 to 20 % and
/// found less reliability beyond 5 %).
pub const THRESHOLD: f64 = 0.05;
/// Length of a time slice, seconds. In each slice, the person is where the forecast has them at its middle.
const SLICE_S: f64 = 0.2;

/// How far beyond the time of braking the check looks: bodies that begin to touch at its end overlap by little then,
/// and the next check comes a control period later.
pub const BEYOND: Span = Span::from_millis(500);

/// Where a robot will be: corners along its path, and the speed it drives at.
#[derive(Clone, Debug)]
pub struct Swept {
    /// Path from the robot's position, in driving order.
    pub way: Vec<Point>,
    /// Speed of the robot, metres per second.
    pub speed_mps: f64,
    /// Half the side of the robot's footprint, metres.
    pub half_m: f64,
    /// What the worker moves as.
    pub mover: Mover,
}

impl Swept {
    /// Position of the robot's middle after `seconds`; finally the end of the path.
    fn at(&self, seconds: f64) -> Point {
        let mut left = self.speed_mps * seconds;
        let mut at = self.way[0];
        for pair in self.way.windows(2) {
            let leg: Vector = pair[1] - pair[0];
            let length = leg.norm();
            if length > left {
                return pair[0] + leg * (left / length);
            }
            (left, at) = (left - length, pair[1]);
        }
        at
    }

    /// The rectangle that the footprint, widened by half the worker, sweeps from one moment to another.
    fn sweep(&self, from_s: f64, to_s: f64) -> (Point, Point) {
        let ends = [self.at(from_s), self.at(to_s)];
        let reach = self.half_m + self.mover.body_m();
        let low = Point::new(ends[0].x.min(ends[1].x) - reach, ends[0].y.min(ends[1].y) - reach);
        (low, Point::new(ends[0].x.max(ends[1].x) + reach, ends[0].y.max(ends[1].y) + reach))
    }
}

/// The probability that person and robot touch within `time`, if the robot drives on as it does. A person who is off
/// the middle of a path now will later be off it to the same side, so each of [`PLACES`] of a forecast's part is
/// followed through time, and counts once, when the robot first meets it. `person` gives the forecast for a moment; the
/// result is nothing if no person was seen.
pub fn collision(
    person: impl Fn(Time) -> Option<Mixture>,
    robot: &Swept,
    now: Time,
    time: Span,
) -> Option<f64> {
    assert!(!robot.way.is_empty(), "a robot is somewhere");
    let slices = (time.as_secs_f64() / SLICE_S).ceil().max(1.0);
    let slice_s = time.as_secs_f64() / slices;
    // The places of each part that were met, as bits.
    let mut met: SmallVec<[u64; 32]> = SmallVec::new();
    let mut probability = 0.0;
    for k in 0..slices as usize {
        let (from_s, to_s) = (k as f64 * slice_s, (k + 1) as f64 * slice_s);
        let mixture = person(now + Span::from_secs_f64((from_s + to_s) / 2.0))?;
        let (low, high) = robot.sweep(from_s, to_s);
        met.resize(mixture.parts.len(), 0);
        for (met, part) in met.iter_mut().zip(&mixture.parts) {
            let first = part.places_within(low, high) & !*met;
            *met |= first;
            probability += part.weight * f64::from(first.count_ones()) / PLACES as f64;
        }
    }
    Some(probability.min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::human::motion::{Fix, Motion};
    use crate::human::{Forecast, Model, Part};
    use nalgebra::Matrix2;

    /// A person who walks along x at 1.2 m/s and is at the origin after two seconds.
    fn walking() -> (Motion, Time) {
        let model = Model::builtin();
        let mut motion = Motion::new(model.motion);
        let mut t = Time::ZERO;
        for i in 0..=20 {
            t = Time(i * 100_000);
            let at = Point::new(0.12 * (i as f64 - 20.0), 0.0);
            motion.see(Fix { seen: t, at, sigma_m: 0.02 });
        }
        (motion, t)
    }

    fn ask(robot: &Swept, lead_s: f64) -> f64 {
        ask_scaled(robot, lead_s, 1.0)
    }

    /// The probability of a collision with a forecast that experience has widened by `scale`.
    fn ask_scaled(robot: &Swept, lead_s: f64, scale: f64) -> f64 {
        let (motion, now) = walking();
        let model = Model::builtin();
        let forecast = Forecast { motion: &motion, ways: &[], bound: &model.bound, free: &model.free };
        collision(|t| Some(forecast.at(t)?.scaled(scale)), robot, now, Span::from_secs_f64(lead_s)).unwrap()
    }

    fn robot(from: (f64, f64), to: (f64, f64)) -> Swept {
        let way = vec![Point::new(from.0, from.1), Point::new(to.0, to.1)];
        Swept { way, speed_mps: 1.5, half_m: 0.45, mover: Mover::OnFoot }
    }

    #[test]
    fn a_robot_that_comes_head_on_will_meet_the_person_and_one_far_beside_will_not() {
        assert!(ask(&robot((4.0, 0.0), (0.0, 0.0)), 2.0) > 0.7);
        assert!(ask(&robot((4.0, 6.0), (0.0, 6.0)), 2.0) < 0.01);
        assert!(ask(&robot((-6.0, 0.0), (-12.0, 0.0)), 2.0) < 0.02, "behind and driving off");
    }

    #[test]
    fn who_stands_beside_a_standing_robot_is_met_once_at_most() {
        let part = Part { weight: 1.0, mean: Point::new(1.0, 0.0), cov: Matrix2::identity() * 0.09 };
        let person = |_| Some(Mixture { parts: vec![part] });
        let stands = robot((0.0, 0.0), (0.0, 0.0));
        let within = |lead_s| collision(person, &stands, Time::ZERO, Span::from_secs_f64(lead_s)).unwrap();
        // The share of a bell of 0.3 m around one metre that is within 0.7 m: one standard deviation out.
        assert!((within(0.2) - 0.16).abs() < 0.05, "{}", within(0.2));
        assert_eq!(within(0.2), within(3.0));
    }

    #[test]
    fn crossing_behind_is_safer_than_crossing_in_front() {
        let front = ask(&robot((1.8, -2.5), (1.8, 2.5)), 2.0);
        let behind = ask(&robot((-1.5, -2.5), (-1.5, 2.5)), 2.0);
        assert!(front > 3.0 * behind && front > THRESHOLD, "{front} and {behind}");
    }

    #[test]
    fn a_forecast_that_experience_has_widened_reaches_robots_farther_beside() {
        let beside = robot((1.5, 2.0), (-1.5, 2.0));
        assert!(ask_scaled(&beside, 1.5, 2.5) > 2.0 * ask(&beside, 1.5));
    }

    #[test]
    fn looking_farther_ahead_never_makes_it_less_probable_by_much() {
        let head_on = robot((5.0, 0.0), (0.0, 0.0));
        let mut before = 0.0;
        for lead_s in [0.4, 0.8, 1.2, 1.6, 2.0] {
            let p = ask(&head_on, lead_s);
            assert!(p > before - 0.05, "{lead_s}: {p} after {before}");
            before = p;
        }
    }
}
