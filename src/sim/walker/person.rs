//! A body, and another person as walkers see it.
//!
//! Main type: [`PersonNear`]. Refuses: to move anybody, and to know where others are going beyond where they turn next.

use giveway_floor::geometry::{Point, Vector};

/// Radius of a body, metres.
pub const BODY_M: f64 = 0.25;
/// Sway of the trunk to either side, metres: a few centimetres at the frequency of strides.
pub const SWAY_M: f64 = 0.03;
/// Least distance between the middles of two bodies at which they do not touch when both sway, metres.
pub const APART_M: f64 = 2.0 * (BODY_M + SWAY_M);
/// People farther apart than this ignore one another, metres.
const MATTERS_M: f64 = 4.0;
/// A walker turns its shoulders to pass a person: then its middle comes this near to a wall, metres.
pub(super) const SQUEEZE_M: f64 = 0.2;
/// Distance at which a walker plans to pass others, metres.
pub(super) const PASSING_M: f64 = APART_M + 0.06;

/// Another person as walkers see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PersonNear {
    /// The person's number.
    pub who: usize,
    /// The person's position.
    pub at: Point,
    /// The person's velocity, metres per second.
    pub velocity: Vector,
    /// Where the person is about to walk next; nothing if the person means to stand.
    pub aim: Option<Point>,
    /// Whether the person works at the current place.
    pub works: bool,
    /// Whether people have kept this person from walking on for a while.
    pub kept: bool,
    /// The person's usual walking speed, metres per second.
    pub usual_mps: f64,
}

impl PersonNear {
    /// Whether a walker at a place takes notice of this person.
    pub fn matters_to(&self, at: Point) -> bool {
        (self.at - at).norm() < MATTERS_M
    }

    /// Seconds until a body at `at` that moves with `velocity` passes too near to this person, if both go on like that.
    pub(super) fn meets(&self, at: Point, velocity: Vector) -> Option<f64> {
        let (d, v) = (self.at - at, velocity - self.velocity);
        let closing = d.dot(&v);
        if closing <= 0.0 {
            return None;
        }
        let inside = d.norm_squared() - PASSING_M * PASSING_M;
        if inside <= 0.0 {
            return Some(0.0);
        }
        let root = closing * closing - v.norm_squared() * inside;
        (root > 0.0).then(|| (closing - root.sqrt()) / v.norm_squared())
    }

    /// Whether a step from `from` to `to` would bring a body too near to this person, or nearer if it already is.
    pub(super) fn is_hit(&self, from: Point, to: Point) -> bool {
        let far = (to - self.at).norm();
        far < APART_M && far < (from - self.at).norm()
    }
}
