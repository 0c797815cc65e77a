//! A customer changes a job that no robot has yet.
//!
//! Refuses: to change a job on which a robot works; it would have to be cancelled and submitted again.

use crate::requests::intake::Intake;
use crate::state::fact::JobFact;
use crate::state::job::{JobChange, JobRequest, JobState};
use crate::state::job_kind::{JobKind, JobParts};
use crate::state::refusal::{JobRefusal, Refusal};
use crate::state::request::{Answer, Answered};
use giveway_floor::id::JobId;
use giveway_floor::time::Time;

impl Intake<'_> {
    /// Changes a waiting job, whole or not at all.
    pub(crate) fn change(&mut self, job: JobId, change: JobChange, now: Time) -> Answered {
        if job.0 == 0 || job.0 >= self.writer.ledger().next_job {
            return Err(Refusal::Job(JobRefusal::Unknown(job)));
        }
        let Some(record) = self.writer.ledger().jobs.get(&job) else {
            return Err(Refusal::Job(JobRefusal::IsOver(job)));
        };
        if record.state != JobState::Waiting {
            return Err(Refusal::Job(JobRefusal::HasBegun(job)));
        }
        let before = &record.request;
        let kind = changed_kind(before.kind, &change)?;
        if kind != before.kind {
            self.writer.floor().check_request(&JobRequest { kind, ..before.clone() })?;
        }
        let priority = change.priority.unwrap_or(before.priority);
        if priority > 9 {
            return Err(Refusal::Job(JobRefusal::Priority(priority)));
        }
        if change.deadline.flatten().is_some_and(|deadline| deadline < now) {
            return Err(Refusal::Job(JobRefusal::DeadlineIsOver));
        }
        let deadline = change.deadline.unwrap_or(before.deadline);
        if (kind, deadline) != (before.kind, before.deadline) {
            self.writer.record(JobFact::Changed { job, kind, priority, deadline, at: now });
        } else if priority != before.priority {
            self.writer.record(JobFact::Prioritised { job, priority, at: now });
        }
        Ok(Answer::Done)
    }
}

/// What is wanted after a change. The kind itself and its rack stay.
fn changed_kind(kind: JobKind, change: &JobChange) -> Result<JobKind, Refusal> {
    let JobChange { station, robot, .. } = *change;
    let before = kind.parts();
    if station.is_some() && before.station.is_none() {
        return Err(Refusal::Job(JobRefusal::HasNoStation(kind.word())));
    }
    if robot.is_some() && before.robot.is_none() {
        return Err(Refusal::Job(JobRefusal::HasNoRobot(kind.word())));
    }
    let (station, robot) = (station.or(before.station), robot.or(before.robot));
    Ok(kind.name().with(JobParts { station, robot, ..before }).expect("a job keeps the parts that it has"))
}
