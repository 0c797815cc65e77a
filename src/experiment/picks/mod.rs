//! Recorded people who reach for places.
//!
//! Refuses: to read files.
mod data;
mod score;
pub use data::*;
pub use score::*;
