//! How facts change the index of the ledger, which follows from what was promised.
//!
//! Refuses: to hold anything that the ledger does not say.

use super::{Ledger, RackAt};
use crate::state::fact::{Act, AssignmentFact, Fact, JobFact, RobotFact, RouteFact, Task};
use crate::state::index::{BAD_END_KNOWN, Index};
use crate::state::job::{Job, JobState, RobotChoice};
use giveway_floor::id::{JobId, RackId, RobotId};
use giveway_floor::time::Time;
use std::collections::BTreeMap;

impl Ledger {
    /// Rebuilds the index from the rest of the ledger, after that was put together from stored parts.
    pub fn reindex(&mut self) {
        let mut index = Index::new(self.warehouse());
        index.queue.advance(self.index.queue.as_of());
        index.count_closures_from(&self.index);
        self.index = index;
        let racks: Vec<RackId> = self.promises.racks.ids().collect();
        racks.into_iter().for_each(|rack| self.index_rack(rack));
        let robots: Vec<RobotId> = self.promises.robots.ids().collect();
        robots.into_iter().for_each(|robot| self.index_robot(robot));
        self.index_present();
        for (id, job) in &self.promises.jobs {
            admit(&mut self.index, &self.promises.jobs, &self.promises.ended_badly, *id, job);
        }
        for (id, at) in &self.promises.ended_badly {
            self.index.waits.note_bad_end(*id, *at);
        }
        for (id, assignment) in &self.promises.assignments {
            self.index.assign(assignment.worker, *id);
        }
        for (id, job) in &self.promises.jobs {
            self.index.note_named(*id, &job.request.kind, job.state);
        }
    }

    /// Compares the index with a rebuilt one.
    ///
    /// # Panics
    /// If they differ: some fact was taken in without updating the index.
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

    /// The rack that a fact lifts or sets down. To be called before the fact is taken in.
    pub(super) fn rack_moved_by(&self, fact: &Fact) -> Option<RackId> {
        let robot = match fact {
            Fact::Route(RouteFact::Acted { robot, .. }) => robot,
            Fact::Robot(RobotFact::RackTaken { rack, .. }) => return Some(*rack),
            _ => return None,
        };
        match self.promises.robots[*robot].stops.first()?.act {
            Act::Lift(rack) | Act::Set(rack) => Some(rack),
            Act::Pick(_) | Act::Arrive => None,
        }
    }

    /// Updates the index after a fact was taken in.
    pub(super) fn keep_index(&mut self, fact: &Fact, moved: Option<RackId>) {
        if let Some(rack) = moved {
            self.index_rack(rack);
        }
        match fact {
            Fact::Robot(of) => self.index_after_robot(of),
            Fact::Route(of) => self.index_after_route(of),
            Fact::Job(of) => self.index_after_job(of),
            Fact::Assignment(AssignmentFact::Assigned { assignment, worker, .. }) => {
                self.index.assign(*worker, *assignment);
            }
            Fact::Assignment(AssignmentFact::Given { assignment, worker, .. }) => {
                self.index.unassign(*assignment);
                self.index.assign(Some(*worker), *assignment);
            }
            Fact::Assignment(AssignmentFact::Advanced { assignment, state, .. }) => {
                if state.is_over() {
                    self.index.unassign(*assignment);
                }
            }
            Fact::Area(_) => self.index.note_closure_change(),
            Fact::Worker(_) | Fact::Floor(_) | Fact::Encounter(_) | Fact::Noted(_) => {}
        }
    }

    fn index_after_robot(&mut self, fact: &RobotFact) {
        match fact {
            RobotFact::Registered { robot, .. }
            | RobotFact::Left { robot, .. }
            | RobotFact::Returned { robot, .. } => {
                self.index_present();
                self.index_robot(*robot);
            }
            RobotFact::Tasked { robot, .. } => self.index_robot(*robot),
            RobotFact::Failed { .. }
            | RobotFact::Repaired { .. }
            | RobotFact::Fenced { .. }
            | RobotFact::Maintenance { .. }
            | RobotFact::Retired { .. }
            | RobotFact::Linked { .. }
            | RobotFact::RackTaken { .. } => {}
        }
    }

    fn index_after_route(&mut self, fact: &RouteFact) {
        match fact {
            RouteFact::Routed { bookings } => bookings.iter().for_each(|b| self.index_robot(b.robot)),
            RouteFact::Truncated { robots } => robots.iter().for_each(|kept| self.index_robot(kept.robot)),
            RouteFact::Placed { robot, cut, .. } => {
                self.index_robot(*robot);
                cut.iter().for_each(|kept| self.index_robot(kept.robot));
            }
            RouteFact::Granted { .. }
            | RouteFact::Passed { .. }
            | RouteFact::Acted { .. }
            | RouteFact::Retimed { .. }
            | RouteFact::Revoked { .. } => {}
        }
    }

    fn index_after_job(&mut self, fact: &JobFact) {
        match fact {
            JobFact::Accepted { job, .. }
            | JobFact::Prioritised { job, .. }
            | JobFact::Changed { job, .. }
            | JobFact::Chosen { job, .. } => self.index_job(*job),
            JobFact::Served { job, tasked: (robot, _), .. } => {
                self.index_robot(*robot);
                self.index_job(*job);
            }
            JobFact::Progressed { job, state, tasked, at } => {
                if let Some((robot, _)) = tasked {
                    self.index_robot(*robot);
                }
                self.index_job(*job);
                self.index_end(*job, *state, *at);
            }
            JobFact::LineChanged { .. } => {}
        }
    }

    fn index_present(&mut self) {
        let robots = self.promises.robots.pairs().filter(|(_, r)| !r.is_gone());
        self.index.note_present(robots.map(|(robot, _)| robot));
    }

    fn index_robot(&mut self, robot: RobotId) {
        let task = self.promises.robots[robot].task;
        let chain = self.timeline.chain(robot).expect("every robot stands somewhere");
        let end = chain.last().filter(|_| !chain.is_absent()).map(|v| v.node);
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
        let stored = match self.promises.racks[rack] {
            RackAt::Stored(node) => Some(node),
            RackAt::On(_) => None,
        };
        self.index.places.store(rack, stored);
        let is_free = stored.is_some() && !self.index.places.is_fetched(rack);
        self.index.queue.set_free(rack, is_free);
    }

    fn index_job(&mut self, id: JobId) {
        self.index.queue.remove(id);
        self.index.chosen.remove(&id);
        self.index.waits.remove(id);
        match self.promises.jobs.get(&id) {
            Some(job) => admit(&mut self.index, &self.promises.jobs, &self.promises.ended_badly, id, job),
            None => self.index.places.relocates(id, None),
        }
    }

    /// Wakes the jobs behind a job that is done; the jobs behind a job that ended badly never start.
    fn index_end(&mut self, id: JobId, state: JobState, at: Time) {
        match state {
            JobState::Done => {
                for ready in self.index.waits.ends_well(id) {
                    self.index.queue.unblock(ready);
                }
            }
            JobState::Cancelled | JobState::Failed(_) => {
                self.promises.ended_badly.insert(id, at);
                self.index.waits.note_bad_end(id, at);
                while let Some(old) = self.index.waits.forget_bad_end(at) {
                    self.promises.ended_badly.remove(&old);
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
    if job.choice != RobotChoice::Any {
        index.chosen.insert(id);
    }
    let bad = |a: &JobId| ended_badly.get(a).is_some_and(|t| job.accepted < *t + BAD_END_KNOWN);
    let before = job.request.after.iter().copied().filter(|a| jobs.contains_key(a) || bad(a));
    let is_blocked = index.waits.add(id, before, bad);
    index.queue.insert(id, job, is_blocked);
}
