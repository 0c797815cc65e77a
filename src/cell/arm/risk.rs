//! How probably an arm and a person's limbs overlap: as published, and from the distance of capsules and its spread.
//!
//! Main types: [`UncertainLimbs`], [`UncertainPoint`], [`LimbBone`]. Refuses: chance; its sample points are always the
//! same.
//!
//! The published form is Liu and Jebelli 2023 (equations 8 to 16, algorithm 1), here with a list of bones instead of
//! consecutive joints and with the covariance turned to the bone. Both ellipsoids are independent, so that equation 16
//! is the sum of both covariances and needs no samples. The printed form peaks far below one: 9 % for two limbs of
//! equal length.

use super::capsule::{Capsule, Nearest};
use nalgebra::{Matrix3, Point3, Vector3};
use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};
use std::sync::LazyLock;

/// The estimate of a point of a person's body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UncertainPoint {
    /// Mean, map frame, metres.
    pub mean: Point3<f64>,
    /// Covariance, m².
    pub cov: Matrix3<f64>,
}

/// A limb between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimbBone {
    /// Number of the point where the limb begins.
    pub from: usize,
    /// Number of the point where the limb ends.
    pub to: usize,
    /// Radius, metres.
    pub radius_m: f64,
}

/// The estimate of a person's limbs at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct UncertainLimbs {
    /// Joints; only the first [`MOST_POINTS`] are used.
    pub points: Vec<UncertainPoint>,
    /// Limbs between the points; limbs with unknown points are ignored.
    pub bones: Vec<LimbBone>,
}

/// Number of points of a body that are used.
pub const MOST_POINTS: usize = 8;

impl UncertainLimbs {
    /// The limbs at their means, each thickened by `margin_m`.
    pub fn capsules(&self, margin_m: f64) -> Vec<Capsule> {
        let known = self.known_bones();
        let capsule = |bone: &LimbBone| Capsule {
            a: self.points[bone.from].mean,
            b: self.points[bone.to].mean,
            radius_m: bone.radius_m + margin_m,
        };
        known.map(capsule).collect()
    }

    /// The limbs at their means, each thickened by `deviations` times the standard deviation of its less certain end.
    pub fn thickened(&self, deviations: f64) -> Vec<Capsule> {
        let spread = |k: usize| (self.points[k].cov.trace().max(0.0) / 3.0).sqrt();
        let capsule = |bone: &LimbBone| Capsule {
            a: self.points[bone.from].mean,
            b: self.points[bone.to].mean,
            radius_m: bone.radius_m + deviations * spread(bone.from).max(spread(bone.to)),
        };
        self.known_bones().map(capsule).collect()
    }

    fn known_bones(&self) -> impl Iterator<Item = &LimbBone> {
        let count = self.points.len().min(MOST_POINTS);
        self.bones.iter().filter(move |bone| bone.from < count && bone.to < count)
    }
}

/// The share of the standard normal distribution below `x`.
pub fn normal_below(x: f64) -> f64 {
    0.5 * libm::erfc(-x * FRAC_1_SQRT_2)
}

/// Half the length of a segment.
fn half_length(c: &Capsule) -> f64 {
    0.5 * (c.b - c.a).norm()
}

/// The covariance of a limb's ellipsoid with semi-axes ℓ, ℓ/2, ℓ/2, ℓ along the bone: R·diag(ℓ², ℓ²/4, ℓ²/4)·Rᵀ. It
/// needs no rotation, since it equals ℓ²/4 (1 + 3 u uᵀ) with the bone's direction u.
pub fn bone_covariance(limb: &Capsule) -> Matrix3<f64> {
    let half = half_length(limb);
    let u = (limb.b - limb.a) / (2.0 * half).max(1e-9);
    (Matrix3::identity() + u * u.transpose() * 3.0) * (half * half / 4.0).max(1e-9)
}

/// Equation 15 for one link and one limb: volume times density, and its share of the peak.
fn equation_15(link: &Capsule, limb: &Capsule) -> (f64, f64) {
    let cov = bone_covariance(link) + bone_covariance(limb);
    let half = half_length(link);
    let volume = 4.0 / 3.0 * PI * half * (half / 2.0) * (half / 2.0);
    let apart: Vector3<f64> = link.at(0.5) - limb.at(0.5);
    let Some(root) = cov.cholesky() else { return (0.0, 0.0) };
    let share = libm::exp(-0.5 * apart.dot(&root.solve(&apart)));
    let peak = volume / ((TAU * TAU * TAU) * cov.determinant()).sqrt();
    ((peak * share).min(1.0), share)
}

/// Equation 15 as printed, clamped to one: the greatest over all pairs (algorithm 1).
pub fn printed_probability(links: &[Capsule], limbs: &[Capsule]) -> f64 {
    pairs(links, limbs).map(|(link, limb)| equation_15(link, limb).0).fold(0.0, f64::max)
}

/// Equation 15 normalised by its peak, greatest over all pairs: one where both middles coincide.
pub fn normalised_probability(links: &[Capsule], limbs: &[Capsule]) -> f64 {
    pairs(links, limbs).map(|(link, limb)| equation_15(link, limb).1).fold(0.0, f64::max)
}

fn pairs<'a>(links: &'a [Capsule], limbs: &'a [Capsule]) -> impl Iterator<Item = (&'a Capsule, &'a Capsule)> {
    links.iter().flat_map(move |link| limbs.iter().map(move |limb| (link, limb)))
}

/// Number of lines along which the distance is followed, counting their mirror images.
const LINES: usize = 32;
/// Dimensions of the space of errors.
const SPACE: usize = 3 * MOST_POINTS;
/// Number of standard deviations that are examined.
const FAR: f64 = 4.5;

/// Fixed normal numbers: the errors through which the lines go.
static THROUGH: LazyLock<[[f64; SPACE]; LINES]> = LazyLock::new(|| {
    let unit = |n: u64| {
        let mut x = n.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    };
    std::array::from_fn(|line| {
        std::array::from_fn(|k| {
            let n = 2 * (line * SPACE + k) as u64;
            (-2.0 * libm::log(1.0 - unit(n + 1))).sqrt() * libm::cos(TAU * unit(n + 2))
        })
    })
});

/// The probability that any link overlaps any limb: P(distance < 0) with the limbs' points independent and normal.
///
/// To first order it is Φ(−d/σ), with d the least distance of capsules and σ its standard deviation along the closest
/// direction. The distance bends, though, and several limbs may be near; therefore it is followed along parallel lines
/// in the space of errors ("line sampling", Koutsourelakis et al. 2004): each lies along the direction in which the
/// distance changes fastest and goes through a fixed error; the normal measure of the part with negative distance is
/// exact on each line.
pub fn overlap_probability(links: &[Capsule], limbs: &UncertainLimbs) -> f64 {
    let Some(space) = ErrorSpace::new(links, limbs) else { return 0.0 };
    let (least, direction, sigma) = space.steepest();
    if sigma < 1e-5 {
        return if least < 0.0 { 1.0 } else { 0.0 };
    }
    // Nothing moves farther than FAR times its largest standard deviation.
    if least > FAR * space.largest {
        return 0.0;
    }
    let lines = THROUGH.iter().flat_map(|through| [1.0, -1.0].map(|sign| (through, sign)));
    let share = |(through, sign): (&[f64; SPACE], f64)| {
        let along: f64 = through.iter().zip(&direction).map(|(u, a)| u * a).sum();
        let foot: [f64; SPACE] = std::array::from_fn(|k| sign * (through[k] - along * direction[k]));
        space.share_of_line(&foot, &direction)
    };
    lines.map(share).sum::<f64>() / (2 * LINES) as f64
}

/// The first-order form Φ(−d/σ) for the closest pair: the value of [`overlap_probability`] where nothing bends.
pub fn first_order_probability(links: &[Capsule], limbs: &UncertainLimbs) -> f64 {
    let Some(space) = ErrorSpace::new(links, limbs) else { return 0.0 };
    let (least, _, sigma) = space.steepest();
    normal_below(-least / sigma.max(1e-9))
}

/// Errors of a body's points in units of their standard deviations.
struct ErrorSpace<'a> {
    links: &'a [Capsule],
    limbs: &'a UncertainLimbs,
    roots: Vec<Matrix3<f64>>,
    largest: f64,
}

impl<'a> ErrorSpace<'a> {
    /// The space of these links and limbs; nothing where there are no links or no limbs.
    fn new(links: &'a [Capsule], limbs: &'a UncertainLimbs) -> Option<ErrorSpace<'a>> {
        if links.is_empty() || limbs.known_bones().next().is_none() {
            return None;
        }
        let root = |p: &UncertainPoint| {
            let cov = p.cov + Matrix3::identity() * 1e-12;
            cov.cholesky().map_or_else(Matrix3::zeros, |c| c.l())
        };
        let roots: Vec<Matrix3<f64>> = limbs.points.iter().take(MOST_POINTS).map(root).collect();
        let largest = roots.iter().map(|r| r.norm()).fold(0.0, f64::max);
        Some(ErrorSpace { links, limbs, roots, largest })
    }

    fn limb(&self, bone: &LimbBone, error: &[f64; SPACE]) -> Capsule {
        let point = |k: usize| {
            let e = Vector3::new(error[3 * k], error[3 * k + 1], error[3 * k + 2]);
            self.limbs.points[k].mean + self.roots[k] * e
        };
        Capsule { a: point(bone.from), b: point(bone.to), radius_m: bone.radius_m }
    }

    /// The least distance with these errors.
    fn distance(&self, error: &[f64; SPACE]) -> f64 {
        let mut least = f64::INFINITY;
        for bone in self.limbs.known_bones() {
            let limb = self.limb(bone, error);
            for link in self.links {
                least = least.min(link.distance_m(&limb));
            }
        }
        least
    }

    /// The least distance without errors, the unit direction of errors in which it changes fastest, and how fast: the
    /// standard deviation of the distance.
    fn steepest(&self) -> (f64, [f64; SPACE], f64) {
        let none = [0.0; SPACE];
        let mut best: Option<(f64, &LimbBone, Nearest)> = None;
        for bone in self.limbs.known_bones() {
            let limb = self.limb(bone, &none);
            for link in self.links {
                let nearest = link.nearest(&limb);
                let distance = nearest.apart_m - link.radius_m - bone.radius_m;
                if best.is_none_or(|(least, _, _)| distance < least) {
                    best = Some((distance, bone, nearest));
                }
            }
        }
        let Some((least, bone, nearest)) = best else { return (f64::INFINITY, none, 0.0) };
        let mut direction = none;
        for (k, share) in [(bone.from, 1.0 - nearest.t), (bone.to, nearest.t)] {
            let slope = self.roots[k].transpose() * nearest.normal() * -share;
            (0..3).for_each(|i| direction[3 * k + i] += slope[i]);
        }
        let sigma = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
        if sigma > 1e-12 {
            direction.iter_mut().for_each(|x| *x /= sigma);
        }
        (least, direction, sigma)
    }

    /// The normal measure of the part of a line with negative distance.
    fn share_of_line(&self, foot: &[f64; SPACE], direction: &[f64; SPACE]) -> f64 {
        const STEP: f64 = 0.15;
        // A point of a limb moves no faster along the line than its faster end.
        let speed = |k: usize| {
            let d = Vector3::new(direction[3 * k], direction[3 * k + 1], direction[3 * k + 2]);
            (self.roots[k] * d).norm()
        };
        let fastest = (0..self.roots.len()).map(speed).fold(1e-9, f64::max);
        let at = |c: f64| {
            let error: [f64; SPACE] = std::array::from_fn(|k| foot[k] + c * direction[k]);
            self.distance(&error)
        };
        let (mut c, mut here, mut share) = (-FAR, at(-FAR), 0.0);
        while c < FAR {
            let next = (c + (here.abs() / fastest).max(STEP)).min(FAR);
            let there = at(next);
            // Between two points of different sign the distance is taken as linear.
            let root = c + (next - c) * here / (here - there);
            share += match (here < 0.0, there < 0.0) {
                (true, true) => normal_below(next) - normal_below(c),
                (true, false) => normal_below(root) - normal_below(c),
                (false, true) => normal_below(next) - normal_below(root),
                (false, false) => 0.0,
            };
            (c, here) = (next, there);
        }
        (share / (1.0 - 2.0 * normal_below(-FAR))).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn capsule(a: [f64; 3], b: [f64; 3], radius_m: f64) -> Capsule {
        Capsule { a: a.into(), b: b.into(), radius_m }
    }

    fn limb(a: [f64; 3], b: [f64; 3], sigma: f64) -> UncertainLimbs {
        let point = |p: [f64; 3]| UncertainPoint { mean: p.into(), cov: Matrix3::identity() * sigma * sigma };
        let bones = vec![LimbBone { from: 0, to: 1, radius_m: 0.05 }];
        UncertainLimbs { points: vec![point(a), point(b)], bones }
    }

    #[test]
    fn two_equal_limbs_at_one_place_have_the_published_peak_of_nine_percent() {
        let one = capsule([-0.2, 0.0, 0.0], [0.2, 0.0, 0.0], 0.05);
        let printed = printed_probability(&[one], &[one]);
        assert!((printed - 0.094).abs() < 0.001, "{printed}");
        assert!((normalised_probability(&[one], &[one]) - 1.0).abs() < 1e-12);
        let longer = capsule([-0.4, 0.0, 0.0], [0.4, 0.0, 0.0], 0.05);
        let printed = printed_probability(&[one], &[longer]);
        assert!((printed - 0.024).abs() < 0.001, "the limb is twice as long: {printed}");
    }

    #[test]
    fn the_ellipsoid_lies_along_its_bone() {
        let upright = bone_covariance(&capsule([0.0; 3], [0.0, 0.0, 0.4], 0.05));
        assert!((upright[(2, 2)] - 0.04).abs() < 1e-12 && (upright[(0, 0)] - 0.01).abs() < 1e-12);
        let slanted = bone_covariance(&capsule([0.0; 3], [0.3, 0.0, 0.3], 0.05));
        assert!(slanted[(0, 2)] > 0.01, "{slanted}");
    }

    #[test]
    fn an_overlap_is_as_probable_as_the_distance_is_spread() {
        // A long link across a limb: nothing bends, and the probability is Φ(−d/σ).
        let link = [capsule([0.0, -2.0, 0.0], [0.0, 2.0, 0.0], 0.05)];
        for (height, expected) in [(0.1, 0.5), (0.2, 0.022_75), (0.0, 0.954_5)] {
            let limbs = limb([-2.0, 0.0, height], [2.0, 0.0, height], 0.05 * 2f64.sqrt());
            let p = overlap_probability(&link, &limbs);
            assert!((p - expected).abs() < 0.005, "{height}: {p}, not {expected}");
        }
    }

    #[test]
    fn a_point_and_a_ball_are_as_the_integral_says() {
        // A ball of 0.1 m around the mean of a point with 0.1 m: chi with three degrees of freedom, P(r < 1) = 0.1987.
        let ball = [capsule([0.0; 3], [0.0; 3], 0.05)];
        let cov = Matrix3::identity() * 0.01;
        let point = |x: f64| UncertainPoint { mean: Point3::new(x, 0.0, 0.0), cov };
        let one = |x: f64| UncertainLimbs {
            points: vec![point(x)],
            bones: vec![LimbBone { from: 0, to: 0, radius_m: 0.05 }],
        };
        let p = overlap_probability(&ball, &one(0.0));
        assert!((p - 0.1987).abs() < 0.04, "{p}");
        assert!(overlap_probability(&ball, &one(0.2)) < p);
        assert_eq!(overlap_probability(&ball, &one(2.0)), 0.0);
    }

    #[test]
    fn certain_limbs_overlap_or_do_not() {
        let link = [capsule([0.0; 3], [0.0, 1.0, 0.0], 0.05)];
        assert_eq!(overlap_probability(&link, &limb([0.05, 0.0, 0.0], [0.05, 1.0, 0.0], 0.0)), 1.0);
        assert_eq!(overlap_probability(&link, &limb([0.15, 0.0, 0.0], [0.15, 1.0, 0.0], 0.0)), 0.0);
        let nobody = UncertainLimbs { points: Vec::new(), bones: Vec::new() };
        assert_eq!(overlap_probability(&link, &nobody), 0.0);
        let unknown = LimbBone { from: 0, to: 9, radius_m: 0.05 };
        assert_eq!(overlap_probability(&link, &UncertainLimbs { bones: vec![unknown], ..nobody }), 0.0);
    }
}
