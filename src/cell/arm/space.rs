//! Where an arm can be: configurations and ways that are free of obstacles and of the arm itself.
//!
//! Main types: [`ArmSpace`], [`ArmWay`]. Refuses: a way that it has not checked. Ways are checked in steps of 0.05 rad, between which
//! no point of an arm of 1 m moves more than 5 cm; obstacles are thickened by half of that.

use super::capsule::Capsule;
use super::kinematics::{ArmKind, Joints, between, joint_distance};
use nalgebra::Isometry3;

/// Greatest distance of two checked configurations, radians.
pub const CHECK_RAD: f64 = 0.05;
/// By so much obstacles are thickened, since nothing is looked at between two checked configurations, metres.
pub const CHECK_MARGIN_M: f64 = 0.025;

/// A way through configurations, straight between two, that was checked.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmWay {
    /// The configurations, start and goal among them.
    configurations: Vec<Joints>,
}

/// An arm among obstacles.
#[derive(Clone, Debug)]
pub struct ArmSpace {
    /// What arm it is.
    pub kind: ArmKind,
    /// Where it stands.
    pub base: Isometry3<f64>,
    /// What it must not touch.
    pub obstacles: Vec<Capsule>,
    /// No link may be lower than this, metres.
    pub floor_m: f64,
    /// Sampled angles lie between these, radians.
    pub low_rad: Joints,
    /// See `low_rad`.
    pub high_rad: Joints,
}

impl ArmSpace {
    /// Whether the arm touches nothing with these angles.
    pub fn is_free(&self, joints: &Joints) -> bool {
        if !self.kind.allows(joints) {
            return false;
        }
        let pose = self.kind.pose(&self.base, joints);
        let links: [Capsule; 5] = match self.kind.links.len() {
            5 => std::array::from_fn(|k| {
                let link = &self.kind.links[k];
                Capsule { a: pose.points[link.from], b: pose.points[link.to], radius_m: link.radius_m }
            }),
            _ => return self.are_free(&self.kind.capsules(&pose, 0.0)),
        };
        self.are_free(&links)
    }

    fn are_free(&self, links: &[Capsule]) -> bool {
        let low = |link: &Capsule| link.a.z.min(link.b.z) - link.radius_m < self.floor_m;
        if links.iter().skip(1).any(low) {
            return false;
        }
        let meets = |link: &Capsule, other: &Capsule| {
            // Boxes first: they cost little.
            let apart = link.radius_m + other.radius_m + CHECK_MARGIN_M;
            let beside = |i: usize| {
                link.a[i].min(link.b[i]) - apart > other.a[i].max(other.b[i])
                    || link.a[i].max(link.b[i]) + apart < other.a[i].min(other.b[i])
            };
            !(beside(0) || beside(1) || beside(2)) && link.nearest(other).apart_m < apart
        };
        if links.iter().any(|link| self.obstacles.iter().any(|o| meets(link, o))) {
            return false;
        }
        // Links that are not next to one another.
        let pairs = (0..links.len()).flat_map(|i| (i + 2..links.len()).map(move |j| (i, j)));
        !pairs.into_iter().any(|(i, j)| links[i].distance_m(&links[j]) < 0.0)
    }

    /// Whether the straight way between two configurations is free, both ends among it.
    pub fn is_free_between(&self, a: &Joints, b: &Joints) -> bool {
        let steps = (joint_distance(a, b) / CHECK_RAD).ceil().max(1.0) as usize;
        // From the middle outwards, what is blocked shows sooner.
        let mut stride = steps.next_power_of_two();
        if !self.is_free(b) || !self.is_free(a) {
            return false;
        }
        while stride > 1 {
            let half = stride / 2;
            let mut k = half;
            while k < steps {
                if !self.is_free(&between(a, b, k as f64 / steps as f64)) {
                    return false;
                }
                k += stride;
            }
            stride = half;
        }
        true
    }

    /// A way through these configurations, if all of it is free.
    pub fn check(&self, configurations: Vec<Joints>) -> Option<ArmWay> {
        let is_way = !configurations.is_empty() && self.is_free(&configurations[0]);
        let free = is_way && configurations.windows(2).all(|pair| self.is_free_between(&pair[0], &pair[1]));
        free.then_some(ArmWay { configurations })
    }

    /// A configuration from six numbers of `0..1`.
    pub fn configuration(&self, draw: &mut dyn FnMut() -> f64) -> Joints {
        std::array::from_fn(|k| self.low_rad[k] + (self.high_rad[k] - self.low_rad[k]) * draw())
    }

    /// The same way with fewer corners: each of so many tries joins two places of it where that is free.
    pub fn shortened(&self, way: &ArmWay, tries: usize, draw: &mut dyn FnMut() -> f64) -> ArmWay {
        let mut all = way.configurations.clone();
        for _ in 0..tries {
            if all.len() < 3 {
                break;
            }
            let i = (draw() * (all.len() - 2) as f64) as usize;
            let j = i + 2 + (draw() * (all.len() - i - 2) as f64) as usize;
            if self.is_free_between(&all[i], &all[j]) {
                all.drain(i + 1..j);
            }
        }
        ArmWay { configurations: all }
    }

    /// How far the tool's tip goes, metres.
    pub fn tip_length_m(&self, way: &ArmWay) -> f64 {
        let mut length = 0.0;
        for pair in way.configurations.windows(2) {
            let steps = (joint_distance(&pair[0], &pair[1]) / 0.1).ceil().max(1.0) as usize;
            let tip = |k: usize| {
                self.kind.pose(&self.base, &between(&pair[0], &pair[1], k as f64 / steps as f64)).points[7]
            };
            length += (0..steps).map(|k| (tip(k + 1) - tip(k)).norm()).sum::<f64>();
        }
        length
    }
}

impl ArmWay {
    /// The configurations.
    pub fn configurations(&self) -> &[Joints] {
        &self.configurations
    }

    /// Length in configurations, radians.
    pub fn length_rad(&self) -> f64 {
        self.configurations.windows(2).map(|pair| joint_distance(&pair[0], &pair[1])).sum()
    }

    /// The configuration so many radians along it.
    pub fn at_rad(&self, mut along: f64) -> Joints {
        for pair in self.configurations.windows(2) {
            let length = joint_distance(&pair[0], &pair[1]);
            if along <= length && length > 0.0 {
                return between(&pair[0], &pair[1], along.max(0.0) / length);
            }
            along -= length;
        }
        self.configurations[self.configurations.len() - 1]
    }
}
