//! Measurements that others can repeat: published tables and benchmark floors.
//!
//! Main modules: [`grid`] (benchmark floors as text), [`lifelong`] (goals reached per step under pebble rules),
//! [`planning`] (one route among many). Refuses:
//! to read files or clocks; whoever calls passes texts in and takes figures out.

pub mod grid;
pub mod lifelong;
pub mod planning;
