//! Third phase: what has come true? Places passed are free again, stops done lead to the next task, delays are noted.
//!
//! Refuses: to plan; a robot whose task has no route yet is picked up by the planning phase.

use crate::fleet::state::core::Core;
use crate::fleet::state::fact::{Act, Moved, Purpose, RobotFact, RouteFact, Task};
use crate::fleet::state::floor::Floor;
use crate::fleet::state::job::{JobFailure, JobState};
use crate::fleet::state::job_kind::JobKind;
use crate::fleet::traffic::failure::fail;
use crate::fleet::traffic::revoke::note_revoked;
use crate::fleet::traffic::state::Traffic;
use crate::id::{JobId, NodeId, RackId, RobotId};
use crate::time::{Span, Time};

/// A robot this much behind its plan is late.
const LATE: Span = Span::from_millis(1500);
/// A late robot is expected to need this much longer than now.
const GUESS: Span = Span::from_millis(1000);
/// So many jobs that come after one that ended badly fail in one step.
pub(in crate::fleet) const ORPHANS_PER_STEP: usize = 64;

impl Traffic {
    /// Takes what robots report into the ledger. Gives the robots that were taken up where they were not expected.
    pub(in crate::fleet) fn note_progress(&mut self, core: &mut Core, now: Time) -> Vec<RobotId> {
        let mut taken_up = Vec::new();
        for robot in core.ledger.present() {
            core.at_hand.note(robot);
            let Some(seen) = core.scene.robot(robot).copied() else { continue };
            // What a robot reports that is fenced off would only meet the same contradiction.
            if core.ledger.robots[robot].fenced.is_some() {
                self.note_place(core, robot, &seen, now);
                continue;
            }
            note_health(core, robot, seen.cannot_drive(), now);
            note_passed(core, robot, seen.reached, now);
            note_revoked(core, robot, &seen, now);
            note_stop(core, robot, seen.acted, now);
            if self.note_place(core, robot, &seen, now) {
                taken_up.push(robot);
            }
            note_delay(core, robot, now);
        }
        core.at_hand.clear();
        fail_orphans(core, now);
        taken_up
    }
}

fn note_health(core: &mut Core, robot: RobotId, failed: bool, now: Time) {
    match (core.ledger.robots[robot].failed, failed) {
        (false, true) => fail(core, robot, now),
        // A displaced robot counts as failed; one that was not heard of since a start may be displaced.
        (true, false) if core.scene.is_placed(robot) => core.record(RobotFact::Repaired { robot, at: now }),
        _ => {}
    }
}

fn note_passed(core: &mut Core, robot: RobotId, reached: u64, now: Time) {
    let chain = core.ledger.chain(robot);
    let reached = reached.min(chain.granted() - 1);
    if reached <= chain.first() {
        return;
    }
    core.record(RouteFact::Passed { robot, serial: reached });
    let next = core.ledger.robots[robot].stops.first().copied();
    if let (Task::Deliver { job, .. }, Some(stop)) = (core.ledger.robots[robot].task, next)
        && matches!(stop.act, Act::Pick(_))
        && stop.serial == reached
        && core.ledger.jobs[&job].state == (JobState::Carrying { robot })
    {
        core.progress(job, JobState::Picking { robot }, None, now);
    }
}

/// The robot says that it did what it was to do at its next stop.
fn note_stop(core: &mut Core, robot: RobotId, acted: Option<u64>, now: Time) {
    let Some(stop) = core.ledger.robots[robot].stops.first().copied() else { return };
    let there = core.ledger.chain(robot).first() == stop.serial;
    // The station says when a pick has ended.
    if !there || acted < Some(stop.serial) || matches!(stop.act, Act::Pick(_)) {
        return;
    }
    core.record(RouteFact::Acted { robot, serial: stop.serial });
    let task = core.ledger.robots[robot].task;
    match (stop.act, task) {
        (Act::Lift(rack), Task::Fetch { job: Some(job), .. }) => lifted(core, robot, job, rack, now),
        (Act::Lift(rack), Task::Fetch { job: None, .. }) => {
            let task = core.floor().put_away(robot, None, rack);
            core.record(RobotFact::Tasked { robot, task });
        }
        (Act::Set(_), Task::Store { job: None, .. }) => {
            core.record(RobotFact::Tasked { robot, task: Task::Idle });
        }
        (Act::Set(_), Task::Store { job: Some(job), .. }) => {
            core.progress(job, JobState::Done, Some((robot, Task::Idle)), now);
        }
        (Act::Arrive, Task::Move { job, goal, stay, purpose }) if goal == core.ledger.node_of(robot) => {
            arrived(core, robot, job, goal == stay, stay, purpose, now);
        }
        (Act::Set(_), Task::Deliver { job, .. }) => {
            // It was to go on to another station, but found no way there before it was back in storage.
            core.progress(job, JobState::Waiting, Some((robot, Task::Idle)), now);
        }
        // What was granted is done although the job was cancelled meanwhile.
        (Act::Pick(_) | Act::Arrive, _) => {}
        (Act::Lift(_) | Act::Set(_), task) => panic!("{robot:?} did {:?} during {task:?}", stop.act),
    }
}

fn lifted(core: &mut Core, robot: RobotId, job: JobId, rack: RackId, now: Time) {
    let here = core.ledger.node_of(robot);
    let task = match core.ledger.jobs[&job].request.kind {
        JobKind::Deliver { station, .. } => {
            let station = core.warehouse().stations[station].node;
            Task::Deliver { job, rack, station, store: here }
        }
        JobKind::Relocate { node, .. } if core.floor().storage_taken(node, rack) => {
            let state = JobState::Failed(JobFailure::StorageTaken(node));
            let task = core.floor().put_away(robot, None, rack);
            return core.progress(job, state, Some((robot, task)), now);
        }
        JobKind::Relocate { node, .. } => Task::Store { job: Some(job), rack, store: node },
        _ => core.floor().put_away(robot, Some(job), rack),
    };
    core.progress(job, JobState::Carrying { robot }, Some((robot, task)), now);
}

fn arrived(
    core: &mut Core,
    robot: RobotId,
    job: Option<JobId>,
    is_end: bool,
    stay: NodeId,
    purpose: Purpose,
    now: Time,
) {
    let task = if is_end { Task::Idle } else { Task::rest_at(stay, purpose) };
    match job {
        Some(job) => core.progress(job, JobState::Done, Some((robot, task)), now),
        None => core.record(RobotFact::Tasked { robot, task }),
    }
}

/// Notes that a robot is late, so that every robot that comes after it is planned with what is true.
fn note_delay(core: &mut Core, robot: RobotId, now: Time) {
    let chain = core.ledger.chain(robot);
    let serial = chain.first();
    let (Some(here), Some(next)) = (chain.get(serial), chain.get(serial + 1)) else { return };
    if here.depart.is_forever() || next.arrive + LATE >= now {
        return;
    }
    let depart = here.depart + (now - next.arrive) + GUESS;
    let slip = core.ledger.timeline().delay(robot, serial, depart);
    let moved = slip.into_iter().map(|(h, shifts)| Moved { robot: h, shifts });
    debug_assert!(depart > core.floor().ledger.chain(robot).get(serial).expect("it stands there").depart);
    core.record(RouteFact::Retimed { moved: moved.collect() });
}

/// Jobs that come after one that was cancelled or failed will never start; neither will those that come after
/// them. They fail a few in each step, so that the journal keeps up. The ledger knows meanwhile which ones have
/// to, over a restart as well, and none of them starts.
fn fail_orphans(core: &mut Core, now: Time) {
    for _ in 0..ORPHANS_PER_STEP {
        let Some((job, bad)) = core.ledger.index().waits.next_doomed() else { return };
        let state = JobState::Failed(JobFailure::Predecessor(bad));
        core.progress(job, state, None, now);
    }
}

impl Floor<'_> {
    /// To bring the rack to the best free storage node.
    fn put_away(&self, robot: RobotId, job: Option<JobId>, rack: RackId) -> Task {
        let here = self.ledger.node_of(robot);
        Task::Store { job, rack, store: self.best_storage(robot, rack, here, 0) }
    }
}
