//! The simple body of a virtual robot: it drives straight from point to point, turns in place, and brakes.
//!
//! Main types: [`VirtualBody`], what it is told ([`BodyCommand`]) and what it reports ([`BodyReport`]). Another body,
//! for example a simulated one, may take its place by the same two types. Refuses: to know orders and versions.

use std::f64::consts::PI;

/// How a body moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyLimits {
    /// Top speed, m/s.
    pub speed_mps: f64,
    /// Acceleration, m/s².
    pub accel_mps2: f64,
    /// Deceleration, m/s².
    pub brake_mps2: f64,
    /// Speed of turning in place, rad/s.
    pub turn_radps: f64,
}

impl Default for BodyLimits {
    fn default() -> BodyLimits {
        BodyLimits { speed_mps: 1.5, accel_mps2: 0.8, brake_mps2: 1.0, turn_radps: 1.0 }
    }
}

/// A point that a body is to reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// The number by which the body reports the point as reached.
    pub key: u32,
    /// Metres, in the map's frame.
    pub x: f64,
    /// Metres, in the map's frame.
    pub y: f64,
    /// The heading without which the point does not count as reached, and its tolerance; both in radians.
    pub heading: Option<(f64, f64)>,
    /// The top speed on the way to the point, m/s.
    pub speed_mps: f64,
}

/// Whether a body follows its path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BodyMotion {
    /// It drives.
    Go,
    /// It brakes along its path and stands.
    #[default]
    Brake,
}

/// What a body is told. The path is the whole of what is released: the body never passes its last point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyCommand {
    /// The points to reach, in order. A body without a path stands at once.
    pub path: Vec<PathPoint>,
    /// Whether to follow the path.
    pub motion: BodyMotion,
    /// A pose to take over first, x and y in metres and the heading in radians: the robot was carried elsewhere.
    pub placed: Option<(f64, f64, f64)>,
}

/// What a body reports.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyReport {
    /// Metres, in the map's frame.
    pub x: f64,
    /// Metres, in the map's frame.
    pub y: f64,
    /// Heading, radians.
    pub theta: f64,
    /// Speed ahead, m/s.
    pub speed_mps: f64,
    /// Speed of turning, rad/s.
    pub turn_radps: f64,
    /// The keys of the points that were reached since the last report, in order.
    pub reached: Vec<u32>,
}

impl BodyReport {
    /// Whether the body neither drives nor turns.
    pub fn stands(&self) -> bool {
        self.speed_mps == 0.0 && self.turn_radps == 0.0
    }
}

/// A body without mass or wheels.
#[derive(Clone, Debug, PartialEq)]
pub struct VirtualBody {
    limits: BodyLimits,
    x: f64,
    y: f64,
    theta: f64,
    speed_mps: f64,
    turn_radps: f64,
}

/// The longest time that is computed at once, microseconds.
const SLICE_US: i64 = 10_000;
/// The longest advance in one call, microseconds; what is beyond is not driven.
const ADVANCE_MOST_US: i64 = 3_600_000_000;
/// The distance at which a point counts as reached, metres.
const NEAR_M: f64 = 1e-6;
/// The bend that is driven without a stop, radians.
const BEND_RAD: f64 = 0.1;
/// The error of heading with which a standing body drives off, radians.
const ALIGNED_RAD: f64 = 0.01;

impl VirtualBody {
    /// A body that stands at a pose: metres and radians.
    pub fn new(limits: BodyLimits, x: f64, y: f64, theta: f64) -> VirtualBody {
        VirtualBody { limits, x, y, theta, speed_mps: 0.0, turn_radps: 0.0 }
    }

    /// Moves for a time in microseconds and reports.
    pub fn advance(&mut self, duration_us: i64, command: &BodyCommand) -> BodyReport {
        if let Some((x, y, theta)) = command.placed {
            *self = VirtualBody::new(self.limits, x, y, theta);
        }
        let mut path = command.path.as_slice();
        let mut reached = Vec::new();
        let mut left_us = duration_us.clamp(0, ADVANCE_MOST_US);
        loop {
            while let Some((point, rest)) = path.split_first().filter(|(p, _)| self.is_at(p)) {
                reached.push(point.key);
                path = rest;
            }
            if left_us == 0 || (path.is_empty() && self.speed_mps == 0.0 && self.turn_radps == 0.0) {
                break;
            }
            let slice_us = left_us.min(SLICE_US);
            self.move_on(slice_us as f64 * 1e-6, path, command.motion);
            left_us -= slice_us;
        }
        if path.is_empty() {
            (self.speed_mps, self.turn_radps) = (0.0, 0.0);
        }
        self.report(reached)
    }

    /// What the body would report now, having reached these points.
    pub fn report(&self, reached: Vec<u32>) -> BodyReport {
        BodyReport {
            x: self.x,
            y: self.y,
            theta: self.theta,
            speed_mps: self.speed_mps,
            turn_radps: self.turn_radps,
            reached,
        }
    }

    fn is_at(&self, point: &PathPoint) -> bool {
        let is_turned = |(theta, tolerance): (f64, f64)| {
            angle_between(self.theta, theta).abs() <= tolerance.max(ALIGNED_RAD)
        };
        (point.x - self.x).hypot(point.y - self.y) <= NEAR_M && point.heading.is_none_or(is_turned)
    }

    fn move_on(&mut self, seconds: f64, path: &[PathPoint], motion: BodyMotion) {
        self.turn_radps = 0.0;
        let Some(target) = path.first() else {
            self.speed_mps = 0.0;
            return;
        };
        let distance_m = (target.x - self.x).hypot(target.y - self.y);
        let ahead = (target.y - self.y).atan2(target.x - self.x);
        let bend = if self.speed_mps > 0.0 { BEND_RAD } else { ALIGNED_RAD };
        let turn_to = match target.heading {
            Some((theta, _)) if distance_m <= NEAR_M => Some(theta),
            _ if angle_between(self.theta, ahead).abs() > bend => Some(ahead),
            _ => None,
        };
        if let Some(theta) = turn_to {
            self.speed_mps = 0.0;
            if motion == BodyMotion::Go {
                self.turn(seconds, theta);
            }
            return;
        }
        let wish_mps = match motion {
            BodyMotion::Go => self.speed_ahead(path, distance_m),
            BodyMotion::Brake => 0.0,
        };
        let change_mps = wish_mps - self.speed_mps;
        self.speed_mps +=
            change_mps.clamp(-self.limits.brake_mps2 * seconds, self.limits.accel_mps2 * seconds);
        self.drive(seconds, target, distance_m, ahead);
        if path.len() == 1 && (self.x, self.y) == (target.x, target.y) {
            self.speed_mps = 0.0;
        }
    }

    fn drive(&mut self, seconds: f64, target: &PathPoint, distance_m: f64, ahead: f64) {
        let step_m = self.speed_mps * seconds;
        if step_m > 0.0 {
            self.theta = ahead;
        }
        if step_m >= distance_m {
            (self.x, self.y) = (target.x, target.y);
        } else {
            self.x += step_m * ahead.cos();
            self.y += step_m * ahead.sin();
            // The last hundredth of a millimetre would take for ever at the speed that braking allows there.
            if distance_m - step_m < NEAR_M * 10.0 && self.speed_mps > 0.0 {
                (self.x, self.y) = (target.x, target.y);
            }
        }
    }

    fn turn(&mut self, seconds: f64, theta: f64) {
        let error = angle_between(self.theta, theta);
        let step = self.limits.turn_radps * seconds;
        if error.abs() <= step {
            self.theta = theta;
        } else {
            self.turn_radps = self.limits.turn_radps * error.signum();
            self.theta = angle_between(0.0, self.theta + step * error.signum());
        }
    }

    /// The speed with which the body can still stop, or slow down, wherever the path ahead asks for it; m/s.
    fn speed_ahead(&self, path: &[PathPoint], distance_m: f64) -> f64 {
        let top = self.limits.speed_mps;
        let braked = |end_mps: f64, distance_m: f64| {
            (end_mps * end_mps + 2.0 * self.limits.brake_mps2 * distance_m).sqrt()
        };
        let mut from = (self.x, self.y);
        let mut distance_m = distance_m;
        let mut speed_mps = top;
        for (i, point) in path.iter().enumerate() {
            if i == 0 {
                speed_mps = speed_mps.min(point.speed_mps);
            }
            let next = path.get(i + 1).filter(|next| !must_stand(from, point, next));
            let end_mps = next.map_or(0.0, |next| next.speed_mps.min(top));
            speed_mps = speed_mps.min(braked(end_mps, distance_m));
            let Some(next) = next.filter(|_| braked(0.0, distance_m) < top) else { break };
            distance_m += (next.x - point.x).hypot(next.y - point.y);
            from = (point.x, point.y);
        }
        // At the very end the profile's root goes to zero and would never arrive.
        speed_mps.max(0.01_f64.min(top))
    }
}

/// Whether a body that comes from a place must stand at a point before it drives to the next one.
fn must_stand(from: (f64, f64), point: &PathPoint, next: &PathPoint) -> bool {
    let came = (point.y - from.1).atan2(point.x - from.0);
    let goes = (next.y - point.y).atan2(next.x - point.x);
    let is_long = |x: f64, y: f64| x.hypot(y) > NEAR_M;
    let bends = is_long(point.x - from.0, point.y - from.1)
        && is_long(next.x - point.x, next.y - point.y)
        && angle_between(came, goes).abs() > BEND_RAD;
    let turns = point
        .heading
        .is_some_and(|(theta, tolerance)| angle_between(came, theta).abs() > tolerance.max(ALIGNED_RAD));
    bends || turns
}

/// The angle by which to turn from one heading to another, from -π to π; 0 if either is not finite.
pub(super) fn angle_between(from: f64, to: f64) -> f64 {
    let turn = (to - from).rem_euclid(2.0 * PI);
    if !turn.is_finite() {
        0.0
    } else if turn > PI {
        turn - 2.0 * PI
    } else {
        turn
    }
}
