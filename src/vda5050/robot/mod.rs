//! A virtual robot, for tests of any master.
//!
//! Main type: [`VirtualBody`] (what moves). Refuses: clocks, input and output, randomness.

mod body;
#[cfg(test)]
mod tests;

pub use body::{BodyCommand, BodyLimits, BodyMotion, BodyReport, PathPoint, VirtualBody};
