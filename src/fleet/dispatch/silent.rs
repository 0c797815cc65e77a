//! Robots that cannot be reached give their jobs back, and other robots do them.
//!
//! Main function: [`give_back_silent`]. Refuses: to take a job from a robot that may be about to lift its rack, or
//! whose whole link is down: all robots would lose their jobs to none.

use crate::state::fact::{Purpose, Task};
use crate::state::floor::Floor;
use crate::state::job::JobState;
use crate::state::link::LinkReach;
use crate::state::writer::Writer;
use giveway_floor::id::{JobId, RobotId};
use giveway_floor::time::{Span, Time};

/// A robot that was not heard of for this long will not fetch its rack soon. Robots of other vendors are asked for a
/// state every 30 s and have 5 s to answer.
pub(crate) const GIVES_BACK: Span = Span::from_secs(35);

/// Has robots that were silent for long give back jobs that they have not begun.
pub(crate) fn give_back_silent(writer: &mut Writer, now: Time) {
    for robot in writer.ledger().present() {
        if let Some((job, task)) = writer.floor().instead_of_silent(robot, now) {
            writer.progress(job, JobState::Waiting, Some((robot, task)), now);
        }
    }
}

impl Floor<'_> {
    /// The job that a silent robot gives back, and where it is to stay when it is heard of again.
    fn instead_of_silent(&self, robot: RobotId, now: Time) -> Option<(JobId, Task)> {
        let Task::Fetch { job: Some(job), .. } = self.ledger.robots[robot].task else { return None };
        let is_down = self.scene.reach(robot) == LinkReach::LineDown;
        if is_down || self.scene.is_heard(robot, now) || self.next_stop_is_granted(robot) {
            return None;
        }
        let since = self.scene.silent_since(robot).or(self.scene.began())?;
        let is_long = now - since >= GIVES_BACK;
        is_long.then_some((job, Task::rest_at(self.any_stay(robot)?, Purpose::Park)))
    }
}
