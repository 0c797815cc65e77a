//! What was asked of the server, by whom, and which facts resulted.
//!
//! Main types: [`AuditRow`], [`AuditFilter`], [`StepCause`]; [`Store::audit`] lists, [`Store::causes`] gives the
//! requests behind a step. A request that caused facts is written in their transaction. Refuses: to change what was
//! written, except for the outcome of a request whose answer came later.

use super::{BEGIN, COMMIT, Store, StoreError, settle};
use futures_util::TryStreamExt;
use giveway_floor::time::Time;
use serde::{Deserialize, Serialize};
use sqlx::Row;
use sqlx::sqlite::{SqliteConnection, SqliteRow};
use std::ops::Range;

const BEGUN: &str = "INSERT OR IGNORE INTO audit (id, actor, role, what, subject, outcome) \
    VALUES ($1, $2, $3, $4, $5, $6)";
const ENDED: &str = "INSERT INTO audit (id, actor, role, what, subject, outcome) VALUES ($1, $2, $3, $4, $5, $6) \
    ON CONFLICT (id) DO UPDATE SET outcome = excluded.outcome, subject = excluded.subject";
const LAST: &str = "SELECT coalesce(max(id), 0) FROM audit";
const SOME: &str = "SELECT * FROM audit WHERE id < $1 AND id >= $2 ORDER BY id DESC LIMIT $3";
const OF_ACTOR: &str = "SELECT * FROM audit INDEXED BY audit_by_actor \
    WHERE actor = $4 AND id < $1 AND id >= $2 ORDER BY id DESC LIMIT $3";
const DONE: &str =
    "SELECT what, count(*) FROM audit WHERE id >= $1 AND id < $2 AND outcome < 400 GROUP BY what";
const CAUSES: &str = "SELECT seq, causes FROM steps WHERE seq > $1 AND causes IS NOT NULL ORDER BY seq";

/// A request to change something.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AuditRow {
    /// Number of the request: its arrival time in microseconds since 1970, made later where two arrived at once.
    pub id: i64,
    /// Name of the caller.
    pub actor: String,
    /// The word for the caller's role.
    pub role: String,
    /// Method and route of the request.
    pub what: String,
    /// The id in the path, or the id of what was made.
    pub subject: Option<String>,
    /// Status of the answer; nothing where none is known.
    pub outcome: Option<u16>,
}

/// Which requests to list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AuditFilter {
    /// Only requests that came at this time or later.
    pub from: Option<Time>,
    /// Only requests that came before this time.
    pub to: Option<Time>,
    /// Only requests by this caller.
    pub actor: Option<String>,
    /// Only requests with a smaller number.
    pub before: Option<i64>,
    /// Largest number of requests to list.
    pub limit: u32,
}

/// The facts of a step that a request caused.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepCause {
    /// Positions of these facts among the facts of the step, counted from 0.
    pub facts: Range<usize>,
    /// The request.
    pub request: AuditRow,
}

impl Store {
    /// Writes answered requests.
    ///
    /// # Errors
    /// If the database refuses the write. Then nothing was written, and it may be tried again.
    pub async fn keep_audit(&self, rows: &[AuditRow]) -> Result<(), StoreError> {
        self.check_place()?;
        let mut connection = self.writer.acquire().await?;
        let result = keep(&mut connection, rows).await.map_err(StoreError::from);
        settle(connection, result).await
    }

    /// The number of the last written request; 0 if there is none.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn last_audit(&self) -> Result<i64, StoreError> {
        Ok(sqlx::query_scalar(LAST).fetch_one(&self.readers).await?)
    }

    /// A page of requests, newest first.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn audit(&self, q: &AuditFilter) -> Result<Vec<AuditRow>, StoreError> {
        let end = q.before.unwrap_or(i64::MAX).min(q.to.map_or(i64::MAX, |t| t.0));
        let statement = if q.actor.is_some() { OF_ACTOR } else { SOME };
        let query = sqlx::query(statement).bind(end).bind(q.from.map_or(i64::MIN, |t| t.0)).bind(q.limit);
        let query = if q.actor.is_some() { query.bind(&q.actor) } else { query };
        let rows = query.fetch_all(&self.readers).await?;
        debug_assert!(rows.len() as i64 <= i64::from(q.limit), "a page is no longer than was asked for");
        Ok(rows.iter().map(read).collect::<Result<_, _>>()?)
    }

    /// How often each kind of request was made with success, from one moment to another.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn acts(&self, (from, to): (Time, Time)) -> Result<Vec<(String, u64)>, StoreError> {
        debug_assert!(from <= to, "a time ends after it begins");
        let rows = sqlx::query(DONE).bind(from.0).bind(to.0).fetch_all(&self.readers).await?;
        let read = |row: &SqliteRow| Ok((row.try_get(0)?, row.try_get::<i64, _>(1)?.unsigned_abs()));
        Ok(rows.iter().map(read).collect::<Result<_, sqlx::Error>>()?)
    }

    /// The requests behind the facts of the steps after `behind`, as far back as the journal reaches: for each such
    /// step with causes its number and what caused its facts. Facts without a request were decided by the fleet.
    ///
    /// # Errors
    /// If the database does not answer, or a row cannot be read.
    pub async fn causes(&self, behind: i64) -> Result<Vec<(i64, Vec<StepCause>)>, StoreError> {
        let mut found = Vec::new();
        let mut rows = sqlx::query(CAUSES).bind(behind).fetch(&self.readers);
        while let Some(row) = rows.try_next().await? {
            let text: String = row.try_get(1)?;
            let causes = serde_json::from_str(&text).map_err(|e| sqlx::Error::Decode(e.into()))?;
            found.push((row.try_get(0)?, causes));
        }
        Ok(found)
    }
}

/// Causes as the text of a step's row; nothing if there are none.
pub(super) fn encode(causes: &[StepCause]) -> Option<String> {
    (!causes.is_empty()).then(|| serde_json::to_string(causes).expect("causes are plain"))
}

/// Writes the requests that caused facts of a step, in the step's transaction.
pub(super) async fn project(db: &mut SqliteConnection, causes: &[StepCause]) -> Result<(), sqlx::Error> {
    for cause in causes {
        debug_assert!(!cause.facts.is_empty(), "a request is written with the facts that it caused");
        write(&mut *db, BEGUN, &cause.request).await?;
    }
    Ok(())
}

async fn keep(db: &mut SqliteConnection, rows: &[AuditRow]) -> Result<(), sqlx::Error> {
    sqlx::query(BEGIN).execute(&mut *db).await?;
    for row in rows {
        write(&mut *db, ENDED, row).await?;
    }
    sqlx::query(COMMIT).execute(&mut *db).await?;
    Ok(())
}

/// Writes one request that is answered at once, through a table of tokens.
pub(super) async fn note(db: &mut SqliteConnection, row: &AuditRow) -> Result<(), sqlx::Error> {
    write(db, BEGUN, row).await
}

async fn write(
    db: &mut SqliteConnection,
    statement: &'static str,
    row: &AuditRow,
) -> Result<(), sqlx::Error> {
    let AuditRow { id, actor, role, what, subject, outcome } = row;
    let query = sqlx::query(statement).bind(id).bind(actor).bind(role).bind(what).bind(subject);
    query.bind(outcome.map(i64::from)).execute(db).await?;
    Ok(())
}

fn read(row: &SqliteRow) -> Result<AuditRow, sqlx::Error> {
    Ok(AuditRow {
        id: row.try_get("id")?,
        actor: row.try_get("actor")?,
        role: row.try_get("role")?,
        what: row.try_get("what")?,
        subject: row.try_get("subject")?,
        outcome: row.try_get::<Option<i64>, _>("outcome")?.and_then(|status| u16::try_from(status).ok()),
    })
}
