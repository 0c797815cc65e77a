//! People as beliefs: where they are, whether they keep to their path, where they are going.
//!
//! Main types: [`Sighting`] (what a source says). Refuses: to know robots' routes, and to decide anything.

mod sighting;

pub use sighting::{Quality, Sighting};
