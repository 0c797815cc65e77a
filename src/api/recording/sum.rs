//! Running sums: counts since a recording began, for charts over any period of it.
//!
//! Main types: [`RunningTotals`] (the sums), [`Sum`] (with their time), [`Counting`] (adds them up from frame to
//! frame). Differences of sums make figures, and any of the sums may be left out ([`thinned`]). Counters are the
//! fleet's, which continue after a restart; seconds start anew. Refuses: rates.

use crate::live::Frame;
use crate::wire::text::round3;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Frames farther apart than this have a gap between them, in which nothing is counted, seconds.
const GAP_S: f64 = 1.0;

/// Sums farther apart than this have a gap between them, seconds.
const APART_S: f64 = 15.0;

/// What has been counted so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RunningTotals {
    /// Seconds that are covered by frames.
    pub covered_s: f64,
    /// Racks served at stations.
    pub robot_deliveries: u64,
    /// Assignments completed by workers.
    pub human_deliveries: u64,
    /// How often a robot came into region 1 of a worker.
    pub encounters: u64,
    /// How often a worker left the path.
    pub deviations: u64,
    /// How often a robot had to stop or to change its route because of a worker.
    pub interruptions: u64,
    /// Routes planned anew because of workers and closures.
    pub replans: u64,
    /// Seconds that robots stood although they had to drive on, summed over all robots.
    pub waiting_s: f64,
    /// Seconds that workers spent on the floor, summed over all workers.
    pub worker_s: f64,
    /// Duration of the last 1200 route searches, median, microseconds; 0 if it was not measured. This is not a sum.
    pub plan_us_p50: u64,
    /// Duration of the last 1200 route searches, 99th percentile, microseconds. This is not a sum.
    pub plan_us_p99: u64,
}

/// The sums at a point in time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Sum {
    /// The time of the sums, seconds from the start.
    pub at_s: f64,
    /// What had been counted by then.
    #[serde(flatten)]
    pub tally: RunningTotals,
}

/// Counts seconds between frames.
#[derive(Debug, Default)]
pub(super) struct Counting {
    covered_s: f64,
    waiting_s: f64,
    worker_s: f64,
}

impl Counting {
    /// Adds the time from one frame to the next.
    pub(super) fn go(&mut self, old: &Frame, new: &Frame) {
        let span = new.time_s - old.time_s;
        if span <= GAP_S {
            self.covered_s += span;
            self.waiting_s += span * new.beside.waiting as f64;
            self.worker_s += span * new.beside.people as f64;
        }
    }

    /// The sums at a frame.
    pub(super) fn sum(&self, frame: &Frame) -> Sum {
        let count = |name: &str| frame.counters[name].as_u64().unwrap_or(0);
        let tally = RunningTotals {
            covered_s: round3(self.covered_s),
            robot_deliveries: count("robot_deliveries"),
            human_deliveries: count("human_deliveries"),
            encounters: count("encounters"),
            deviations: count("deviations"),
            interruptions: count("interruptions"),
            replans: count("replans"),
            waiting_s: round3(self.waiting_s),
            worker_s: round3(self.worker_s),
            plan_us_p50: count("plan_us_p50"),
            plan_us_p99: count("plan_us_p99"),
        };
        Sum { at_s: frame.time_s, tally }
    }
}

/// One sum per `step_s` seconds: the first of each step, the last of all, and both ends of each gap, so that
/// differences stay the same.
pub fn thinned(sums: &[Sum], step_s: f64) -> Vec<Sum> {
    let apart = |a: &Sum, b: &Sum| b.at_s - a.at_s > APART_S || b.tally.covered_s < a.tally.covered_s;
    let step = |s: &Sum| (s.at_s / step_s).floor();
    let kept = |i: &usize| {
        let here = &sums[*i];
        let before = i.checked_sub(1).map(|b| &sums[b]);
        let first = before.is_none_or(|b| step(b) != step(here) || apart(b, here));
        first || sums.get(i + 1).is_none_or(|next| apart(here, next))
    };
    (0..sums.len()).filter(kept).map(|i| sums[i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_first_of_each_step_and_the_ends_of_gaps() {
        let sum = |at_s: f64, covered_s: f64| Sum {
            at_s,
            tally: RunningTotals { covered_s, ..RunningTotals::default() },
        };
        let mut sums: Vec<Sum> = (0..12).map(|i| sum(10.0 * f64::from(i), 10.0 * f64::from(i))).collect();
        // A restart within seconds, then a gap.
        sums.extend([
            sum(113.0, 0.0),
            sum(123.0, 10.0),
            sum(300.0, 10.0),
            sum(310.0, 20.0),
            sum(320.0, 30.0),
        ]);
        let times: Vec<f64> = thinned(&sums, 60.0).iter().map(|s| s.at_s).collect();
        assert_eq!(times, [0.0, 60.0, 110.0, 113.0, 123.0, 300.0, 320.0]);
        assert_eq!(thinned(&sums, 10.0), sums);
        assert!(thinned(&[], 10.0).is_empty());
    }
}
