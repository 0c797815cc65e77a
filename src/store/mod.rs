//! The journal of steps, snapshots of what they led to, the lists of jobs, assignments and encounters, and figures
//! over time, in SQLite.
//!
//! Main types: [`Store`] (open, load, append, snapshot, lists), [`Entry`], [`Loaded`], [`JobRow`],
//! [`AssignmentRow`], [`EncounterRow`], [`StoreError`]; [`record`] is the wire form of facts, [`ledger_record`]
//! that of snapshots. This module is the seam behind which PostgreSQL follows: statements are constants with `$1`,
//! and nobody outside sees a row. What is guaranteed: an [`Store::append`] that returned `Ok` survives loss of
//! power; a step is there whole or not at all; the journal and the lists never differ; a batch that is appended
//! again after an unclear failure is written once. Refuses: observations, a second process on the same file, a map
//! other than the one that the facts speak of.

mod act_record;
mod error;
mod history;
mod jobs;
pub mod ledger_record;
mod people;
mod people_record;
pub mod record;
mod retention;
mod route_record;
mod seal;
mod snapshot;
mod steps;

pub use error::StoreError;
pub use jobs::{JobQuery, JobRow};
pub use people::{AssignmentQuery, AssignmentRow, EncounterQuery, EncounterRow};
pub use seal::seal;
pub use snapshot::SNAPSHOT_AFTER;
pub use steps::{Entry, Loaded};

use crate::time::Span;
use crate::warehouse::Warehouse;
use sqlx::migrate::{Migration, MigrationType, Migrator};
use sqlx::sqlite::{
    SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous,
};
use sqlx::{AssertSqlSafe, SqlSafeStr};
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How long a statement waits for another program's lock.
const BUSY: Duration = Duration::from_secs(5);

/// Connections that read.
const READERS: u32 = 4;

const ABOUT: &str = "SELECT value FROM about WHERE key = $1";
const SET_ABOUT: &str = "INSERT INTO about (key, value) VALUES ($1, $2)";
const TAKE: &str = "INSERT OR REPLACE INTO about (key, value) VALUES ('run', $1)";
const EARLIER: &str = "SELECT count(*) FROM sqlite_schema WHERE name = 'journal'";
const EARLIER_ROWS: &str = "SELECT count(*) FROM (SELECT 1 FROM journal LIMIT 1)";
const BEGIN: &str = "BEGIN IMMEDIATE";
const COMMIT: &str = "COMMIT";
const ROLLBACK: &str = "ROLLBACK";

/// After truncating, the write-ahead log keeps at most so many bytes of the disk.
const LOG_BYTES: &str = "67108864";

/// What is over stays in the lists for so many days unless the settings say otherwise.
pub const KEEP_DAYS: u32 = 400;

/// The database: one connection that writes, some that read.
#[derive(Debug)]
pub struct Store {
    path: PathBuf,
    writer: SqlitePool,
    readers: SqlitePool,
    /// Names this opening of the database: what others wrote since is noticed.
    run: String,
    keep: Span,
    _lock: File,
}

impl Store {
    /// Opens the database, makes it where there is none, and brings its tables up to date.
    ///
    /// # Errors
    /// Where the file cannot be used, another process uses it, or it belongs to another map.
    pub async fn open(path: &Path, map: &Warehouse) -> Result<Store, StoreError> {
        let lock = lock(path)?;
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
            .connect_with(options.clone().create_if_missing(true))
            .await
            .map_err(open)?;
        refuse_earlier(&writer, path).await?;
        migrator().run(&writer).await.map_err(|why| StoreError::Migrate { path: path.into(), why })?;
        check_seal(&writer, path, map).await?;
        let run = uuid::Uuid::new_v4().to_string();
        sqlx::query(TAKE).bind(&run).execute(&writer).await?;
        let readers = SqlitePoolOptions::new()
            .max_connections(READERS)
            .acquire_timeout(BUSY)
            .connect_with(options.read_only(true))
            .await
            .map_err(open)?;
        let keep = days(KEEP_DAYS);
        Ok(Store { path: path.into(), writer, readers, run, keep, _lock: lock })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The same, but what is over stays in the lists for so many days.
    pub fn keep_days(self, keep: u32) -> Store {
        Store { keep: days(keep), ..self }
    }

    /// Names this opening of the database; each step says by which run it was written.
    pub fn run(&self) -> &str {
        &self.run
    }

    /// Lets the file grow to so many pages of 4 KiB and no further: beyond, it behaves like a full disk.
    ///
    /// # Errors
    /// Where the database does not answer.
    pub async fn cap(&self, pages: u32) -> Result<(), StoreError> {
        let statement = AssertSqlSafe(format!("PRAGMA max_page_count = {pages}"));
        sqlx::query(statement).execute(&self.writer).await?;
        Ok(())
    }

    /// Writes everything into the main file and closes it.
    pub async fn close(&self) {
        self.readers.close().await;
        self.writer.close().await;
    }
}

fn days(n: u32) -> Span {
    Span::from_secs(24 * 3600) * i64::from(n)
}

/// Refuses a database from before the first release: its journal may end inside a step.
async fn refuse_earlier(writer: &SqlitePool, path: &Path) -> Result<(), StoreError> {
    let tables: i64 = sqlx::query_scalar(EARLIER).fetch_one(writer).await?;
    let rows: i64 = if tables == 0 { 0 } else { sqlx::query_scalar(EARLIER_ROWS).fetch_one(writer).await? };
    if rows == 0 { Ok(()) } else { Err(StoreError::Earlier(path.into())) }
}

/// Takes the lock beside the database. It falls with the process, however that ends.
fn lock(path: &Path) -> Result<File, StoreError> {
    let mut name = path.as_os_str().to_owned();
    name.push("-lock");
    let path_of_lock = PathBuf::from(name);
    let fail = |why| StoreError::Lock { path: path_of_lock.clone(), why };
    let file = File::options().create(true).truncate(false).write(true).open(&path_of_lock).map_err(fail)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(StoreError::InUse(path.into())),
        Err(TryLockError::Error(why)) => Err(fail(why)),
    }
}

fn migrator() -> Migrator {
    let first = include_str!("../../migrations/sqlite/0001_journal.sql").into_sql_str();
    let second = include_str!("../../migrations/sqlite/0002_people.sql").into_sql_str();
    let third = include_str!("../../migrations/sqlite/0003_history.sql").into_sql_str();
    let fourth = include_str!("../../migrations/sqlite/0004_steps.sql").into_sql_str();
    Migrator::with_migrations(vec![
        Migration::new(1, "journal".into(), MigrationType::Simple, first, false),
        Migration::new(2, "people".into(), MigrationType::Simple, second, false),
        Migration::new(3, "history".into(), MigrationType::Simple, third, false),
        Migration::new(4, "steps".into(), MigrationType::Simple, fourth, false),
    ])
}

/// Seals a new database with the map, and refuses another map later.
async fn check_seal(writer: &SqlitePool, path: &Path, map: &Warehouse) -> Result<(), StoreError> {
    let ours = seal(map);
    let mut tx = writer.begin_with("BEGIN IMMEDIATE").await?;
    let theirs: Option<String> = sqlx::query_scalar(ABOUT).bind("seal").fetch_optional(&mut *tx).await?;
    match theirs {
        None => {
            sqlx::query(SET_ABOUT).bind("seal").bind(&ours).execute(&mut *tx).await?;
            sqlx::query(SET_ABOUT).bind("map").bind(&map.name).execute(&mut *tx).await?;
            tx.commit().await?;
            Ok(())
        }
        Some(seal) if seal == ours => Ok(()),
        Some(_) => {
            let name: Option<String> = sqlx::query_scalar(ABOUT).bind("map").fetch_optional(&mut *tx).await?;
            let theirs = name.unwrap_or_default();
            Err(StoreError::OtherMap { path: path.into(), theirs, ours: map.name.clone() })
        }
    }
}
