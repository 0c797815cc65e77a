//! Robots whose jobs cannot go on because of one that cannot drive: they give the jobs back and do others meanwhile.
//!
//! Main function: [`give_back_blocked`]. Refuses: to touch a robot that stands elsewhere with its rack; traffic brings
//! it to storage first.

use crate::state::fact::{Purpose, Task};
use crate::state::floor::Floor;
use crate::state::job::JobState;
use crate::state::needs::Needs;
use crate::state::writer::Writer;
use giveway_floor::id::{JobId, RobotId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::NodeKind;

/// A robot that has not found a way past a broken robot for this long sets its rack down.
const LONG: Span = Span::from_secs(60);

/// Robots that stand with their racks in storage, and cannot go on because of one that cannot drive, set them down
/// there after a while. No robot goes on to fetch another rack past it. The jobs wait until the way is clear, or a
/// robot on the right side does them.
pub(crate) fn give_back_blocked(writer: &mut Writer, needs: &Needs, now: Time) {
    if writer.restrictions.cut_off.is_empty() {
        return;
    }
    for robot in writer.ledger().present() {
        if let Some((job, task)) = writer.floor().instead_of_blocked(robot, needs, now) {
            writer.progress(job, JobState::Waiting, Some((robot, task)), now);
        }
    }
}

impl Floor<'_> {
    /// The job that a robot gives back because the way is blocked, and what it does instead.
    fn instead_of_blocked(&self, robot: RobotId, needs: &Needs, now: Time) -> Option<(JobId, Task)> {
        if self.scene.fit(robot, now).is_none() || self.next_stop_is_granted(robot) {
            return None;
        }
        let task = self.ledger.robots[robot].task;
        let (job, here) = (task.job()?, self.ledger.node_of(robot));
        let (cut_off, kind) = (&self.restrictions.cut_off, &self.ledger.jobs[&job].request.kind);
        let rests = self.warehouse().kind(here) == NodeKind::Storage && self.lacks_route(robot);
        let waits_long = rests && needs.waited(robot, now) > LONG;
        let is_station_blocked = || kind.station().is_some_and(|s| cut_off.blocks_for_long(s, now).is_some());
        let is_way_blocked = |from| cut_off.blocks_job(self.warehouse(), kind, from).is_some();
        match task {
            Task::Fetch { node, .. } => {
                let is_cut_off = self.lacks_route(robot) && !cut_off.may_fetch(here, node);
                if !is_station_blocked() && !is_way_blocked(node) && !is_cut_off {
                    return None;
                }
                let stay = || Some(Task::rest_at(self.any_stay(robot)?, Purpose::Park));
                Some((job, if rests { Task::Idle } else { stay()? }))
            }
            Task::Deliver { rack, .. } | Task::Store { rack, .. } => {
                let is_in_vain = rests && is_station_blocked() || waits_long && is_way_blocked(here);
                // While it was to bring the rack elsewhere, the place may have been promised to another rack.
                let may_stay = is_in_vain && !self.is_taken_storage(here, rack, robot);
                may_stay.then_some((job, Task::Store { job: None, rack, store: here }))
            }
            Task::Idle | Task::Move { .. } => None,
        }
    }
}
