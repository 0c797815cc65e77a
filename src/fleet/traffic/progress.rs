//! Third phase: what has come true? Passed nodes become free, finished stops lead to the next task, delays are noted.
//!
//! Refuses: to plan; a robot whose task has no route yet is picked up by the planning phase.

use crate::state::fact::{Act, Moved, Purpose, RobotFact, RouteFact, Task};
use crate::state::floor::Floor;
use crate::state::job::{JobFailure, JobState};
use crate::state::job_kind::JobKind;
use crate::state::writer::Writer;
use crate::traffic::displaced::take_up;
use crate::traffic::failure::fail;
use crate::traffic::revoke::note_revoked;
use crate::traffic::state::Traffic;
use giveway_floor::id::{JobId, NodeId, RackId, RobotId};
use giveway_floor::time::{Span, Time};

/// A robot this much behind its plan is late.
const LATE: Span = Span::from_millis(1500);
/// A late robot is expected to need this much longer than now.
const GUESS: Span = Span::from_millis(1000);
/// How many jobs at most fail in one step because a job before them was cancelled or failed.
pub const ORPHANS_PER_STEP: usize = 64;

impl Traffic {
    /// Takes the robots' reports into the ledger. Returns the robots that were taken up where they were not expected.
    pub(crate) fn note_progress(&mut self, writer: &mut Writer, now: Time) -> Vec<RobotId> {
        let mut taken_up = Vec::new();
        for robot in writer.ledger().present() {
            writer.at_hand.note(robot);
            let Some(seen) = writer.scene.robot(robot).copied() else { continue };
            // The reports of a fenced-off robot would only meet the same contradiction.
            if writer.ledger().robots[robot].fenced.is_some() {
                self.note_place(writer, robot, &seen, now);
                continue;
            }
            note_health(writer, robot, seen.cannot_drive(), now);
            note_passed(writer, robot, seen.reached, now);
            note_revoked(writer, robot, &seen, now);
            note_stop(writer, robot, seen.acted, now);
            note_failed_lift(writer, robot, now);
            if self.note_place(writer, robot, &seen, now) {
                taken_up.push(robot);
            }
            note_delay(writer, robot, now);
        }
        writer.at_hand.clear();
        fail_orphans(writer, now);
        taken_up
    }
}

fn note_health(writer: &mut Writer, robot: RobotId, failed: bool, now: Time) {
    match (writer.ledger().robots[robot].failed, failed) {
        (false, true) => fail(writer, robot, now),
        // A displaced robot counts as failed; a robot that has not been heard of since a start may be displaced.
        (true, false) if writer.scene.is_placed(robot) => {
            writer.record(RobotFact::Repaired { robot, at: now })
        }
        _ => {}
    }
}

fn note_passed(writer: &mut Writer, robot: RobotId, reached: u64, now: Time) {
    let chain = writer.ledger().chain(robot);
    let reached = reached.min(chain.granted() - 1);
    if reached <= chain.first() {
        return;
    }
    writer.record(RouteFact::Passed { robot, serial: reached });
    let next = writer.ledger().robots[robot].stops.first().copied();
    if let (Task::Deliver { job, .. }, Some(stop)) = (writer.ledger().robots[robot].task, next)
        && matches!(stop.act, Act::Pick(_))
        && stop.serial == reached
        && writer.ledger().jobs[&job].state == (JobState::Carrying { robot })
    {
        writer.progress(job, JobState::Picking { robot }, None, now);
    }
}

/// Takes a robot's report that it finished its action at its next stop.
fn note_stop(writer: &mut Writer, robot: RobotId, acted: Option<u64>, now: Time) {
    let Some(stop) = writer.ledger().robots[robot].stops.first().copied() else { return };
    let there = writer.ledger().chain(robot).first() == stop.serial;
    // The station, not the robot, says when a pick has ended.
    if !there || acted < Some(stop.serial) || matches!(stop.act, Act::Pick(_)) {
        return;
    }
    writer.record(RouteFact::Acted { robot, serial: stop.serial });
    let task = writer.ledger().robots[robot].task;
    match (stop.act, task) {
        (Act::Lift(rack), Task::Fetch { job: Some(job), .. }) => lifted(writer, robot, job, rack, now),
        (Act::Lift(rack), Task::Fetch { job: None, .. }) => {
            let task = writer.floor().put_away(robot, None, rack);
            writer.record(RobotFact::Tasked { robot, task });
        }
        (Act::Set(_), Task::Store { job: None, .. }) => {
            writer.record(RobotFact::Tasked { robot, task: Task::Idle });
        }
        (Act::Set(_), Task::Store { job: Some(job), .. }) => {
            writer.progress(job, JobState::Done, Some((robot, Task::Idle)), now);
        }
        (Act::Arrive, Task::Move { job, goal, stay, purpose }) if goal == writer.ledger().node_of(robot) => {
            arrived(writer, robot, job, goal == stay, stay, purpose, now);
        }
        (Act::Set(_), Task::Deliver { job, .. }) => {
            // The robot was to go on to another station, but found no way there before it was back in storage.
            writer.progress(job, JobState::Waiting, Some((robot, Task::Idle)), now);
        }
        // A granted stop is done even if the job was cancelled meanwhile.
        (Act::Pick(_) | Act::Arrive, _) => {}
        (Act::Lift(_) | Act::Set(_), task) => panic!("{robot:?} did {:?} during {task:?}", stop.act),
    }
}

/// Takes the word of a robot's link that the robot could not lift its rack: it is booked where it stands, without the
/// stop, and other robots may do the job.
fn note_failed_lift(writer: &mut Writer, robot: RobotId, now: Time) {
    let Some(stop) = writer.ledger().robots[robot].stops.first().copied() else { return };
    let failed = writer.scene.link(robot).and_then(|link| link.failed_stop) == Some(stop.serial);
    let there = writer.ledger().chain(robot).first() == stop.serial;
    if failed && there && matches!(stop.act, Act::Lift(_)) {
        let node = writer.ledger().node_of(robot);
        take_up(writer, robot, node, now);
    }
}

fn lifted(writer: &mut Writer, robot: RobotId, job: JobId, rack: RackId, now: Time) {
    let here = writer.ledger().node_of(robot);
    let task = match writer.ledger().jobs[&job].request.kind {
        JobKind::Deliver { station, .. } => {
            let station = writer.warehouse().stations[station].node;
            Task::Deliver { job, rack, station, store: here }
        }
        JobKind::Relocate { node, .. } if writer.floor().storage_taken(node, rack) => {
            let state = JobState::Failed(JobFailure::StorageTaken(node));
            let task = writer.floor().put_away(robot, None, rack);
            return writer.progress(job, state, Some((robot, task)), now);
        }
        JobKind::Relocate { node, .. } => Task::Store { job: Some(job), rack, store: node },
        _ => writer.floor().put_away(robot, Some(job), rack),
    };
    writer.progress(job, JobState::Carrying { robot }, Some((robot, task)), now);
}

fn arrived(
    writer: &mut Writer,
    robot: RobotId,
    job: Option<JobId>,
    is_end: bool,
    stay: NodeId,
    purpose: Purpose,
    now: Time,
) {
    let task = if is_end { Task::Idle } else { Task::rest_at(stay, purpose) };
    match job {
        Some(job) => writer.progress(job, JobState::Done, Some((robot, task)), now),
        None => writer.record(RobotFact::Tasked { robot, task }),
    }
}

/// Notes that a robot is late, so that every robot behind it is planned with its true times.
fn note_delay(writer: &mut Writer, robot: RobotId, now: Time) {
    let chain = writer.ledger().chain(robot);
    let serial = chain.first();
    let (Some(here), Some(next)) = (chain.get(serial), chain.get(serial + 1)) else { return };
    if here.depart.is_forever() || next.arrive + LATE >= now {
        return;
    }
    let depart = here.depart + (now - next.arrive) + GUESS;
    let slip = writer.ledger().timeline().delay(robot, serial, depart);
    let moved = slip.into_iter().map(|(h, shifts)| Moved { robot: h, shifts });
    debug_assert!(depart > writer.floor().ledger.chain(robot).get(serial).expect("it stands there").depart);
    writer.record(RouteFact::Retimed { moved: moved.collect() });
}

/// Jobs behind a job that was cancelled or failed never start; neither do the jobs behind them. A few of them fail in
/// each step, so that the journal keeps up. Meanwhile, and over a restart, the ledger knows which jobs are still to
/// fail, and none of them starts.
fn fail_orphans(writer: &mut Writer, now: Time) {
    for _ in 0..ORPHANS_PER_STEP {
        let Some((job, bad)) = writer.ledger().index().waits.next_doomed() else { return };
        let state = JobState::Failed(JobFailure::Predecessor(bad));
        writer.progress(job, state, None, now);
    }
}

impl Floor<'_> {
    /// The task to bring a rack to the best free storage node.
    fn put_away(&self, robot: RobotId, job: Option<JobId>, rack: RackId) -> Task {
        let here = self.ledger.node_of(robot);
        Task::Store { job, rack, store: self.best_storage(robot, rack, here, 0) }
    }
}
