//! The journal of facts, the lists of jobs, assignments and encounters, and figures over time, in SQLite.
//!
//! Main types: [`Store`] (open, load, append, lists), [`Entry`], [`Loaded`], [`JobRow`],
//! [`AssignmentRow`], [`EncounterRow`], [`StoreError`];
//! [`record`] is the wire form. This module is the seam behind which PostgreSQL follows: statements are
//! constants with `$1`, and nobody outside sees a row. What is guaranteed: an [`Store::append`] that returned
//! `Ok` survives loss of power; the journal and the lists never differ; a batch that is appended again
//! after an unclear failure is written once. Refuses: observations, a second process on the same file, a map
//! other than the one that the facts speak of, to acknowledge what goes into a file that was taken away.

mod act_record;
mod check;
mod error;
mod history;
mod identity;
mod jobs;
mod lock;
mod opening;
mod people;
mod people_record;
pub mod record;
mod seal;

pub use check::Belongs;
pub use error::StoreError;
pub use jobs::{JobQuery, JobRow};
pub use opening::Opening;
pub use people::{AssignmentQuery, AssignmentRow, EncounterQuery, EncounterRow};
pub use seal::seal;

use crate::fleet::Fact;
use crate::time::Time;
use crate::warehouse::Warehouse;
use identity::Place;
use lock::{Lock, Record};
use sqlx::migrate::{Migration, MigrationType, Migrator};
use sqlx::sqlite::{
    SqliteConnectOptions, SqliteConnection, SqliteJournalMode, SqlitePool, SqlitePoolOptions,
    SqliteSynchronous,
};
use sqlx::{AssertSqlSafe, Row, SqlSafeStr};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use uuid::Uuid;

/// How long a statement waits for another program's lock.
const BUSY: Duration = Duration::from_secs(5);

/// Connections that read.
const READERS: u32 = 4;

const ABOUT: &str = "SELECT value FROM about WHERE key = $1";
const SET_ABOUT: &str = "INSERT INTO about (key, value) VALUES ($1, $2)";
const FACTS: &str = "SELECT seq, at, wire, fact FROM journal ORDER BY seq";
const LAST: &str = "SELECT coalesce(max(seq), 0) FROM journal";
const JOURNALS: &str = "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name = 'journal'";
const BEGIN: &str = "BEGIN IMMEDIATE";
const COMMIT: &str = "COMMIT";
const ROLLBACK: &str = "ROLLBACK";
const APPEND: &str = "INSERT INTO journal (seq, at, wire, fact) VALUES ($1, $2, $3, $4)";

/// A fact with the time of its step.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// When.
    pub at: Time,
    /// What.
    pub fact: Fact,
}

/// The journal as it was when it was opened.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Loaded {
    /// Everything that happened.
    pub facts: Vec<Fact>,
    /// When the last of it did.
    pub last: Option<Time>,
    /// The number that the next fact gets.
    pub next: i64,
}

/// The database: one connection that writes, some that read.
#[derive(Debug)]
pub struct Store {
    writer: SqlitePool,
    readers: SqlitePool,
    place: Place,
    /// The number of the last fact when it was opened.
    last: i64,
    lock: Arc<Lock>,
}

impl Store {
    /// Opens the database, makes it where there is none, and brings its tables up to date.
    ///
    /// # Errors
    /// Where the file cannot be used, another process uses it, or it belongs to another map.
    pub async fn open(path: &Path, map: &Warehouse) -> Result<Store, StoreError> {
        Store::open_as(path, map, &Opening::default()).await
    }

    /// Opens the database whose lock is held. It must have the facts that the lock file knows of.
    async fn connect(lock: &Arc<Lock>, known: Option<&Record>, map: &Warehouse) -> Result<Store, StoreError> {
        let path = lock.path();
        let open = |why| StoreError::Open { path: path.into(), why };
        let options = SqliteConnectOptions::new()
            .filename(path)
            .journal_mode(SqliteJournalMode::Wal)
            .synchronous(SqliteSynchronous::Full)
            .busy_timeout(BUSY)
            .foreign_keys(true);
        let writer = SqlitePoolOptions::new()
            .max_connections(1)
            .max_lifetime(None)
            .idle_timeout(None)
            .connect_with(options.clone())
            .await
            .map_err(open)?;
        let (last, known) = (last_fact(&writer).await?, known.map_or(0, |r| r.last));
        if last < known {
            writer.close().await;
            return Err(StoreError::Lost { path: path.into(), found: last, known });
        }
        migrator().run(&writer).await.map_err(|why| StoreError::Migrate { path: path.into(), why })?;
        check_seal(&writer, path, map).await?;
        // One of them is always open: with its last connection SQLite would remove the write-ahead log.
        let readers = SqlitePoolOptions::new()
            .max_connections(READERS)
            .min_connections(1)
            .max_lifetime(None)
            .idle_timeout(None)
            .acquire_timeout(BUSY)
            .connect_with(options.read_only(true))
            .await
            .map_err(open)?;
        let place = Place::of(path).map_err(|why| StoreError::Lock { path: path.into(), why })?;
        lock.note(last);
        Ok(Store { writer, readers, place, last, lock: lock.clone() })
    }

    /// Whether the files that it writes to are still the database. What is appended is acknowledged only then.
    ///
    /// # Errors
    /// Where they were deleted, moved or replaced.
    pub fn check_place(&self) -> Result<(), StoreError> {
        self.place.check()
    }

    /// Makes what the lock file knows outlast a loss of power.
    ///
    /// # Errors
    /// Where the disk refuses.
    pub fn sync_lock(&self) -> std::io::Result<()> {
        self.lock.sync()
    }

    /// A name for all that is written between opening and closing.
    pub fn run(&self) -> Uuid {
        self.lock.run()
    }

    /// The file.
    pub fn path(&self) -> &Path {
        self.lock.path()
    }

    /// Everything that happened.
    ///
    /// # Errors
    /// Where the database does not answer, or a fact cannot be read.
    pub async fn load(&self) -> Result<Loaded, StoreError> {
        let mut out = Loaded { next: 1, ..Loaded::default() };
        for row in sqlx::query(FACTS).fetch_all(&self.readers).await? {
            let seq: i64 = row.try_get(0)?;
            let text: &str = row.try_get(3)?;
            let fact =
                record::decode(row.try_get(2)?, text).map_err(|why| StoreError::Record { seq, why })?;
            out.facts.push(fact);
            out.last = Some(Time(row.try_get(1)?)).max(out.last);
            out.next = seq + 1;
        }
        Ok(out)
    }

    /// Writes facts and what they mean for the lists, all or none. `next` is the number of the first
    /// one: where the journal has them already, since an earlier try succeeded unnoticed, nothing is written.
    ///
    /// # Errors Where the database does not take them. Then nothing was written, and it may be tried again
    /// with the same facts unless [`StoreError::is_fatal`].
    pub async fn append(&self, next: i64, entries: &[Entry]) -> Result<(), StoreError> {
        self.place.check()?;
        let mut connection = self.writer.acquire().await?;
        let result = write(&mut connection, next, entries).await;
        if let Err(e) = &result {
            // On a full disk SQLite has rolled back by itself; then this says so, which is as good.
            let _ = sqlx::query(ROLLBACK).execute(&mut *connection).await;
            if !e.leaves_connection_sound() {
                let _ = connection.close().await;
            }
        }
        result?;
        self.lock.note(next - 1 + entries.len() as i64);
        self.place.check()
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

    /// Writes everything into the main file, closes it and lets go of it, whatever else still knows this store.
    pub async fn close(&self) {
        self.readers.close().await;
        self.writer.close().await;
        self.lock.release();
    }
}

/// Writes facts in one transaction. Its statements are sent as they are: sqlx counts transactions by itself,
/// and loses count where SQLite rolls one back on its own, as on a full disk.
async fn write(connection: &mut SqliteConnection, next: i64, entries: &[Entry]) -> Result<(), StoreError> {
    sqlx::query(BEGIN).execute(&mut *connection).await?;
    let last: i64 = sqlx::query_scalar(LAST).fetch_one(&mut *connection).await?;
    if last != next - 1 && last != next - 1 + entries.len() as i64 {
        return Err(StoreError::OutOfStep { expected: next - 1, found: last });
    }
    let missing = if last == next - 1 { entries } else { &[] };
    for (seq, entry) in (next..).zip(missing) {
        sqlx::query(APPEND)
            .bind(seq)
            .bind(entry.at.0)
            .bind(record::VERSION)
            .bind(record::encode(&entry.fact))
            .execute(&mut *connection)
            .await?;
        jobs::project(&mut *connection, &entry.fact).await?;
        people::project(&mut *connection, seq, &entry.fact).await?;
    }
    sqlx::query(COMMIT).execute(&mut *connection).await?;
    Ok(())
}

/// The number of the last fact; 0 in a database that has no tables yet.
async fn last_fact(pool: &SqlitePool) -> Result<i64, StoreError> {
    let tables: i64 = sqlx::query_scalar(JOURNALS).fetch_one(pool).await?;
    if tables == 0 {
        return Ok(0);
    }
    Ok(sqlx::query_scalar(LAST).fetch_one(pool).await?)
}

fn migrator() -> Migrator {
    let first = include_str!("../../migrations/sqlite/0001_journal.sql").into_sql_str();
    let second = include_str!("../../migrations/sqlite/0002_people.sql").into_sql_str();
    let third = include_str!("../../migrations/sqlite/0003_history.sql").into_sql_str();
    Migrator::with_migrations(vec![
        Migration::new(1, "journal".into(), MigrationType::Simple, first, false),
        Migration::new(2, "people".into(), MigrationType::Simple, second, false),
        Migration::new(3, "history".into(), MigrationType::Simple, third, false),
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
