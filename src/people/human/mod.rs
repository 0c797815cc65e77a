//! People as beliefs: where they are, whether they keep to their path, where they are going.
//!
//! Main types: [`Sighting`] (what a source reports), [`Track`] (where a worker is), [`Follower`] (progress along the
//! assigned path), [`Distances`] (from anywhere to each goal, repaired as robots block the way), [`tiles`] (how good
//! positions and headings are for each goal on a small floor), [`Intention`] (where a person is going, with what
//! probability), [`Mover`] (on foot, or in a vehicle), [`Hypothesis`] and [`Passage`] (where a person will be, when).
//! Refuses: to know robots' routes, and to decide anything; modules that know both people and routes are in `aware`.

mod coverage;
mod deviation;
pub mod distance;
mod field;
pub mod forecast;
pub mod intention;
mod mixture;
mod model;
pub mod motion;
mod mover;
mod passage;
mod sighting;
mod source;
pub mod tiles;
mod track;
mod way;

pub use coverage::{Coverage, HorizonCoverage, WATCHED_S};
pub use deviation::{Conduct, Follower, NODE_M};
pub use distance::{Distances, Vantage};
pub use field::{Field, Graph};
pub use forecast::Forecast;
pub use intention::{Belief, IntentEpisode, IntentState, Intention, Method};
pub use mixture::{FEW_PLACES, Mixture, PLACES, Part};
pub use model::{Model, ModelError};
#[cfg(test)]
pub(crate) use mover::tests as mover_tests;
pub use mover::{BODY_M, Mover, Vehicle, VehicleFault, VehicleFigures, WALK_MPS};
pub use passage::{Band, Hypothesis, Passage, passages};
pub use sighting::{Quality, Sighting, SourceId};
pub use track::{FeedCounts, LOST, LastKnown, Presence, STALE, SightingOutcome, Track, Whereabouts};
pub use way::{common_prefix, straight_on, towards_goal};
