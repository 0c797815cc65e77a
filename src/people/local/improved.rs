//! The improved dynamic window: forecasts of people instead of inflated obstacles; speeds within safe spaces.
//!
//! Main type: [`ImprovedWeights`]; main function: [`ImprovedWeights::cost`]. Source: Ye, Guo, Guo and Luo (2024),
//! section 3.3: only one short step is ever decided. What follows it is evaluated in a few simple variants (on the line
//! or beside it; accelerate, keep the speed, or let a person pass first), and the cheapest counts. Costs are seconds. A
//! path behind a person wins if it is cheaper; nothing else makes the robot choose it. Refuses: to be sure of a
//! forecast: each part of it counts with its probability.

use super::drive::{DriveLimits, DriveState, Twist, aim};
use super::spaces::{AHEAD_STEP_S, AHEAD_STEPS, NearPerson, Spaces};
use crate::human::{Mixture, Part};
use giveway_floor::geometry::{Point, Pose, Segment, Vector};

/// Weights of the improved method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImprovedWeights {
    /// Cost of a metre of detour besides its time, seconds.
    pub detour_s_per_m: f64,
    /// Weight of a second near people, seconds: if being within a person's safe space has a probability of one half, a
    /// second costs about two thirds of this.
    pub near_s_per_s: f64,
    /// Cost of turning, seconds per radian per second: it keeps paths smooth.
    pub turn_s_per_rps: f64,
    /// Width of the edge of a safe space whose position is known exactly, metres.
    pub edge_m: f64,
}

impl Default for ImprovedWeights {
    fn default() -> ImprovedWeights {
        ImprovedWeights { detour_s_per_m: 3.0, near_s_per_s: 0.2, turn_s_per_rps: 0.01, edge_m: 0.15 }
    }
}

/// Lateral positions after the decided step: on the line, and halfway or all the way to the edge of the corridor on
/// each side.
const ASIDE: [f64; 5] = [0.0, 0.5, -0.5, 1.0, -1.0];
/// How far ahead the robot steers, seconds of driving and least metres.
const STEERS_FOR: (f64, f64) = (1.2, 0.8);
/// Time in which the angle to that point is corrected, seconds.
const AIM_S: f64 = 0.6;
/// A robot that lets a person pass brakes for this long, seconds, and then accelerates.
const LETS_PASS_S: f64 = 2.4;

/// Cost of a second, per metre outside of the corridor, if only a later step would lead there, seconds: the
/// continuation is no promise, but it must not look free where it is not.
const OUTSIDE_PER_M: f64 = 50.0;

/// Largest probability with which a person is taken to be in the way.
const SURE: f64 = 0.998;

/// How the speed continues after the decided step.
#[derive(Clone, Copy)]
enum Then {
    Gain,
    Keep,
    LetPass,
}

/// What all continuations from here have in common.
#[derive(Clone, Copy)]
pub(super) struct Outlook<'a> {
    pub limits: &'a DriveLimits,
    pub spaces: &'a Spaces,
    /// How far the robot's middle may be beside the line to the left and to the right, metres.
    pub room_m: (f64, f64),
    pub line: Segment,
    pub state: &'a DriveState,
    pub goal: Point,
    pub people: &'a [NearPerson<'a>],
}

impl ImprovedWeights {
    /// Cost of this motion, seconds; infinite if it is not below `bound`.
    pub(super) fn cost(&self, look: &Outlook<'_>, twist: Twist, bound: f64) -> f64 {
        let turning = self.turn_s_per_rps * twist.turn_rps.abs();
        let ways =
            ASIDE.into_iter().flat_map(|aside| [Then::Gain, Then::Keep, Then::LetPass].map(|t| (aside, t)));
        let least = ways.fold(bound - turning, |least, (aside, then)| {
            let aside_m = aside * if aside > 0.0 { look.room_m.0 } else { look.room_m.1 };
            least.min(self.way(look, twist, aside_m, then, least))
        });
        if least < bound - turning { turning + least } else { f64::INFINITY }
    }

    /// Cost of one continuation; infinite as soon as it cannot be less than `least`.
    fn way(&self, look: &Outlook<'_>, first: Twist, aside_m: f64, then: Then, least: f64) -> f64 {
        let (mut pose, mut twist) = (look.state.pose, first);
        let (mut extra_s, mut driven_m, mut passed_s) = (0.0, 0.0, 0.0);
        let left_before = (look.goal - pose.at).norm();
        let mut left = left_before;
        for k in 0..AHEAD_STEPS {
            if k > 0 {
                twist = next(look, twist, pose, (left, aside_m), then, passed_s);
                if !may_go(look, pose, twist, k - 1) {
                    twist.speed_mps = 0.0;
                }
            }
            // The last step ends at the goal.
            let dt =
                if twist.speed_mps * AHEAD_STEP_S > left { left / twist.speed_mps } else { AHEAD_STEP_S };
            pose = twist.moved(pose, dt);
            driven_m += twist.speed_mps * dt;
            passed_s += dt;
            left = (look.goal - pose.at).norm();
            extra_s += dt * OUTSIDE_PER_M * outside_m(look, pose.at);
            // No continuation is shorter than straight on at full speed.
            if passed_s + left / look.limits.speed_mps + extra_s > least {
                return f64::INFINITY;
            }
            extra_s += dt * self.near_s_per_s * self.nearness(look, pose, twist, k);
            if dt < AHEAD_STEP_S {
                break;
            }
        }
        let detour = (driven_m + left - left_before).max(0.0);
        passed_s + left / look.limits.speed_mps + self.detour_s_per_m * detour + extra_s
    }

    /// How near the robot is to people after step `k`: minus the logarithm of the probability that it is in no person's
    /// safe space. A small probability costs little; where a person surely is, there is no way through.
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
            let within = match person.ahead.get(k) {
                None => one(person.at, Vector::zeros(), 0.0),
                Some(mixture) => {
                    let part = |p: &Part| {
                        let spread = (p.cov.trace() / 2.0).max(0.0).sqrt();
                        p.weight * one(p.mean, (p.mean - person.at) / after_s, spread)
                    };
                    mixture.parts.iter().map(part).sum()
                }
            };
            sum -= libm::log(1.0 - within.min(SURE));
        }
        sum
    }
}

/// Speed and turn rate of a step after the first.
fn next(
    look: &Outlook<'_>,
    now: Twist,
    pose: Pose,
    (left_m, aside_m): (f64, f64),
    then: Then,
    passed_s: f64,
) -> Twist {
    let limits = look.limits;
    let gained = (now.speed_mps + limits.accel_mps2 * AHEAD_STEP_S).min(limits.speed_mps);
    let speed_mps = match then {
        Then::Keep => now.speed_mps,
        Then::LetPass if passed_s < LETS_PASS_S => {
            (now.speed_mps - limits.brake_mps2 * AHEAD_STEP_S).max(0.0)
        }
        Then::LetPass | Then::Gain => gained,
    };
    let speed_mps = speed_mps.min((2.0 * limits.brake_mps2 * left_m).sqrt());
    let change = limits.turn_accel_rps2 * AHEAD_STEP_S;
    let wanted = aim(pose, steers_for(look, pose.at, speed_mps, aside_m)) / AIM_S;
    let turn_rps = wanted.clamp(now.turn_rps - change, now.turn_rps + change);
    Twist { speed_mps, turn_rps: turn_rps.clamp(-limits.turn_rps, limits.turn_rps) }
}

/// Whether the robot will be allowed to drive on after step `k`, if people are as expected. If not, it stands, and may
/// turn.
fn may_go(look: &Outlook<'_>, pose: Pose, twist: Twist, k: usize) -> bool {
    let ahead = Vector::new(libm::cos(pose.heading), libm::sin(pose.heading)) * twist.speed_mps;
    look.people.iter().all(|p| {
        let mean = p.ahead.get(k).and_then(Mixture::mean).unwrap_or(p.at);
        let velocity = (mean - p.at) / (AHEAD_STEP_S * (k + 1) as f64);
        look.spaces.allow(ahead, velocity, mean - pose.at)
    })
}

/// How far the robot's middle is outside of its allowed floor, metres.
fn outside_m(look: &Outlook<'_>, at: Point) -> f64 {
    let way = look.line.b - look.line.a;
    let aside = way.perp(&(at - look.line.a)) / way.norm().max(1e-9);
    (aside - look.room_m.0).max(-aside - look.room_m.1).max(0.0)
}

/// The point to steer for: ahead, beside the line; the goal if that is nearer.
fn steers_for(look: &Outlook<'_>, at: Point, speed_mps: f64, aside_m: f64) -> Point {
    let way = look.line.b - look.line.a;
    let along = way / way.norm().max(1e-9);
    let ahead = (at - look.line.a).dot(&along) + (STEERS_FOR.0 * speed_mps).max(STEERS_FOR.1);
    if ahead >= (look.goal - look.line.a).dot(&along) {
        return look.goal;
    }
    look.line.a + along * ahead + Vector::new(-along.y, along.x) * aside_m
}
