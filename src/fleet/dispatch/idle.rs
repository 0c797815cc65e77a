//! Robots that could do something, and the jobs that ask for one by name.
//!
//! Refuses: to say which of them has the charge for a job.

use crate::state::fact::Task;
use crate::state::floor::Floor;
use crate::state::ledger::Service;
use giveway_floor::id::{JobId, RobotId};
use giveway_floor::time::Time;
use std::cmp::Reverse;

impl Floor<'_> {
    /// Robots that have nothing to do and could do something.
    pub(crate) fn idle_robots(&self, now: Time) -> Vec<RobotId> {
        let idle = |r: &RobotId| {
            let record = &self.ledger.robots[*r];
            let fit = !record.failed && !self.is_halted(*r) && self.scene.fit(*r, now).is_some();
            record.task == Task::Idle && record.service == Service::Works && fit
        };
        self.ledger.present().filter(idle).collect()
    }

    /// The job that a robot is to do next by name: the most urgent one; nothing if none can start.
    pub fn named_job_for(&self, robot: RobotId) -> Option<JobId> {
        let index = self.ledger.index();
        let mut ready = index.named_for(robot).filter(|id| !index.waits.is_blocked(*id)).peekable();
        ready.peek()?;
        ready.max_by_key(|id| (self.named_urgency_ms(*id), Reverse(*id)))
    }

    /// How urgent a waiting job is among those that name robots, milliseconds.
    pub(crate) fn named_urgency_ms(&self, job: JobId) -> i64 {
        let queue = &self.ledger.index().queue;
        let now = queue.as_of();
        queue.urgency_ms(job, now, &queue.oldest(now))
    }
}
