//! Swarm testing: each seed draws a floor, robots, people, jobs and faults, and the fleet has to keep all laws on it.
//!
//! Main types: [`SwarmCase`] (what to run, as the flags of one command), [`SwarmSetup`] (what a case draws),
//! [`SwarmRun`] (a case under way), [`SwarmTally`]; main function [`shrink()`]. A run has two phases. While faults
//! last, all laws hold at each step. Then the floor heals: within [`HEALS_WITHIN`] every job ends and every rack is in
//! storage. Refuses: threads, clocks and catching panics, which the caller does.

mod case;
mod draw;
mod maps;
mod run;
mod shrink;
mod tally;

pub use case::{SwarmCase, SwarmMap, SwarmPart};
pub use draw::{HEALS_WITHIN, SwarmSetup};
pub use run::{SwarmFailure, SwarmRun};
pub use shrink::{Shrunk, shrink};
pub use tally::SwarmTally;
