//! Jobs that no robot has yet, in the order in which the fleet looks at them; for a look at the fleet at one moment.
//!
//! Main types: [`Backlog`], [`Pending`]. Not part of [`super::view::View`]: a view is made ten times a second, and a
//! hundred thousand jobs may wait. Refuses: to list more than it is asked for, and to be an input of any decision.

use crate::Fleet;
use crate::state::floor::Floor;
use crate::state::job_kind::JobKind;
use giveway_floor::id::JobId;
use giveway_floor::time::Time;

/// The first of the waiting jobs at a moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Backlog {
    /// The moment.
    pub at: Time,
    /// The most urgent jobs, in order.
    pub jobs: Vec<Pending>,
}

/// A job that no robot has yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pending {
    /// The number of the job.
    pub job: JobId,
    /// What is wanted.
    pub kind: JobKind,
    /// Priority, 0 to 9; 9 goes first.
    pub priority: u8,
    /// When the job was accepted.
    pub accepted: Time,
    /// A job that must be over first and is not, if there is one.
    pub after: Option<JobId>,
}

impl Fleet {
    /// The first `most` waiting jobs, in the order in which idle robots are matched with them: by priority, deadline
    /// and age. Which job goes first also depends on where racks and robots stand. Costs a look at each job that it
    /// returns, however many wait.
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
    /// The first job that keeps this one from starting, because it is not over or ended badly.
    pub(crate) fn first_before(&self, job: JobId) -> Option<JobId> {
        self.ledger.index().waits.first_before(job)
    }
}
