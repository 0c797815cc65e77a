//! What happened to each robot: facts about it alone, together with its jobs and alarms in one list.
//!
//! Main functions: [`Store::robot_events`], [`Store::robot_jobs`]. Refuses: names, since the caller gives them to ids.

use super::events::read_details;
use super::{Store, StoreError};
use giveway_fleet::{Fact, RobotEventQuery, RobotEventRow, RobotEventSource, RobotJobCounts, robot_change};
use giveway_floor::id::RobotId;
use giveway_floor::time::Time;
use sqlx::Row;
use sqlx::sqlite::{SqliteConnection, SqliteRow};

const NOTE: &str = "INSERT INTO robot_changes (robot, at, what) VALUES ($1, $2, $3)";
const COUNTS: &str = "SELECT done, failed FROM robot_tallies WHERE robot = $1";
/// Takes from each list no more rows than the page has: all are read from the newest on.
const EVENTS: &str = "SELECT at, source, id, word, text, ended FROM ( \
    SELECT * FROM (SELECT updated AS at, 1 AS source, id, state AS word, kind AS text, NULL AS ended \
    FROM jobs INDEXED BY jobs_by_worker WHERE worker = $1 AND updated <= $3 AND (updated, 1, id) < ($3, $4, $5) \
    AND updated >= $6 AND updated < $7 ORDER BY updated DESC, id DESC LIMIT $8) \
    UNION ALL SELECT * FROM (SELECT since, 2, id, kind, text, cleared \
    FROM alarms INDEXED BY alarms_by_subject WHERE subject_kind = 'robot' AND subject = $2 AND since <= $3 \
    AND (since, 2, id) < ($3, $4, $5) AND since >= $6 AND since < $7 ORDER BY since DESC, id DESC LIMIT $8) \
    UNION ALL SELECT * FROM (SELECT at, 3, id, what, NULL, NULL \
    FROM robot_changes INDEXED BY robot_changes_by_robot WHERE robot = $1 AND at <= $3 \
    AND (at, 3, id) < ($3, $4, $5) AND at >= $6 AND at < $7 ORDER BY at DESC, id DESC LIMIT $8) \
    UNION ALL SELECT * FROM (SELECT at, 3, id, what, NULL, NULL \
    FROM robot_changes INDEXED BY robot_changes_by_robot WHERE robot IS NULL AND at <= $3 \
    AND (at, 3, id) < ($3, $4, $5) AND at >= $6 AND at < $7 ORDER BY at DESC, id DESC LIMIT $8) \
    UNION ALL SELECT * FROM (SELECT at, 4, seq, new, text, NULL \
    FROM events INDEXED BY events_by_subject WHERE kind = 'robot_replanned' AND subject = $1 AND at <= $3 \
    AND (at, 4, seq) < ($3, $4, $5) AND at >= $6 AND at < $7 ORDER BY seq DESC LIMIT $8)) \
    ORDER BY at DESC, source DESC, id DESC LIMIT $8";

impl Store {
    /// A page of what happened to a robot, newest first.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn robot_events(&self, q: &RobotEventQuery) -> Result<Vec<RobotEventRow>, StoreError> {
        let (at, source, id) = q.before.unwrap_or((Time(i64::MAX), RobotEventSource::Replan, i64::MAX));
        let rows = sqlx::query(EVENTS)
            .bind(q.robot.0)
            .bind(&q.name)
            .bind(at.0)
            .bind(source.number())
            .bind(id)
            .bind(q.from.map_or(i64::MIN, |t| t.0))
            .bind(q.to.map_or(i64::MAX, |t| t.0))
            .bind(q.limit)
            .fetch_all(&self.readers)
            .await?;
        let rows: Result<Vec<_>, sqlx::Error> = rows.iter().map(decode).collect();
        let events: Vec<RobotEventRow> = rows?.into_iter().flatten().collect();
        debug_assert!(events.len() <= q.limit as usize, "a page is no longer than was asked for");
        debug_assert!(events.is_sorted_by(|a, b| a.at >= b.at), "the newest come first");
        Ok(events)
    }

    /// Number of listed jobs that a robot did, and that it failed.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn robot_jobs(&self, robot: RobotId) -> Result<RobotJobCounts, StoreError> {
        let row = sqlx::query(COUNTS).bind(robot.0).fetch_optional(&self.readers).await?;
        let Some(row) = row else { return Ok(RobotJobCounts::default()) };
        let (done, failed): (i64, i64) = (row.try_get(0)?, row.try_get(1)?);
        Ok(RobotJobCounts { done: done.unsigned_abs(), failed: failed.unsigned_abs() })
    }
}

/// Writes what a fact of a step at this time says about a robot alone.
pub(super) async fn project(db: &mut SqliteConnection, fact: &Fact, at: Time) -> Result<(), sqlx::Error> {
    if let Some((robot, what)) = robot_change(fact) {
        sqlx::query(NOTE).bind(robot.map(|r| r.0)).bind(at.0).bind(what.word()).execute(db).await?;
    }
    Ok(())
}

/// Reads a row; nothing if it is from a newer version.
fn decode(row: &SqliteRow) -> Result<Option<RobotEventRow>, sqlx::Error> {
    let Some(source) = RobotEventSource::of_number(row.try_get("source")?) else { return Ok(None) };
    let text: Option<String> = row.try_get("text")?;
    Ok(Some(RobotEventRow {
        at: Time(row.try_get("at")?),
        source,
        id: row.try_get("id")?,
        word: row.try_get("word")?,
        details: text.as_deref().filter(|_| source == RobotEventSource::Replan).and_then(read_details),
        text: text.filter(|_| source != RobotEventSource::Replan),
        ended: row.try_get::<Option<i64>, _>("ended")?.map(Time),
    }))
}
