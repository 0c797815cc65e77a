//! Where an arm can be: configurations and paths that are free of obstacles and of the arm itself.
//!
//! Main types: [`ArmSpace`], [`ArmWay`]. Refuses: a path that it has not checked. Paths are checked in steps of 0.05
//! rad, between which no point of an arm of 1 m moves more than 5 cm; obstacles are thickened by half of that.

use super::capsule::Capsule;
use super::kinematics::{ArmKind, Joints, between, joint_distance};
use nalgebra::Isometry3;

/// Greatest distance of two checked configurations, radians.
pub const CHECK_RAD: f64 = 0.05;
/// Thickening of obstacles, metres, since nothing is checked between two checked configurations.
pub const CHECK_MARGIN_M: f64 = 0.025;

/// A checked path through configurations, straight between two of them.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmWay {
    /// The configurations, including start and goal.
    configurations: Vec<Joints>,
}

/// An arm among obstacles.
#[derive(Clone, Debug)]
pub struct ArmSpace {
    /// The kind of arm.
    pub kind: ArmKind,
    /// Where the arm stands.
    pub base: Isometry3<f64>,
    /// What the arm must not touch.
    pub obstacles: Vec<Capsule>,
    /// Least height of any link, metres.
    pub floor_m: f64,
    /// Lower bounds of sampled angles, radians.
    pub low_rad: Joints,
    /// Upper bounds of sampled angles, radians.
    pub high_rad: Joints,
}

impl ArmSpace {
    /// Whether the arm touches nothing at these angles.
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
            // Boxes first: they are cheap.
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
        // Links that are not adjacent.
        let pairs = (0..links.len()).flat_map(|i| (i + 2..links.len()).map(move |j| (i, j)));
        !pairs.into_iter().any(|(i, j)| links[i].distance_m(&links[j]) < 0.0)
    }

    /// Whether the straight path between two configurations is free, including both ends.
    pub fn is_free_between(&self, a: &Joints, b: &Joints) -> bool {
        let steps = (joint_distance(a, b) / CHECK_RAD).ceil().max(1.0) as usize;
        // From the middle outwards, obstacles show sooner.
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

    /// A path through these configurations, if all of it is free.
    pub fn check(&self, configurations: Vec<Joints>) -> Option<ArmWay> {
        let is_way = !configurations.is_empty() && self.is_free(&configurations[0]);
        let free = is_way && configurations.windows(2).all(|pair| self.is_free_between(&pair[0], &pair[1]));
        free.then_some(ArmWay { configurations })
    }

    /// A configuration from six drawn numbers of `0..1`.
    pub fn configuration(&self, draw: &mut dyn FnMut() -> f64) -> Joints {
        std::array::from_fn(|k| self.low_rad[k] + (self.high_rad[k] - self.low_rad[k]) * draw())
    }

    /// The path with fewer corners: each of `tries` attempts joins two points of the path where that is free.
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

    /// Distance that the tool's tip covers on a path, metres.
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

    /// Length of the path in joint space, radians.
    pub fn length_rad(&self) -> f64 {
        self.configurations.windows(2).map(|pair| joint_distance(&pair[0], &pair[1])).sum()
    }

    /// The configuration `along` radians along the path.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::rrt_connect;
    use nalgebra::Point3;

    const START: Joints = [-0.8, -1.3, 1.7, -1.97, -1.57, 0.0];
    const GOAL: Joints = [0.8, -1.3, 1.7, -1.97, -1.57, 0.0];

    /// A space with a post between start and goal.
    fn space() -> ArmSpace {
        let post =
            Capsule { a: Point3::new(-0.45, -0.1, 0.0), b: Point3::new(-0.45, -0.1, 0.5), radius_m: 0.06 };
        ArmSpace {
            kind: ArmKind::collaborative().clone(),
            base: Isometry3::identity(),
            obstacles: vec![post],
            floor_m: 0.0,
            low_rad: [-2.6, -2.8, -2.4, -3.0, -2.2, -2.0],
            high_rad: [2.6, -0.3, 2.4, 1.0, 2.2, 2.0],
        }
    }

    fn drawing(seed: u64) -> impl FnMut() -> f64 {
        let mut k = seed;
        move || {
            k = k.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (k >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    #[test]
    fn a_way_round_a_post_touches_nothing() {
        let space = space();
        assert!(space.is_free(&START) && space.is_free(&GOAL));
        assert!(!space.is_free_between(&START, &GOAL), "the post is in the way");
        let way = rrt_connect(&space, &START, &GOAL, 3000, &mut drawing(7)).expect("a way");
        let all = way.configurations();
        assert_eq!((all[0], all[all.len() - 1]), (START, GOAL));
        let steps = (way.length_rad() / 0.01) as usize;
        for k in 0..=steps {
            let q = way.at_rad(way.length_rad() * k as f64 / steps as f64);
            let links = space.kind.capsules(&space.kind.pose(&space.base, &q), 0.0);
            assert!(links.iter().all(|l| l.distance_m(&space.obstacles[0]) > 0.0), "at {k}");
        }
    }

    #[test]
    fn the_same_numbers_make_the_same_way() {
        let space = space();
        let way = || rrt_connect(&space, &START, &GOAL, 3000, &mut drawing(3));
        assert_eq!(way(), way());
    }

    #[test]
    fn there_is_no_way_to_where_the_arm_cannot_be() {
        let mut space = space();
        let at = space.kind.pose(&space.base, &GOAL).points[3];
        space.obstacles.push(Capsule { a: at, b: at, radius_m: 0.05 });
        assert_eq!(rrt_connect(&space, &START, &GOAL, 750, &mut drawing(5)), None);
    }

    #[test]
    fn a_way_is_made_shorter_and_stays_free() {
        let space = space();
        let way = rrt_connect(&space, &START, &GOAL, 3000, &mut drawing(11)).expect("a way");
        let shorter = space.shortened(&way, 60, &mut drawing(2));
        assert!(shorter.length_rad() <= way.length_rad());
        assert_eq!(space.check(shorter.configurations().to_vec()), Some(shorter));
        assert!(space.check(vec![START, GOAL]).is_none() && space.check(Vec::new()).is_none());
    }
}
