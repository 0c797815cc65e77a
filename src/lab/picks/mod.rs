//! Recorded people who reach for places: how well it is told where to, where the arm will be, and where they look.
//!
//! Main types: [`PickRecording`] (the tables), [`PickReport`] (all figures); main functions: [`fold`] (people
//! left out two at a time), [`with_model`] (a model that was learned elsewhere). People point here; they do not
//! grasp, and the eyes of those who reach were not recorded. Refuses: to read files, and figures of people that were
//! learned from.

mod data;
mod report;
mod score;

pub use data::*;
pub use report::*;
pub use score::*;
