//! Plane geometry in the map frame: metres, radians, right-handed, y up.
//!
//! Main types: [`Point`], [`Pose`], [`Segment`]; robot footprints are squares along the map's axes,
//! because a carried rack keeps its orientation while the robot turns beneath it. Refuses: any notion
//! of time, and frames other than the map's.

mod outline;

pub use outline::{OutlineFault, outline_area_m2};

use nalgebra::{Point2, Vector2};

/// Largest distance of anything on a floor from the map's zero, metres: the one limit for coordinates of maps, people,
/// outlines and devices.
pub const FARTHEST_M: f64 = 100_000.0;

/// A point in the map frame, metres.
pub type Point = Point2<f64>;
/// A displacement in the map frame, metres.
pub type Vector = Vector2<f64>;

/// A point rounded to millimetres: for values that are stored and compared, where rounding must not matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Spot {
    /// Millimetres along x.
    pub x_mm: i64,
    /// Millimetres along y.
    pub y_mm: i64,
}

impl From<Point> for Spot {
    fn from(p: Point) -> Spot {
        Spot { x_mm: to_mm(p.x), y_mm: to_mm(p.y) }
    }
}

impl From<Spot> for Point {
    fn from(s: Spot) -> Point {
        Point::new(s.x_mm as f64 / 1000.0, s.y_mm as f64 / 1000.0)
    }
}

/// Metres as whole millimetres.
#[inline]
pub fn to_mm(metres: f64) -> i64 {
    (metres * 1000.0).round() as i64
}

/// Position and heading in the map frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Position, metres.
    pub at: Point,
    /// Direction, radians, anticlockwise from +x.
    pub heading: f64,
}

/// The straight segment between two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// One end.
    pub a: Point,
    /// The other end.
    pub b: Point,
}

/// The angle `a` brought into `(-π, π]`.
#[inline]
pub fn wrap_angle(a: f64) -> f64 {
    let two_pi = std::f64::consts::TAU;
    let r = a.rem_euclid(two_pi);
    if r > std::f64::consts::PI { r - two_pi } else { r }
}

/// The smaller angle between two headings, in `[0, π]`.
#[inline]
pub fn turn_between(from: f64, to: f64) -> f64 {
    wrap_angle(to - from).abs()
}

impl Segment {
    /// The heading from `a` to `b`, radians.
    #[inline]
    pub fn heading(&self) -> f64 {
        let d = self.b - self.a;
        d.y.atan2(d.x)
    }

    /// Distance of a point from the nearest point of the segment, metres.
    #[inline]
    pub fn distance_to(&self, p: Point) -> f64 {
        let along = self.b - self.a;
        let u = ((p - self.a).dot(&along) / along.norm_squared().max(1e-12)).clamp(0.0, 1.0);
        (p - (self.a + along * u)).norm()
    }

    /// The length, metres.
    #[inline]
    pub fn length(&self) -> f64 {
        (self.b - self.a).norm()
    }

    /// The point at fraction `u` of the segment.
    #[inline]
    pub fn point(&self, u: f64) -> Point {
        self.a + (self.b - self.a) * u
    }
}

/// The larger of the two axis distances between points: squares of side `s` along the axes around them
/// overlap exactly if this is below `s`.
#[inline]
pub fn axis_distance(a: Point, b: Point) -> f64 {
    let d = a - b;
    d.x.abs().max(d.y.abs())
}

/// The smallest [`axis_distance`] between a point and a segment.
///
/// The distance along the segment is the maximum of four linear functions, hence convex and piecewise
/// linear: its minimum stands at an end or where two of them meet.
pub fn axis_distance_to_segment(p: Point, s: Segment) -> f64 {
    let d = s.b - s.a;
    let r = s.a - p;
    let meets = [(d.x, r.x), (d.y, r.y), (d.x - d.y, r.x - r.y), (d.x + d.y, r.x + r.y)];
    let mut best = axis_distance(p, s.a).min(axis_distance(p, s.b));
    for (slope, at_zero) in meets {
        if slope != 0.0 {
            let u = (-at_zero / slope).clamp(0.0, 1.0);
            best = best.min(axis_distance(p, s.point(u)));
        }
    }
    best
}

/// The smallest [`axis_distance`] between two segments: zero where they cross, else at one of the ends.
pub fn axis_distance_of_segments(s: Segment, t: Segment) -> f64 {
    if cross_inside(s, t) {
        return 0.0;
    }
    let ends = [
        axis_distance_to_segment(s.a, t),
        axis_distance_to_segment(s.b, t),
        axis_distance_to_segment(t.a, s),
        axis_distance_to_segment(t.b, s),
    ];
    ends.into_iter().fold(f64::INFINITY, f64::min)
}

fn cross_inside(s: Segment, t: Segment) -> bool {
    let side = |o: Point, a: Point, b: Point| (a - o).perp(&(b - o));
    side(s.a, s.b, t.a) * side(s.a, s.b, t.b) < 0.0 && side(t.a, t.b, s.a) * side(t.a, t.b, s.b) < 0.0
}

/// Whether `p` lies inside the polygon (even-odd rule; its boundary counts as either).
pub fn inside(polygon: &[Point], p: Point) -> bool {
    let mut odd = false;
    for i in 0..polygon.len() {
        let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
        if (a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x {
            odd = !odd;
        }
    }
    odd
}

/// Whether a straight segment runs through the polygon, or begins or ends in it.
#[inline]
pub fn runs_through(polygon: &[Point], s: Segment) -> bool {
    let sides = (0..polygon.len()).map(|i| Segment { a: polygon[i], b: polygon[(i + 1) % polygon.len()] });
    inside(polygon, s.a) || inside(polygon, s.b) || sides.into_iter().any(|side| cross_inside(side, s))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seg(ax: f64, ay: f64, bx: f64, by: f64) -> Segment {
        Segment { a: Point::new(ax, ay), b: Point::new(bx, by) }
    }

    #[test]
    fn squares_on_neighbouring_grid_cells_touch_only_if_wider_than_the_pitch() {
        assert_eq!(axis_distance_to_segment(Point::new(0.0, 1.0), seg(0.0, 0.0, 1.0, 0.0)), 1.0);
        assert_eq!(axis_distance_of_segments(seg(0.0, 0.0, 1.0, 0.0), seg(0.0, 1.0, 1.0, 1.0)), 1.0);
    }

    #[test]
    fn the_distance_to_a_diagonal_is_found_between_its_ends() {
        let d = axis_distance_to_segment(Point::new(1.0, 0.0), seg(0.0, 0.0, 1.0, 1.0));
        assert!((d - 0.5).abs() < 1e-12);
    }

    #[test]
    fn crossing_segments_have_no_distance() {
        assert_eq!(axis_distance_of_segments(seg(0.0, 0.0, 1.0, 1.0), seg(0.0, 1.0, 1.0, 0.0)), 0.0);
    }

    #[test]
    fn angles_wrap_to_the_shorter_way_round() {
        assert!((turn_between(3.0, -3.0) - (std::f64::consts::TAU - 6.0)).abs() < 1e-12);
        assert_eq!(turn_between(0.5, 0.5), 0.0);
    }

    #[test]
    fn a_point_is_inside_its_own_square() {
        let square = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)].map(|(x, y)| Point::new(x, y));
        assert!(inside(&square, Point::new(1.0, 1.0)));
        assert!(!inside(&square, Point::new(3.0, 1.0)));
    }
}
