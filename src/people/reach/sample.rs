//! What is seen of a person at arm's length at one instant.
//!
//! Main types: [`ArmSample`], [`ReachTarget`]. Metres and radians in the frame of the opening: x into it, y to the left
//! of the person before it, z up. Refuses: to know where the frame is in the hall.

use nalgebra::{Point3, Vector3};

/// A place in the frame of the opening, metres.
pub type ArmPoint = Point3<f64>;
/// A displacement in the frame of the opening, metres.
pub type ArmVector = Vector3<f64>;

/// A person's arm and head at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmSample {
    /// Time of the sample, seconds.
    pub at_s: f64,
    /// Position of the reaching arm's shoulder.
    pub shoulder: ArmPoint,
    /// Position of the forearm, between elbow and wrist.
    pub forearm: ArmPoint,
    /// Position of the palm.
    pub hand: ArmPoint,
    /// Position of the tip of the index finger.
    pub finger: ArmPoint,
    /// Position of the head's middle.
    pub head: ArmPoint,
    /// Yaw of the head, left positive, radians.
    pub yaw: f64,
    /// Pitch of the head, up positive, radians.
    pub pitch: f64,
}

/// A place that a hand can go to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReachTarget {
    /// Where the finger tip ends.
    pub hand: ArmPoint,
    /// Where a person who reaches for it looks.
    pub look: ArmPoint,
}

/// Number of forecast parts of the arm, in this order: shoulder, forearm, hand, finger tip.
pub const ARM_PARTS: usize = 4;

impl ArmSample {
    /// The places of the [`ARM_PARTS`].
    pub fn parts(&self) -> [ArmPoint; ARM_PARTS] {
        [self.shoulder, self.forearm, self.hand, self.finger]
    }

    /// The sample mirrored left to right: a left arm becomes a right one.
    pub fn mirrored(&self) -> ArmSample {
        let flip = |p: ArmPoint| ArmPoint::new(p.x, -p.y, p.z);
        ArmSample {
            at_s: self.at_s,
            shoulder: flip(self.shoulder),
            forearm: flip(self.forearm),
            hand: flip(self.hand),
            finger: flip(self.finger),
            head: flip(self.head),
            yaw: -self.yaw,
            pitch: self.pitch,
        }
    }

    /// Interpolates between this sample and a later one; `share` from 0 (this one) to 1.
    pub fn towards(&self, later: &ArmSample, share: f64) -> ArmSample {
        let at = |a: ArmPoint, b: ArmPoint| a + (b - a) * share;
        ArmSample {
            at_s: self.at_s + (later.at_s - self.at_s) * share,
            shoulder: at(self.shoulder, later.shoulder),
            forearm: at(self.forearm, later.forearm),
            hand: at(self.hand, later.hand),
            finger: at(self.finger, later.finger),
            head: at(self.head, later.head),
            yaw: self.yaw + (later.yaw - self.yaw) * share,
            pitch: self.pitch + (later.pitch - self.pitch) * share,
        }
    }
}

impl ReachTarget {
    /// The place mirrored left to right.
    pub fn mirrored(&self) -> ReachTarget {
        let flip = |p: ArmPoint| ArmPoint::new(p.x, -p.y, p.z);
        ReachTarget { hand: flip(self.hand), look: flip(self.look) }
    }
}

/// Yaw and pitch of a direction.
pub fn angles(direction: ArmVector) -> (f64, f64) {
    let level = libm::hypot(direction.x, direction.y);
    (libm::atan2(direction.y, direction.x), libm::atan2(direction.z, level))
}

/// The unit vector of yaw and pitch.
pub fn ray(yaw: f64, pitch: f64) -> ArmVector {
    let level = libm::cos(pitch);
    ArmVector::new(level * libm::cos(yaw), level * libm::sin(yaw), libm::sin(pitch))
}
