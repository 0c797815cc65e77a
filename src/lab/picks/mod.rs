//! Recorded people who reach for places: predictions of the place, of the arm, and of gaze.
//!
//! Main types: [`PickRecording`] (the tables), [`PickReport`] (all figures); main functions: [`fold`] (people left out
//! two at a time), [`with_model`] (a model learned elsewhere). People point here; they do not grasp, and the eyes of
//! those who reach were not recorded. Refuses: to read files, and figures of people that were learned from.

mod data;
mod report;
mod score;

pub use data::*;
pub use report::*;
pub use score::*;
