//! A simple picker's arm as ground truth for the arm's experiments.
//!
//! Main types: [`BenchPerson`], [`Reaching`]. Hands move with minimum jerk in warped time: the speed peaks at 37 % of
//! the movement, not at 50 %. Paths are bent and end beside their goal. Refuses: to tell predictors where it is going.

use giveway_cell::arm::{LimbBone, UncertainLimbs, UncertainPoint};
use giveway_sim::random::Stream;
use nalgebra::{Matrix3, Point3, Rotation3, Unit, Vector3};

/// Positions of shoulder, elbow, wrist and palm, map frame, metres.
pub type ArmJoints = [Point3<f64>; 4];

/// The limbs between these joints: upper arm, forearm, hand; radii of adults.
pub const BONES: [LimbBone; 3] = [
    LimbBone { from: 0, to: 1, radius_m: 0.05 },
    LimbBone { from: 1, to: 2, radius_m: 0.042 },
    LimbBone { from: 2, to: 3, radius_m: 0.042 },
];

/// The exponent of the time warp for which minimum jerk is fastest at 37 % of the time: with w = τ^γ the speed is
/// proportional to τ^(3γ−1) (1 − w)², which is greatest at w = (3γ − 1) / (5γ − 1).
const WARP: f64 = 0.778;

/// The share of the path after a share of the time.
pub fn progress(time: f64) -> f64 {
    let w = libm::pow(time.clamp(0.0, 1.0), WARP);
    w * w * w * (10.0 - 15.0 * w + 6.0 * w * w)
}

/// A person at a bench.
#[derive(Clone, Debug)]
pub struct BenchPerson {
    /// Position of the right shoulder when the hand is at rest.
    pub shoulder: Point3<f64>,
    /// Lengths of upper arm, forearm and hand to the palm, metres.
    pub lengths_m: [f64; 3],
    /// How far the elbow is lifted sideways, radians.
    pub swivel: f64,
    /// Factor on the usual duration of a movement.
    pub pace: f64,
    /// Upward bend of the path, as a share of its length.
    pub bend: f64,
    /// Constant offset of the hand's end from its goals, metres.
    pub habit: Vector3<f64>,
}

/// One movement of the hand.
#[derive(Clone, Debug)]
pub struct Reaching {
    /// Start of the palm.
    pub from: Point3<f64>,
    /// End of the palm.
    pub to: Point3<f64>,
    /// Duration, seconds.
    pub lasts_s: f64,
    /// Offset of the path's middle from the straight line, metres.
    pub bend: Vector3<f64>,
}

impl BenchPerson {
    /// A random person, around a usual position of the shoulder.
    pub fn random(chance: &mut Stream, shoulder: Point3<f64>) -> BenchPerson {
        let size = 1.0 + 0.05 * chance.normal().clamp(-2.0, 2.0);
        let mut about = |sigma: f64| sigma * chance.normal().clamp(-2.0, 2.0);
        BenchPerson {
            shoulder: shoulder + Vector3::new(about(0.03), about(0.03), about(0.03)),
            lengths_m: [0.30 * size, 0.26 * size, 0.09 * size],
            swivel: about(0.15),
            pace: (1.0 + about(0.12)).max(0.7),
            bend: 0.12 + about(0.04),
            habit: Vector3::new(about(0.008), about(0.008), about(0.004)),
        }
    }

    /// A movement to a goal.
    pub fn reach(&self, chance: &mut Stream, from: Point3<f64>, goal: Point3<f64>) -> Reaching {
        let mut about = |sigma: f64| sigma * chance.normal();
        let to = goal + self.habit + Vector3::new(about(0.008), about(0.008), about(0.003));
        let length = (to - from).norm();
        // Fitts 1954 with goals of 4 cm.
        let index = libm::log2(2.0 * length.max(0.05) / 0.04);
        let lasts_s = (self.pace * (0.25 + 0.17 * index) * (1.0 + about(0.08))).max(0.35);
        let side = Vector3::new(about(0.03), about(0.03), 0.0) * length;
        Reaching { from, to, lasts_s, bend: Vector3::z() * length * (self.bend + about(0.02)) + side }
    }

    /// The arm's joints for this position of the palm: the elbow hangs down and outwards, the trunk leans if the arm is
    /// too short.
    pub fn joints(&self, palm: Point3<f64>) -> ArmJoints {
        let [upper, fore, hand] = self.lengths_m;
        let mut shoulder = self.shoulder;
        let forward = (palm - shoulder).normalize();
        let wrist = palm - forward * hand;
        let most = 0.97 * (upper + fore);
        let apart = wrist - shoulder;
        if apart.norm() > most {
            shoulder += apart * (1.0 - most / apart.norm());
        }
        let apart = wrist - shoulder;
        let d = apart.norm().max(0.05);
        let along = apart / d;
        let a = ((upper * upper - fore * fore + d * d) / (2.0 * d)).clamp(-upper, upper);
        let height = (upper * upper - a * a).max(0.0).sqrt();
        let pole = Vector3::new(0.6, 0.0, -0.8);
        let pole = (pole - along * pole.dot(&along)).try_normalize(1e-6).unwrap_or_else(Vector3::x);
        let pole = Rotation3::from_axis_angle(&Unit::new_normalize(along), self.swivel) * pole;
        [shoulder, shoulder + along * a + pole * height, wrist, palm]
    }
}

impl Reaching {
    /// Position of the palm `after_s` seconds after the movement began.
    pub fn palm(&self, after_s: f64) -> Point3<f64> {
        let s = progress(after_s / self.lasts_s);
        self.from + (self.to - self.from) * s + self.bend * (4.0 * s * (1.0 - s))
    }
}

/// The joints as limbs that are known to one standard deviation.
pub fn certain(joints: &ArmJoints, sigma_m: f64) -> UncertainLimbs {
    let cov = Matrix3::identity() * sigma_m * sigma_m;
    let points = joints.iter().map(|mean| UncertainPoint { mean: *mean, cov }).collect();
    UncertainLimbs { points, bones: BONES.to_vec() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hand_is_fastest_at_thirty_seven_percent_of_its_time() {
        let speed = |k: i32| progress(f64::from(k + 1) / 1000.0) - progress(f64::from(k) / 1000.0);
        let fastest = (0..1000).max_by(|a, b| speed(*a).total_cmp(&speed(*b))).unwrap();
        assert!((365..375).contains(&fastest), "{fastest}");
        assert!(progress(0.0) == 0.0 && (progress(1.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn bones_keep_their_lengths_wherever_the_hand_is() {
        let person = BenchPerson::random(&mut Stream::new(1, 0, 0), Point3::new(0.15, -0.4, 0.35));
        for x in [-0.25, 0.0, 0.25] {
            for y in [-0.3, 0.0, 0.2] {
                let joints = person.joints(Point3::new(x, y, 0.05));
                for k in 0..3 {
                    let length = (joints[k + 1] - joints[k]).norm();
                    assert!((length - person.lengths_m[k]).abs() < 0.02, "{x} {y} {k}: {length}");
                }
            }
        }
    }
}
