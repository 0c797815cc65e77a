//! The port to the durable lists, and the requests in the queue to the fleet.
//!
//! Main types: [`Records`], [`QueuedRequest`]. Refuses: to know where lists are kept, and what takes requests.

use crate::access::audit::{AuditEntry, AuditQuery};
use crate::port::Later;
use crate::port::linked::NewLinked;
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
    /// How the jobs of a robot ended.
    fn robot_jobs(&self, robot: RobotId) -> Later<'_, Result<RobotJobCounts, String>>;
    /// Some events, in order; none if a recording is shown.
    fn events(&self, _: EventQuery) -> Later<'_, Result<Vec<EventRow>, String>> {
        Box::pin(async { Ok(Vec::new()) })
    }
    /// What the lists say about a period; what is not over at `now` counts until then.
    fn shift(&self, between: (Time, Time), now: Time) -> Later<'_, Result<ShiftRows, String>>;
    /// The range of events that are kept.
    fn event_span(&self) -> Later<'_, Result<EventSpan, String>> {
        Box::pin(async { Ok(EventSpan::default()) })
    }
    /// Changes when there may be new events.
    fn events_changed(&self) -> watch::Receiver<()> {
        watch::channel(()).1
    }
    /// Audit entries, newest first; none if a recording is shown.
    fn audit(&self, _: AuditQuery) -> Later<'_, Result<Vec<AuditEntry>, String>> {
        Box::pin(async { Ok(Vec::new()) })
    }
    /// Keeps a robot of another vendor that was listed over the API.
    fn keep_linked(&self, _: NewLinked) -> Later<'_, Result<(), String>> {
        Box::pin(async { Err("a recording keeps nothing".to_owned()) })
    }
    /// Forgets such a robot; one that is not kept is no error.
    fn forget_linked(&self, _: String) -> Later<'_, Result<(), String>> {
        Box::pin(async { Err("a recording keeps nothing".to_owned()) })
    }
    /// How often each audited request was carried out in a period; nothing if a recording is shown.
    fn acts(&self, _: (Time, Time)) -> Later<'_, Result<Vec<(String, u64)>, String>> {
        Box::pin(async { Ok(Vec::new()) })
    }
}

/// A request on its way to the fleet.
#[derive(Debug)]
pub struct QueuedRequest {
    /// The request.
    pub request: Request,
    /// The audit entry of the request, with the caller.
    pub by: Arc<AuditEntry>,
    /// Receives the answer once it is durable.
    pub reply: oneshot::Sender<Answered>,
}
