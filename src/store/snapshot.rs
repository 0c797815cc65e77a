//! Snapshots: the ledger after a step, so that a start need not read the steps that led to it.
//!
//! Main function: [`Store::snapshot`]. The last two are kept; the steps that led to the older one are deleted bit by
//! bit with the appends that follow (`retention`). Refuses: a snapshot of anything but the last step.

use super::{BEGIN, COMMIT, Store, StoreError, ledger_record, settle};
use giveway_fleet::{Ledger, Parts};
use giveway_floor::time::Time;
use sqlx::Row;
use sqlx::sqlite::{SqliteConnection, SqlitePool};

/// Number of facts after which the ledger should be written: a start reads it, and about this many facts at most. The
/// cost is measured in docs/robustness.md.
pub const SNAPSHOT_AFTER: usize = 100_000;

const NEWEST: &str = "SELECT seq, at, wire, body FROM snapshots ORDER BY seq DESC LIMIT 2";
const KEEP: &str = "INSERT OR REPLACE INTO snapshots (seq, at, wire, body) VALUES ($1, $2, $3, $4)";
const FORGET: &str =
    "DELETE FROM snapshots WHERE seq NOT IN (SELECT seq FROM snapshots ORDER BY seq DESC LIMIT 2)";

/// A snapshot that was read.
pub(super) struct Snapshot {
    pub seq: i64,
    pub at: Time,
    pub ledger: Ledger,
}

impl Store {
    /// Writes the ledger after the step `seq`, which must be the last one.
    ///
    /// # Errors
    /// If the database refuses the write. Then nothing was written.
    pub async fn snapshot(&self, seq: i64, at: Time, parts: Parts) -> Result<(), StoreError> {
        // Some megabytes of text are work: not on a thread on which other tasks wait.
        let encoded = tokio::task::spawn_blocking(move || ledger_record::encode(&parts));
        let body = encoded.await.expect("writing text does not break");
        let mut connection = self.writer.acquire().await?;
        let result = self.write_snapshot(&mut connection, (seq, at), &body).await;
        settle(connection, result).await
    }

    async fn write_snapshot(
        &self,
        db: &mut SqliteConnection,
        (seq, at): (i64, Time),
        body: &str,
    ) -> Result<(), StoreError> {
        sqlx::query(BEGIN).execute(&mut *db).await?;
        let last = self.last_of_this_run(db).await?;
        if last != seq {
            return Err(StoreError::OutOfStep { expected: seq, found: last });
        }
        debug_assert!(seq > 0, "a snapshot follows a step");
        let row = sqlx::query(KEEP).bind(seq).bind(at.0).bind(ledger_record::VERSION).bind(body);
        row.execute(&mut *db).await?;
        sqlx::query(FORGET).execute(&mut *db).await?;
        sqlx::query(COMMIT).execute(&mut *db).await?;
        Ok(())
    }
}

/// The newest snapshot that can be read; nothing if there never was one.
pub(super) async fn newest(db: &SqlitePool, empty: &Ledger) -> Result<Option<Snapshot>, StoreError> {
    let mut first_error = None;
    for row in sqlx::query(NEWEST).fetch_all(db).await? {
        let (seq, at, body): (i64, i64, &str) = (row.try_get(0)?, row.try_get(1)?, row.try_get(3)?);
        let (warehouse, kinds) = (empty.warehouse(), empty.kinds().site());
        match ledger_record::decode(row.try_get(2)?, body, warehouse, kinds) {
            Ok(ledger) => return Ok(Some(Snapshot { seq, at: Time(at), ledger })),
            Err(why) => {
                // The steps after the previous snapshot are all there and say the same.
                tracing::warn!(seq, "a snapshot cannot be used: {why}");
                first_error.get_or_insert(StoreError::Snapshot { seq, why });
            }
        }
    }
    first_error.map_or(Ok(None), Err)
}
