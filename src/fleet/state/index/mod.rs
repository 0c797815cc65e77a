//! What the ledger looks up instead of searching: robots and racks by node, waiting jobs in order, jobs by predecessor.
//!
//! Main type: [`Index`]. The ledger keeps it, and it follows from the rest of the ledger, which can make it anew; the
//! laws of simulations compare the two. Refuses: to hold anything that the ledger does not say.

mod places;
mod queue;
mod waits;

pub use places::Places;
pub use queue::{DeadlineStage, Queue, QueueLine, RackGoal, Rank, urgency_ms};
pub use waits::SuccessorIndex;

use crate::state::job::JobState;
use crate::state::job_kind::JobKind;
use giveway_floor::id::{AssignmentId, JobId, RobotId, WorkerId};
use giveway_floor::time::Span;
use giveway_floor::warehouse::Warehouse;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// How long the ledger knows that a job was cancelled or failed: jobs that are to come after it fail as well.
pub const BAD_END_KNOWN: Span = Span::from_secs(7 * 24 * 3600);
/// How many badly ended jobs the ledger knows at most; the oldest is forgotten first.
pub const BAD_ENDS_MAX: usize = 100_000;

/// Everything that can be looked up. Ledgers are equal whatever their indexes hold.
#[derive(Clone, Debug)]
pub struct Index {
    /// Robots and racks by node.
    pub places: Places,
    /// Waiting jobs in order.
    pub queue: Queue,
    /// Jobs by the jobs that they come after.
    pub waits: SuccessorIndex,
    /// Waiting jobs for a rack that not every robot may do, because an operator chose.
    pub chosen: BTreeSet<JobId>,
    /// Waiting jobs for a robot that the customer named, by robot.
    named: BTreeMap<RobotId, BTreeSet<JobId>>,
    /// Robots on the floor, by number. Shared, so that the ledger can change while a loop goes over them.
    present: Arc<[RobotId]>,
    /// Open assignments by worker.
    assignments: BTreeMap<WorkerId, BTreeSet<AssignmentId>>,
    /// Open assignments that no worker has yet.
    unassigned: BTreeSet<AssignmentId>,
    /// How many closures were announced or taken back so far.
    closure_changes: u64,
}

impl PartialEq for Index {
    fn eq(&self, _: &Index) -> bool {
        true
    }
}

impl Index {
    /// The index of an empty ledger.
    pub fn new(warehouse: &Warehouse) -> Index {
        Index {
            places: Places::new(warehouse),
            queue: Queue::new(warehouse.racks.len()),
            waits: SuccessorIndex::default(),
            chosen: BTreeSet::new(),
            named: BTreeMap::new(),
            present: Arc::new([]),
            assignments: BTreeMap::new(),
            unassigned: BTreeSet::new(),
            closure_changes: 0,
        }
    }

    /// Robots on the floor, by number.
    pub fn present(&self) -> &Arc<[RobotId]> {
        &self.present
    }

    /// Notes which robots are on the floor.
    pub(in crate::state) fn note_present(&mut self, robots: impl Iterator<Item = RobotId>) {
        self.present = robots.collect();
    }

    /// The open assignments of a worker, oldest first.
    pub fn assignments_of(&self, worker: WorkerId) -> impl Iterator<Item = AssignmentId> + '_ {
        self.assignments.get(&worker).into_iter().flatten().copied()
    }

    /// Workers who have open assignments.
    pub fn assigned_workers(&self) -> impl Iterator<Item = WorkerId> + '_ {
        self.assignments.keys().copied()
    }

    /// How many closures were announced or taken back so far.
    pub fn closure_changes(&self) -> u64 {
        self.closure_changes
    }

    /// Notes that a closure was announced or taken back.
    pub(in crate::state) fn note_closure_change(&mut self) {
        self.closure_changes += 1;
    }

    /// Continues the count of closure changes from another index.
    pub(in crate::state) fn count_closures_from(&mut self, other: &Index) {
        self.closure_changes = other.closure_changes + 1;
    }

    /// Waiting jobs for a robot that the customer named, by number.
    pub fn named_for(&self, robot: RobotId) -> impl Iterator<Item = JobId> + '_ {
        self.named.get(&robot).into_iter().flatten().copied()
    }

    /// Updates the list of jobs that wait for a robot that the customer named.
    pub(in crate::state) fn note_named(&mut self, id: JobId, kind: &JobKind, state: JobState) {
        let Some(robot) = kind.robot() else { return };
        let waiting = self.named.entry(robot).or_default();
        match state {
            JobState::Waiting => waiting.insert(id),
            _ => waiting.remove(&id),
        };
        if waiting.is_empty() {
            self.named.remove(&robot);
        }
    }

    /// Assignments that no worker has yet, oldest first.
    pub fn unassigned(&self) -> impl Iterator<Item = AssignmentId> + '_ {
        self.unassigned.iter().copied()
    }

    pub(in crate::state) fn assign(&mut self, worker: Option<WorkerId>, id: AssignmentId) {
        match worker {
            Some(worker) => self.assignments.entry(worker).or_default().insert(id),
            None => self.unassigned.insert(id),
        };
    }

    pub(in crate::state) fn unassign(&mut self, id: AssignmentId) {
        if self.unassigned.remove(&id) {
            return;
        }
        let of = self.assignments.iter_mut().find(|(_, ids)| ids.contains(&id));
        let Some((worker, ids)) = of else { return };
        ids.remove(&id);
        if ids.is_empty() {
            let worker = *worker;
            self.assignments.remove(&worker);
        }
    }

    /// Whether two indexes say the same.
    pub(in crate::state) fn says_the_same(&self, other: &Index) -> bool {
        self.present == other.present
            && self.places == other.places
            && self.queue == other.queue
            && self.waits == other.waits
            && self.named == other.named
            && self.assignments == other.assignments
            && self.unassigned == other.unassigned
    }
}
