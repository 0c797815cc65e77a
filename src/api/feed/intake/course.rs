//! Whether a person faces in the direction of walking, according to the device: course against heading.
//!
//! Main type: [`Course`]. If a device's axes are right, its positions and rotations agree on this, whatever the
//! alignment. Agreement proves nothing, since a frame in which both have left and right exchanged agrees with itself.
//! Pure. Refuses: to conclude anything from a few steps backwards.

use giveway_floor::geometry::{Vector, wrap_angle};
use std::collections::VecDeque;

/// The distance walked that is considered, metres.
const WAY_M: f64 = 2.5;

/// A person whose course differs from the heading by at least this much for the whole distance walks askew: 60 degrees.
/// Heads turn, but over metres they face ahead.
const ASKEW: f64 = std::f64::consts::FRAC_PI_3;

/// The angles between course and heading are consistent if the length of their vector sum is at least this share of the
/// maximum.
const AGREE: f64 = 0.8;

/// The latest strides: their lengths, and by how many radians the course differed from the head's direction.
#[derive(Clone, Debug, Default)]
pub struct Course {
    strides: VecDeque<(f64, f64)>,
}

impl Course {
    /// Adds a stride in the device's floor plan, with the direction that the head faced.
    pub fn stride(&mut self, way: Vector, faced: Option<f64>) {
        let Some(faced) = faced else { return };
        self.strides.push_back((way.norm(), wrap_angle(faced - way.y.atan2(way.x))));
        while let Some((first, _)) = self.strides.front()
            && self.length_m() - first >= WAY_M
        {
            self.strides.pop_front();
        }
    }

    /// Whether the head has faced in another direction than the course for the whole distance.
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

    /// Strides of a quarter of a metre along the x axis, with these headings.
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
