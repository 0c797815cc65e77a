//! What is seen of the fleet from outside: the view, why something waits, occupancy of an area and safety regions in
//! it, the jobs that wait, rows of lists.
//!
//! Main types: [`view::View`], `why::Waiting`, `occupancy::NodeOccupancy`, `backlog::Backlog`, `rows::JobRow`. Refuses:
//! to be an input of any decision.

pub(crate) mod area;
pub(crate) mod backlog;
pub(crate) mod build;
pub(crate) mod closing;
pub(crate) mod events;
pub(crate) mod occupancy;
mod questions;
pub(crate) mod robot_events;
pub mod rows;
pub(crate) mod safety_regions;
pub(crate) mod shift;
pub(crate) mod unsettled;
pub(crate) mod untrue;
pub mod view;
pub(crate) mod why;
