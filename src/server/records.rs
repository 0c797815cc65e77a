//! The store as the API sees it.
//!
//! Main type: [`Shelf`]. Refuses: to write.

use crate::api::port::{JobFilter, JobRecord, Later, Records};
use crate::id::JobId;
use crate::store::{JobQuery, JobRow, Store, StoreError};
use std::sync::Arc;

/// Durable jobs, to be read.
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
}

impl From<JobRow> for JobRecord {
    fn from(row: JobRow) -> JobRecord {
        JobRecord { id: row.id, job: row.job, robot: row.robot, updated: row.updated }
    }
}

/// Logs the failure here, once; the customer learns that it is the database.
fn told(e: StoreError) -> String {
    tracing::error!("jobs cannot be read: {e}");
    "the database does not answer; the server's log says why".into()
}
