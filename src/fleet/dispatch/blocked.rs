//! Robots whose jobs cannot go on because of a robot that cannot drive give them back and do others meanwhile.
//!
//! Main function: [`give_back_blocked`]. Refuses: to touch a robot that has lifted its rack; traffic has it set that
//! down first.

use crate::state::fact::{Purpose, Task};
use crate::state::floor::Floor;
use crate::state::job::JobState;
use crate::state::writer::Writer;
use giveway_floor::id::{JobId, RobotId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::NodeKind;

/// No robot goes on to fetch a rack for a job that cannot go on: it gives the job back, which waits until the way is
/// clear, or until a robot on the right side does it.
pub(crate) fn give_back_blocked(writer: &mut Writer, now: Time) {
    if writer.restrictions.cut_off.is_empty() {
        return;
    }
    for robot in writer.ledger().present() {
        if let Some((job, task)) = writer.floor().instead_of_blocked(robot, now) {
            writer.progress(job, JobState::Waiting, Some((robot, task)), now);
        }
    }
}

impl Floor<'_> {
    /// The job for which a robot does not fetch the rack because the way is blocked, and what it does instead.
    fn instead_of_blocked(&self, robot: RobotId, now: Time) -> Option<(JobId, Task)> {
        if self.scene.fit(robot, now).is_none() || self.next_stop_is_granted(robot) {
            return None;
        }
        let Task::Fetch { job: Some(job), node, .. } = self.ledger.robots[robot].task else { return None };
        let here = self.ledger.node_of(robot);
        let (cut_off, kind) = (&self.restrictions.cut_off, &self.ledger.jobs[&job].request.kind);
        let is_station_blocked = kind.station().is_some_and(|s| cut_off.blocks_for_long(s, now).is_some());
        let is_way_blocked = || cut_off.blocks_job(self.warehouse(), kind, node).is_some();
        let is_cut_off = || self.lacks_route(robot) && !cut_off.may_fetch(here, node);
        if !is_station_blocked && !is_way_blocked() && !is_cut_off() {
            return None;
        }
        let rests = self.warehouse().kind(here) == NodeKind::Storage && self.lacks_route(robot);
        let instead = if rests { Task::Idle } else { Task::rest_at(self.any_stay(robot)?, Purpose::Park) };
        Some((job, instead))
    }
}
