//! The fleet's view at one moment, with measurements of the loop; and figures over time.
//!
//! Main types: [`Moment`], [`FloorSimulation`], [`SharedHistory`]. Refuses: to change anything.

use giveway_fleet::history::{History, LoopTimes};
use giveway_fleet::{Backlog, Expected, View};
use giveway_floor::time::Time;
use std::sync::{Arc, Mutex};

/// A floor on which all robots and people are simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FloorSimulation {
    /// How many times as fast as real time the floor runs; at least 1.
    pub speed: u32,
}

/// The fleet at one moment, with measurements of the loop.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moment {
    /// The fleet's view.
    pub view: View,
    /// How many robots have sent no report yet but still may: after a while, a robot that was switched off is known to
    /// be silent. Nothing before the first view.
    pub unheard: Option<usize>,
    /// Seconds since the server started.
    pub time_s: f64,
    /// The simulation; nothing where people or robots are real, or a recording does not say.
    pub simulation: Option<FloorSimulation>,
    /// Measurements of the loop.
    pub measured: LoopFigures,
    /// Where people may be in the coming seconds; at most half a second old.
    pub forecasts: Arc<Vec<Expected>>,
    /// The first of the waiting jobs, at most a second old; empty if no past is kept.
    pub backlog: Arc<Backlog>,
}

/// Figures of the loop over the last minutes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoopFigures {
    /// Racks served per hour, over the last ten minutes.
    pub deliveries_per_hour: f64,
    /// Duration of a route search, median, microseconds.
    pub plan_us_p50: u64,
    /// Duration of a route search, 99th percentile, microseconds.
    pub plan_us_p99: u64,
    /// Duration of a step, 99th percentile, microseconds.
    pub step_us_p99: u64,
}

/// Figures over time, which one task writes and others read.
#[derive(Debug)]
pub struct SharedHistory {
    /// When the clock of the live feed was zero.
    pub started: Time,
    /// The human-aware policy, as a word.
    pub arm: &'static str,
    history: Mutex<History>,
}

impl SharedHistory {
    /// Figures over time, continued from what was kept of earlier runs.
    pub fn new(started: Time, arm: &'static str, history: History) -> SharedHistory {
        SharedHistory { started, arm, history: Mutex::new(history) }
    }

    /// Adds a view.
    pub fn note(&self, view: &View, times: &LoopTimes) {
        self.history.lock().expect("nobody panics with this lock").note(view, times);
    }

    /// Reads the figures.
    pub fn with<T>(&self, look: impl FnOnce(&History) -> T) -> T {
        look(&self.history.lock().expect("nobody panics with this lock"))
    }
}
