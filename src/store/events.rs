//! What happened, for other systems that follow it by number.
//!
//! Main functions: [`Store::events`], [`Store::event_span`], [`Store::events_changed`]. Refuses: names, which others
//! give to ids, and to keep events for longer than [`EVENTS_KEPT`].

use super::gone::Gone;
use super::{Store, StoreError};
use crate::alarm::Alarm;
use crate::fleet::{EventKind, EventQuery, EventRow, EventSpan, Fact, floor_event};
use crate::id::{RobotId, StationId, WorkerId};
use crate::time::{Span, Time};
use sqlx::sqlite::{SqliteConnection, SqliteRow};
use sqlx::{QueryBuilder, Row};
use tokio::sync::watch;

/// How long events are kept.
pub const EVENTS_KEPT: Span = Span::from_secs(7 * 24 * 3600);

/// The state before is that of the last event about the same subject; encounters have none.
const NOTE: &str = "INSERT INTO events (at, kind, subject, old, new, robot, worker) VALUES ($1, $2, $3, \
    CASE WHEN $2 = 'encounter' THEN NULL ELSE \
    (SELECT new FROM events WHERE kind = $2 AND subject IS $3 ORDER BY seq DESC LIMIT 1) END, $4, $5, $6)";
const NOTE_ALARM: &str = "INSERT INTO events (at, kind, subject, old, new, text) \
    SELECT $1, 'alarm', $2, (SELECT new FROM events WHERE kind = 'alarm' AND subject = $2 ORDER BY seq DESC LIMIT 1), \
    $3, $4 WHERE $3 IS NOT (SELECT new FROM events WHERE kind = 'alarm' AND subject = $2 ORDER BY seq DESC LIMIT 1)";
const TOLD: &str = "SELECT 1 FROM events WHERE kind = 'alarm' AND subject = $1 LIMIT 1";
/// Jobs whose state changes without a fact, where a database is carried over to another map.
pub(super) const NOTE_JOBS: &str = "INSERT INTO events (at, kind, subject, old, new) \
    SELECT $1, 'job', value, \
    (SELECT new FROM events WHERE kind = 'job' AND subject = value ORDER BY seq DESC LIMIT 1), \
    $3 FROM json_each($2)";
const SOME: &str = "SELECT seq, at, kind, subject, old, new, robot, worker, text, \
    CASE WHEN kind = 'job' THEN (SELECT reference FROM jobs WHERE id = subject) END AS reference \
    FROM events WHERE seq > ";
const SPAN: &str = "SELECT (SELECT min(seq) FROM events), \
    coalesce((SELECT seq FROM sqlite_sequence WHERE name = 'events'), 0)";

impl Store {
    /// Some events, in order.
    ///
    /// # Errors
    /// Where the database does not answer.
    pub async fn events(&self, q: &EventQuery) -> Result<Vec<EventRow>, StoreError> {
        let mut query = QueryBuilder::new(SOME);
        query.push_bind(q.after);
        if !q.kinds.is_empty() {
            let mut kinds = query.push(" AND kind IN (").separated(", ");
            for kind in &q.kinds {
                kinds.push_bind(kind.word());
            }
            query.push(")");
        }
        query.push(" ORDER BY seq LIMIT ").push_bind(q.limit);
        let rows = query.build().fetch_all(&self.readers).await?;
        let rows: Result<Vec<_>, sqlx::Error> = rows.iter().map(|row| decode(row, &self.gone)).collect();
        Ok(rows?.into_iter().flatten().collect())
    }

    /// Which events are kept.
    ///
    /// # Errors
    /// Where the database does not answer.
    pub async fn event_span(&self) -> Result<EventSpan, StoreError> {
        let row = sqlx::query(SPAN).fetch_one(&self.readers).await?;
        let (first, last): (Option<i64>, i64) = (row.try_get(0)?, row.try_get(1)?);
        Ok(EventSpan { before: first.map_or(last, |first| first - 1), last })
    }

    /// Changes when there may be new events.
    pub fn events_changed(&self) -> watch::Receiver<()> {
        self.news.subscribe()
    }
}

/// Writes down what a fact of a step at this time means for others, and whether it means anything.
pub(super) async fn project(db: &mut SqliteConnection, fact: &Fact, at: Time) -> Result<bool, sqlx::Error> {
    let Some(event) = floor_event(fact) else { return Ok(false) };
    sqlx::query(NOTE)
        .bind(event.at.unwrap_or(at).0)
        .bind(event.kind.word())
        .bind(event.subject.map(u64::cast_signed))
        .bind(event.new)
        .bind(event.robot.map(|r| r.0))
        .bind(event.worker.map(|w| w.0))
        .execute(db)
        .await?;
    Ok(true)
}

/// Writes down what became of an alarm, if that has changed. Of a member of a group that was not told before, the group
/// tells.
pub(super) async fn note_alarm(db: &mut SqliteConnection, alarm: &Alarm) -> Result<(), sqlx::Error> {
    if alarm.group.is_some() {
        let told = sqlx::query(TOLD).bind(alarm.id.cast_signed()).fetch_optional(&mut *db).await?;
        if told.is_none() {
            return Ok(());
        }
    }
    let noted = alarm.acknowledged.as_ref().map(|noted| ("acknowledged", noted.at));
    let (new, at) = match alarm.cleared {
        Some(at) => ("cleared", at),
        None => noted.unwrap_or(("active", alarm.since)),
    };
    let query = sqlx::query(NOTE_ALARM).bind(at.0).bind(alarm.id.cast_signed()).bind(new).bind(&alarm.text);
    query.execute(db).await?;
    Ok(())
}

/// Nothing where the row is from a newer version.
fn decode(row: &SqliteRow, gone: &Gone) -> Result<Option<EventRow>, sqlx::Error> {
    let Some(kind) = EventKind::of_word(row.try_get("kind")?) else { return Ok(None) };
    let subject = row.try_get::<Option<i64>, _>("subject")?.map(i64::cast_unsigned);
    let station = subject.filter(|_| kind == EventKind::Station).and_then(|id| u32::try_from(id).ok());
    let text = station.and_then(|id| gone.station(StationId(id)));
    Ok(Some(EventRow {
        seq: row.try_get("seq")?,
        at: Time(row.try_get("at")?),
        kind,
        subject,
        old: row.try_get("old")?,
        new: row.try_get("new")?,
        robot: row.try_get::<Option<u32>, _>("robot")?.map(RobotId),
        worker: row.try_get::<Option<u32>, _>("worker")?.map(WorkerId),
        text: text.or(row.try_get("text")?),
        reference: row.try_get("reference")?,
    }))
}
