//! Alarms, active and past.
//!
//! Main functions: [`Store::keep_alarms`], [`Store::active_alarms`], [`Store::alarms`]. Refuses: to be a dependency of
//! anything else: rows of kinds unknown to this Giveway are left out.

use super::{BEGIN, COMMIT, Store, StoreError, events, settle};
use giveway_fleet::alarm::{
    Acknowledgement, Alarm, AlarmKind, AlarmNote, AlarmQuery, AlarmSeverity, AlarmSubject, Shelving,
    SubjectKind,
};
use giveway_floor::geometry::Spot;
use giveway_floor::text::Sentence;
use giveway_floor::time::Time;
use sqlx::Row;
use sqlx::sqlite::{SqliteConnection, SqliteRow};

/// Number of ended alarms that are kept.
pub const MOST_PAST: i64 = 20_000;

const KEEP: &str = "INSERT OR REPLACE INTO alarms (id, kind, severity, subject_kind, subject, text, remedy, x, y, \
    waiting, since, acknowledged_by, acknowledged, cleared, shelved_by, shelved, shelved_until, shelved_reason, \
    notes, grp) \
    VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17, $18, $19, $20)";
/// Active alarms keep their numbers; so few of them are below the limit that they are skipped over.
const FORGET: &str =
    "DELETE FROM alarms WHERE cleared IS NOT NULL AND id <= (SELECT max(id) FROM alarms) - $1";
const LAST: &str = "SELECT coalesce(max(id), 0) FROM alarms";
const ACTIVE: &str = "SELECT * FROM alarms INDEXED BY alarms_by_end WHERE cleared IS NULL ORDER BY id";
const SOME: &str = "SELECT * FROM alarms WHERE id < $1 AND (cleared IS NULL OR cleared >= $2) AND since < $3 \
    ORDER BY id DESC LIMIT $4";
/// As `SOME`, where alarms are numbered in the order of their beginnings: the active alarms, and of the others those
/// that began in the time or an hour before it, or lasted for more than an hour.
const SOME_IN_ORDER: &str = "SELECT * FROM alarms WHERE id IN ( \
    SELECT * FROM (SELECT id FROM alarms INDEXED BY alarms_by_end WHERE cleared IS NULL AND id < $1 AND since < $3 \
    ORDER BY id DESC LIMIT $4) \
    UNION ALL SELECT * FROM (SELECT id FROM alarms WHERE cleared >= $2 AND since < $3 AND id < min($1, \
    coalesce((SELECT id FROM alarms INDEXED BY alarms_by_start WHERE since >= $3 ORDER BY since, id LIMIT 1), $1)) \
    AND id >= min(coalesce((SELECT id FROM alarms INDEXED BY alarms_by_start WHERE since >= $2 - 3600000000 \
    ORDER BY since, id LIMIT 1), $1), coalesce((SELECT min(id) FROM alarms INDEXED BY alarms_of_hours \
    WHERE cleared - since > 3600000000 AND cleared >= $2), $1)) \
    ORDER BY id DESC LIMIT $4)) ORDER BY id DESC LIMIT $4";
const SHELVED: &str = "SELECT * FROM alarms INDEXED BY alarms_by_shelf \
    WHERE cleared IS NOT NULL AND shelved_until > $1 ORDER BY id";
const OF_GROUP: &str = "SELECT * FROM alarms INDEXED BY alarms_by_group WHERE grp = $5 AND id < $1 \
    AND (cleared IS NULL OR cleared >= $2) AND since < $3 ORDER BY id DESC LIMIT $4";

impl Store {
    /// Writes the present state of alarms in place of what was stored, and deletes the oldest alarms over the limit.
    ///
    /// # Errors
    /// If the database refuses the write. Then nothing was written.
    pub async fn keep_alarms(&self, alarms: &[Alarm]) -> Result<(), StoreError> {
        self.check_place()?;
        let mut connection = self.writer.acquire().await?;
        let result = write(&mut connection, alarms).await;
        let result = settle(connection, result).await;
        self.news.send_replace(());
        result
    }

    /// The number of the last alarm, and the alarms that have not ended or are shelved until later than `now`.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn active_alarms(&self, now: Time) -> Result<(u64, Vec<Alarm>), StoreError> {
        let last: i64 = sqlx::query_scalar(LAST).fetch_one(&self.readers).await?;
        let active = sqlx::query(ACTIVE).fetch_all(&self.readers).await?;
        let shelved = sqlx::query(SHELVED).bind(now.0).fetch_all(&self.readers).await?;
        Ok((last.unsigned_abs(), active.iter().chain(&shelved).filter_map(read).collect()))
    }

    /// A page of alarms, active or past, newest first.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn alarms(&self, q: &AlarmQuery) -> Result<Vec<Alarm>, StoreError> {
        let plain = if self.is_orderly { SOME_IN_ORDER } else { SOME };
        let some = sqlx::query(if q.group.is_some() { OF_GROUP } else { plain })
            .bind(q.before.map_or(i64::MAX, |id| i64::try_from(id).unwrap_or(i64::MAX)))
            .bind(q.from.map_or(0, |t| t.0))
            .bind(q.to.map_or(i64::MAX, |t| t.0))
            .bind(q.limit);
        let some = match q.group {
            Some(group) => some.bind(group.cast_signed()),
            None => some,
        };
        let rows = some.fetch_all(&self.readers).await?;
        debug_assert!(rows.len() as i64 <= i64::from(q.limit), "a page is no longer than was asked for");
        Ok(rows.iter().filter_map(read).collect())
    }
}

async fn write(db: &mut SqliteConnection, alarms: &[Alarm]) -> Result<(), StoreError> {
    debug_assert!(alarms.iter().all(|a| a.id > 0), "alarms are numbered from 1");
    sqlx::query(BEGIN).execute(&mut *db).await?;
    for a in alarms {
        let (noted, shelved) = (a.acknowledged.as_ref(), a.shelved.as_ref());
        sqlx::query(KEEP)
            .bind(a.id.cast_signed())
            .bind(a.kind.word())
            .bind(a.severity.word())
            .bind(a.subject.kind.word())
            .bind(&a.subject.id)
            .bind(a.text.kept())
            .bind(a.remedy.kept())
            .bind(a.at.map(|at| at.x_mm))
            .bind(a.at.map(|at| at.y_mm))
            .bind(a.waiting as i64)
            .bind(a.since.0)
            .bind(noted.map(|n| n.by.as_str()))
            .bind(noted.map(|n| n.at.0))
            .bind(a.cleared.map(|t| t.0))
            .bind(shelved.map(|s| s.by.as_str()))
            .bind(shelved.map(|s| s.at.0))
            .bind(shelved.map(|s| s.until.0))
            .bind(shelved.map(|s| s.reason.as_str()))
            .bind(encode(&a.notes))
            .bind(a.group.map(u64::cast_signed))
            .execute(&mut *db)
            .await?;
        events::note_alarm(&mut *db, a).await?;
    }
    sqlx::query(FORGET).bind(MOST_PAST).execute(&mut *db).await?;
    sqlx::query(COMMIT).execute(&mut *db).await?;
    Ok(())
}

fn read(row: &SqliteRow) -> Option<Alarm> {
    let id: i64 = row.try_get("id").ok()?;
    let word = |column: &str| row.try_get::<&str, _>(column).ok();
    let number = |column: &str| row.try_get::<Option<i64>, _>(column).ok().flatten();
    let text = |column: &str| row.try_get::<Option<String>, _>(column).ok().flatten();
    let at = number("x").zip(number("y")).map(|(x_mm, y_mm)| Spot { x_mm, y_mm });
    let noted = text("acknowledged_by").zip(number("acknowledged"));
    let shelved = text("shelved_by").zip(number("shelved").zip(number("shelved_until")));
    let reason = text("shelved_reason").unwrap_or_default();
    let notes = text("notes").and_then(|notes| decode(&notes)).unwrap_or_default();
    Some(Alarm {
        id: id.unsigned_abs(),
        kind: AlarmKind::of_word(word("kind")?)?,
        severity: AlarmSeverity::of_word(word("severity")?)?,
        subject: AlarmSubject::new(SubjectKind::of_word(word("subject_kind")?)?, text("subject")?),
        text: Sentence::read(&text("text")?),
        remedy: Sentence::read(&text("remedy")?),
        at,
        waiting: usize::try_from(number("waiting")?).ok()?,
        since: Time(number("since")?),
        acknowledged: noted.map(|(by, at)| Acknowledgement { by, at: Time(at) }),
        shelved: shelved.map(|(by, (at, until))| Shelving { by, at: Time(at), until: Time(until), reason }),
        notes,
        group: number("grp").map(i64::cast_unsigned),
        members: Vec::new(),
        cleared: number("cleared").map(Time),
    })
}

/// Notes as the text of a row; nothing if there are none.
fn encode(notes: &[AlarmNote]) -> Option<String> {
    let rows: Vec<_> = notes.iter().map(|note| (&note.by, note.at.0, &note.text)).collect();
    (!rows.is_empty()).then(|| serde_json::to_string(&rows).expect("notes are plain"))
}

fn decode(text: &str) -> Option<Vec<AlarmNote>> {
    let rows: Vec<(String, i64, String)> = serde_json::from_str(text).ok()?;
    Some(rows.into_iter().map(|(by, at, text)| AlarmNote { by, at: Time(at), text }).collect())
}
