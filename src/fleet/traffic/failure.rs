//! Robots that have stopped for good: what others take over from them, which routes that changes, and what they cut
//! off.
//!
//! Refuses: to say when a robot has failed.

use crate::state::cut_off::CutOff;
use crate::state::fact::{Purpose, RobotFact, Task};
use crate::state::floor::Floor;
use crate::state::job::JobState;
use crate::state::writer::Writer;
use crate::traffic::truncate::truncate_behind;
use giveway_floor::id::RobotId;
use giveway_floor::time::Time;

/// A robot stops for good: its job goes to another robot if it can no longer lift the rack, and all robots whose routes
/// lead over its place lose those routes.
pub(super) fn fail(writer: &mut Writer, robot: RobotId, now: Time) {
    assert!(!writer.ledger().robots[robot].failed, "{robot:?} fails twice");
    writer.record(RobotFact::Failed { robot, at: now });
    give_up(writer, robot, now);
}

/// Gives up what others can take over from a robot that has stopped for good, and the routes of the robots behind it.
pub(crate) fn give_up(writer: &mut Writer, robot: RobotId, now: Time) {
    let task = writer.ledger().robots[robot].task;
    if !writer.floor().next_stop_is_granted(robot) {
        match task {
            Task::Fetch { job: Some(job), .. } => {
                writer.progress(job, JobState::Waiting, Some((robot, Task::Idle)), now);
            }
            // The robot's place at a charger or to park becomes free for another robot.
            Task::Move { job: None, .. } => writer.record(RobotFact::Tasked { robot, task: Task::Idle }),
            Task::Move { job: Some(job), purpose: Purpose::Charge | Purpose::Park, .. } => {
                writer.progress(job, JobState::Waiting, Some((robot, Task::Idle)), now);
            }
            _ => {}
        }
    }
    truncate_behind(writer, robot);
}

/// Stations and storage nodes that are cut off by closed areas and by robots that cannot drive; nothing if that has not
/// changed.
pub(crate) fn cut_off_anew(floor: Floor<'_>, now: Time) -> Option<CutOff> {
    let closed = floor.restrictions.areas.closed_by();
    floor.restrictions.cut_off.anew(floor.ledger, floor.scene, closed, now)
}
