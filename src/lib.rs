//! Giveway: a warehouse fleet manager in which robots give way to people.

pub mod geometry;
pub mod id;
pub mod route;
pub mod time;
pub mod timeline;
pub mod warehouse;
