//! The journal: one row for each step that changed anything.
//!
//! Main types: [`StepEntry`], [`Loaded`]; [`Store::append`], [`Store::load`]. A row is written whole or not at all, so
//! no start ever sees a part of a step. Refuses: rows that cannot be read, gaps, and rows of another process.

use super::{
    ABOUT, BEGIN, COMMIT, StepCause, Store, StoreError, audit, events, jobs, people, record, retention,
    robots, settle, snapshot,
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
    /// Time of the step.
    pub at: Time,
    /// The facts of the step, in order.
    pub facts: Vec<Fact>,
    /// Which requests caused which facts. Not read back with the facts: use [`Store::causes`].
    pub causes: Vec<StepCause>,
}

/// What was promised when the database was opened.
#[derive(Debug)]
pub struct Loaded {
    /// The ledger of the last snapshot; the given one if there is none.
    pub ledger: Ledger,
    /// The steps after that ledger.
    pub steps: Vec<StepEntry>,
    /// Time of the last step.
    pub last: Option<Time>,
    /// The number of the next step.
    pub next: i64,
}

impl Loaded {
    /// Number of facts after the ledger.
    pub fn facts(&self) -> usize {
        self.steps.iter().map(|s| s.facts.len()).sum()
    }

    /// The ledger, and the facts after it.
    pub fn into_parts(self) -> (Ledger, impl Iterator<Item = Fact>) {
        (self.ledger, self.steps.into_iter().flat_map(|s| s.facts))
    }
}

impl Store {
    /// The ledger of the last snapshot and the steps after it; without a snapshot, `empty` and all steps.
    ///
    /// # Errors
    /// If the database does not answer, or something in it cannot be read: promises are not guessed.
    pub async fn load(&self, empty: Ledger) -> Result<Loaded, StoreError> {
        load(&self.readers, empty).await
    }

    /// Reads every step that is there. Gives their number of facts, and the time of the last one.
    ///
    /// # Errors
    /// If the database does not answer, or a step cannot be read.
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

    /// Writes steps and their effect on the lists, all or none, while the files are still the database. `next` is the
    /// number of the first one: if the journal has the steps already, since an earlier attempt succeeded unnoticed,
    /// nothing is written.
    ///
    /// # Errors
    /// If the database refuses the write. Then nothing was written, and the same steps may be tried again unless
    /// [`StoreError::is_fatal`].
    pub async fn append(&self, next: i64, steps: &[StepEntry]) -> Result<(), StoreError> {
        self.place.check()?;
        debug_assert!(next > 0, "steps are numbered from 1");
        debug_assert!(steps.is_sorted_by(|a, b| a.at <= b.at), "steps come in order");
        let names_facts = |s: &StepEntry| s.causes.iter().all(|cause| cause.facts.end <= s.facts.len());
        debug_assert!(steps.iter().all(names_facts), "requests caused facts of their own step");
        let mut connection = self.writer.acquire().await?;
        let result = self.write(&mut connection, next, steps).await;
        if settle(connection, result).await? {
            self.news.send_replace(());
        }
        self.lock.note(next - 1 + steps.len() as i64);
        self.place.check()
    }

    /// Writes steps in one transaction; gives whether there were events among them. Its statements are sent as they
    /// are: sqlx counts transactions by itself, and loses count where SQLite rolls one back on its own, as on a full
    /// disk.
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
    debug_assert_eq!(out.next - 1, behind + out.steps.len() as i64, "every step is there once");
    Ok(out)
}

fn decode(row: &SqliteRow) -> Result<(i64, StepEntry), StoreError> {
    let seq: i64 = row.try_get(0)?;
    let (at, text) = (Time(row.try_get(1)?), row.try_get(3)?);
    let facts = record::decode(row.try_get(2)?, text).map_err(|why| StoreError::Record { seq, why })?;
    Ok((seq, StepEntry { at, facts, causes: Vec::new() }))
}
