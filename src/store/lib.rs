//! The journal of steps, snapshots of the ledger, the lists of jobs, assignments, encounters and alarms, what happened
//! to robots, figures over time, tokens and the audit of requests, in SQLite.
//!
//! Main types: [`Store`] (open, load, append, snapshot, rows of lists), [`StepEntry`], [`Loaded`], [`StoreError`];
//! [`record`] is the wire form of facts, [`ledger_record`] that of snapshots. This module is the seam behind which
//! PostgreSQL follows: statements are constants with `$1`, and no other module sees a row. Guarantees: an
//! [`Store::append`] that returned `Ok` survives loss of power; a step is there whole or not at all; the journal and
//! the lists never differ; a batch that is appended again after an unclear failure is written once. Refuses:
//! observations, a second process on the same file, a map other than that of the facts unless they can be carried over
//! to it, and to acknowledge a write into a file that was taken away.

mod act_record;
mod alarms;
mod answers;
mod audit;
mod body_record;
mod carry;
mod check;
mod error;
mod events;
mod floor;
mod gone;
mod history;
mod identity;
mod job_record;
mod jobs;
pub mod ledger_record;
mod line_record;
mod linked;
mod listing;
mod lock;
mod migrations;
mod names;
mod note_record;
mod old_kinds;
mod opening;
mod people;
mod people_record;
mod published;
pub mod record;
mod retention;
mod robots;
mod route_record;
mod seal;
mod sessions;
mod set_clock;
mod shift;
mod snapshot;
mod steps;
mod tokens;
mod webhooks;
mod written;

#[cfg(test)]
mod tests;

pub use alarms::MOST_PAST;
pub use answers::{AnswerKey, AnswerRow};
pub use audit::{AuditFilter, AuditRow, StepCause};
pub use carry::{CarriedOver, CarryOver};
pub use check::Belongs;
pub use error::StoreError;
pub use events::EVENTS_KEPT;
pub use linked::LinkedRow;
pub use names::PersonRow;
pub use opening::Opening;
pub use published::{MapNote, PublishedMap, map_digest};
pub use seal::seal;
pub use sessions::SessionRow;
pub use snapshot::SNAPSHOT_AFTER;
pub use steps::{Loaded, StepEntry};
pub use tokens::{MOST_OVER, TokenDraft, TokenRow, TokenTable};
pub use webhooks::{FailedRow, HookRow};

use giveway_floor::time::Span;
use giveway_floor::warehouse::Warehouse;
use gone::Gone;
use identity::OpenFiles;
use lock::{Lock, LockRecord};
use sqlx::pool::PoolConnection;
use sqlx::sqlite::{
    SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous,
};
use sqlx::{AssertSqlSafe, Sqlite};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch;

/// How long a statement waits for another program's lock.
const BUSY: Duration = Duration::from_secs(5);

/// Number of connections that read.
const READERS: u32 = 4;

const ABOUT: &str = "SELECT value FROM about WHERE key = $1";
/// Key in the table `about` that tells that the clock was once set back.
const SET_BACK: &str = "set_back";
const TAKE: &str = "INSERT OR REPLACE INTO about (key, value) VALUES ('run', $1), ('open', $1)";
const SHUT: &str = "DELETE FROM about WHERE key = 'open' AND ($1 IS NULL OR value = $1)";
const INTO_MAIN: &str = "PRAGMA wal_checkpoint(PASSIVE)";
const EARLIER: &str = "SELECT count(*) FROM sqlite_schema WHERE name = 'journal'";
const EARLIER_ROWS: &str = "SELECT count(*) FROM (SELECT 1 FROM journal LIMIT 1)";
const JOURNALS: &str = "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name = 'steps'";
const BEGIN: &str = "BEGIN IMMEDIATE";
const COMMIT: &str = "COMMIT";
const ROLLBACK: &str = "ROLLBACK";

/// Largest size of the write-ahead log after truncation, bytes.
const LOG_BYTES: &str = "67108864";

/// Number of days for which ended items stay in the lists unless the settings say otherwise.
pub const KEEP_DAYS: u32 = 400;

/// Number of days for which lists name people, unless the settings say otherwise.
pub const PEOPLE_KEEP_DAYS: u32 = 7;

/// The database: one connection that writes, and several that read.
#[derive(Debug)]
pub struct Store {
    writer: SqlitePool,
    readers: SqlitePool,
    place: OpenFiles,
    /// The number of the last step when the database was opened.
    last: i64,
    /// Id of this opening of the database: writes of other processes since then are noticed.
    run: String,
    keep: Span,
    /// How long lists name people.
    keep_people: Span,
    /// Whether later acceptance always means a higher number: the clock was never set back.
    is_orderly: bool,
    lock: Arc<Lock>,
    /// Names of things that the lists refer to and the map no longer has.
    gone: Gone,
    carried: Option<CarriedOver>,
    /// Tells followers of events that there may be new ones.
    news: watch::Sender<()>,
}

impl Store {
    /// Opens the database, makes it if there is none, and brings its tables up to date.
    ///
    /// # Errors
    /// If the file cannot be used, another process uses it, or it belongs to another map.
    pub async fn open(path: &Path, map: &Warehouse) -> Result<Store, StoreError> {
        Store::open_as(path, map, &Opening::default()).await
    }

    /// Opens the database whose lock is held. It must have the steps that the lock file knows of.
    async fn connect(
        lock: &Arc<Lock>,
        known: Option<&LockRecord>,
        map: &Warehouse,
        opening: &Opening,
    ) -> Result<Store, StoreError> {
        let path = lock.path();
        let open = |why| StoreError::Open { path: path.into(), why };
        let options = SqliteConnectOptions::new()
            .filename(path)
            .journal_mode(SqliteJournalMode::Wal)
            .synchronous(SqliteSynchronous::Full)
            .busy_timeout(BUSY)
            .pragma("journal_size_limit", LOG_BYTES)
            .foreign_keys(true);
        let writer = SqlitePoolOptions::new()
            .max_connections(1)
            .max_lifetime(None)
            .idle_timeout(None)
            .connect_with(options.clone())
            .await
            .map_err(open)?;
        let prepared = prepare(&writer, lock, known, (map, opening)).await;
        let (last, carried) = match prepared {
            Ok(prepared) => prepared,
            Err(e) => {
                writer.close().await;
                return Err(e);
            }
        };
        // One reader is always open: with its last connection SQLite would remove the write-ahead log.
        let readers = SqlitePoolOptions::new()
            .max_connections(READERS)
            .min_connections(1)
            .max_lifetime(None)
            .idle_timeout(None)
            .acquire_timeout(BUSY)
            .connect_with(options.read_only(true))
            .await
            .map_err(open)?;
        let place = OpenFiles::of(path).map_err(|why| StoreError::Lock { path: path.into(), why })?;
        let gone = Gone::read(&readers).await?;
        let set_back: Option<String> =
            sqlx::query_scalar(ABOUT).bind(SET_BACK).fetch_optional(&readers).await?;
        let (is_orderly, run) = (set_back.is_none(), lock.run().to_string());
        lock.note(last);
        let (keep, keep_people, lock) = (days(KEEP_DAYS), days(PEOPLE_KEEP_DAYS), lock.clone());
        let news = watch::Sender::new(());
        Ok(Store {
            writer,
            readers,
            place,
            last,
            run,
            keep,
            keep_people,
            is_orderly,
            lock,
            gone,
            carried,
            news,
        })
    }

    /// Checks that the files being written to are still the database. Only then are appends acknowledged.
    ///
    /// # Errors
    /// If they were deleted, moved or replaced.
    pub fn check_place(&self) -> Result<(), StoreError> {
        self.place.check()
    }

    /// Makes the contents of the lock file survive a loss of power.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn sync_lock(&self) -> std::io::Result<()> {
        self.lock.sync()
    }

    /// Path of the main file.
    pub fn path(&self) -> &Path {
        self.lock.path()
    }

    /// What was carried over, if the database was opened with another map than its own.
    pub fn carried(&self) -> Option<&CarriedOver> {
        self.carried.as_ref()
    }

    /// Sets the number of days for which ended items stay in the lists.
    pub fn keep_days(self, keep: u32) -> Store {
        Store { keep: days(keep), ..self }
    }

    /// Sets the number of days for which lists name people.
    pub fn keep_people_days(self, keep: u32) -> Store {
        Store { keep_people: days(keep), ..self }
    }

    /// Id of this opening of the database; each step records the run that wrote it.
    pub fn run(&self) -> &str {
        &self.run
    }

    /// Limits the file to this many pages of 4 KiB: beyond, it behaves like a full disk.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn cap(&self, pages: u32) -> Result<(), StoreError> {
        let statement = AssertSqlSafe(format!("PRAGMA max_page_count = {pages}"));
        sqlx::query(statement).execute(&self.writer).await?;
        Ok(())
    }

    /// Writes everything into the main file, closes it and releases it, even if other handles to this store remain.
    pub async fn close(&self) {
        self.readers.close().await;
        // An inspected database has no run. On a full disk, it stays marked as open.
        if !self.run.is_empty()
            && let Err(e) = sqlx::query(SHUT).bind(&self.run).execute(&self.writer).await
        {
            tracing::debug!("that the database is closed is not written down: {e}");
        }
        self.writer.close().await;
        self.lock.release();
    }
}

/// Ends a write on this connection: what failed is rolled back, and a connection that is not sound is closed.
async fn settle<T>(
    mut connection: PoolConnection<Sqlite>,
    result: Result<T, StoreError>,
) -> Result<T, StoreError> {
    if let Err(e) = &result {
        // On a full disk SQLite has rolled back by itself; then this statement fails, which is as good.
        let _ = sqlx::query(ROLLBACK).execute(&mut *connection).await;
        if !e.leaves_connection_sound() {
            let _ = connection.close().await;
        }
    }
    result
}

fn days(n: u32) -> Span {
    Span::from_secs(24 * 3600) * i64::from(n)
}

/// Checks the database, brings it up to date and takes it. Gives the number of the last step.
async fn prepare(
    writer: &SqlitePool,
    lock: &Lock,
    known: Option<&LockRecord>,
    (map, opening): (&Warehouse, &Opening),
) -> Result<(i64, Option<CarriedOver>), StoreError> {
    let path = lock.path();
    refuse_earlier(writer, path).await?;
    let (last, known) = (last_step(writer).await?, known.map_or(0, |r| r.last));
    if last < known {
        return Err(StoreError::Lost { path: path.into(), found: last, known });
    }
    if lock.is_bare() && is_open(writer).await? {
        lock.leave_bare();
        return Err(StoreError::Alone(path.into()));
    }
    migrations::migrator().run(writer).await.map_err(|why| StoreError::Migrate { path: path.into(), why })?;
    let last = old_kinds::take_up(writer, path, (map, &lock.run().to_string()), last).await?;
    let carried = seal_or_carry(writer, path, map, opening).await?;
    sqlx::query(TAKE).bind(lock.run().to_string()).execute(writer).await?;
    // So that a main file without its log can tell that it is not complete.
    if let Err(e) = sqlx::query(INTO_MAIN).execute(writer).await {
        tracing::debug!("the log is not yet written into the main file: {e}");
    }
    Ok((last, carried))
}

/// Whether the last run did not close the database. An earlier Giveway records nothing about that.
async fn is_open(db: &SqlitePool) -> Result<bool, StoreError> {
    let tables: i64 = sqlx::query_scalar(JOURNALS).fetch_one(db).await?;
    if tables == 0 {
        return Ok(false);
    }
    let about = async |key| -> Result<Option<String>, StoreError> {
        Ok(sqlx::query_scalar(ABOUT).bind(key).fetch_optional(db).await?)
    };
    let open = about("open").await?;
    Ok(open.is_some() && open == about("run").await?)
}

/// Refuses a database from before the first release: its journal may end inside a step.
async fn refuse_earlier(writer: &SqlitePool, path: &Path) -> Result<(), StoreError> {
    let tables: i64 = sqlx::query_scalar(EARLIER).fetch_one(writer).await?;
    let rows: i64 = if tables == 0 { 0 } else { sqlx::query_scalar(EARLIER_ROWS).fetch_one(writer).await? };
    if rows == 0 { Ok(()) } else { Err(StoreError::Earlier(path.into())) }
}

/// The number of the last step; 0 in a database that has no tables yet.
async fn last_step(pool: &SqlitePool) -> Result<i64, StoreError> {
    let tables: i64 = sqlx::query_scalar(JOURNALS).fetch_one(pool).await?;
    if tables == 0 {
        return Ok(0);
    }
    Ok(sqlx::query_scalar(steps::LAST).fetch_one(pool).await?)
}

/// Seals a new database with the map, and carries a database of another map over to this one.
async fn seal_or_carry(
    writer: &SqlitePool,
    path: &Path,
    map: &Warehouse,
    opening: &Opening,
) -> Result<Option<CarriedOver>, StoreError> {
    let theirs: Option<String> = sqlx::query_scalar(ABOUT).bind("seal").fetch_optional(writer).await?;
    if theirs.is_some_and(|theirs| theirs != seal(map)) {
        let name: Option<String> = sqlx::query_scalar(ABOUT).bind("map").fetch_optional(writer).await?;
        return carry::carry_over(writer, path, map, name.unwrap_or_default(), opening).await.map(Some);
    }
    let mut tx = writer.begin_with("BEGIN IMMEDIATE").await?;
    floor::keep(&mut tx, map).await?;
    published::note(&mut tx, &opening.note).await?;
    tx.commit().await?;
    Ok(None)
}
