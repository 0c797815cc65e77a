//! The fleet's view at one moment, with what the loop measured, and figures over time.
//!
//! Main types: [`Moment`], [`SharedHistory`]. Refuses: to change anything.

use giveway_fleet::history::{History, LoopTimes};
use giveway_fleet::{Backlog, Expected, View};
use giveway_floor::time::Time;
use std::sync::{Arc, Mutex};

/// The fleet at one moment, with what the loop measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moment {
    /// The view.
    pub view: View,
    /// How many robots have said nothing yet, and may still: a robot that was switched off is known to be silent after
    /// a while. Nothing before the first view.
    pub unheard: Option<usize>,
    /// Seconds since the server started.
    pub time_s: f64,
    /// What the loop measured.
    pub measured: LoopFigures,
    /// Where people may be in the coming seconds, as it was half a second ago at most.
    pub forecasts: Arc<Vec<Expected>>,
    /// The first of the jobs that wait, as they were a second ago at most; nothing where no past is kept.
    pub backlog: Arc<Backlog>,
}

/// Figures of the loop over the last minutes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoopFigures {
    /// Racks served per hour, over the last ten minutes.
    pub deliveries_per_hour: f64,
    /// Length of a search for a route, median, microseconds.
    pub plan_us_p50: u64,
    /// The same, 99th percentile.
    pub plan_us_p99: u64,
    /// Step time, 99th percentile, microseconds.
    pub step_us_p99: u64,
}

/// Figures over time, which one task keeps and others read.
#[derive(Debug)]
pub struct SharedHistory {
    /// When the clock of the live feed was zero.
    pub started: Time,
    /// How the fleet deals with people, in a word.
    pub arm: &'static str,
    history: Mutex<History>,
}

impl SharedHistory {
    /// With what was kept of earlier runs.
    pub fn new(started: Time, arm: &'static str, history: History) -> SharedHistory {
        SharedHistory { started, arm, history: Mutex::new(history) }
    }

    /// Takes a view in.
    pub fn note(&self, view: &View, times: &LoopTimes) {
        self.history.lock().expect("nobody panics with this lock").note(view, times);
    }

    /// Looks at them.
    pub fn with<T>(&self, look: impl FnOnce(&History) -> T) -> T {
        look(&self.history.lock().expect("nobody panics with this lock"))
    }
}
