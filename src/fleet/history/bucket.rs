//! What happened in one span of time.
//!
//! Main type: [`Bucket`]. Refuses: rates, which readers compute from sums and the time that is covered.

use super::{Lengths, RobotTimes};
use crate::Counts;
use giveway_floor::time::{Span, Time};

/// Sums over a span of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bucket {
    /// When the bucket began; it is as long as all of its tier.
    pub start: Time,
    /// How much of the bucket was seen: less than its length if the server did not run, or the bucket is not over yet.
    pub covered: Span,
    /// Racks served at stations.
    pub robot_deliveries: u64,
    /// Assignments completed by workers.
    pub human_deliveries: u64,
    /// Encounters of robots and workers.
    pub encounters: u64,
    /// How often a worker left the path.
    pub deviations: u64,
    /// How often a robot had to stop or to change its route because of a worker.
    pub interruptions: u64,
    /// Routes planned anew because of workers and closures.
    pub replans: u64,
    /// Routes planned.
    pub plans: u64,
    /// Searches that found no route.
    pub plan_failures: u64,
    /// Time of workers on the floor, summed over the workers.
    pub worker_time: Span,
    /// Time for which robots stood although they would have driven on, summed over the robots.
    pub waiting_time: Span,
    /// Order lines that were over, at picking stations.
    pub lines: u64,
    /// Reaches of pickers that were warned of.
    pub wrong_reaches: u64,
    /// Time in which picking stations had no rack to pick from, summed over the stations.
    pub idle_time: Span,
    /// How long robots did what, and waited for what.
    pub robots: RobotTimes,
    /// How long searches took.
    pub searches: Lengths,
    /// The longest step, microseconds.
    pub step_max_us: u64,
}

impl Bucket {
    /// What was counted between two moments. A count that became smaller belongs to another run and tells nothing.
    pub fn between(before: &Counts, now: &Counts) -> Bucket {
        let more = |of: fn(&Counts) -> u64| of(now).saturating_sub(of(before));
        Bucket {
            robot_deliveries: more(|c| c.robot_deliveries),
            human_deliveries: more(|c| c.human_deliveries),
            encounters: more(|c| c.encounters),
            deviations: more(|c| c.deviations),
            interruptions: more(|c| c.interruptions),
            replans: more(|c| c.replans),
            plans: more(|c| c.plans),
            plan_failures: more(|c| c.plan_failures),
            lines: more(|c| c.lines),
            wrong_reaches: more(|c| c.wrong_reaches),
            ..Bucket::default()
        }
    }

    /// Adds what happened in another bucket.
    pub fn add(&mut self, other: &Bucket) {
        self.covered += other.covered;
        self.robot_deliveries += other.robot_deliveries;
        self.human_deliveries += other.human_deliveries;
        self.encounters += other.encounters;
        self.deviations += other.deviations;
        self.interruptions += other.interruptions;
        self.replans += other.replans;
        self.plans += other.plans;
        self.plan_failures += other.plan_failures;
        self.worker_time += other.worker_time;
        self.waiting_time += other.waiting_time;
        self.lines += other.lines;
        self.wrong_reaches += other.wrong_reaches;
        self.idle_time += other.idle_time;
        self.robots.add(&other.robots);
        self.searches.add(&other.searches);
        self.step_max_us = self.step_max_us.max(other.step_max_us);
    }
}
