//! What the lists say about a stretch of time, for reports.
//!
//! Main function: [`Store::shift`]. Refuses: figures, since the caller makes them from the rows.

use super::people::encounter;
use super::{Store, StoreError};
use futures_util::TryStreamExt;
use giveway_fleet::{EndedJob, ShiftRows};
use giveway_floor::id::StationId;
use giveway_floor::time::{Span, Time};
use sqlx::Row;
use sqlx::sqlite::SqliteRow;

const ENDED: &str = "SELECT kind, state, station, created, deadline, arrived_at, ended_at FROM jobs \
    INDEXED BY jobs_by_end WHERE ended_at >= $1 AND ended_at < $2";
/// At any moment of its picking, a job is listed with its end, or is still being picked. A pick that ended more than an
/// hour after the time either took longer than an hour, or began after the time.
const PICKING: &str = "SELECT station, sum(min(ended, $2) - max(began, $1)) FROM ( \
    SELECT station, arrived_at AS began, ended_at AS ended FROM jobs INDEXED BY jobs_by_end \
    WHERE ended_at > $1 AND ended_at <= $2 + 3600000000 AND arrived_at < $2 \
    UNION ALL SELECT station, arrived_at, ended_at FROM jobs INDEXED BY jobs_picked_long \
    WHERE ended_at - arrived_at > 3600000000 AND ended_at > max($1, $2 + 3600000000) AND arrived_at < $2 \
    UNION ALL SELECT station, arrived_at, $3 FROM jobs INDEXED BY jobs_by_state \
    WHERE state = 'picking' AND arrived_at < $2) \
    WHERE station IS NOT NULL AND min(ended, $2) > max(began, $1) GROUP BY station";
const OVERDUE: &str = "SELECT count(*) FROM jobs INDEXED BY jobs_by_deadline WHERE deadline >= $1 AND deadline < $2 \
    AND (ended_at IS NULL OR ended_at >= $2) AND created < $2";
const ASSIGNMENTS: &str = "SELECT count(*) FROM assignments INDEXED BY assignments_by_change \
    WHERE state = 'done' AND updated >= $1 AND updated < $2";
const ENCOUNTERS: &str =
    "SELECT * FROM encounters INDEXED BY encounters_by_time WHERE began >= $1 AND began < $2";

impl Store {
    /// What the lists say about the time from one moment to another; anything not over lasts until `now`.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn shift(&self, (from, to): (Time, Time), now: Time) -> Result<ShiftRows, StoreError> {
        debug_assert!(from <= to, "a time ends after it begins");
        let over = |statement: &'static str| sqlx::query(statement).bind(from.0).bind(to.0);
        let ended = over(ENDED).try_map(|row| ended_job(&row)).fetch(&self.readers).try_collect().await?;
        let picking = over(PICKING)
            .bind(now.0)
            .try_map(|row: SqliteRow| Ok((StationId(row.try_get(0)?), Span(row.try_get(1)?))))
            .fetch(&self.readers)
            .try_collect()
            .await?;
        let overdue: i64 = over(OVERDUE).fetch_one(&self.readers).await?.try_get(0)?;
        let assignments: i64 = over(ASSIGNMENTS).fetch_one(&self.readers).await?.try_get(0)?;
        let met = over(ENCOUNTERS).fetch_all(&self.readers).await?;
        let met: Result<Vec<_>, StoreError> =
            met.iter().map(|row| encounter(row).map(|row| row.encounter)).collect();
        Ok(ShiftRows {
            ended,
            picking,
            overdue: overdue.unsigned_abs(),
            assignments_done: assignments.unsigned_abs(),
            encounters: met?,
        })
    }
}

fn ended_job(row: &SqliteRow) -> Result<EndedJob, sqlx::Error> {
    let time = |name: &str| -> Result<Option<Time>, sqlx::Error> {
        Ok(row.try_get::<Option<i64>, _>(name)?.map(Time))
    };
    Ok(EndedJob {
        kind: row.try_get("kind")?,
        state: row.try_get("state")?,
        station: row.try_get::<Option<u32>, _>("station")?.map(StationId),
        accepted: Time(row.try_get("created")?),
        deadline: time("deadline")?,
        arrived: time("arrived_at")?,
        ended: Time(row.try_get("ended_at")?),
    })
}
