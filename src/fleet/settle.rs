//! Second phase: what has come true? Places passed are free again, stops done lead to the next task, delays are noted.
//!
//! Refuses: to plan; a robot whose task has no route yet is picked up by the planning phase.

use super::cut::robot_of;
use super::fact::{Act, Fact, Moved, Purpose, Task};
use super::job::{JobFailure, JobKind, JobState};
use super::{Fleet, ledger};
use crate::id::{JobId, RackId, RobotId};
use crate::time::{Span, Time};
use crate::timeline::Holder;
use crate::warehouse::NodeKind;

/// A robot this much behind its plan is late.
const LATE: Span = Span::from_millis(1500);
/// A late robot is expected to need this much longer than now.
const GUESS: Span = Span::from_millis(1000);

impl Fleet {
    pub(super) fn settle(&mut self, now: Time) {
        for robot in ledger::all(&self.ledger.robots) {
            let Some(seen) = self.scene.robot(robot).copied() else { continue };
            self.settle_health(robot, seen.failed, now);
            self.settle_progress(robot, seen.reached, now);
            self.settle_recall(robot, &seen, now);
            self.settle_stop(robot, seen.acted, now);
            self.settle_delay(robot, now);
        }
        self.settle_orphans(now);
    }

    fn settle_health(&mut self, robot: RobotId, failed: bool, now: Time) {
        match (self.ledger.robots[robot].failed, failed) {
            (false, true) => self.fail(robot, now),
            (true, false) => self.record(Fact::Repaired { robot, at: now }),
            _ => {}
        }
    }

    /// A robot stops for good: its job goes to another if it has not lifted the rack yet, and everybody whose way
    /// leads over its place loses that way.
    fn fail(&mut self, robot: RobotId, now: Time) {
        self.record(Fact::Failed { robot, at: now });
        let task = self.ledger.robots[robot].task;
        if let (Task::Fetch { job, .. } | Task::Move { job: Some(job), .. }, Some(_)) = (task, task.job())
            && self.ledger.rack_on(robot).is_none()
        {
            let again = matches!(task, Task::Fetch { .. });
            let state = if again { JobState::Waiting } else { JobState::Assigned { robot } };
            if self.ledger.jobs.contains_key(&job) {
                self.record(Fact::Progressed { job, state, at: now });
            }
            if again {
                self.record(Fact::Tasked { robot, task: Task::Idle });
            }
        }
        self.cut_for(robot);
    }

    fn settle_progress(&mut self, robot: RobotId, reached: u64, now: Time) {
        let chain = self.ledger.chain(robot);
        let reached = reached.min(chain.granted() - 1);
        if reached <= chain.first() {
            return;
        }
        self.record(Fact::Passed { robot, serial: reached });
        let next = self.ledger.robots[robot].stops.first().copied();
        if let (Task::Deliver { job, .. }, Some(stop)) = (self.ledger.robots[robot].task, next)
            && matches!(stop.act, Act::Pick(_))
            && stop.serial == reached
        {
            self.progress(job, JobState::Picking { robot }, now);
        }
    }

    fn progress(&mut self, job: JobId, state: JobState, now: Time) {
        if self.ledger.jobs.contains_key(&job) {
            self.record(Fact::Progressed { job, state, at: now });
        }
    }

    /// The robot says that it did what it was to do at its next stop.
    fn settle_stop(&mut self, robot: RobotId, acted: Option<u64>, now: Time) {
        let Some(stop) = self.ledger.robots[robot].stops.first().copied() else { return };
        let there = self.ledger.chain(robot).first() == stop.serial;
        if !there || acted < Some(stop.serial) {
            return;
        }
        self.record(Fact::Acted { robot, serial: stop.serial });
        let task = self.ledger.robots[robot].task;
        match (stop.act, task) {
            (Act::Lift(rack), Task::Fetch { job, .. }) => self.lifted(robot, job, rack, now),
            (Act::Lift(rack), _) => self.put_away(robot, None, rack),
            (Act::Pick(_), Task::Deliver { job, rack, store, .. }) => {
                self.progress(job, JobState::Done, now);
                self.record(Fact::Tasked { robot, task: Task::Store { job: None, rack, store } });
                self.chain_next_delivery(robot, rack, store, now);
            }
            (Act::Set(_), Task::Store { job, .. }) => {
                self.record(Fact::Tasked { robot, task: Task::Idle });
                if let Some(job) = job {
                    self.progress(job, JobState::Done, now);
                }
            }
            (Act::Arrive, Task::Move { job, goal, stay, purpose }) => {
                self.arrived(robot, job, goal == stay, stay, purpose, now);
            }
            (Act::Set(_), Task::Deliver { job, .. }) => {
                // It was to go on to another station, but found no way there before it was back in storage.
                self.progress(job, JobState::Waiting, now);
                self.record(Fact::Tasked { robot, task: Task::Idle });
            }
            (Act::Pick(_) | Act::Set(_) | Act::Arrive, _) => {}
        }
    }

    fn lifted(&mut self, robot: RobotId, job: JobId, rack: RackId, now: Time) {
        let Some(record) = self.ledger.jobs.get(&job) else { return self.put_away(robot, None, rack) };
        match record.request.kind {
            JobKind::Deliver { station, .. } => {
                let station = self.warehouse().stations[station].node;
                let store = self.ledger.node_of(robot);
                self.progress(job, JobState::Carrying { robot }, now);
                self.record(Fact::Tasked { robot, task: Task::Deliver { job, rack, station, store } });
            }
            JobKind::Relocate { node, .. } => {
                self.progress(job, JobState::Carrying { robot }, now);
                let free = !self.storage_taken(node, rack);
                let store = if free { node } else { self.ledger.node_of(robot) };
                self.record(Fact::Tasked { robot, task: Task::Store { job: Some(job), rack, store } });
            }
            _ => {
                self.progress(job, JobState::Carrying { robot }, now);
                self.put_away(robot, Some(job), rack);
            }
        }
    }

    /// The rack goes to the best free storage node.
    fn put_away(&mut self, robot: RobotId, job: Option<JobId>, rack: RackId) {
        let here = self.ledger.node_of(robot);
        let store = self.best_storage(robot, rack, here, 0);
        self.record(Fact::Tasked { robot, task: Task::Store { job, rack, store } });
    }

    fn arrived(
        &mut self,
        robot: RobotId,
        job: Option<JobId>,
        is_end: bool,
        stay: crate::id::NodeId,
        purpose: Purpose,
        now: Time,
    ) {
        if let Some(job) = job {
            self.progress(job, JobState::Done, now);
        }
        let task = if is_end { Task::Idle } else { Task::Move { job: None, goal: stay, stay, purpose } };
        self.record(Fact::Tasked { robot, task });
    }

    /// If the rack that was just picked from is wanted at a station again, it need not be put away first.
    fn chain_next_delivery(&mut self, robot: RobotId, rack: RackId, store: crate::id::NodeId, now: Time) {
        let wanted = self.ledger.jobs.iter().filter(|(_, j)| j.state == JobState::Waiting);
        let same = wanted.filter(|(id, j)| {
            matches!(j.request.kind, JobKind::Deliver { rack: k, .. } if k == rack) && self.is_ready(**id)
        });
        let best =
            same.min_by_key(|(id, j)| (std::cmp::Reverse(j.request.priority), **id)).map(|(id, _)| *id);
        let Some(job) = best else { return };
        let JobKind::Deliver { station, .. } = self.ledger.jobs[&job].request.kind else { return };
        let station = self.warehouse().stations[station].node;
        self.progress(job, JobState::Carrying { robot }, now);
        self.record(Fact::Tasked { robot, task: Task::Deliver { job, rack, station, store } });
    }

    /// Notes that a robot is late, so that everybody who comes after it is planned with what is true.
    fn settle_delay(&mut self, robot: RobotId, now: Time) {
        let chain = self.ledger.chain(robot);
        let serial = chain.first();
        let (Some(here), Some(next)) = (chain.get(serial), chain.get(serial + 1)) else { return };
        if here.depart.is_forever() || next.arrive + LATE >= now {
            return;
        }
        let depart = here.depart + (now - next.arrive) + GUESS;
        let slip = self.ledger.timeline.delay(Holder::Robot(robot), serial, depart);
        let moved = slip.into_iter().map(|(h, shifts)| Moved { robot: robot_of(h), shifts });
        self.record(Fact::Delayed { moved: moved.collect() });
    }

    /// Jobs that wait for one that was cancelled or failed will never start; neither will those that wait for them.
    fn settle_orphans(&mut self, now: Time) {
        let mut i = 0;
        while let Some(fact) = self.out.facts.get(i) {
            i += 1;
            let Some(bad) = ended_badly(fact) else { continue };
            let orphans: Vec<JobId> = (self.ledger.jobs.iter())
                .filter(|(_, j)| j.state == JobState::Waiting && j.request.after.contains(&bad))
                .map(|(id, _)| *id)
                .collect();
            for job in orphans {
                let state = JobState::Failed(JobFailure::Predecessor(bad));
                self.record(Fact::Progressed { job, state, at: now });
            }
        }
    }

    /// Whether a robot standing on this node is at a charger.
    pub(super) fn at_charger(&self, robot: RobotId) -> bool {
        self.warehouse().nodes[self.ledger.node_of(robot)].kind == NodeKind::Charger
    }
}

fn ended_badly(fact: &Fact) -> Option<JobId> {
    match fact {
        Fact::Progressed { job, state: JobState::Cancelled | JobState::Failed(_), .. } => Some(*job),
        _ => None,
    }
}
