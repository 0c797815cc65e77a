//! A person's build and habits.
//!
//! Main types: [`ArmBuild`], [`ArmRest`]. People differ in size, pace, where the hand rests, how paths bend and where
//! hands end, more widely than the eight recorded ones. Refuses: a person of an impossible size.

use crate::random::Stream;
use giveway_people::reach::{ArmPoint, ArmVector};

/// The arm that reaches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ArmSide {
    /// The right arm.
    #[default]
    Right,
    /// The left arm.
    Left,
}

/// Where a person's arm and head are between movements, as if the right arm reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmRest {
    /// Position of the finger tip.
    pub finger: ArmPoint,
    /// Position of the shoulder.
    pub shoulder: ArmPoint,
    /// Position of the head.
    pub head: ArmPoint,
    /// Yaw of the head, radians.
    pub yaw: f64,
    /// Pitch of the head, radians.
    pub pitch: f64,
    /// Direction from wrist to finger tip, a unit vector.
    pub points: ArmVector,
}

/// A person's build and habits, metres and radians; all places as if the right arm reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmBuild {
    /// The arm that reaches.
    pub side: ArmSide,
    /// The shoulder of a person who stands still.
    pub shoulder: ArmPoint,
    /// The head of a person who stands still.
    pub head: ArmPoint,
    /// Length from shoulder to elbow.
    pub upper_m: f64,
    /// Length from elbow to wrist.
    pub lower_m: f64,
    /// Length from wrist to finger tip.
    pub hand_m: f64,
    /// Resting position of the finger tip, relative to the shoulder.
    pub rest: ArmVector,
    /// Factor on all durations.
    pub pace: f64,
    /// Share of a movement's time at which it is fastest.
    pub peak: f64,
    /// Height of the path's bend, as a share of its length.
    pub bend: f64,
    /// Direction of the bend: towards the body, outward, up.
    pub bends_to: ArmVector,
    /// Offset of the hand's end position from the target.
    pub ends: ArmVector,
    /// Rotation of the elbow about the line from shoulder to wrist, from straight down outward.
    pub swivel: f64,
    /// Share of a target's yaw that the head turns by.
    pub yaw_share: f64,
    /// Share of a target's pitch that the head turns by.
    pub pitch_share: f64,
    /// Where the head points when nothing is looked at: yaw and pitch.
    pub ahead: (f64, f64),
    /// When the head begins to turn, relative to the hand, seconds; mostly before it.
    pub head_starts_s: f64,
    /// How far shoulder and head move along, metres.
    pub goes_along_m: (f64, f64),
    /// Where a sensor sees the forearm and the hand: shares of the way along the lower arm, and from wrist to finger
    /// tip.
    pub seen_at: (f64, f64),
    /// Direction of the resting hand, from wrist to finger tip.
    pub points: ArmVector,
    /// Tremor of the hand, metres.
    pub tremor_m: f64,
    /// Probability that the eyes wander once during a reach.
    pub wanders: f64,
}

/// Draws a personal value around a middle, at most twice the deviation away.
fn around(middle: f64, deviation: f64, chance: &mut Stream) -> f64 {
    middle + deviation * chance.normal().clamp(-2.0, 2.0)
}

impl ArmBuild {
    /// A person of this height who stands `apart_m` before the opening's plane.
    pub fn of_height(height_m: f64, apart_m: f64, chance: &mut Stream) -> ArmBuild {
        let height_m = height_m.clamp(1.4, 2.2);
        let x = -apart_m;
        let (y, z) = (around(-0.18, 0.02, chance), around(0.80 * height_m, 0.02, chance));
        // Between a hand held before the belly and one that hangs down.
        let rest = ArmVector::new(
            chance.between(0.02, 0.26),
            chance.between(-0.10, 0.28),
            -chance.between(0.30, 0.66),
        );
        ArmBuild {
            side: ArmSide::Right,
            shoulder: ArmPoint::new(x, y, z),
            head: ArmPoint::new(x + around(0.08, 0.04, chance), 0.0, around(0.935 * height_m, 0.02, chance)),
            upper_m: around(0.186, 0.008, chance) * height_m,
            lower_m: around(0.146, 0.007, chance) * height_m,
            hand_m: around(0.105, 0.005, chance) * height_m,
            rest,
            pace: libm::exp(around(0.0, 0.14, chance)),
            peak: around(0.33, 0.06, chance),
            bend: around(0.36, 0.10, chance).max(0.03),
            bends_to: ArmVector::new(
                around(-0.4, 0.5, chance),
                around(-0.1, 0.4, chance),
                around(0.1, 0.6, chance),
            ),
            ends: ArmVector::new(
                around(0.0, 0.04, chance),
                around(0.0, 0.04, chance),
                around(0.0, 0.04, chance),
            ),
            swivel: around(0.4, 0.25, chance),
            yaw_share: around(0.70, 0.16, chance),
            pitch_share: around(0.37, 0.12, chance),
            ahead: (around(0.0, 0.06, chance), around(-0.06, 0.10, chance)),
            head_starts_s: around(-0.08, 0.10, chance),
            goes_along_m: (around(0.045, 0.012, chance), around(0.038, 0.010, chance)),
            seen_at: (chance.between(0.3, 0.8), chance.between(0.0, 0.6)),
            points: ArmVector::new(
                around(0.5, 0.4, chance),
                around(0.3, 0.4, chance),
                around(-0.3, 0.5, chance),
            ),
            tremor_m: around(0.0004, 0.0002, chance).max(0.0),
            wanders: chance.between(0.05, 0.4),
        }
    }

    /// A random adult.
    pub fn any(apart_m: f64, chance: &mut Stream) -> ArmBuild {
        let height_m = around(1.74, 0.09, chance);
        ArmBuild::of_height(height_m, apart_m, chance)
    }

    /// Greatest distance of the finger tip from the shoulder.
    pub fn longest_m(&self) -> f64 {
        self.upper_m + self.lower_m + self.hand_m
    }

    /// The person standing still with the arm at rest, with a small random variation of the place.
    pub fn rest(&self, chance: &mut Stream) -> ArmRest {
        let jitter = ArmVector::new(chance.normal(), chance.normal(), chance.normal());
        ArmRest {
            finger: self.shoulder + self.rest + jitter * 0.015,
            shoulder: self.shoulder,
            head: self.head,
            yaw: self.ahead.0 + 0.03 * chance.normal(),
            pitch: self.ahead.1 + 0.03 * chance.normal(),
            points: (self.points + jitter * 0.1).try_normalize(1e-6).unwrap_or_else(ArmVector::x),
        }
    }
}
