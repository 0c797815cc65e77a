//! A body, and another person as walkers see it.
//!
//! Main type: [`PersonNear`]. Refuses: to move anybody, and to know where others are going beyond where they turn next.

use giveway_floor::geometry::{Point, Vector};

/// Radius of a body, metres.
pub const BODY_M: f64 = 0.25;
/// Sway of the trunk to either side, metres: a few centimetres at the frequency of strides.
pub const SWAY_M: f64 = 0.03;
/// Two bodies keep the middles of their ways so far apart that they do not touch when both sway, metres.
pub const APART_M: f64 = 2.0 * (BODY_M + SWAY_M);
/// Farther apart than this, people do not matter to one another, metres.
const MATTERS_M: f64 = 4.0;
/// A walker turns its shoulders to pass somebody: its middle comes so near to a wall then, metres.
pub(super) const SQUEEZE_M: f64 = 0.2;
/// A walker plans to pass others at this distance, metres.
pub(super) const PASSING_M: f64 = APART_M + 0.06;

/// Another person as walkers see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PersonNear {
    /// Its number.
    pub who: usize,
    /// Where it is.
    pub at: Point,
    /// How it moves, metres per second.
    pub velocity: Vector,
    /// Where it is about to walk next; nothing where it means to stand.
    pub aim: Option<Point>,
    /// Whether it works where it is.
    pub works: bool,
    /// Whether people have kept it from walking on for a while.
    pub kept: bool,
    /// The speed at which it usually walks, metres per second.
    pub usual_mps: f64,
}

impl PersonNear {
    /// Whether somebody at a place takes notice of this person.
    pub fn matters_to(&self, at: Point) -> bool {
        (self.at - at).norm() < MATTERS_M
    }

    /// Seconds until a body at `at` that moves with `velocity` passes too near to this one, if both go on so.
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

    /// Whether a step from `from` to `to` would bring a body too near to this one, or nearer than too near.
    pub(super) fn is_hit(&self, from: Point, to: Point) -> bool {
        let far = (to - self.at).norm();
        far < APART_M && far < (from - self.at).norm()
    }
}
