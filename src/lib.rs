//! Giveway: a warehouse fleet manager in which robots give way to people.

#[cfg(feature = "edge")]
pub mod api;
#[cfg(feature = "edge")]
pub mod cli;
pub mod experiment;
pub mod fleet;
pub mod geometry;
pub mod id;
pub mod route;
#[cfg(feature = "edge")]
pub mod server;
pub mod sim;
#[cfg(feature = "edge")]
pub mod store;
pub mod time;
pub mod timeline;
pub mod warehouse;
