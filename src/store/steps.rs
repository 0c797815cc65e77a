//! The journal: one row for each step that changed anything.
//!
//! Main types: [`StepEntry`], [`Loaded`]; [`Store::append`], [`Store::load`]. A row is written whole or not at all, so
//! no start ever sees a part of a step. Refuses: rows that cannot be read, gaps, and rows of another process.

use super::{
    ABOUT, BEGIN, COMMIT, ROLLBACK, StepCause, Store, StoreError, audit, events, jobs, people, record,
    retention, robots, snapshot,
};
use futures_util::TryStreamExt;
use giveway_fleet::{Fact, Ledger};
use giveway_floor::time::Time;
use sqlx::Row;
use sqlx::sqlite::{SqliteConnection, SqlitePool, SqliteRow};

const STEPS: &str = "SELECT seq, at, wire, facts FROM steps WHERE seq > $1 ORDER BY seq";
pub(super) const LAST: &str = "SELECT max(coalesce((SELECT max(seq) FROM steps), 0), \
    coalesce((SELECT max(seq) FROM snapshots), 0))";
const APPEND: &str = "INSERT INTO steps (seq, at, wire, run, facts, causes) VALUES ($1, $2, $3, $4, $5, $6)";

/// What one step of the fleet recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct StepEntry {
    /// When the step was.
    pub at: Time,
    /// What happened, in order.
    pub facts: Vec<Fact>,
    /// Which requests caused which of them. Not read back with the facts: [`Store::causes`] says it.
    pub causes: Vec<StepCause>,
}

/// What was promised when the database was opened.
#[derive(Debug)]
pub struct Loaded {
    /// The ledger as the last snapshot has it; the one that was given where there is none.
    pub ledger: Ledger,
    /// The steps behind it.
    pub steps: Vec<StepEntry>,
    /// When the last step was.
    pub last: Option<Time>,
    /// The number that the next step gets.
    pub next: i64,
}

impl Loaded {
    /// How many facts there are behind the ledger.
    pub fn facts(&self) -> usize {
        self.steps.iter().map(|s| s.facts.len()).sum()
    }

    /// The ledger, and the facts behind it.
    pub fn into_parts(self) -> (Ledger, impl Iterator<Item = Fact>) {
        (self.ledger, self.steps.into_iter().flat_map(|s| s.facts))
    }
}

impl Store {
    /// The last ledger that was written down, and the steps behind it; where none was, the steps behind `empty`.
    ///
    /// # Errors
    /// Where the database does not answer, or something in it cannot be read: what was promised is not guessed.
    pub async fn load(&self, empty: Ledger) -> Result<Loaded, StoreError> {
        load(&self.readers, empty).await
    }

    /// Reads every step that is there: how many facts they have, and when the last one was.
    ///
    /// # Errors
    /// Where the database does not answer, or a step cannot be read.
    pub async fn scan(&self) -> Result<(usize, Option<Time>), StoreError> {
        let (mut facts, mut last) = (0, None);
        let mut rows = sqlx::query(STEPS).bind(0).fetch(&self.readers);
        while let Some(row) = rows.try_next().await? {
            let (_, entry) = decode(&row)?;
            facts += entry.facts.len();
            last = Some(entry.at).max(last);
        }
        Ok((facts, last))
    }

    /// Writes steps and what they mean for the lists, all or none, while the files are still the database. `next` is
    /// the number of the first one: where the journal has them already, since an earlier try succeeded unnoticed,
    /// nothing is written.
    ///
    /// # Errors Where the database does not take them. Then nothing was written, and it may be tried again
    /// with the same steps unless [`StoreError::is_fatal`].
    pub async fn append(&self, next: i64, steps: &[StepEntry]) -> Result<(), StoreError> {
        self.place.check()?;
        debug_assert!(next > 0, "steps are numbered from 1");
        let names_facts = |s: &StepEntry| s.causes.iter().all(|cause| cause.facts.end <= s.facts.len());
        debug_assert!(steps.iter().all(names_facts), "requests caused facts of their own step");
        let mut connection = self.writer.acquire().await?;
        let result = self.write(&mut connection, next, steps).await;
        if let Err(e) = &result {
            // On a full disk SQLite has rolled back by itself; then this says so, which is as good.
            let _ = sqlx::query(ROLLBACK).execute(&mut *connection).await;
            if !e.leaves_connection_sound() {
                let _ = connection.close().await;
            }
        }
        if result? {
            self.news.send_replace(());
        }
        self.lock.note(next - 1 + steps.len() as i64);
        self.place.check()
    }

    /// Writes steps in one transaction; whether there were events among them. Its statements are sent as they are:
    /// sqlx counts transactions by itself, and loses count where SQLite rolls one back on its own, as on a full disk.
    async fn write(
        &self,
        connection: &mut SqliteConnection,
        next: i64,
        steps: &[StepEntry],
    ) -> Result<bool, StoreError> {
        sqlx::query(BEGIN).execute(&mut *connection).await?;
        let last = self.last_of_this_run(connection).await?;
        if last != next - 1 && last != next - 1 + steps.len() as i64 {
            return Err(StoreError::OutOfStep { expected: next - 1, found: last });
        }
        let missing = if last == next - 1 { steps } else { &[] };
        let mut news = false;
        for (seq, step) in (next..).zip(missing) {
            sqlx::query(APPEND)
                .bind(seq)
                .bind(step.at.0)
                .bind(record::VERSION)
                .bind(&self.run)
                .bind(record::encode(&step.facts))
                .bind(audit::encode(&step.causes))
                .execute(&mut *connection)
                .await?;
            audit::project(&mut *connection, &step.causes).await?;
            for fact in &step.facts {
                jobs::project(&mut *connection, fact).await?;
                people::project(&mut *connection, fact).await?;
                robots::project(&mut *connection, fact, step.at).await?;
                news |= events::project(&mut *connection, fact, step.at).await?;
            }
        }
        if let Some(step) = missing.last() {
            retention::tidy(&mut *connection, step.at, (self.keep, self.keep_people)).await?;
        }
        sqlx::query(COMMIT).execute(&mut *connection).await?;
        Ok(news)
    }

    /// The number of the last step, if this process is still the one that writes.
    pub(super) async fn last_of_this_run(&self, db: &mut SqliteConnection) -> Result<i64, StoreError> {
        let run: Option<String> = sqlx::query_scalar(ABOUT).bind("run").fetch_optional(&mut *db).await?;
        if run.as_deref() != Some(self.run.as_str()) {
            return Err(StoreError::Taken(self.path().into()));
        }
        Ok(sqlx::query_scalar(LAST).fetch_one(db).await?)
    }
}

/// See [`Store::load`].
pub(super) async fn load(db: &SqlitePool, empty: Ledger) -> Result<Loaded, StoreError> {
    let found = snapshot::newest(db, &empty).await?;
    let (behind, last, ledger) = match found {
        Some(s) => (s.seq, Some(s.at), s.ledger),
        None => (0, None, empty),
    };
    let mut out = Loaded { ledger, steps: Vec::new(), last, next: behind + 1 };
    let mut rows = sqlx::query(STEPS).bind(behind).fetch(db);
    while let Some(row) = rows.try_next().await? {
        let (seq, entry) = decode(&row)?;
        if seq != out.next {
            return Err(StoreError::FreeWindow { expected: out.next, found: seq });
        }
        debug_assert!(seq > behind, "steps follow the snapshot");
        out.last = Some(entry.at).max(out.last);
        out.next = seq + 1;
        out.steps.push(entry);
    }
    Ok(out)
}

fn decode(row: &SqliteRow) -> Result<(i64, StepEntry), StoreError> {
    let seq: i64 = row.try_get(0)?;
    let (at, text) = (Time(row.try_get(1)?), row.try_get(3)?);
    let facts = record::decode(row.try_get(2)?, text).map_err(|why| StoreError::Record { seq, why })?;
    Ok((seq, StepEntry { at, facts, causes: Vec::new() }))
}
