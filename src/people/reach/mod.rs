//! People at arm's length, as beliefs: which place a hand is going to, where the arm will be, where the eyes are.
//!
//! Main types: [`ArmSample`] (what is seen), [`ReachTarget`] (a place a hand can go to), [`SlotTracker`] (probabilities
//! while a hand moves), [`PickModel`] (all learned figures). Pure: samples in, probabilities out. Refuses: to know
//! racks, lines and robots, to draw random numbers, and to learn.

pub mod arm;
pub mod ends;
pub mod features;
pub mod gaze;
pub mod mixtures;
pub mod model;
pub mod net;
pub mod places;
pub mod posture;
pub mod sample;
mod tracker;

pub use model::{PickModel, PickModelError};
pub use sample::{ArmPoint, ArmSample, ArmVector, ReachTarget};
pub use tracker::SlotTracker;
