//! What a robot takes of the floor: its outline, and the area that the outline covers while the robot turns and drives.
//!
//! Main types: [`Footprint`], [`Hull`] (an outline at a place). Refuses: outlines that are not convex; it takes their
//! hull.

use super::corridor::Corridor;
use crate::geometry::{Point, Pose, Segment, Vector};
use nalgebra::Rotation2;

/// The outline of a robot, with its rack if it carries one, around the point on which it turns.
#[derive(Clone, Debug, PartialEq)]
pub enum Footprint {
    /// A square along the map's axes, whichever way the robot is turned: racks keep their orientation.
    Square {
        /// Side of the square, metres.
        side_m: f64,
    },
    /// A disc.
    Circle {
        /// Radius of the disc, metres.
        radius_m: f64,
    },
    /// A polygon, of which the hull is used.
    Polygon {
        /// Corners, metres, x ahead and y to the left of the robot; along the map's axes if it does not turn.
        corners: Vec<Point>,
        /// Whether the robot turns to where it drives (differential drive); otherwise it keeps its orientation.
        turns: bool,
    },
}

/// A convex part of the floor: a hull, widened on all sides.
#[derive(Clone, Debug, PartialEq)]
pub struct Hull {
    corners: Vec<Point>,
    round_m: f64,
}

/// Number of directions in which extents are compared, a multiple of eight.
const DIRECTIONS: u32 = 64;

impl Footprint {
    /// The area of a robot at a pose.
    pub fn at(&self, pose: Pose) -> Hull {
        let placed = |corner: Point| pose.at + corner.coords;
        match self {
            Footprint::Square { side_m } => {
                Hull { corners: square(*side_m).map(placed).into(), round_m: 0.0 }
            }
            Footprint::Circle { radius_m } => Hull { corners: vec![pose.at], round_m: *radius_m },
            Footprint::Polygon { corners, turns } => {
                let turn = Rotation2::new(if *turns { pose.heading } else { 0.0 });
                let corners = corners.iter().map(|c| placed(turn * c)).collect();
                Hull { corners: hull(corners), round_m: 0.0 }
            }
        }
    }

    /// The area of a robot that stands at a place and may turn there: its turning circle, if it turns.
    pub fn standing(&self, at: Point) -> Hull {
        match self {
            Footprint::Polygon { corners, turns: true } => {
                Hull { corners: vec![at], round_m: farthest_m(corners) }
            }
            _ => self.at(Pose { at, heading: 0.0 }),
        }
    }

    /// The area of a robot that drives a lane, either way.
    pub fn driving(&self, lane: Segment) -> Hull {
        let ahead = lane.heading();
        let headings = [ahead, ahead + std::f64::consts::PI];
        let poses = headings.into_iter().flat_map(|heading| [lane.a, lane.b].map(|at| Pose { at, heading }));
        let bodies: Vec<Hull> = poses.map(|p| self.at(p)).collect();
        let round_m = bodies[0].round_m;
        Hull { corners: hull(bodies.into_iter().flat_map(|b| b.corners).collect()), round_m }
    }

    /// The area of a robot that may leave the line of a lane within a corridor: its area on the line, and the corridor.
    /// Beside the lane this is exactly the corridor; beyond its ends it reaches at most as far as on the line.
    pub fn free(&self, lane: Segment, corridor: Corridor) -> Hull {
        let Hull { mut corners, round_m } = self.driving(lane);
        corners.extend(corridor.corners(lane, round_m));
        Hull { corners: hull(corners), round_m }
    }

    /// Half of the greatest width: how far the outline reaches from its middle along an axis of the map, metres.
    pub fn half_m(&self) -> f64 {
        match self {
            Footprint::Square { side_m } => side_m / 2.0,
            Footprint::Circle { radius_m } => *radius_m,
            Footprint::Polygon { corners, turns: true } => farthest_m(corners),
            Footprint::Polygon { corners, turns: false } => {
                corners.iter().map(|c| c.x.abs().max(c.y.abs())).fold(0.0, f64::max)
            }
        }
    }

    /// Whether this footprint lies within another one wherever both stand, turn and drive.
    pub fn is_within(&self, other: &Footprint) -> bool {
        let at = Point::origin();
        let headings = (0..8).map(|i| f64::from(i) * std::f64::consts::FRAC_PI_4);
        let turned = |heading| (self.at(Pose { at, heading }), other.at(Pose { at, heading }));
        std::iter::once((self.standing(at), other.standing(at)))
            .chain(headings.map(turned))
            .all(|(inner, outer)| inner.is_within(&outer))
    }
}

impl Hull {
    /// Whether this hull and another one overlap by more than `slack_m`.
    ///
    /// Two convex shapes are apart exactly if they are along some axis, and for rounded polygons one of these is among
    /// the normals of all edges and the directions between all corners (Ericson 2005, 5.2.1).
    pub fn overlaps(&self, other: &Hull, slack_m: f64) -> bool {
        let round_m = self.round_m + other.round_m;
        let normals = self.normals().chain(other.normals());
        let between = self.corners.iter().flat_map(|p| other.corners.iter().map(move |q| q - p));
        let mut axes = normals.chain(between).filter_map(|axis| axis.try_normalize(1e-9));
        !axes.any(|axis| {
            let ((low, high), (from, to)) = (extent(&self.corners, axis), extent(&other.corners, axis));
            (from - high).max(low - to) >= round_m - slack_m
        })
    }

    /// Distance of the hull from a point outside, metres; zero within.
    pub fn distance_to(&self, p: Point) -> f64 {
        if self.corners.len() > 2 && crate::geometry::inside(&self.corners, p) {
            return 0.0;
        }
        let edges = self.edges().map(|e| e.distance_to(p));
        (edges.fold(f64::INFINITY, f64::min) - self.round_m).max(0.0)
    }

    /// Depth of a place within the hull, metres: its distance from the hull's edge, negative outside.
    pub fn depth_of(&self, p: Point) -> f64 {
        let nearest = self.edges().map(|e| e.distance_to(p)).fold(f64::INFINITY, f64::min);
        let within = self.corners.len() > 2 && crate::geometry::inside(&self.corners, p);
        self.round_m + if within { nearest } else { -nearest }
    }

    /// Whether all of another hull lies within, up to `slack_m`. Both are convex: the corners decide.
    pub fn holds(&self, other: &Hull, slack_m: f64) -> bool {
        other.corners.iter().all(|c| self.depth_of(*c) >= other.round_m - slack_m)
    }

    fn is_within(&self, outer: &Hull) -> bool {
        let axes = (0..DIRECTIONS).map(|i| {
            let angle = f64::from(i) * std::f64::consts::TAU / f64::from(DIRECTIONS);
            Vector::new(angle.cos(), angle.sin())
        });
        let reach = |shape: &Hull, axis| extent(&shape.corners, axis).1 + shape.round_m;
        axes.into_iter().all(|axis| reach(self, axis) <= reach(outer, axis) + 1e-6)
    }

    fn edges(&self) -> impl Iterator<Item = Segment> {
        let ends = self.corners.iter().zip(self.corners.iter().cycle().skip(1));
        ends.map(|(a, b)| Segment { a: *a, b: *b })
    }

    fn normals(&self) -> impl Iterator<Item = Vector> {
        self.edges().map(|e| Vector::new(e.b.y - e.a.y, e.a.x - e.b.x))
    }
}

fn square(side_m: f64) -> [Point; 4] {
    let half = side_m / 2.0;
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Point::new(x * half, y * half))
}

fn farthest_m(corners: &[Point]) -> f64 {
    corners.iter().map(|c| c.coords.norm()).fold(0.0, f64::max)
}

/// Least and greatest coordinate of points along an axis.
fn extent(points: &[Point], axis: Vector) -> (f64, f64) {
    let along = points.iter().map(|p| p.coords.dot(&axis));
    along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// The convex hull, anticlockwise: a chain below and one above (Andrew 1979).
fn hull(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let mut hull = chain(points.iter());
    hull.pop();
    hull.extend(chain(points.iter().rev()));
    hull.pop();
    hull
}

/// From one end of sorted points to the other, turning left.
fn chain<'a>(points: impl Iterator<Item = &'a Point>) -> Vec<Point> {
    let mut chain: Vec<Point> = Vec::new();
    for p in points {
        while let [.., a, b] = chain[..]
            && (b - a).perp(&(p - b)) <= 0.0
        {
            chain.pop();
        }
        chain.push(*p);
    }
    chain
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{axis_distance, axis_distance_of_segments};
    use proptest::prelude::*;

    fn point(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    fn forklift() -> Footprint {
        let corners = vec![point(-1.0, -0.5), point(1.0, -0.5), point(1.0, 0.5), point(-1.0, 0.5)];
        Footprint::Polygon { corners, turns: true }
    }

    #[test]
    fn discs_overlap_when_their_middles_are_nearer_than_their_radii() {
        let disc = Footprint::Circle { radius_m: 0.5 };
        let here = disc.standing(point(0.0, 0.0));
        assert!(here.overlaps(&disc.standing(point(0.6, 0.6)), 1e-6), "0.85 m apart");
        assert!(!here.overlaps(&disc.standing(point(0.8, 0.7)), 1e-6), "1.06 m apart");
        assert!(!here.overlaps(&disc.standing(point(1.0, 0.0)), 1e-6), "they touch");
    }

    #[test]
    fn a_polygon_that_turns_takes_its_turning_circle_where_it_stands_and_its_width_where_it_drives() {
        let long = forklift();
        let beside = Footprint::Circle { radius_m: 0.1 }.standing(point(0.0, 1.0));
        assert!(long.standing(point(0.0, 0.0)).overlaps(&beside, 1e-6), "its corners sweep 1.12 m");
        let lane = Segment { a: point(-3.0, 0.0), b: point(3.0, 0.0) };
        assert!(!long.driving(lane).overlaps(&beside, 1e-6), "it is half a metre wide on each side");
        let across = Segment { a: point(0.0, -3.0), b: point(0.0, 3.0) };
        assert!(long.driving(across).overlaps(&beside, 1e-6));
    }

    #[test]
    fn a_polygon_that_does_not_turn_keeps_to_the_axes() {
        let Footprint::Polygon { corners, .. } = forklift() else { unreachable!() };
        let pallet = Footprint::Polygon { corners, turns: false };
        let lane = Segment { a: point(0.0, -3.0), b: point(0.0, 3.0) };
        let beside = Footprint::Circle { radius_m: 0.1 }.standing(point(0.8, 0.0));
        assert!(pallet.driving(lane).overlaps(&beside, 1e-6), "it drives crosswise");
        assert!(!forklift().driving(lane).overlaps(&beside, 1e-6));
        assert_eq!((pallet.half_m(), (forklift().half_m() * 1000.0).round()), (1.0, 1118.0));
    }

    #[test]
    fn within_is_told_wherever_robots_turn() {
        let square = |side_m| Footprint::Square { side_m };
        assert!(Footprint::Circle { radius_m: 0.45 }.is_within(&square(0.9)));
        assert!(!Footprint::Circle { radius_m: 0.46 }.is_within(&square(0.9)));
        assert!(forklift().is_within(&Footprint::Circle { radius_m: 1.2 }));
        assert!(!forklift().is_within(&square(2.0)), "turning, it reaches 1.12 m");
        assert!(square(0.9).is_within(&square(0.9)));
    }

    #[test]
    fn a_shape_is_as_far_as_its_nearest_edge() {
        let body = forklift().at(Pose { at: point(0.0, 0.0), heading: std::f64::consts::FRAC_PI_2 });
        assert!((body.distance_to(point(1.5, 0.0)) - 1.0).abs() < 1e-9, "its side");
        assert!((body.distance_to(point(0.0, 1.5)) - 0.5).abs() < 1e-9, "its front");
        assert_eq!(body.distance_to(point(0.2, 0.2)), 0.0);
    }

    #[test]
    fn an_outline_is_held_exactly_where_it_does_not_leave_the_corridor() {
        let lane = Segment { a: point(0.0, 0.0), b: point(8.0, 0.0) };
        let corridor = Corridor { left_m: 2.0, right_m: 1.0 };
        let disc = Footprint::Circle { radius_m: 0.4 };
        for robot in [disc, forklift(), Footprint::Square { side_m: 0.8 }] {
            let floor = robot.free(lane, corridor);
            let half = if matches!(robot, Footprint::Polygon { .. }) { 0.5 } else { 0.4 };
            let holds = |x: f64, y: f64| floor.holds(&robot.at(Pose { at: point(x, y), heading: 0.0 }), 1e-9);
            assert!(holds(4.0, 2.0 - half) && !holds(4.0, 2.01 - half), "{robot:?} on the left");
            assert!(holds(4.0, half - 1.0) && !holds(4.0, half - 1.01), "{robot:?} on the right");
            assert!(holds(0.0, 0.0) && holds(8.0, 0.0), "the ends of the line");
            assert!(!holds(8.05, 0.0) && !holds(8.05, 1.0), "{robot:?} beyond the end, and beside it");
        }
    }

    proptest! {
        #[test]
        fn squares_overlap_as_their_axis_distances_say(
            a in (0i32..40, 0i32..40), b in (0i32..40, 0i32..40),
            c in (0i32..40, 0i32..40), d in (0i32..40, 0i32..40), side in 1i32..30,
        ) {
            let p = |(x, y): (i32, i32)| point(f64::from(x) / 10.0, f64::from(y) / 10.0);
            let (s, t) = (Segment { a: p(a), b: p(b) }, Segment { a: p(c), b: p(d) });
            let side_m = f64::from(side) / 10.0 + 0.003;
            let square = Footprint::Square { side_m };
            let nodes = square.standing(s.a).overlaps(&square.standing(t.a), 1e-6);
            prop_assert_eq!(nodes, axis_distance(s.a, t.a) < side_m - 1e-6);
            let lanes = square.driving(s).overlaps(&square.driving(t), 1e-6);
            prop_assert_eq!(lanes, axis_distance_of_segments(s, t) < side_m - 1e-6);
        }

        #[test]
        fn a_body_on_a_lane_or_turning_on_a_node_lies_within_what_was_held(
            x in 1i32..20, y in 1i32..20, heading in 0.0..6.3f64, u in 0.0..1.0f64, turns: bool,
        ) {
            let (x, y) = (f64::from(x) / 10.0, f64::from(y) / 10.0);
            let corners = vec![point(-x, -y), point(x, -y / 2.0), point(x / 2.0, y)];
            let robot = Footprint::Polygon { corners, turns };
            let lane = Segment { a: point(0.0, 0.0), b: point(4.0 * heading.cos(), 4.0 * heading.sin()) };
            let body = robot.at(Pose { at: lane.point(u), heading: lane.heading() });
            prop_assert!(body.is_within(&robot.driving(lane)));
            let turning = robot.at(Pose { at: lane.a, heading: 5.0 * u });
            prop_assert!(turning.is_within(&robot.standing(lane.a)));
        }
    }
}
