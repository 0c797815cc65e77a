//! Hands of a person at a work cell, as a headset saw them at one instant.
//!
//! Main types: [`HandsSeen`], [`HandPoints`]. Places are in the map's frame, metres. Refuses: frames of devices and
//! their clocks; the program that receives hands aligns them first.

use giveway_floor::id::StationId;
use giveway_floor::time::Time;
use giveway_floor::warehouse::Place;

/// The points of one hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandPoints {
    /// The wrist.
    pub wrist: Place,
    /// The middle of the palm.
    pub palm: Place,
    /// The tips of thumb and index finger.
    pub tips: [Place; 2],
}

impl HandPoints {
    /// The middle between the two finger tips: where the hand grasps.
    pub fn grip(&self) -> Place {
        nalgebra::center(&self.tips[0], &self.tips[1])
    }

    /// Whether the points can belong to one hand: all are finite, and none is farther from the palm than a hand is
    /// long.
    pub fn is_sound(&self) -> bool {
        let all = [self.wrist, self.palm, self.tips[0], self.tips[1]];
        let near = |p: &Place| (p - self.palm).norm() <= HAND_M;
        all.iter().all(|p| p.coords.iter().all(|x| x.is_finite()) && near(p))
    }
}

/// Longest distance between the palm and any other point of a hand, metres.
const HAND_M: f64 = 0.25;

/// The hands of one person at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandsSeen {
    /// The station in whose workplace the person is.
    pub station: StationId,
    /// Number of the person, as long as the observations go on: another number is another person.
    pub person: u32,
    /// When the hands were seen, in the server's time.
    pub seen: Time,
    /// The middle of the head.
    pub head: Place,
    /// Direction of the head, of length one; nothing where it is not known.
    pub facing: Option<nalgebra::Vector3<f64>>,
    /// Direction of the eyes, of length one; nothing where they are not measured.
    pub eyes: Option<nalgebra::Vector3<f64>>,
    /// Left and right hand; nothing for an unseen hand.
    pub hands: [Option<HandPoints>; 2],
}
