//! What the ledger looks up instead of searching: robots and racks by node, waiting jobs in order, jobs by predecessor.
//!
//! Main type: [`Index`]. [`Ledger::evolve`] alone keeps it, and it follows from the rest of the ledger:
//! [`Ledger::reindex`] makes it anew, and the laws of simulations compare the two. Refuses: to hold anything that the
//! ledger does not say.

mod places;
mod queue;
mod waits;

pub use places::Places;
pub use queue::{Goal, Line, Queue, Rank, Stage, urgency_ms};
pub use waits::Waits;

use crate::fleet::state::fact::{Act, Fact, Task};
use crate::fleet::state::job::{Job, JobKind, JobState};
use crate::fleet::state::ledger::Ledger;
use crate::fleet::state::ledger::RackAt;
use crate::id::{AssignmentId, JobId, RackId, RobotId, WorkerId};
use crate::time::{Span, Time};
use crate::timeline::Holder;
use crate::warehouse::Warehouse;
use std::collections::{BTreeMap, BTreeSet};

/// For how long the ledger knows that a job was cancelled or failed: jobs that are to come after it fail as well.
pub const BAD_END_KNOWN: Span = Span::from_secs(7 * 24 * 3600);
/// How many badly ended jobs the ledger knows at most; the oldest is forgotten first.
pub const BAD_ENDS_MAX: usize = 100_000;

/// Everything that is looked up. Ledgers are equal without regard to it.
#[derive(Clone, Debug)]
pub struct Index {
    /// Robots and racks by node.
    pub places: Places,
    /// Waiting jobs in order.
    pub queue: Queue,
    /// Jobs by the jobs that they come after.
    pub waits: Waits,
    /// Open assignments by worker.
    assignments: BTreeMap<WorkerId, BTreeSet<AssignmentId>>,
    /// Counts every closure that was announced or taken back.
    closure_changes: u64,
}

impl PartialEq for Index {
    fn eq(&self, _: &Index) -> bool {
        true
    }
}

impl Index {
    /// Of an empty ledger.
    pub fn new(warehouse: &Warehouse) -> Index {
        Index {
            places: Places::new(warehouse),
            queue: Queue::new(warehouse.racks.len()),
            waits: Waits::default(),
            assignments: BTreeMap::new(),
            closure_changes: 0,
        }
    }

    /// The open assignments of a worker, oldest first.
    pub fn assignments_of(&self, worker: WorkerId) -> impl Iterator<Item = AssignmentId> + '_ {
        self.assignments.get(&worker).into_iter().flatten().copied()
    }

    /// Workers who have open assignments.
    pub fn assigned_workers(&self) -> impl Iterator<Item = WorkerId> + '_ {
        self.assignments.keys().copied()
    }

    /// Counts every closure that was announced or taken back.
    pub fn closure_changes(&self) -> u64 {
        self.closure_changes
    }

    fn assign(&mut self, worker: WorkerId, id: AssignmentId) {
        self.assignments.entry(worker).or_default().insert(id);
    }

    fn unassign(&mut self, id: AssignmentId) {
        let of = self.assignments.iter_mut().find(|(_, ids)| ids.contains(&id));
        let Some((worker, ids)) = of else { return };
        ids.remove(&id);
        if ids.is_empty() {
            let worker = *worker;
            self.assignments.remove(&worker);
        }
    }

    /// Whether two indexes say the same.
    fn says_the_same(&self, other: &Index) -> bool {
        self.places == other.places
            && self.queue == other.queue
            && self.waits == other.waits
            && self.assignments == other.assignments
    }
}

impl Ledger {
    /// Makes the index anew from the rest of the ledger: after it was put together from stored parts.
    pub fn reindex(&mut self) {
        let mut index = Index::new(self.warehouse());
        index.queue.advance(self.index.queue.as_of());
        index.closure_changes = self.index.closure_changes + 1;
        self.index = index;
        let racks: Vec<RackId> = self.racks.ids().collect();
        racks.into_iter().for_each(|rack| self.index_rack(rack));
        let robots: Vec<RobotId> = self.robots.ids().collect();
        robots.into_iter().for_each(|robot| self.index_robot(robot));
        for (id, job) in &self.jobs {
            admit(&mut self.index, &self.jobs, &self.ended_badly, *id, job);
        }
        for (id, at) in &self.ended_badly {
            self.index.waits.note_bad_end(*id, *at);
        }
        for (id, assignment) in &self.assignments {
            self.index.assign(assignment.worker, *id);
        }
        self.named.clear();
        let jobs: Vec<(JobId, JobKind, JobState)> =
            self.jobs.iter().map(|(id, j)| (*id, j.request.kind, j.state)).collect();
        jobs.into_iter().for_each(|(id, kind, state)| self.note_named(id, &kind, state));
    }

    /// Compares the index with one that is made anew.
    ///
    /// # Panics
    /// If they differ: some fact was taken in without it.
    pub fn assert_indexed(&self) {
        let mut anew = self.clone();
        anew.reindex();
        assert!(
            self.index.says_the_same(&anew.index),
            "the index follows from the ledger: {:#?}\nand anew: {:#?}",
            self.index,
            anew.index
        );
    }

    /// The rack that a fact lifts or sets down. To be asked before the fact is taken in.
    pub(in crate::fleet) fn rack_moved_by(&self, fact: &Fact) -> Option<RackId> {
        let Fact::Acted { robot, .. } = fact else { return None };
        match self.robots[*robot].stops.first()?.act {
            Act::Lift(rack) | Act::Set(rack) => Some(rack),
            Act::Pick(_) | Act::Arrive => None,
        }
    }

    /// Keeps the index after a fact was taken in.
    pub(in crate::fleet) fn keep_index(&mut self, fact: &Fact, moved: Option<RackId>) {
        if let Some(rack) = moved {
            self.index_rack(rack);
        }
        match fact {
            Fact::Registered { robot, .. } | Fact::Tasked { robot, .. } => self.index_robot(*robot),
            Fact::Routed { bookings } => bookings.iter().for_each(|b| self.index_robot(b.robot)),
            Fact::Truncated { robots } => robots.iter().for_each(|kept| self.index_robot(kept.robot)),
            Fact::Placed { robot, cut, .. } => {
                self.index_robot(*robot);
                cut.iter().for_each(|kept| self.index_robot(kept.robot));
            }
            Fact::Accepted { job, .. } | Fact::Prioritised { job, .. } => self.index_job(*job),
            Fact::Progressed { job, state, tasked, at } => {
                if let Some((robot, _)) = tasked {
                    self.index_robot(*robot);
                }
                self.index_job(*job);
                self.index_end(*job, *state, *at);
            }
            Fact::Assigned { assignment, worker, .. } => self.index.assign(*worker, *assignment),
            Fact::Advanced { assignment, state, .. } if state.is_over() => self.index.unassign(*assignment),
            Fact::Closed { .. } | Fact::Reopened { .. } => self.index.closure_changes += 1,
            _ => {}
        }
    }

    fn index_robot(&mut self, robot: RobotId) {
        let task = self.robots[robot].task;
        let chain = self.timeline.chain(Holder::Robot(robot)).expect("every robot stands somewhere");
        let end = chain.last().map(|v| v.node);
        self.index.places.claim(robot, end, task.destination());
        let fetched = match task {
            Task::Fetch { rack, .. } => Some(rack),
            _ => None,
        };
        if let Some(before) = self.index.places.fetches(robot, fetched) {
            self.index_rack(before);
        }
        if let Some(rack) = fetched {
            self.index_rack(rack);
        }
    }

    fn index_rack(&mut self, rack: RackId) {
        let stored = match self.racks[rack] {
            RackAt::Stored(node) => Some(node),
            RackAt::On(_) => None,
        };
        self.index.places.store(rack, stored);
        let is_free = stored.is_some() && !self.index.places.is_fetched(rack);
        self.index.queue.set_free(rack, is_free);
    }

    fn index_job(&mut self, id: JobId) {
        self.index.queue.remove(id);
        self.index.waits.remove(id);
        match self.jobs.get(&id) {
            Some(job) => admit(&mut self.index, &self.jobs, &self.ended_badly, id, job),
            None => self.index.places.relocates(id, None),
        }
    }

    /// Wakes the jobs that come after one that is done; those that come after one that ended badly never start.
    fn index_end(&mut self, id: JobId, state: JobState, at: Time) {
        match state {
            JobState::Done => {
                for ready in self.index.waits.ends_well(id) {
                    self.index.queue.unblock(ready);
                }
            }
            JobState::Cancelled | JobState::Failed(_) => {
                self.ended_badly.insert(id, at);
                self.index.waits.note_bad_end(id, at);
                while let Some(old) = self.index.waits.forget_bad_end(at) {
                    self.ended_badly.remove(&old);
                }
            }
            _ => {}
        }
    }
}

/// Takes a job that is not over into the index.
fn admit(
    index: &mut Index,
    jobs: &BTreeMap<JobId, Job>,
    ended_badly: &BTreeMap<JobId, Time>,
    id: JobId,
    job: &Job,
) {
    index.places.relocates(id, Some(job));
    if job.state != JobState::Waiting {
        return;
    }
    let bad = |a: &JobId| ended_badly.get(a).is_some_and(|t| job.accepted < *t + BAD_END_KNOWN);
    let before = job.request.after.iter().copied().filter(|a| jobs.contains_key(a) || bad(a));
    let is_blocked = index.waits.add(id, before, bad);
    index.queue.insert(id, job, is_blocked);
}
