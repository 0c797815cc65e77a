//! Counts over many runs of the swarm.
//!
//! Main type: [`SwarmTally`]. Refuses: to judge.

use crate::measure::tally::JobTally;
use giveway_floor::time::Span;
use std::collections::BTreeMap;

/// Counts of one run or of many.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SwarmTally {
    /// Number of runs.
    pub runs: u64,
    /// Simulated time times the number of robots, including the time in which floors heal.
    pub robot_time: Span,
    /// Number of searches for routes.
    pub searches: u64,
    /// Racks served at stations.
    pub deliveries: u64,
    /// Assignments that people completed.
    pub human_deliveries: u64,
    /// Outcomes of jobs of each kind.
    pub jobs: BTreeMap<&'static str, JobTally>,
    /// How often each kind of fault, and of manual action, happened.
    pub injected: BTreeMap<&'static str, u64>,
    /// How many runs each map had.
    pub maps: BTreeMap<String, u64>,
    /// How many runs failed in each way.
    pub failures: BTreeMap<String, u64>,
}

impl SwarmTally {
    /// Simulated hours times the number of robots.
    pub fn robot_hours(&self) -> f64 {
        self.robot_time.as_secs_f64() / 3600.0
    }

    /// Adds the counts of other runs.
    pub fn add(&mut self, other: &SwarmTally) {
        self.runs += other.runs;
        self.robot_time += other.robot_time;
        self.searches += other.searches;
        self.deliveries += other.deliveries;
        self.human_deliveries += other.human_deliveries;
        for (kind, more) in &other.jobs {
            let sum = self.jobs.entry(*kind).or_default();
            sum.accepted += more.accepted;
            sum.done += more.done;
            sum.failed += more.failed;
            sum.cancelled += more.cancelled;
            sum.open_at_end += more.open_at_end;
        }
        for (kind, more) in &other.injected {
            *self.injected.entry(*kind).or_default() += more;
        }
        for (name, more) in &other.maps {
            *self.maps.entry(name.clone()).or_default() += more;
        }
        for (kind, more) in &other.failures {
            *self.failures.entry(kind.clone()).or_default() += more;
        }
    }
}
