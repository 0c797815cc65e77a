//! People as beliefs, and what these mean for robots.
//!
//! - [`human`]: where people are, whether they keep to their path, what their goals are, where they will be when.
//! - [`aware`]: conditions on nodes for the search and the grants, regions for speeds, encounters. People and routes
//!   meet nowhere else.
//! - [`reach`]: a person at arm's length: which place a hand is going to, where the eyes look.
//! - [`local`]: how a robot with a corridor passes a person beside its line.
//!
//! Pure. Refuses: a second planner, and to name anybody.

pub mod aware;
pub mod human;
pub mod local;
pub mod reach;
