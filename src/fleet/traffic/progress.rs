//! Second phase: what has come true? Places passed are free again, stops done lead to the next task, delays are noted.
//!
//! Refuses: to plan; a robot whose task has no route yet is picked up by the planning phase.

use crate::fleet::Fleet;
use crate::fleet::state::fact::{Act, Fact, Moved, Purpose, Task};
use crate::fleet::state::floor::Floor;
use crate::fleet::state::job::{JobFailure, JobKind, JobState};
use crate::fleet::state::ledger;
use crate::fleet::traffic::truncate::robot_of;
use crate::id::{JobId, NodeId, RackId, RobotId};
use crate::time::{Span, Time};
use crate::timeline::Holder;
use crate::warehouse::NodeKind;

/// A robot this much behind its plan is late.
const LATE: Span = Span::from_millis(1500);
/// A late robot is expected to need this much longer than now.
const GUESS: Span = Span::from_millis(1000);
/// So many jobs that come after one that ended badly fail in one step.
pub(in crate::fleet) const ORPHANS_PER_STEP: usize = 64;

impl Fleet {
    pub(in crate::fleet) fn note_progress(&mut self, now: Time) {
        for robot in ledger::all(&self.ledger.robots) {
            self.at_hand = Some(robot);
            let Some(seen) = self.scene.robot(robot).copied() else { continue };
            // What a robot reports that is fenced off would only meet the same contradiction.
            if self.ledger.robots[robot].fenced.is_some() {
                self.note_place(robot, &seen, now);
                continue;
            }
            self.note_health(robot, seen.cannot_drive(), now);
            self.note_passed(robot, seen.reached, now);
            self.note_revoked(robot, &seen, now);
            self.note_stop(robot, seen.acted, now);
            self.note_place(robot, &seen, now);
            self.note_delay(robot, now);
        }
        self.at_hand = None;
        self.fail_orphans(now);
    }

    fn note_health(&mut self, robot: RobotId, failed: bool, now: Time) {
        match (self.ledger.robots[robot].failed, failed) {
            (false, true) => self.fail(robot, now),
            // A displaced robot counts as failed; one that was not heard of since a start may be displaced.
            (true, false) if self.scene.is_placed(robot) => self.record(Fact::Repaired { robot, at: now }),
            _ => {}
        }
    }

    /// A robot stops for good: its job goes to another if it cannot lift the rack any more, and all robots whose way
    /// leads over its place lose that way.
    pub(super) fn fail(&mut self, robot: RobotId, now: Time) {
        self.record(Fact::Failed { robot, at: now });
        self.give_up(robot, now);
    }

    /// What others take over from a robot that stands for good.
    pub(in crate::fleet) fn give_up(&mut self, robot: RobotId, now: Time) {
        if let Task::Fetch { job: Some(job), .. } = self.ledger.robots[robot].task
            && !self.floor().next_stop_is_granted(robot)
        {
            self.progress(job, JobState::Waiting, Some((robot, Task::Idle)), now);
        }
        self.truncate_behind(robot);
    }

    fn note_passed(&mut self, robot: RobotId, reached: u64, now: Time) {
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
            && self.ledger.jobs[&job].state == (JobState::Carrying { robot })
        {
            self.progress(job, JobState::Picking { robot }, None, now);
        }
    }

    /// A job comes to another state, and its robot to another task with it.
    pub(in crate::fleet) fn progress(
        &mut self,
        job: JobId,
        state: JobState,
        tasked: Option<(RobotId, Task)>,
        now: Time,
    ) {
        self.record(Fact::Progressed { job, state, tasked, at: now });
    }

    /// The robot says that it did what it was to do at its next stop.
    fn note_stop(&mut self, robot: RobotId, acted: Option<u64>, now: Time) {
        let Some(stop) = self.ledger.robots[robot].stops.first().copied() else { return };
        let there = self.ledger.chain(robot).first() == stop.serial;
        // The station says when a pick has ended.
        if !there || acted < Some(stop.serial) || matches!(stop.act, Act::Pick(_)) {
            return;
        }
        self.record(Fact::Acted { robot, serial: stop.serial });
        let task = self.ledger.robots[robot].task;
        match (stop.act, task) {
            (Act::Lift(rack), Task::Fetch { job: Some(job), .. }) => self.lifted(robot, job, rack, now),
            (Act::Lift(rack), Task::Fetch { job: None, .. }) => {
                let task = self.put_away(robot, None, rack);
                self.record(Fact::Tasked { robot, task });
            }
            (Act::Set(_), Task::Store { job: None, .. }) => {
                self.record(Fact::Tasked { robot, task: Task::Idle });
            }
            (Act::Set(_), Task::Store { job: Some(job), .. }) => {
                self.progress(job, JobState::Done, Some((robot, Task::Idle)), now);
            }
            (Act::Arrive, Task::Move { job, goal, stay, purpose }) if goal == self.ledger.node_of(robot) => {
                self.arrived(robot, job, goal == stay, stay, purpose, now);
            }
            (Act::Set(_), Task::Deliver { job, .. }) => {
                // It was to go on to another station, but found no way there before it was back in storage.
                self.progress(job, JobState::Waiting, Some((robot, Task::Idle)), now);
            }
            // What was granted is done although the job was cancelled meanwhile.
            (Act::Pick(_) | Act::Arrive, _) => {}
            (Act::Lift(_) | Act::Set(_), task) => panic!("{robot:?} did {:?} during {task:?}", stop.act),
        }
    }

    fn lifted(&mut self, robot: RobotId, job: JobId, rack: RackId, now: Time) {
        let here = self.ledger.node_of(robot);
        let task = match self.ledger.jobs[&job].request.kind {
            JobKind::Deliver { station, .. } => {
                let station = self.warehouse().stations[station].node;
                Task::Deliver { job, rack, station, store: here }
            }
            JobKind::Relocate { node, .. } if self.floor().storage_taken(node, rack) => {
                let state = JobState::Failed(JobFailure::StorageTaken(node));
                let task = self.put_away(robot, None, rack);
                return self.progress(job, state, Some((robot, task)), now);
            }
            JobKind::Relocate { node, .. } => Task::Store { job: Some(job), rack, store: node },
            _ => self.put_away(robot, Some(job), rack),
        };
        self.progress(job, JobState::Carrying { robot }, Some((robot, task)), now);
    }

    /// To bring the rack to the best free storage node.
    fn put_away(&self, robot: RobotId, job: Option<JobId>, rack: RackId) -> Task {
        let here = self.ledger.node_of(robot);
        Task::Store { job, rack, store: self.best_storage(robot, rack, here, 0) }
    }

    fn arrived(
        &mut self,
        robot: RobotId,
        job: Option<JobId>,
        is_end: bool,
        stay: NodeId,
        purpose: Purpose,
        now: Time,
    ) {
        let task = if is_end { Task::Idle } else { Task::Move { job: None, goal: stay, stay, purpose } };
        match job {
            Some(job) => self.progress(job, JobState::Done, Some((robot, task)), now),
            None => self.record(Fact::Tasked { robot, task }),
        }
    }

    /// If the rack that was just picked from is wanted at a station again, it need not be put away first.
    pub(in crate::fleet) fn chain_next_delivery(
        &mut self,
        robot: RobotId,
        rack: RackId,
        store: NodeId,
        now: Time,
    ) {
        if self.floor().named_job_for(robot).is_some() || self.floor().is_critical(robot) {
            return;
        }
        let Some(job) = self.ledger.index.queue.next_delivery(rack) else { return };
        let JobKind::Deliver { station, .. } = self.ledger.jobs[&job].request.kind else { return };
        let station = self.warehouse().stations[station].node;
        let task = Task::Deliver { job, rack, station, store };
        self.progress(job, JobState::Carrying { robot }, Some((robot, task)), now);
    }

    /// Notes that a robot is late, so that everybody who comes after it is planned with what is true.
    fn note_delay(&mut self, robot: RobotId, now: Time) {
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

    /// Jobs that come after one that was cancelled or failed will never start; neither will those that come after
    /// them. They fail a few in each step, so that the journal keeps up. The ledger knows meanwhile which ones have
    /// to, over a restart as well, and none of them starts.
    fn fail_orphans(&mut self, now: Time) {
        for _ in 0..ORPHANS_PER_STEP {
            let Some((job, bad)) = self.ledger.index.waits.next_doomed() else { return };
            let state = JobState::Failed(JobFailure::Predecessor(bad));
            self.progress(job, state, None, now);
        }
    }
}

impl Floor<'_> {
    /// Whether a robot standing on this node is at a charger.
    pub(in crate::fleet) fn at_charger(&self, robot: RobotId) -> bool {
        self.warehouse().nodes[self.ledger.node_of(robot)].kind == NodeKind::Charger
    }
}
