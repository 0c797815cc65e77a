//! Jobs that nobody has yet, in the order in which the fleet looks at them, for whoever looks back at a moment.
//!
//! Main types: [`Backlog`], [`Pending`]. Not part of [`super::View`]: that is made ten times a second, and a hundred
//! thousand jobs may wait. Refuses: to list more than it is asked for, and to be an input of any decision.

use super::job::{Job, JobKind};
use super::{Fleet, JobState};
use crate::id::JobId;
use crate::time::Time;

/// The first of the waiting jobs at a moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Backlog {
    /// When.
    pub at: Time,
    /// The most urgent ones, in order.
    pub jobs: Vec<Pending>,
}

/// A job that nobody has yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pending {
    /// Its number.
    pub job: JobId,
    /// What is wanted.
    pub kind: JobKind,
    /// 0 to 9, 9 first.
    pub priority: u8,
    /// When it was accepted.
    pub accepted: Time,
    /// A job that must be over first and is not.
    pub after: Option<JobId>,
}

impl Fleet {
    /// The first `most` waiting jobs, in the order in which idle robots are matched with them: by priority, deadline
    /// and age. Which one goes first depends on where racks and robots stand, too. Costs one look at each waiting job
    /// and the sorting of `most`: 4.5 ms for 99 000 jobs, for which a whole view takes half as long. That is too much
    /// for every picture, and well for once a second; an order that is kept would change with age all the time.
    pub fn backlog(&self, most: usize, now: Time) -> Backlog {
        let waiting: Vec<(JobId, &Job)> = self.waiting_jobs().collect();
        let mut ranks = self.ranks(&waiting, now);
        if most > 0 && ranks.len() > most {
            ranks.select_nth_unstable(most - 1);
        }
        ranks.truncate(most);
        ranks.sort_unstable();
        let pending = |(_, id): (i64, JobId)| {
            let job = &self.ledger.jobs[&id];
            let (kind, priority) = (job.request.kind, job.request.priority);
            Pending { job: id, kind, priority, accepted: job.accepted, after: self.first_before(job) }
        };
        Backlog { at: now, jobs: ranks.into_iter().map(pending).collect() }
    }

    /// Jobs that nobody has yet, by number.
    pub(super) fn waiting_jobs(&self) -> impl Iterator<Item = (JobId, &Job)> {
        self.ledger.jobs.iter().filter(|(_, j)| j.state == JobState::Waiting).map(|(id, j)| (*id, j))
    }

    /// The first job that must be over before this one, and is not.
    pub(super) fn first_before(&self, job: &Job) -> Option<JobId> {
        job.request.after.iter().copied().find(|a| self.ledger.jobs.contains_key(a))
    }
}
