//! The store behind the API's durable lists.
//!
//! Main type: [`StoredRecords`]. Refuses: to write anything but the list of other vendors' robots.

use giveway_api::{AuditEntry, AuditQuery, Later, NewLinked, Records, Role};
use giveway_fleet::alarm::{Alarm, AlarmQuery};
use giveway_fleet::{
    AssignmentQuery, AssignmentRow, EncounterQuery, EncounterRow, EventQuery, EventRow, EventSpan, JobQuery,
    JobRow, Listed, RobotEventQuery, RobotEventRow, RobotJobCounts, ShiftRows,
};
use giveway_floor::id::{AssignmentId, JobId, RobotId};
use giveway_floor::time::Time;
use giveway_store::{AuditFilter, AuditRow, LinkedRow, Store, StoreError};
use std::sync::Arc;
use tokio::sync::watch;

/// Durable lists, read from the store.
pub struct StoredRecords(pub Arc<Store>);

impl Records for StoredRecords {
    fn job(&self, id: JobId) -> Later<'_, Result<Option<JobRow>, String>> {
        Box::pin(async move { self.0.job(id).await.map_err(told) })
    }

    fn jobs(&self, query: JobQuery) -> Later<'_, Result<Listed<JobRow, JobId>, String>> {
        Box::pin(async move { self.0.jobs(&query).await.map_err(told) })
    }

    fn assignment(&self, id: AssignmentId) -> Later<'_, Result<Option<AssignmentRow>, String>> {
        Box::pin(async move { self.0.assignment(id).await.map_err(told) })
    }

    fn assignments(
        &self,
        query: AssignmentQuery,
    ) -> Later<'_, Result<Listed<AssignmentRow, AssignmentId>, String>> {
        Box::pin(async move { self.0.assignments(&query).await.map_err(told) })
    }

    fn alarms(&self, query: AlarmQuery) -> Later<'_, Result<Vec<Alarm>, String>> {
        Box::pin(async move { self.0.alarms(&query).await.map_err(told) })
    }

    fn encounters(&self, query: EncounterQuery) -> Later<'_, Result<Listed<EncounterRow, i64>, String>> {
        Box::pin(async move { self.0.encounters(&query).await.map_err(told) })
    }

    fn shift(&self, between: (Time, Time), now: Time) -> Later<'_, Result<ShiftRows, String>> {
        Box::pin(async move { self.0.shift(between, now).await.map_err(told) })
    }

    fn robot_events(&self, query: RobotEventQuery) -> Later<'_, Result<Vec<RobotEventRow>, String>> {
        Box::pin(async move { self.0.robot_events(&query).await.map_err(told) })
    }

    fn audit(&self, q: AuditQuery) -> Later<'_, Result<Vec<AuditEntry>, String>> {
        let AuditQuery { from, to, actor, before, limit } = q;
        let filter = AuditFilter { from, to, actor, before, limit };
        Box::pin(async move {
            let rows = self.0.audit(&filter).await.map_err(told)?;
            Ok(rows.into_iter().filter_map(entry).collect())
        })
    }

    fn acts(&self, between: (Time, Time)) -> Later<'_, Result<Vec<(String, u64)>, String>> {
        Box::pin(async move { self.0.acts(between).await.map_err(told) })
    }

    fn robot_jobs(&self, robot: RobotId) -> Later<'_, Result<RobotJobCounts, String>> {
        Box::pin(async move { self.0.robot_jobs(robot).await.map_err(told) })
    }

    fn events(&self, query: EventQuery) -> Later<'_, Result<Vec<EventRow>, String>> {
        Box::pin(async move { self.0.events(&query).await.map_err(told) })
    }

    fn keep_linked(&self, new: NewLinked) -> Later<'_, Result<(), String>> {
        let NewLinked { name, manufacturer, serial, kind, version } = new;
        let row = LinkedRow { name, manufacturer, serial, kind, version };
        Box::pin(async move { self.0.keep_linked_robot(&row).await.map_err(told) })
    }

    fn forget_linked(&self, name: String) -> Later<'_, Result<(), String>> {
        Box::pin(async move { self.0.forget_linked_robot(&name).await.map_err(told) })
    }

    fn event_span(&self) -> Later<'_, Result<EventSpan, String>> {
        Box::pin(async move { self.0.event_span().await.map_err(told) })
    }

    fn events_changed(&self) -> watch::Receiver<()> {
        self.0.events_changed()
    }
}

/// A row as the API knows it; nothing if its role is of another version of Giveway.
fn entry(row: AuditRow) -> Option<AuditEntry> {
    let AuditRow { id, actor, role, what, subject, outcome } = row;
    Some(AuditEntry { id, actor, role: Role::of_word(&role)?, what, subject, status: outcome })
}

/// Logs the failure, once; the client only learns that the database failed.
fn told(e: StoreError) -> String {
    tracing::error!("a list cannot be read: {e}");
    "the database does not answer; the server's log says why".into()
}
