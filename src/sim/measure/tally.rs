//! Outcomes of jobs, by kind.
//!
//! Main types: [`JobTally`], `Tallies`. Refuses: to look at anything but facts.

use giveway_fleet::{Fact, Fleet, JobFact, JobState};
use giveway_floor::id::JobId;
use std::collections::BTreeMap;

/// Outcomes of the jobs of one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JobTally {
    /// Jobs that were accepted.
    pub accepted: u64,
    /// Jobs that were done.
    pub done: u64,
    /// Jobs that could not be done.
    pub failed: u64,
    /// Jobs that were cancelled.
    pub cancelled: u64,
    /// Jobs still open at the end.
    pub open_at_end: u64,
}

/// Outcomes of all jobs.
#[derive(Debug, Default)]
pub(crate) struct Tallies {
    open: BTreeMap<JobId, &'static str>,
    kinds: BTreeMap<&'static str, JobTally>,
}

impl Tallies {
    pub fn note(&mut self, facts: &[Fact]) {
        for fact in facts {
            match fact {
                Fact::Job(JobFact::Accepted { job, request, .. }) => {
                    let word = request.kind.word();
                    self.open.insert(*job, word);
                    self.kinds.entry(word).or_default().accepted += 1;
                }
                Fact::Job(JobFact::Progressed { job, state, .. }) if state.is_over() => {
                    self.end(*job, *state)
                }
                _ => {}
            }
        }
    }

    fn end(&mut self, job: JobId, state: JobState) {
        let Some(word) = self.open.remove(&job) else { return };
        let tally = self.kinds.entry(word).or_default();
        match state {
            JobState::Done => tally.done += 1,
            JobState::Cancelled => tally.cancelled += 1,
            _ => tally.failed += 1,
        }
    }

    /// All counts, with the ledger's open jobs at the end.
    pub fn all(&self, fleet: &Fleet) -> BTreeMap<&'static str, JobTally> {
        let mut all = self.kinds.clone();
        for job in fleet.ledger().jobs.values() {
            all.entry(job.request.kind.word()).or_default().open_at_end += 1;
        }
        all
    }
}
