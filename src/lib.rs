//! Giveway: a warehouse fleet manager in which robots give way to people.

#[cfg(feature = "edge")]
pub mod cli;
pub mod experiment;
pub mod fleet;
pub mod geometry;
pub mod id;
pub mod route;
pub mod sim;
pub mod time;
pub mod timeline;
pub mod warehouse;
