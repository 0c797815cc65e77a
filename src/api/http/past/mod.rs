//! Handlers for the past: recordings, events, encounters, figures over time, the heat map, the report of a shift.
//!
//! Main functions: [`recordings::past`], [`events::list`], [`history::history`], [`shift::report`]. Refuses: to change
//! anything.

pub mod encounters;
pub mod events;
pub mod heat;
pub mod history;
pub mod recordings;
pub mod shift;
