//! What outsiders see: the view, why something waits, occupancy of an area and safety regions in it, the jobs that
//! wait, rows of lists.
//!
//! Main types: [`view::View`], `why::Waiting`, `occupancy::NodeOccupancy`, `backlog::Backlog`, `rows::JobRow`. Refuses:
//! to be an input of any decision.

pub(in crate::fleet) mod area;
pub(in crate::fleet) mod backlog;
pub(in crate::fleet) mod build;
pub(in crate::fleet) mod closing;
pub(in crate::fleet) mod events;
pub(in crate::fleet) mod occupancy;
mod questions;
pub(in crate::fleet) mod robot_events;
pub mod rows;
pub(in crate::fleet) mod safety_regions;
pub(in crate::fleet) mod shift;
pub(in crate::fleet) mod unsettled;
pub mod view;
pub(in crate::fleet) mod why;
