//! What is measured of a simulation against the truth: encounters, how well the fleet detects where people go, outcomes
//! of jobs, a digest of all facts.
//!
//! Main types: [`encounter::EncounterMeter`], [`rings::RingColumn`], [`detection::Score`], [`tally::JobTally`],
//! [`digest::Digest`]. Refuses: to tell the fleet anything.

pub mod detection;
pub mod digest;
pub mod encounter;
pub mod rings;
pub mod tally;
