//! Simulated pickers: people at a station whose true hands, heads and eyes are known.
//!
//! Main module: [`motion`] (a person's build and one reach). Refuses: to show a cell anything that a sensor would not.

pub mod motion;
