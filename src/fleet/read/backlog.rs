//! Jobs that no robot has yet, in the order in which the fleet looks at them, for readers who look back at a moment.
//!
//! Main types: [`Backlog`], [`Pending`]. Not part of [`super::view::View`]: that is made ten times a second, and a
//! hundred thousand jobs may wait. Refuses: to list more than it is asked for, and to be an input of any decision.

use crate::Fleet;
use crate::state::floor::Floor;
use crate::state::job_kind::JobKind;
use giveway_floor::id::JobId;
use giveway_floor::time::Time;

/// The first of the waiting jobs at a moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Backlog {
    /// When.
    pub at: Time,
    /// The most urgent ones, in order.
    pub jobs: Vec<Pending>,
}

/// A job that no robot has yet.
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
    /// and age. Which one goes first depends on where racks and robots stand, too. Costs a look at each of those that
    /// it gives, however many wait.
    pub fn backlog(&self, most: usize, now: Time) -> Backlog {
        let pending = |id: JobId| {
            let job = &self.writer.ledger().jobs[&id];
            let (kind, priority) = (job.request.kind, job.request.priority);
            Pending { job: id, kind, priority, accepted: job.accepted, after: self.floor().first_before(id) }
        };
        Backlog {
            at: now,
            jobs: self.writer.ledger().index().queue.in_order(now).take(most).map(pending).collect(),
        }
    }
}

impl Floor<'_> {
    /// The first job that keeps this one from starting: it is not over, or it ended badly.
    pub(crate) fn first_before(&self, job: JobId) -> Option<JobId> {
        self.ledger.index().waits.first_before(job)
    }
}
