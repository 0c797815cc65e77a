//! Capsules: segments with a radius, for limbs of people and links of arms, and the distances between them.
//!
//! Main types: [`Capsule`], [`Nearest`]. Refuses: to know what moves, and how uncertain it is.

use nalgebra::{Point3, Vector3};

/// All points within a radius of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Start of the segment, map frame, metres.
    pub a: Point3<f64>,
    /// End of the segment, map frame, metres.
    pub b: Point3<f64>,
    /// Radius, metres.
    pub radius_m: f64,
}

/// The closest points of two segments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The point on the first segment.
    pub first: Point3<f64>,
    /// The point on the second segment.
    pub second: Point3<f64>,
    /// Position of the first point along its segment: 0 at `a`, 1 at `b`.
    pub s: f64,
    /// Position of the second point along its segment: 0 at `a`, 1 at `b`.
    pub t: f64,
    /// Distance between the two points, metres.
    pub apart_m: f64,
}

impl Capsule {
    /// The point at a share of the segment, 0 at `a`.
    pub fn at(&self, share: f64) -> Point3<f64> {
        self.a + (self.b - self.a) * share
    }

    /// The closest points of both segments (Ericson 2005, 5.1.9); for parallel segments, any closest pair.
    pub fn nearest(&self, other: &Capsule) -> Nearest {
        let (d1, d2, r) = (self.b - self.a, other.b - other.a, self.a - other.a);
        let (a, e, f) = (d1.norm_squared(), d2.norm_squared(), d2.dot(&r));
        const POINT: f64 = 1e-12;
        let (s, t) = if a <= POINT && e <= POINT {
            (0.0, 0.0)
        } else if a <= POINT {
            (0.0, (f / e).clamp(0.0, 1.0))
        } else {
            let c = d1.dot(&r);
            if e <= POINT {
                ((-c / a).clamp(0.0, 1.0), 0.0)
            } else {
                let b = d1.dot(&d2);
                let denominator = a * e - b * b;
                let s = if denominator > 1e-12 * a * e {
                    ((b * f - c * e) / denominator).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let t = (b * s + f) / e;
                if t < 0.0 {
                    ((-c / a).clamp(0.0, 1.0), 0.0)
                } else if t > 1.0 {
                    (((b - c) / a).clamp(0.0, 1.0), 1.0)
                } else {
                    (s, t)
                }
            }
        };
        let (first, second) = (self.at(s), other.at(t));
        Nearest { first, second, s, t, apart_m: (first - second).norm() }
    }

    /// Distance between the surfaces, metres; negative where they overlap.
    pub fn distance_m(&self, other: &Capsule) -> f64 {
        self.nearest(other).apart_m - self.radius_m - other.radius_m
    }
}

impl Nearest {
    /// The direction from the second point to the first; upwards where they coincide.
    pub fn normal(&self) -> Vector3<f64> {
        let between = self.first - self.second;
        if self.apart_m > 1e-9 { between / self.apart_m } else { Vector3::z() }
    }
}

/// The least distance of any of `these` to any of `those`, metres; infinite where either is empty.
pub fn least_distance_m(these: &[Capsule], those: &[Capsule]) -> f64 {
    let pairs = these.iter().flat_map(|a| those.iter().map(move |b| a.distance_m(b)));
    pairs.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn capsule(a: [f64; 3], b: [f64; 3]) -> Capsule {
        Capsule { a: a.into(), b: b.into(), radius_m: 0.1 }
    }

    /// The distance of two segments found by trying many pairs of points.
    fn tried(x: &Capsule, y: &Capsule) -> f64 {
        let shares = || (0..=200).map(|i| f64::from(i) / 200.0);
        let pairs = shares().flat_map(|s| shares().map(move |t| (s, t)));
        pairs.map(|(s, t)| (x.at(s) - y.at(t)).norm()).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn closest_points_are_those_that_trying_finds() {
        let mut k = 1u64;
        let mut unit = || {
            k = k.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (k >> 40) as f64 / (1u64 << 24) as f64
        };
        for _ in 0..60 {
            let mut point = || [unit(), unit(), unit()];
            let (x, y) = (capsule(point(), point()), capsule(point(), point()));
            let nearest = x.nearest(&y);
            assert!((nearest.apart_m - tried(&x, &y)).abs() < 0.01, "{x:?} {y:?}");
            assert!(nearest.apart_m <= tried(&x, &y) + 1e-9);
        }
    }

    #[test]
    fn points_parallels_and_crossings_are_no_exceptions() {
        let line = capsule([0.0; 3], [1.0, 0.0, 0.0]);
        let apart = |other: Capsule| line.nearest(&other).apart_m;
        assert!((apart(capsule([0.5, 0.3, 0.0], [0.5, 0.3, 0.0])) - 0.3).abs() < 1e-12);
        assert!((apart(capsule([0.2, 0.0, 0.4], [0.9, 0.0, 0.4])) - 0.4).abs() < 1e-12);
        assert!((apart(capsule([2.0, 0.0, 0.0], [3.0, 0.0, 0.0])) - 1.0).abs() < 1e-12);
        assert!(apart(capsule([0.5, -1.0, 0.0], [0.5, 1.0, 0.0])) < 1e-12);
        let point = capsule([0.5, 0.0, 0.0], [0.5, 0.0, 0.0]);
        assert!((point.nearest(&capsule([0.5, 0.0, 1.0], [0.5, 0.0, 1.0])).apart_m - 1.0).abs() < 1e-12);
        assert!((line.distance_m(&capsule([0.5, 0.3, 0.0], [0.5, 0.3, 1.0])) - 0.1).abs() < 1e-12);
    }
}
