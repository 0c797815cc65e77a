//! Poses in WebXR's conventions: metres, right-handed, y up, z backwards; quaternions as x, y, z, w.
//!
//! Main functions: [`plan`], [`facing`]; main type [`Gaze`] and [`Hand`], on which no decision depends. Pure. Refuses:
//! quaternions that are no rotation.

use super::align::Alignment;
use crate::wire::words::GazeKind;
use giveway_cell::HandPoints;
use giveway_floor::geometry::{Point, Vector};
use giveway_floor::warehouse::Place;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Beyond this pitch, the forward vector says little about the direction that a head faces: 75 degrees.
const STEEP: f64 = 75.0 * std::f64::consts::PI / 180.0;

/// A quaternion whose norm differs from one by more than this is no rotation.
const NORM_TOLERANCE: f64 = 0.1;

/// A position in the device's floor plan: x to the right, y ahead.
pub fn plan(position: [f64; 3]) -> Vector {
    Vector::new(position[0], -position[2])
}

/// The rotation of a quaternion, if it is one.
pub fn rotation(q: [f64; 4]) -> Option<UnitQuaternion<f64>> {
    let q = Quaternion::new(q[3], q[0], q[1], q[2]);
    let close = (q.norm() - 1.0).abs() <= NORM_TOLERANCE;
    close.then(|| UnitQuaternion::from_quaternion(q))
}

/// The direction in which a head of this rotation points, in the device's axes.
pub fn ahead(rotation: UnitQuaternion<f64>) -> Vector3<f64> {
    rotation * Vector3::new(0.0, 0.0, -1.0)
}

/// The heading in the device's floor plan, radians; nothing if the person looks almost straight up or down.
pub fn facing(rotation: UnitQuaternion<f64>) -> Option<f64> {
    let ahead = ahead(rotation);
    let level = ahead.x.hypot(ahead.z);
    (ahead.y.abs().atan2(level) <= STEEP).then(|| (-ahead.z).atan2(ahead.x))
}

/// A gaze ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaze {
    /// Whether the ray comes from the head, from the eyes, or is estimated.
    pub kind: GazeKind,
    /// Where the ray begins: map x, map y, height; metres.
    pub origin: [f64; 3],
    /// The ray's direction in the same axes, a unit vector.
    pub dir: [f64; 3],
}

/// Joints of a hand: map x, map y, height, radius; metres.
pub type Hand = Vec<[f64; 4]>;

/// Indices of joints in WebXR Hand Input: the wrist, the metacarpal of the middle finger, and the tips of thumb and
/// index finger.
const JOINTS: [usize; 4] = [0, 10, 4, 9];

/// The points of a hand for the core; nothing if joints are missing.
pub fn hand_points(hand: &Hand) -> Option<HandPoints> {
    let joint = |i: usize| hand.get(i).map(|[x, y, z, _]| Place::new(*x, *y, *z));
    let [wrist, palm, thumb, index] = JOINTS.map(joint);
    Some(HandPoints { wrist: wrist?, palm: palm?, tips: [thumb?, index?] })
}

/// A point of the device's frame as map x, map y, height above the floor of the marks.
pub fn place(alignment: &Alignment, position: [f64; 3]) -> [f64; 3] {
    let at: Point = alignment.point(plan(position));
    [at.x, at.y, position[1] - alignment.floor_m]
}

/// A direction of the device's frame in the same axes, a unit vector; nothing if it has no length.
pub fn direction(alignment: &Alignment, dir: [f64; 3]) -> Option<[f64; 3]> {
    let length = Vector3::from(dir).norm();
    if !(1e-6..1e6).contains(&length) {
        return None;
    }
    let turned = nalgebra::Rotation2::new(alignment.theta) * plan(dir);
    Some([turned.x / length, turned.y / length, dir[1] / length])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn turned(yaw: f64, pitch: f64) -> UnitQuaternion<f64> {
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), yaw);
        yaw * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), pitch)
    }

    #[test]
    fn ahead_is_up_on_the_plan_and_turning_left_is_anticlockwise() {
        assert_eq!(plan([1.0, 1.6, -2.0]), Vector::new(1.0, 2.0));
        let straight = facing(turned(0.0, 0.0)).unwrap();
        assert!((straight - FRAC_PI_2).abs() < 1e-9, "-z is +y of the plan");
        let left = facing(turned(0.5, 0.3)).unwrap();
        assert!((left - FRAC_PI_2 - 0.5).abs() < 1e-9, "pitch does not matter");
    }

    #[test]
    fn who_looks_at_the_ceiling_or_the_floor_faces_nowhere() {
        let degrees = |d: f64| d * PI / 180.0;
        for pitch in [80.0, -80.0, 90.0, -90.0] {
            assert_eq!(facing(turned(0.3, degrees(pitch))), None, "{pitch}");
        }
        for pitch in [74.0, -74.0] {
            assert!((facing(turned(0.3, degrees(pitch))).unwrap() - FRAC_PI_2 - 0.3).abs() < 1e-9);
        }
    }

    #[test]
    fn a_quaternion_is_of_length_one_or_none() {
        assert!(rotation([0.0, 0.0, 0.0, 1.0]).is_some());
        assert!(rotation([0.0, 0.7, 0.0, 0.7]).is_some(), "rounded ones are");
        for bad in [[0.0; 4], [0.0, 0.0, 0.0, 2.0], [f64::NAN, 0.0, 0.0, 1.0], [1e300; 4]] {
            assert!(rotation(bad).is_none(), "{bad:?}");
        }
    }

    #[test]
    fn rays_are_turned_like_the_frame() {
        let quarter = Alignment::exact(FRAC_PI_2, Vector::zeros());
        let dir = direction(&quarter, [0.0, 0.0, -2.0]).unwrap();
        assert!((Vector3::from(dir) - Vector3::new(-1.0, 0.0, 0.0)).norm() < 1e-9, "{dir:?}");
        assert_eq!(direction(&quarter, [0.0; 3]), None);
        let at = place(&quarter, [1.0, 1.6, 0.0]);
        assert!((Vector3::from(at) - Vector3::new(0.0, 1.0, 1.6)).norm() < 1e-9, "{at:?}");
    }
}
