//! The worker of a scene: follows a fixed plan, and yields to no robot.
//!
//! Main type: [`Stroller`]. The worker sways, veers, and varies the speed; walks into a robot that drives, and steps
//! round one that stands, as round a rack. Refuses: to look ahead.

use super::scene::WorkerWalk;
use giveway_floor::geometry::{Point, Pose, Vector};
use giveway_people::human::BODY_M;
use giveway_people::local::RobotOutline;
use giveway_sim::random::Stream;

/// Sway of the trunk to each side, metres, and its frequency, hertz (reference: a few centimetres at 0.9 Hz).
const SWAY: (f64, f64) = (0.03, 0.9);
/// Deviation of the heading, radians, and how long a deviation lasts, seconds.
const VEER: (f64, f64) = (0.06, 2.0);
/// Deviation of the speed, as a share of it, and how long it lasts, seconds.
const PACE: (f64, f64) = (0.1, 3.0);
/// Greatest walking speed, metres per second: ISO 13855.
const FASTEST_MPS: f64 = 1.6;
/// Least distance of the body from a standing obstacle, metres.
const ELBOW_M: f64 = 0.05;

/// A walking worker.
#[derive(Debug)]
pub(super) struct Stroller {
    walk: WorkerWalk,
    /// Position of the feet; the body sways about it.
    feet: Point,
    body: Point,
    passed_s: f64,
    veer: f64,
    pace: f64,
    phase: f64,
    dice: Stream,
}

impl Stroller {
    pub fn new(walk: WorkerWalk, mut dice: Stream) -> Stroller {
        let phase = dice.between(0.0, std::f64::consts::TAU);
        Stroller {
            walk,
            feet: walk.start,
            body: walk.start,
            passed_s: 0.0,
            veer: 0.0,
            pace: 0.0,
            phase,
            dice,
        }
    }

    /// Position of the body's middle.
    pub fn at(&self) -> Point {
        self.body
    }

    /// The worker's intended direction, radians.
    pub fn heading(&self) -> f64 {
        let turned = self.walk.turn.filter(|(when, _)| self.passed_s >= *when).map_or(0.0, |(_, by)| by);
        self.walk.heading + turned
    }

    /// Walks on for `dt` seconds. `standing` is a robot that does not move.
    pub fn walk(&mut self, dt: f64, standing: Option<(&RobotOutline, Pose)>) {
        self.passed_s += dt;
        let stray = |x: f64, (sd, lasts): (f64, f64), dice: &mut Stream| {
            x - x * dt / lasts + sd * (2.0 * dt / lasts).sqrt() * dice.normal()
        };
        self.veer = stray(self.veer, VEER, &mut self.dice);
        self.pace = stray(self.pace, PACE, &mut self.dice);
        let speed = (self.walk.speed_mps * (1.0 + self.pace)).clamp(0.0, FASTEST_MPS);
        let wanted = self.heading() + self.veer;
        let sway = SWAY.0 * (std::f64::consts::TAU * SWAY.1 * self.passed_s + self.phase).sin();
        let moved = |heading: f64| {
            let ahead = Vector::new(heading.cos(), heading.sin());
            let feet = self.feet + ahead * (speed * dt);
            (feet, feet + Vector::new(-ahead.y, ahead.x) * sway)
        };
        let free = |(_, body): &(Point, Point)| {
            let Some((outline, pose)) = standing else { return true };
            let (now, then) = (outline.gap_m(pose, self.body), outline.gap_m(pose, *body));
            then >= BODY_M + ELBOW_M || then > now
        };
        // The smallest deviation that is free.
        let tries = (0..=12).flat_map(|k| [1.0, -1.0].map(|side| wanted + side * f64::from(k) * 0.15));
        if let Some((feet, body)) = tries.map(moved).find(free) {
            (self.feet, self.body) = (feet, body);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::Footprint;

    fn walk() -> WorkerWalk {
        WorkerWalk { start: Point::origin(), heading: 0.0, speed_mps: 1.0, turn: None }
    }

    #[test]
    fn it_keeps_its_way_and_pace_on_the_whole_and_not_step_by_step() {
        let (mut sum, n) = (Vector::zeros(), 40);
        for who in 0..n {
            let mut w = Stroller::new(walk(), Stream::new(3, 4, who));
            let mut strays: f64 = 0.0;
            for _ in 0..500 {
                w.walk(0.02, None);
                strays = strays.max(w.at().y.abs());
            }
            assert!(strays > 0.02, "{strays}");
            sum += w.at() - Point::origin();
        }
        let mean = sum / n as f64;
        assert!((mean.x - 10.0).abs() < 0.4 && mean.y.abs() < 0.3, "{mean}");
    }

    #[test]
    fn it_steps_round_a_robot_that_stands_and_into_one_that_moves() {
        let outline = RobotOutline::of(&Footprint::Circle { radius_m: 0.4 });
        let pose = Pose { at: Point::new(3.0, 0.0), heading: 0.0 };
        let nearest = |stands: bool| {
            let (mut w, mut nearest) = (Stroller::new(walk(), Stream::new(3, 4, 1)), f64::INFINITY);
            for _ in 0..500 {
                w.walk(0.02, stands.then_some((&outline, pose)));
                nearest = nearest.min(outline.gap_m(pose, w.at()) - BODY_M);
            }
            assert!(w.at().x > 6.0, "it gets on: {}", w.at());
            nearest
        };
        assert!(nearest(true) > 0.0 && nearest(false) < 0.0);
    }
}
