//! What happened, for other systems that follow it by number.
//!
//! Main functions: [`Store::events`], [`Store::event_span`], [`Store::events_changed`]. Refuses: names, since the
//! caller gives names to ids, and to keep events for longer than [`EVENTS_KEPT`].

use super::gone::Gone;
use super::{Store, StoreError};
use giveway_fleet::alarm::Alarm;
use giveway_fleet::{
    EventDetails, EventKind, EventQuery, EventRow, EventSpan, Fact, ReplanCause, floor_event,
};
use giveway_floor::geometry::Spot;
use giveway_floor::id::{RobotId, StationId, WorkerId};
use giveway_floor::time::{Span, Time};
use serde::{Deserialize, Serialize};
use sqlx::sqlite::{SqliteConnection, SqliteRow};
use sqlx::{QueryBuilder, Row, Sqlite};
use tokio::sync::watch;

/// How long events are kept.
pub const EVENTS_KEPT: Span = Span::from_secs(7 * 24 * 3600);

/// The old state is that of the last event about the same subject, where such events have states ($7). Repeated notes
/// of a worker on the floor change no state.
const NOTE: &str = "INSERT INTO events (at, kind, subject, old, new, robot, worker, text) \
    SELECT $1, $2, $3, iif($7, prior, NULL), $4, $5, $6, $8 FROM (SELECT \
    (SELECT new FROM events INDEXED BY events_by_subject \
    WHERE kind = $2 AND subject IS $3 ORDER BY seq DESC LIMIT 1) AS prior) \
    WHERE NOT ($2 = 'worker' AND $4 IS prior)";
const NOTE_ALARM: &str = "INSERT INTO events (at, kind, subject, old, new, text) SELECT $1, 'alarm', $2, \
    (SELECT new FROM events INDEXED BY events_by_subject \
    WHERE kind = 'alarm' AND subject = $2 ORDER BY seq DESC LIMIT 1), $3, $4 \
    WHERE $3 IS NOT (SELECT new FROM events INDEXED BY events_by_subject \
    WHERE kind = 'alarm' AND subject = $2 ORDER BY seq DESC LIMIT 1)";
const TOLD: &str =
    "SELECT 1 FROM events INDEXED BY events_by_subject WHERE kind = 'alarm' AND subject = $1 LIMIT 1";
/// Notes jobs whose state changes without a fact when a database is carried over to another map.
pub(super) const NOTE_JOBS: &str = "INSERT INTO events (at, kind, subject, old, new) \
    SELECT $1, 'job', value, (SELECT new FROM events INDEXED BY events_by_subject \
    WHERE kind = 'job' AND subject = value ORDER BY seq DESC LIMIT 1), $3 FROM json_each($2)";
const SOME: &str = "SELECT seq, at, kind, subject, old, new, robot, worker, text, \
    CASE WHEN kind = 'job' THEN (SELECT reference FROM jobs WHERE id = subject) END AS reference \
    FROM events WHERE seq IN (";
const ANY: &str = "SELECT seq FROM events WHERE seq > ";
/// Selects one kind: a page of several kinds has the first of the first rows of each.
const OF_KIND: &str = "SELECT * FROM (SELECT seq FROM events INDEXED BY events_by_kind WHERE kind = ";
const SPAN: &str = "SELECT (SELECT min(seq) FROM events), \
    coalesce((SELECT seq FROM sqlite_sequence WHERE name = 'events'), 0)";

impl Store {
    /// A page of events, in order.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn events(&self, q: &EventQuery) -> Result<Vec<EventRow>, StoreError> {
        let rows = page(q).build().fetch_all(&self.readers).await?;
        let rows: Result<Vec<_>, sqlx::Error> = rows.iter().map(|row| decode(row, &self.gone)).collect();
        let events: Vec<EventRow> = rows?.into_iter().flatten().collect();
        debug_assert!(events.is_sorted_by(|a, b| a.seq < b.seq), "events come in order, each once");
        debug_assert!(
            events.iter().all(|event| event.seq > q.after),
            "events come after the one that was named"
        );
        Ok(events)
    }

    /// The numbers of the events that are kept.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn event_span(&self) -> Result<EventSpan, StoreError> {
        let row = sqlx::query(SPAN).fetch_one(&self.readers).await?;
        let (first, last): (Option<i64>, i64) = (row.try_get(0)?, row.try_get(1)?);
        Ok(EventSpan { before: first.map_or(last, |first| first - 1), last })
    }

    /// A receiver that changes when there may be new events.
    pub fn events_changed(&self) -> watch::Receiver<()> {
        self.news.subscribe()
    }
}

/// The query of a page of events: rare kinds, too, are found without reading the other events.
pub(super) fn page(q: &EventQuery) -> QueryBuilder<Sqlite> {
    debug_assert!(q.limit > 0, "a page has room for a row");
    let mut query = QueryBuilder::new(SOME);
    if q.kinds.is_empty() {
        query.push(ANY).push_bind(q.after).push(" ORDER BY seq LIMIT ").push_bind(q.limit);
    }
    for (i, kind) in q.kinds.iter().enumerate() {
        query.push(if i == 0 { "" } else { " UNION ALL " }).push(OF_KIND).push_bind(kind.word());
        query.push(" AND seq > ").push_bind(q.after);
        query.push(" ORDER BY seq LIMIT ").push_bind(q.limit).push(")");
    }
    query.push(") ORDER BY seq LIMIT ").push_bind(q.limit);
    query
}

/// Writes the event that a fact of a step at this time means to other systems; gives whether there is one.
pub(super) async fn project(db: &mut SqliteConnection, fact: &Fact, at: Time) -> Result<bool, sqlx::Error> {
    let Some(event) = floor_event(fact) else { return Ok(false) };
    sqlx::query(NOTE)
        .bind(event.at.unwrap_or(at).0)
        .bind(event.kind.word())
        .bind(event.subject.map(u64::cast_signed))
        .bind(event.new)
        .bind(event.robot.map(|r| r.0))
        .bind(event.worker.map(|w| w.0))
        .bind(event.kind.has_states())
        .bind(event.details.map(|details| written(&details)))
        .execute(db)
        .await?;
    Ok(true)
}

/// Writes an alarm's change of state, if there is one. A group's alarm speaks for a member that had no event before it
/// joined.
pub(super) async fn note_alarm(db: &mut SqliteConnection, alarm: &Alarm) -> Result<(), sqlx::Error> {
    debug_assert!(alarm.group != Some(alarm.id), "no alarm is a member of itself");
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
    let query =
        sqlx::query(NOTE_ALARM).bind(at.0).bind(alarm.id.cast_signed()).bind(new).bind(alarm.text.kept());
    query.execute(db).await?;
    Ok(())
}

/// The stored form of details: JSON, places in millimetres.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum DetailsRecord {
    Replanned { cause: String, of: Option<u64>, was: Vec<[i64; 2]>, now: Vec<[i64; 2]> },
    Goal { place: [i64; 2], percent: u8 },
}

fn written(details: &EventDetails) -> String {
    let list = |spots: &[Spot]| spots.iter().map(|s| [s.x_mm, s.y_mm]).collect();
    let record = match details {
        EventDetails::Replanned { cause, was, now } => DetailsRecord::Replanned {
            cause: cause.word().to_owned(),
            of: cause.number(),
            was: list(was),
            now: list(now),
        },
        EventDetails::Goal { place, percent } => {
            DetailsRecord::Goal { place: [place.x_mm, place.y_mm], percent: *percent }
        }
    };
    serde_json::to_string(&record).expect("details are plain")
}

/// Reads details; nothing if they are from a newer version.
pub(super) fn read_details(text: &str) -> Option<EventDetails> {
    let spot = |[x_mm, y_mm]: [i64; 2]| Spot { x_mm, y_mm };
    let list = |spots: Vec<[i64; 2]>| spots.into_iter().map(spot).collect();
    Some(match serde_json::from_str(text).ok()? {
        DetailsRecord::Replanned { cause, of, was, now } => {
            EventDetails::Replanned { cause: ReplanCause::of(&cause, of)?, was: list(was), now: list(now) }
        }
        DetailsRecord::Goal { place, percent } => EventDetails::Goal { place: spot(place), percent },
    })
}

/// Reads a row; nothing if it is from a newer version.
fn decode(row: &SqliteRow, gone: &Gone) -> Result<Option<EventRow>, sqlx::Error> {
    let Some(kind) = EventKind::of_word(row.try_get("kind")?) else { return Ok(None) };
    let subject = row.try_get::<Option<i64>, _>("subject")?.map(i64::cast_unsigned);
    let station = subject.filter(|_| kind == EventKind::Station).and_then(|id| u32::try_from(id).ok());
    let text = station.and_then(|id| gone.station(StationId(id)));
    let kept: Option<String> = row.try_get("text")?;
    let details = kept.as_deref().filter(|_| !kind.has_states()).and_then(read_details);
    Ok(Some(EventRow {
        seq: row.try_get("seq")?,
        at: Time(row.try_get("at")?),
        kind,
        subject,
        old: row.try_get("old")?,
        new: row.try_get("new")?,
        robot: row.try_get::<Option<u32>, _>("robot")?.map(RobotId),
        worker: row.try_get::<Option<u32>, _>("worker")?.map(WorkerId),
        text: text.or(kept.filter(|_| kind.has_states())),
        reference: row.try_get("reference")?,
        details,
    }))
}
