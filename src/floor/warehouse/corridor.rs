//! How far a robot may leave the line of a lane: the corridor that a map gives to the lane.
//!
//! Main type: [`Corridor`]. As in VDA 5050 (`corridor` of an edge, `corridorReferencePoint` CONTOUR) it bounds the
//! whole outline of the robot. Refuses: to determine which robots may leave the line; their kind does.

use crate::geometry::{Point, Segment, Vector};

/// Room for a robot's outline beside the line of a lane, metres, as seen along the lane from its `a` to its `b`. A
/// robot that drives from `b` to `a` has the same floor, with left and right exchanged.
///
/// If a side is narrower than half of the robot, the robot takes there what it takes on the line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corridor {
    /// Room to the left of the line, metres.
    pub left_m: f64,
    /// Room to the right of the line, metres.
    pub right_m: f64,
}

/// Greatest width of a side of a corridor, metres.
pub const CORRIDOR_MAX_M: f64 = 20.0;

impl Corridor {
    /// The same floor for a robot that drives the other way.
    pub fn reversed(self) -> Corridor {
        Corridor { left_m: self.right_m, right_m: self.left_m }
    }

    /// The wider side, metres.
    pub fn widest_m(self) -> f64 {
        self.left_m.max(self.right_m)
    }

    /// The four corners, anticlockwise from the start on the right, each side narrowed by `less_m`, but not beyond the
    /// line.
    pub fn corners(self, lane: Segment, less_m: f64) -> [Point; 4] {
        let along = (lane.b - lane.a).try_normalize(1e-12).unwrap_or(Vector::x());
        let left = Vector::new(-along.y, along.x);
        let (to_left, to_right) =
            (left * (self.left_m - less_m).max(0.0), left * (self.right_m - less_m).max(0.0));
        [lane.a - to_right, lane.b - to_right, lane.b + to_left, lane.a + to_left]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn left_and_right_are_those_of_who_drives_from_a_to_b() {
        let lane = Segment { a: Point::new(0.0, 0.0), b: Point::new(0.0, 4.0) };
        let corridor = Corridor { left_m: 2.0, right_m: 0.5 };
        let expected = [(0.5, 0.0), (0.5, 4.0), (-2.0, 4.0), (-2.0, 0.0)].map(|(x, y)| Point::new(x, y));
        assert_eq!(corridor.corners(lane, 0.0), expected);
        let back = Segment { a: lane.b, b: lane.a };
        let other = corridor.reversed().corners(back, 0.0);
        assert!(other.iter().all(|p| expected.iter().any(|q| (p - q).norm() < 1e-12)), "the same floor");
        let narrow = corridor.corners(lane, 1.0).map(|p| p.x);
        assert_eq!(narrow, [0.0, 0.0, -1.0, -1.0], "no side goes behind the line");
    }
}
