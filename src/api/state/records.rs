//! Durable lists to read, and the queue of requests to the fleet.
//!
//! Main types: [`Records`], [`QueuedRequest`]. Refuses: to know where lists are kept, and who takes requests.

use crate::access::audit::{AuditEntry, AuditQuery};
use crate::port::Later;
use giveway_fleet::alarm::{Alarm, AlarmQuery};
use giveway_fleet::{
    Answered, AssignmentQuery, AssignmentRow, EncounterQuery, EncounterRow, EventQuery, EventRow, EventSpan,
    JobQuery, JobRow, Listed, Request, RobotEventQuery, RobotEventRow, RobotJobCounts, ShiftRows,
};
use giveway_floor::id::{AssignmentId, JobId, RobotId};
use giveway_floor::time::Time;
use std::sync::Arc;
use tokio::sync::{oneshot, watch};

/// Durable lists. Errors are texts for people: what happened and what to do.
pub trait Records: Send + Sync {
    /// One job.
    fn job(&self, id: JobId) -> Later<'_, Result<Option<JobRow>, String>>;
    /// Some jobs, newest first.
    fn jobs(&self, filter: JobQuery) -> Later<'_, Result<Listed<JobRow, JobId>, String>>;
    /// One assignment.
    fn assignment(&self, id: AssignmentId) -> Later<'_, Result<Option<AssignmentRow>, String>>;
    /// Some assignments, newest first.
    fn assignments(
        &self,
        filter: AssignmentQuery,
    ) -> Later<'_, Result<Listed<AssignmentRow, AssignmentId>, String>>;
    /// Some alarms, active or past, newest first.
    fn alarms(&self, filter: AlarmQuery) -> Later<'_, Result<Vec<Alarm>, String>>;
    /// Some encounters, newest first.
    fn encounters(&self, filter: EncounterQuery) -> Later<'_, Result<Listed<EncounterRow, i64>, String>>;
    /// What happened to a robot, newest first.
    fn robot_events(&self, filter: RobotEventQuery) -> Later<'_, Result<Vec<RobotEventRow>, String>>;
    /// What became of the jobs of a robot.
    fn robot_jobs(&self, robot: RobotId) -> Later<'_, Result<RobotJobCounts, String>>;
    /// Some events, in order; none where a recording is shown.
    fn events(&self, _: EventQuery) -> Later<'_, Result<Vec<EventRow>, String>> {
        Box::pin(async { Ok(Vec::new()) })
    }
    /// What the lists say about the time from one moment to another; what is not over lasts until the last of these.
    fn shift(&self, between: (Time, Time), now: Time) -> Later<'_, Result<ShiftRows, String>>;
    /// Which events are kept.
    fn event_span(&self) -> Later<'_, Result<EventSpan, String>> {
        Box::pin(async { Ok(EventSpan::default()) })
    }
    /// Changes when there may be new events.
    fn events_changed(&self) -> watch::Receiver<()> {
        watch::channel(()).1
    }
    /// Who asked to change something, newest first; nobody where a recording is shown.
    fn audit(&self, _: AuditQuery) -> Later<'_, Result<Vec<AuditEntry>, String>> {
        Box::pin(async { Ok(Vec::new()) })
    }
    /// How often what was asked, as the audit has it, and done, from one moment to another; nothing where a recording
    /// is shown.
    fn acts(&self, _: (Time, Time)) -> Later<'_, Result<Vec<(String, u64)>, String>> {
        Box::pin(async { Ok(Vec::new()) })
    }
}

/// A request on its way to the fleet.
#[derive(Debug)]
pub struct QueuedRequest {
    /// What is asked.
    pub request: Request,
    /// Who asks, and as what it is written down.
    pub by: Arc<AuditEntry>,
    /// Gets the answer once it is durable.
    pub reply: oneshot::Sender<Answered>,
}
