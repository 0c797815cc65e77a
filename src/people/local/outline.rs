//! A robot's outline as the local planner needs it: placed at many poses in a tick without allocating memory.
//!
//! Main type: [`RobotOutline`]. Refuses: outlines of more than sixteen corners without allocation; those allocate once.

use giveway_floor::geometry::{Point, Pose, Segment, Vector};
use giveway_floor::warehouse::{Footprint, Hull};
use smallvec::SmallVec;

/// An outline around the point on which the robot turns.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotOutline {
    /// Corners, metres, x ahead and y to the left.
    corners: SmallVec<[Vector; 16]>,
    /// Margin that widens the outline on all sides, metres.
    round_m: f64,
    /// Whether the outline turns with the robot's heading.
    turns: bool,
}

impl RobotOutline {
    /// The outline of a footprint.
    pub fn of(footprint: &Footprint) -> RobotOutline {
        let square = |side_m: f64| {
            let half = side_m / 2.0;
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            corners.iter().map(|(x, y)| Vector::new(x * half, y * half)).collect()
        };
        match footprint {
            Footprint::Square { side_m } => {
                RobotOutline { corners: square(*side_m), round_m: 0.0, turns: false }
            }
            Footprint::Circle { radius_m } => RobotOutline {
                corners: SmallVec::from_slice(&[Vector::zeros()]),
                round_m: *radius_m,
                turns: false,
            },
            Footprint::Polygon { corners, turns } => RobotOutline {
                corners: corners.iter().map(|c| c.coords).collect(),
                round_m: 0.0,
                turns: *turns,
            },
        }
    }

    /// Radius of the smallest circle around the turning point that contains the outline, metres (SS of Ye et al.,
    /// section 3.3.1).
    pub fn circle_m(&self) -> f64 {
        self.corners.iter().map(|c| c.norm()).fold(0.0, f64::max) + self.round_m
    }

    /// The outline's corners at a pose.
    fn placed(&self, pose: Pose) -> impl Iterator<Item = Point> + Clone {
        let (sin, cos) =
            if self.turns { (libm::sin(pose.heading), libm::cos(pose.heading)) } else { (0.0, 1.0) };
        self.corners.iter().map(move |c| pose.at + Vector::new(cos * c.x - sin * c.y, sin * c.x + cos * c.y))
    }

    /// How deep the outline at a pose lies within a part of the floor, metres: negative if some of it is outside.
    pub fn depth_m(&self, floor: &Hull, pose: Pose) -> f64 {
        let deepest = self.placed(pose).map(|corner| floor.depth_of(corner)).fold(f64::INFINITY, f64::min);
        deepest - self.round_m
    }

    /// Distance of the outline from a place, metres; zero for a place within it.
    pub fn gap_m(&self, pose: Pose, place: Point) -> f64 {
        let (mut nearest, mut around) = (f64::INFINITY, self.corners.len() > 2);
        let mut before = self.placed(pose).last().unwrap_or(pose.at);
        for corner in self.placed(pose) {
            let side = Segment { a: before, b: corner };
            nearest = nearest.min(side.distance_to(place));
            around &= (side.b - side.a).perp(&(place - side.a)) >= 0.0;
            before = corner;
        }
        if around { 0.0 } else { (nearest - self.round_m).max(0.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, y: f64) -> Point {
        Point::new(x, y)
    }

    fn truck() -> Footprint {
        let corners = vec![point(-0.6, -0.3), point(0.8, -0.3), point(0.8, 0.3), point(-0.6, 0.3)];
        Footprint::Polygon { corners, turns: true }
    }

    #[test]
    fn gaps_are_those_of_the_hull_of_the_same_footprint() {
        for footprint in [truck(), Footprint::Circle { radius_m: 0.4 }, Footprint::Square { side_m: 0.7 }] {
            let outline = RobotOutline::of(&footprint);
            for k in 0..60 {
                let turn = f64::from(k);
                let pose = Pose { at: point(1.0, -0.5), heading: 0.3 * turn };
                let place = point(1.0 + 1.5 * (0.7 * turn).cos(), -0.5 + 1.5 * (1.1 * turn).sin());
                let (ours, theirs) = (outline.gap_m(pose, place), footprint.at(pose).distance_to(place));
                assert!((ours - theirs).abs() < 1e-9, "{footprint:?} {k}: {ours} and {theirs}");
            }
        }
    }

    #[test]
    fn it_is_within_exactly_what_its_hull_is_within() {
        let lane = Segment { a: point(0.0, 0.0), b: point(6.0, 1.0) };
        let corridor = giveway_floor::warehouse::Corridor { left_m: 1.0, right_m: 1.5 };
        for footprint in [truck(), Footprint::Circle { radius_m: 0.4 }, Footprint::Square { side_m: 0.7 }] {
            let (outline, floor) = (RobotOutline::of(&footprint), footprint.free(lane, corridor));
            let mut counts = [0, 0];
            for k in 0..400 {
                let (x, y) = (f64::from(k % 20) * 0.35 - 0.3, f64::from(k / 20) * 0.15 - 1.4);
                let pose = Pose { at: point(x, y), heading: f64::from(k) };
                let within = outline.depth_m(&floor, pose) >= 0.0;
                assert_eq!(within, floor.holds(&footprint.at(pose), 0.0), "{footprint:?} at {pose:?}");
                counts[usize::from(within)] += 1;
            }
            assert!(counts[0] > 50 && counts[1] > 50, "{counts:?}");
        }
    }

    #[test]
    fn the_circle_around_it_reaches_its_farthest_corner() {
        assert!((RobotOutline::of(&truck()).circle_m() - 0.8_f64.hypot(0.3)).abs() < 1e-12);
        assert_eq!(RobotOutline::of(&Footprint::Circle { radius_m: 0.4 }).circle_m(), 0.4);
    }
}
