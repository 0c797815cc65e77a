//! An operator takes a job from its robot, or gives it to another one.
//!
//! Main function: `reassign`. The job waits again, and the choice of robots is a fact. Refuses: to take a rack from the
//! station at which it is served, or from the robot that carries it to where it is to stay; jobs that name their robot
//! are changed instead.

use crate::requests::intake::Intake;
use crate::state::fact::{JobFact, Purpose, Task};
use crate::state::floor::Floor;
use crate::state::job::{Job, JobState, RobotChoice};
use crate::state::ledger::{RackAt, Service};
use crate::state::refusal::{JobRefusal, Refusal, RobotRefusal};
use crate::state::request::{Answer, Answered};
use giveway_floor::id::{Dense, JobId, RackId, RobotId};
use giveway_floor::time::{Span, Time};

/// How long a robot does not get a job that was taken from it. By then another robot has the job, or none can.
pub(crate) const STAYS_AWAY: Span = Span::from_secs(120);

/// How long a job waits for the robot that was chosen for it. A choice that no robot can meet must not hold a job for
/// ever.
pub(crate) const BINDS: Span = Span::from_secs(300);

impl Intake<'_> {
    /// Takes a job from its robot, and gives it to `chosen`, or to any other robot if none is named.
    pub(crate) fn reassign(&mut self, job: JobId, chosen: Option<RobotId>, now: Time) -> Answered {
        if job.0 == 0 || job.0 >= self.writer.ledger().next_job {
            return Err(Refusal::Job(JobRefusal::Unknown(job)));
        }
        let Some(record) = self.writer.ledger().jobs.get(&job) else {
            return Err(Refusal::Job(JobRefusal::IsOver(job)));
        };
        let (state, has) = (record.state, record.state.robot());
        let Some(rack) = record.request.kind.rack() else {
            return Err(Refusal::Job(JobRefusal::NamesItsRobot(record.request.kind.word())));
        };
        if let Some(robot) = chosen {
            self.writer.floor().check_choice(record, rack, robot)?;
        }
        if has.is_some() && has == chosen {
            return Ok(Answer::Done);
        }
        let is_delivery = record.request.kind.station().is_some();
        if matches!(state, JobState::Picking { .. })
            || (matches!(state, JobState::Carrying { .. }) && !is_delivery)
        {
            return Err(Refusal::Job(JobRefusal::CannotBeTaken(job)));
        }
        if let Some(robot) = has {
            let task = self.writer.floor().task_after_loss(robot);
            self.writer.progress(job, JobState::Waiting, Some((robot, task)), now);
            self.heard.left_early.push(robot);
        }
        let choice = match (chosen, has) {
            (Some(robot), _) => RobotChoice::Only(robot, now + BINDS),
            (None, Some(robot)) => RobotChoice::Except(robot, now + STAYS_AWAY),
            (None, None) => RobotChoice::Any,
        };
        self.writer.record(JobFact::Chosen { job, choice, at: now });
        Ok(Answer::Done)
    }
}

impl Floor<'_> {
    /// Whether a robot may do a job as far as operators are concerned. A choice of a robot that has left, is leaving or
    /// is out of service no longer binds.
    pub(crate) fn is_allowed(&self, robot: RobotId, job: &Job, now: Time) -> bool {
        match job.choice {
            RobotChoice::Only(chosen, _) if self.ledger.robots[chosen].service != Service::Works => true,
            choice => choice.allows(robot, now),
        }
    }

    fn check_choice(&self, job: &Job, rack: RackId, robot: RobotId) -> Result<(), Refusal> {
        if robot.ix() >= self.ledger.robots.len() {
            return Err(Refusal::UnknownPlace);
        }
        if self.ledger.robots[robot].service != Service::Works {
            return Err(Refusal::Robot(RobotRefusal::IsGone(robot)));
        }
        let node = match self.ledger.racks[rack] {
            RackAt::Stored(node) => node,
            RackAt::On(carrier) => self.ledger.node_of(carrier),
        };
        if job.request.is_for(self.warehouse(), self.body(robot), (rack, node)) {
            Ok(())
        } else {
            Err(Refusal::Job(JobRefusal::NotForRobot(robot)))
        }
    }

    /// The task with which a robot goes on when it loses its job to another one: out of the way of the rack, if it has
    /// not lifted the rack and is not granted to.
    fn task_after_loss(&self, robot: RobotId) -> Task {
        match self.ledger.robots[robot].task {
            Task::Fetch { node, .. } if !self.next_stop_is_granted(robot) => {
                Task::rest_at(self.place_without_rack(robot).unwrap_or(node), Purpose::Park)
            }
            _ => self.task_without_job(robot),
        }
    }
}
