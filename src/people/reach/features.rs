//! Features for the nets: of the body, and of the body relative to each place it may reach for.
//!
//! Main types: [`ArmMotion`] (what is kept of earlier samples: speeds and the last rest), [`BODY`], [`BESIDE`].
//! Everything is relative to the person or to a place, so that a place has no name and a rack no position. Refuses: to
//! count samples; all rates are per second.

use super::sample::{ArmPoint, ArmSample, ArmVector, ReachTarget, angles, ray};

/// Number of features of the body alone.
pub const BODY: usize = 30;
/// Number of features of the body relative to one place.
pub const BESIDE: usize = 22;
/// Number of features of joints relative to one place, as published (Petković, section 5.2.2).
pub const JOINTS: usize = 7;
/// Number of these that were selected (section 5.2.1; eyes are not recorded here): hand and head.
pub const SELECTED: usize = 2;

/// Below this speed a finger tip rests, metres per second.
const REST_MPS: f64 = 0.10;
/// Time in which a new rest replaces the previous one, seconds.
const REST_TAKES_S: f64 = 0.08;
/// Times longer than this are equal for the nets, seconds.
const LONG_S: f64 = 2.0;

/// The last rest of the arm.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rest {
    finger: ArmPoint,
    shoulder: ArmPoint,
    yaw: f64,
    pitch: f64,
    until_s: f64,
}

/// How a person moves: speeds between samples and the last rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmMotion {
    now: ArmSample,
    finger: ArmVector,
    change: ArmVector,
    hand: ArmVector,
    shoulder: ArmVector,
    yaw: f64,
    pitch: f64,
    rest: Rest,
}

impl ArmMotion {
    /// The motion of a person at rest, from a first sample.
    pub fn new(first: ArmSample) -> ArmMotion {
        let zero = ArmVector::zeros();
        let rest = Rest {
            finger: first.finger,
            shoulder: first.shoulder,
            yaw: first.yaw,
            pitch: first.pitch,
            until_s: first.at_s,
        };
        let (finger, change, hand, shoulder) = (zero, zero, zero, zero);
        ArmMotion { now: first, finger, change, hand, shoulder, yaw: 0.0, pitch: 0.0, rest }
    }

    /// The motion after one more, later sample.
    pub fn then(&self, next: ArmSample) -> ArmMotion {
        let dt = (next.at_s - self.now.at_s).max(1e-3);
        let finger = (next.finger - self.now.finger) / dt;
        let mut rest = self.rest;
        if finger.norm() < REST_MPS {
            let share = (dt / REST_TAKES_S).min(1.0);
            rest.finger += (next.finger - rest.finger) * share;
            rest.shoulder += (next.shoulder - rest.shoulder) * share;
            rest.yaw += (next.yaw - rest.yaw) * share;
            rest.pitch += (next.pitch - rest.pitch) * share;
            rest.until_s = next.at_s;
        }
        ArmMotion {
            now: next,
            finger,
            change: (finger - self.finger) / dt,
            hand: (next.hand - self.now.hand) / dt,
            shoulder: (next.shoulder - self.now.shoulder) / dt,
            yaw: (next.yaw - self.now.yaw) / dt,
            pitch: (next.pitch - self.now.pitch) / dt,
            rest,
        }
    }

    /// The motion as it would be with a sample that comes before the next step is due; `earlier` was seen one step of
    /// `step_s` before that sample. Speeds are those of a whole step, so that a fast sensor does not make them noisy.
    pub fn glimpse(&self, earlier: &ArmSample, now: ArmSample, step_s: f64) -> ArmMotion {
        ArmMotion {
            now,
            finger: (now.finger - earlier.finger) / step_s,
            hand: (now.hand - earlier.hand) / step_s,
            shoulder: (now.shoulder - earlier.shoulder) / step_s,
            yaw: (now.yaw - earlier.yaw) / step_s,
            pitch: (now.pitch - earlier.pitch) / step_s,
            ..*self
        }
    }

    /// The last sample.
    pub fn now(&self) -> &ArmSample {
        &self.now
    }

    /// Velocity of the finger tip, metres per second.
    pub fn velocity(&self) -> ArmVector {
        self.finger
    }

    /// Seconds since the finger tip rested.
    pub fn moving_s(&self) -> f64 {
        (self.now.at_s - self.rest.until_s).min(LONG_S)
    }

    /// Features of the body, scaled to about one.
    pub fn body(&self, out: &mut [f32]) {
        let now = &self.now;
        let groups = [
            (now.finger - now.shoulder) * 2.0,
            (now.hand - now.finger) * 5.0,
            (now.forearm - now.shoulder) * 3.0,
            self.finger * 0.7,
            self.change * 0.1,
            (self.hand - self.finger) * 2.0,
            (now.finger - self.rest.finger) * 2.0,
            (now.head - now.shoulder) * 4.0,
        ];
        for (out, v) in out.chunks_exact_mut(3).zip(groups) {
            out.iter_mut().zip(v.iter()).for_each(|(o, v)| *o = *v as f32);
        }
        let (yaw, pitch) = (now.yaw - self.rest.yaw, now.pitch - self.rest.pitch);
        let leant = now.shoulder.x - self.rest.shoulder.x;
        let angles =
            [leant * 15.0, yaw * 4.0, pitch * 6.0, now.yaw * 2.0, now.pitch * 3.0, self.moving_s() * 2.0];
        out[BODY - angles.len()..].iter_mut().zip(angles).for_each(|(o, v)| *o = v as f32);
    }

    /// Features of the body relative to one place.
    pub fn beside(&self, target: &ReachTarget, out: &mut [f32]) {
        let now = &self.now;
        let to = target.hand - now.finger;
        let distance = to.norm().max(1e-3);
        let ahead = to / distance;
        let speed = self.finger.norm();
        let closing = self.finger.dot(&ahead);
        let whole = target.hand - self.rest.finger;
        let length = whole.norm().max(0.05);
        let done = now.finger - self.rest.finger;
        let along = done.dot(&whole) / length;
        let aside = (done.norm_squared() - along * along).max(0.0).sqrt();
        let (yaw, pitch) = angles(target.look - now.head);
        let arm = target.hand - now.shoulder;
        let reach = now.finger - now.shoulder;
        let soon = target.hand - (now.finger + self.finger * 0.12 + self.change * 0.004);
        let later = target.hand - (now.finger + self.finger * 0.3);
        let figures = [
            distance * 2.0,
            libm::log(distance + 0.02) + 1.0,
            speed * 0.7,
            closing * 0.7,
            closing / (speed + 0.1),
            self.change.dot(&ahead) * 0.1,
            along / length,
            aside / length * 2.0,
            length * 2.0,
            soon.norm() * 2.0,
            later.norm() * 2.0,
            (yaw - now.yaw) * 2.0,
            (pitch - now.pitch) * 3.0,
            (0.7 * yaw - now.yaw) * 3.0,
            (0.37 * pitch - now.pitch) * 5.0,
            self.yaw * yaw * 1.5,
            self.pitch * pitch * 2.0,
            (ray(yaw, pitch) - ray(now.yaw, now.pitch)).norm() * 2.0,
            (arm.normalize() - reach.normalize()).norm() * 2.0,
            (arm.norm() - reach.norm()) * 3.0,
            self.moving_s() * 2.0,
            (now.yaw - self.rest.yaw) * yaw * 6.0,
        ];
        out.iter_mut().zip(figures).for_each(|(o, f)| *o = f as f32);
    }

    /// Features as published, of every joint and direction that is seen: distances from hand, head, forearm and
    /// shoulder to the place; distances between unit vectors of head, upper arm and forearm and of the direction from
    /// there to the place. The first two are the selected ones: hand and head.
    pub fn joints(&self, target: &ReachTarget, out: &mut [f32]) {
        let now = &self.now;
        let far = |p: ArmPoint| (target.hand - p).norm();
        let apart = |from: ArmPoint, along: ArmVector, to: ArmPoint| (along - (to - from).normalize()).norm();
        let upper = (now.forearm - now.shoulder).normalize();
        let lower = (now.hand - now.forearm).normalize();
        let figures = [
            far(now.finger),
            apart(now.head, ray(now.yaw, now.pitch), target.look),
            far(now.head),
            far(now.forearm),
            far(now.shoulder),
            apart(now.shoulder, upper, target.hand),
            apart(now.forearm, lower, target.hand),
        ];
        out.iter_mut().zip(figures).for_each(|(o, f)| *o = (f * 2.0) as f32);
    }
}
