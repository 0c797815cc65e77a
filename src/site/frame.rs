//! Frames of robots' maps.
//!
//! Main type: [`MapFrame`]. Refuses: scales and reflections; both frames are in metres and right-handed.

use giveway_floor::geometry::{Point, Pose, Vector, wrap_angle};

/// A robot's map that is this floor, or a part of it: turned, then moved.
#[derive(Clone, Debug, PartialEq)]
pub struct MapFrame {
    /// The robots' name of the map.
    pub name: String,
    /// Where its origin is on the floor, metres.
    pub moved: Vector,
    /// By how much it is turned, radians, anticlockwise.
    pub turn: f64,
}

impl MapFrame {
    /// A map with the same frame as the floor.
    pub fn same(name: &str) -> MapFrame {
        MapFrame { name: name.to_owned(), moved: Vector::zeros(), turn: 0.0 }
    }

    /// A pose in the robot's map, on the floor.
    pub fn to_floor(&self, x: f64, y: f64, theta: f64) -> Pose {
        let at = Point::new(0.0, 0.0) + turned(Vector::new(x, y), self.turn) + self.moved;
        Pose { at, heading: wrap_angle(theta + self.turn) }
    }

    /// A place on the floor, in the robot's map.
    pub fn to_robot(&self, at: Point) -> (f64, f64) {
        let there = turned(at.coords - self.moved, -self.turn);
        (there.x, there.y)
    }
}

fn turned(v: Vector, turn: f64) -> Vector {
    let (sin, cos) = turn.sin_cos();
    Vector::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_place_goes_to_the_robots_map_and_back_and_a_quarter_turn_is_one() {
        let frame = MapFrame { name: "hall".into(), moved: Vector::new(10.0, -2.0), turn: FRAC_PI_2 };
        let pose = frame.to_floor(3.0, 1.0, 0.0);
        assert!((pose.at - Point::new(9.0, 1.0)).norm() < 1e-12 && (pose.heading - FRAC_PI_2).abs() < 1e-12);
        let (x, y) = frame.to_robot(pose.at);
        assert!((x - 3.0).abs() < 1e-12 && (y - 1.0).abs() < 1e-12);
    }
}
