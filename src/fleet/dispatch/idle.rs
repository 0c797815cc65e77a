//! Robots that could do something, and the jobs that ask for one by name.
//!
//! Refuses: to say which of them has the charge for a job.

use crate::fleet::state::fact::Task;
use crate::fleet::state::floor::Floor;
use crate::fleet::state::job::Job;
use crate::fleet::state::ledger::Service;
use crate::id::{JobId, RobotId};
use crate::time::Time;

impl Floor<'_> {
    /// Robots with nothing to do that could do something.
    pub(in crate::fleet) fn idle_robots(&self, now: Time) -> Vec<RobotId> {
        let idle = |r: &RobotId| {
            let record = &self.ledger.robots[*r];
            let fit = !record.failed && !self.is_halted(*r) && self.scene.fit(*r, now).is_some();
            record.task == Task::Idle && record.service == Service::Works && fit
        };
        self.ledger.present().filter(idle).collect()
    }

    /// The job that a robot is to do next by name: the highest priority first, then the nearest deadline, then the
    /// oldest. Nothing where none can start.
    pub(in crate::fleet) fn named_job_for(&self, robot: RobotId) -> Option<JobId> {
        let named = self.ledger.index().named_for(robot).map(|id| (id, &self.ledger.jobs[&id]));
        let ready = named.filter(|(id, _)| !self.ledger.index().waits.is_blocked(*id));
        let rank = |j: &Job| (std::cmp::Reverse(j.request.priority), j.request.deadline.unwrap_or(Time::MAX));
        ready.min_by_key(|(id, j)| (rank(j), *id)).map(|(id, _)| id)
    }
}
