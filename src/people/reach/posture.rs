//! Shoulders and elbows of a person of whom only head and hands are seen.
//!
//! Main types: [`BodyLengths`] (of one wearer, learned while hands are seen), [`ArmEstimate`]. A headset sees head,
//! wrists, palms and finger tips; shoulders follow from the head, elbows from both ends of the arm, each with a
//! standard deviation. Shares of the body height are those of Winter, Biomechanics and Motor Control of Human Movement.
//! Refuses: pictures, and hands that no arm reaches.

use super::sample::{ArmPoint, ArmSample, ArmVector, ray};

/// Height of the middle of the head, as a share of the body height.
const HEAD: f64 = 0.935;
/// Distance from there down to the shoulders, and half the shoulders' width, shares of the height.
const DROP: f64 = 0.115;
const HALF_WIDTH: f64 = 0.11;
/// Upper arm and lower arm, shares of the height.
const UPPER: f64 = 0.186;
const LOWER: f64 = 0.146;
/// From wrist to palm and to finger tip, shares of the height.
const PALM: f64 = 0.045;
const FINGER: f64 = 0.105;
/// Relative standard deviation of lengths between people of one height.
const PEOPLE: f64 = 0.05;
/// Share of a head's turn that the chest turns with it.
const CHEST_TURNS: f64 = 0.25;
/// Standard deviation of a shoulder seen from the head, metres: people lean and shrug.
const SHOULDER_M: f64 = 0.04;
/// Rotation of an elbow about the line from shoulder to wrist, from straight down outward, and its standard deviation,
/// radians.
const SWIVEL: (f64, f64) = (0.4, 0.35);
/// A hand farther than the arm's length times this belongs to another person.
const STRANGE: f64 = 1.35;
/// Range of plausible heights, metres.
const HEIGHTS_M: [f64; 2] = [1.3, 2.2];

/// Lengths of one wearer's body, metres. Kept in memory only, and dropped with the shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyLengths {
    /// Body height.
    pub height_m: f64,
    /// Distance from shoulder to wrist of a straight arm.
    pub arm_m: f64,
    /// Standard deviation of the arm's length.
    pub arm_sd_m: f64,
}

/// What is seen of one arm: positions in the frame of the opening.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenArm {
    /// Whether it is the left arm.
    pub is_left: bool,
    /// Position of the wrist.
    pub wrist: ArmPoint,
    /// Position of the palm.
    pub palm: ArmPoint,
    /// Position of the tip of the index finger.
    pub finger: ArmPoint,
}

/// What is seen of a head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenHead {
    /// Position of the head's middle.
    pub at: ArmPoint,
    /// Yaw of the head, left positive, radians.
    pub yaw: f64,
    /// Pitch of the head, up positive, radians.
    pub pitch: f64,
}

/// An arm with the estimated parts that were not seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmEstimate {
    /// Position of the shoulder.
    pub shoulder: ArmPoint,
    /// Standard deviation of the shoulder in every direction, metres.
    pub shoulder_sd_m: f64,
    /// Position of the elbow.
    pub elbow: ArmPoint,
    /// Standard deviation of the elbow in every direction, metres.
    pub elbow_sd_m: f64,
}

impl BodyLengths {
    /// Lengths of a wearer whose head was this high above the floor when standing.
    pub fn of_head(head_m: f64) -> BodyLengths {
        let height_m = (head_m / HEAD).clamp(HEIGHTS_M[0], HEIGHTS_M[1]);
        let arm_m = (UPPER + LOWER) * height_m;
        BodyLengths { height_m, arm_m, arm_sd_m: arm_m * PEOPLE }
    }

    /// Updates the lengths with one more look at head and arm. Heads are highest when people stand; an arm is at least
    /// as long as it reaches, and repeated reaches of the same length make it better known.
    pub fn learn(&mut self, head: &SeenHead, arm: &SeenArm) {
        let height_m = (head.at.z / HEAD).clamp(HEIGHTS_M[0], HEIGHTS_M[1]);
        if height_m > self.height_m {
            let share = height_m / self.height_m;
            (self.height_m, self.arm_m) = (height_m, self.arm_m * share);
        }
        let reach_m = (arm.wrist - self.shoulder(head, arm.is_left)).norm();
        if reach_m > self.arm_m * STRANGE {
            return;
        }
        // Shoulders move along when an arm is stretched, so a little more than its length is no proof.
        let variance = self.arm_sd_m * self.arm_sd_m;
        let noise = SHOULDER_M * SHOULDER_M;
        if reach_m > self.arm_m {
            let gain = variance / (variance + noise);
            self.arm_m += gain * (reach_m - self.arm_m);
            self.arm_sd_m = libm::sqrt(variance * (1.0 - gain)).max(0.005);
        } else if reach_m > 0.95 * self.arm_m {
            self.arm_sd_m = (self.arm_sd_m * 0.999).max(0.005);
        }
    }

    /// Position of a shoulder from the head alone.
    pub fn shoulder(&self, head: &SeenHead, is_left: bool) -> ArmPoint {
        let ahead = ray(CHEST_TURNS * head.yaw, 0.0);
        let left = ArmVector::new(-ahead.y, ahead.x, 0.0);
        let side = if is_left { 1.0 } else { -1.0 };
        let width = HALF_WIDTH * self.height_m * side;
        head.at + left * width - ahead * 0.03 - ArmVector::z() * (DROP * self.height_m)
    }

    /// Shoulder and elbow of an arm; nothing if no arm of this wearer reaches so far.
    pub fn arm(&self, head: &SeenHead, arm: &SeenArm) -> Option<ArmEstimate> {
        let mut shoulder = self.shoulder(head, arm.is_left);
        let way = arm.wrist - shoulder;
        let lacks_m = way.norm() - self.arm_m;
        if lacks_m > (STRANGE - 1.0) * self.arm_m || !way.norm().is_finite() {
            return None;
        }
        let ahead = way.try_normalize(1e-6)?;
        // If the hand is farther than the arm is long, the shoulder moves along with it.
        shoulder += ahead * lacks_m.max(0.0);
        let (upper, lower) = (self.arm_m * UPPER / (UPPER + LOWER), self.arm_m * LOWER / (UPPER + LOWER));
        let far = (arm.wrist - shoulder).norm().clamp((upper - lower).abs() + 0.01, 0.998 * self.arm_m);
        let along = (upper * upper - lower * lower + far * far) / (2.0 * far);
        let aside = libm::sqrt((upper * upper - along * along).max(0.0));
        let out = if arm.is_left { 1.0 } else { -1.0 };
        let down = ArmVector::new(-0.2, out * libm::sin(SWIVEL.0), -libm::cos(SWIVEL.0));
        let down = (down - ahead * down.dot(&ahead)).try_normalize(1e-6).unwrap_or_else(ArmVector::y);
        let elbow = shoulder + ahead * along + down * aside;
        let shoulder_sd_m = SHOULDER_M + 0.25 * lacks_m.max(0.0);
        // Half of the shoulder's error, the swivel's, and what the lengths leave open when the arm is nearly straight.
        let lengths = self.arm_sd_m * (0.5 * self.arm_m / aside.max(0.05)).min(1.0);
        let parts = [0.5 * shoulder_sd_m, aside * SWIVEL.1, lengths];
        let elbow_sd_m = libm::sqrt(parts.iter().map(|p| p * p).sum());
        Some(ArmEstimate { shoulder, shoulder_sd_m, elbow, elbow_sd_m })
    }

    /// A sample for trackers, seen at `at_s`; a left arm becomes a right one, with the places mirrored.
    pub fn sample(&self, at_s: f64, head: &SeenHead, arm: &SeenArm) -> Option<ArmSample> {
        let ArmEstimate { shoulder, elbow, .. } = self.arm(head, arm)?;
        let sample = ArmSample {
            at_s,
            shoulder,
            forearm: elbow + (arm.wrist - elbow) * 0.5,
            hand: arm.palm,
            finger: arm.finger,
            head: head.at,
            yaw: head.yaw,
            pitch: head.pitch,
        };
        Some(if arm.is_left { sample.mirrored() } else { sample })
    }
}

impl SeenArm {
    /// An arm of which only the wrist is seen: palm and finger tip lie ahead of it, away from the head's shoulder.
    pub fn of_wrist(lengths: &BodyLengths, head: &SeenHead, is_left: bool, wrist: ArmPoint) -> SeenArm {
        let ahead =
            (wrist - lengths.shoulder(head, is_left)).try_normalize(1e-6).unwrap_or_else(ArmVector::x);
        let at = |share: f64| wrist + ahead * (share * lengths.height_m);
        SeenArm { is_left, wrist, palm: at(PALM), finger: at(FINGER) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretched_arm_teaches_its_length() {
        let mut lengths = BodyLengths::of_head(1.6);
        let (before, sd) = (lengths.arm_m, lengths.arm_sd_m);
        let head = SeenHead { at: ArmPoint::new(0.0, 0.0, 1.6), yaw: 0.0, pitch: 0.0 };
        let shoulder = lengths.shoulder(&head, false);
        let wrist = shoulder + ArmVector::x() * (before + 0.05);
        let arm = SeenArm::of_wrist(&lengths, &head, false, wrist);
        (0..50).for_each(|_| lengths.learn(&head, &arm));
        assert!(lengths.arm_m > before + 0.01 && lengths.arm_sd_m < sd);
    }

    #[test]
    fn hands_that_no_arm_reaches_and_places_that_are_none_have_no_arm() {
        let lengths = BodyLengths::of_head(1.6);
        let head = SeenHead { at: ArmPoint::new(0.0, 0.0, 1.6), yaw: 0.0, pitch: 0.0 };
        for wrist in [ArmPoint::new(2.0, 0.0, 1.2), ArmPoint::new(f64::NAN, 0.0, 1.2)] {
            let arm = SeenArm { is_left: true, wrist, palm: wrist, finger: wrist };
            assert_eq!(lengths.arm(&head, &arm), None);
        }
    }
}
