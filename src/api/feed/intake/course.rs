//! Whether somebody faces where they walk, as a device tells it: course against heading.
//!
//! Main type: [`Course`]. Positions and rotations of a device in the right axes agree on that, whatever the alignment.
//! Agreement proves nothing, since a frame with left and right exchanged in both agrees with itself. Pure. Refuses: to
//! draw a conclusion from a few steps backwards.

use giveway_floor::geometry::{Vector, wrap_angle};
use std::collections::VecDeque;

/// The way that is looked back on, metres.
const WAY_M: f64 = 2.5;

/// Who walks the whole way at least so far off where they face walks askew: 60 degrees. Heads turn; over metres they
/// face ahead.
const ASKEW: f64 = std::f64::consts::FRAC_PI_3;

/// The angles between course and heading agree with one another if the sum of their directions has at least this share
/// of its greatest length.
const AGREE: f64 = 0.8;

/// The last strides: their length, and how far off the course the head faced, radians.
#[derive(Clone, Debug, Default)]
pub struct Course {
    strides: VecDeque<(f64, f64)>,
}

impl Course {
    /// A stride in the device's floor plan, and where the head faced.
    pub fn stride(&mut self, way: Vector, faced: Option<f64>) {
        let Some(faced) = faced else { return };
        self.strides.push_back((way.norm(), wrap_angle(faced - way.y.atan2(way.x))));
        while let Some((first, _)) = self.strides.front()
            && self.length_m() - first >= WAY_M
        {
            self.strides.pop_front();
        }
    }

    /// Whether the head has faced elsewhere than the way went, all the way.
    pub fn is_askew(&self) -> bool {
        let length_m = self.length_m();
        let sum: Vector = self.strides.iter().map(|(m, off)| Vector::new(off.cos(), off.sin()) * *m).sum();
        length_m >= WAY_M && sum.norm() >= AGREE * length_m && sum.y.atan2(sum.x).abs() >= ASKEW
    }

    fn length_m(&self) -> f64 {
        self.strides.iter().map(|(m, _)| m).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strides of a quarter of a metre along the x axis, facing so.
    fn walked(facing: impl IntoIterator<Item = f64>) -> bool {
        let mut course = Course::default();
        facing.into_iter().for_each(|faced| course.stride(Vector::new(0.25, 0.0), Some(faced)));
        course.is_askew()
    }

    #[test]
    fn who_walks_metres_backwards_or_sideways_is_askew_and_who_looks_round_is_not() {
        use std::f64::consts::{FRAC_PI_2, PI};
        assert!(walked([PI; 12]) && walked([FRAC_PI_2; 12]) && walked([-FRAC_PI_2; 40]));
        assert!(!walked([PI; 8]), "a few steps backwards");
        assert!(!walked([0.3; 40]) && !walked([FRAC_PI_2, -FRAC_PI_2].repeat(20)), "a head that turns");
        assert!(!walked([PI; 40].into_iter().chain([0.0; 12])), "it is over");
        assert!(!walked([]));
    }
}
