//! People as beliefs: where they are, whether they keep to their path, where they are going.
//!
//! Main types: [`Sighting`] (what a source says), [`Track`] (where a worker is), [`Follower`] (progress along
//! the assigned path). Refuses: to know robots' routes, and to decide anything.

mod deviation;
mod forecast;
mod sighting;
mod track;

pub use deviation::{Conduct, Follower, NODE_M};
pub use forecast::{Band, Hypothesis, Passage, passages};
pub use sighting::{Quality, Sighting};
pub use track::{FeedCounts, Presence, STALE, Taken, Track, WALK_MPS, Whereabouts};
