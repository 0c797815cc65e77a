//! People as beliefs: how far it is to their goals, and which goals are theirs.
//!
//! Main types: [`Distances`] (from anywhere to each goal, repaired as robots block the way), [`Intention`] (where a
//! person is going, with what probability). Refuses: routes of robots, reservations and decisions; those who know both
//! people and routes are in `aware`.

pub mod distance;
mod field;
pub mod intention;

pub use distance::{Distances, Vantage};
pub use field::{Field, Graph};
pub use intention::{Belief, Intention, Method};
