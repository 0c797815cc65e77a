//! The store as the API sees it.
//!
//! Main type: [`Shelf`]. Refuses: to write.

use crate::api::port::{
    AssignmentFilter, AssignmentRecord, EncounterFilter, EncounterRecord, Gone, JobFilter, JobRecord, Later,
    Records,
};
use crate::id::{AssignmentId, JobId};
use crate::store::{
    AssignmentQuery, AssignmentRow, EncounterQuery, GoneNames, JobQuery, JobRow, Store, StoreError,
};
use std::sync::Arc;

/// Durable lists, to be read.
pub struct Shelf(pub Arc<Store>);

impl Records for Shelf {
    fn job(&self, id: JobId) -> Later<'_, Result<Option<JobRecord>, String>> {
        Box::pin(async move {
            let row = self.0.job(id).await.map_err(told)?;
            Ok(row.map(JobRecord::from))
        })
    }

    fn jobs(&self, f: JobFilter) -> Later<'_, Result<Vec<JobRecord>, String>> {
        Box::pin(async move {
            let query = JobQuery { state: f.state, before: f.before, limit: f.limit };
            let rows = self.0.jobs(&query).await.map_err(told)?;
            Ok(rows.into_iter().map(JobRecord::from).collect())
        })
    }

    fn assignment(&self, id: AssignmentId) -> Later<'_, Result<Option<AssignmentRecord>, String>> {
        Box::pin(async move {
            let row = self.0.assignment(id).await.map_err(told)?;
            Ok(row.map(AssignmentRecord::from))
        })
    }

    fn assignments(&self, f: AssignmentFilter) -> Later<'_, Result<Vec<AssignmentRecord>, String>> {
        Box::pin(async move {
            let query =
                AssignmentQuery { worker: f.worker, state: f.state, before: f.before, limit: f.limit };
            let rows = self.0.assignments(&query).await.map_err(told)?;
            Ok(rows.into_iter().map(AssignmentRecord::from).collect())
        })
    }

    fn encounters(&self, f: EncounterFilter) -> Later<'_, Result<Vec<EncounterRecord>, String>> {
        Box::pin(async move {
            let EncounterFilter { from, to, worker, robot, before, limit } = f;
            let query = EncounterQuery { from, to, worker, robot, before, limit };
            let rows = self.0.encounters(&query).await.map_err(told)?;
            Ok(rows.into_iter().map(|r| EncounterRecord { seq: r.seq, encounter: r.encounter }).collect())
        })
    }
}

impl From<AssignmentRow> for AssignmentRecord {
    fn from(row: AssignmentRow) -> AssignmentRecord {
        let gone = Gone { node: row.gone, ..Gone::default() };
        AssignmentRecord { id: row.id, assignment: row.assignment, updated: row.updated, gone }
    }
}

impl From<JobRow> for JobRecord {
    fn from(row: JobRow) -> JobRecord {
        let GoneNames { rack, station, node } = row.gone;
        let gone = Gone { rack, station, node };
        JobRecord { id: row.id, job: row.job, robot: row.robot, updated: row.updated, gone }
    }
}

/// Logs the failure here, once; whoever asked learns that it is the database.
fn told(e: StoreError) -> String {
    tracing::error!("a list cannot be read: {e}");
    "the database does not answer; the server's log says why".into()
}
