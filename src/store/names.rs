//! Names of people, apart from everything else, and the erasure of a person.
//!
//! Main type: [`PersonRow`]. Deleted names are overwritten in the file, and the write-ahead log is emptied, since it
//! still has the old pages. Refuses: to delete encounters; the person is removed from them.

use super::{BEGIN, COMMIT, ROLLBACK, Store, StoreError};
use giveway_floor::id::WorkerId;
use giveway_floor::time::Time;
use sqlx::Row;
use sqlx::sqlite::{SqliteConnection, SqliteRow};

const ALL: &str = "SELECT pseudonym, name, since FROM people";
const ADD: &str = "INSERT INTO people (pseudonym, name, since) VALUES ($1, $2, $3)";
const FORGET: &str = "DELETE FROM people WHERE pseudonym = $1";

/// Overwrites deleted data. Only while names are written: for the journal it would cost too much.
const OVERWRITE: &str = "PRAGMA secure_delete = ON";
const LEAVE: &str = "PRAGMA secure_delete = OFF";
const EMPTY_LOG: &str = "PRAGMA wal_checkpoint(TRUNCATE)";

/// Statements that remove a worker from lists: `$1` is the number, `$2` the id on the wire, `$3` the time.
const LISTS: [&str; 6] = [
    "UPDATE encounters INDEXED BY encounters_of_worker SET worker = -1 WHERE worker >= 0 AND worker = $1",
    "UPDATE assignments INDEXED BY assignments_of_worker SET worker = NULL WHERE worker = $1",
    "DELETE FROM events INDEXED BY events_of_worker WHERE worker = $1",
    "DELETE FROM alarms INDEXED BY alarms_by_subject \
     WHERE subject_kind = 'worker' AND subject = $2 AND cleared IS NOT NULL",
    "UPDATE audit INDEXED BY audit_by_actor SET actor = 'device of ' || $2 \
     WHERE actor IN (SELECT name FROM tokens WHERE subject = $2)",
    "UPDATE tokens SET name = 'device of ' || $2, revoked = coalesce(revoked, $3) WHERE subject = $2",
];

/// A name and its pseudonym.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PersonRow {
    /// The pseudonym that everything else uses for this person.
    pub pseudonym: String,
    /// The name.
    pub name: String,
    /// When the person was registered.
    pub since: Time,
}

impl Store {
    /// All names.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn people(&self) -> Result<Vec<PersonRow>, StoreError> {
        let rows = sqlx::query(ALL).fetch_all(&self.readers).await?;
        let read = |row: &SqliteRow| -> Result<PersonRow, sqlx::Error> {
            let since = Time(row.try_get("since")?);
            Ok(PersonRow { pseudonym: row.try_get("pseudonym")?, name: row.try_get("name")?, since })
        };
        Ok(rows.iter().map(read).collect::<Result<_, _>>()?)
    }

    /// Stores a name.
    ///
    /// # Errors
    /// If the database refuses the write.
    pub async fn keep_name(&self, person: &PersonRow) -> Result<(), StoreError> {
        let mut connection = self.writer.acquire().await?;
        sqlx::query(OVERWRITE).execute(&mut *connection).await?;
        let query = sqlx::query(ADD).bind(&person.pseudonym).bind(&person.name).bind(person.since.0);
        let kept = query.execute(&mut *connection).await;
        sqlx::query(LEAVE).execute(&mut *connection).await?;
        kept?;
        Ok(())
    }

    /// Erases a name, and the person's identity in all lists. Without a worker, only the name.
    ///
    /// # Errors
    /// If the database refuses the write. Then nothing is forgotten, or it may be said again.
    pub async fn erase(
        &self,
        pseudonym: &str,
        worker: Option<WorkerId>,
        now: Time,
    ) -> Result<(), StoreError> {
        let mut connection = self.writer.acquire().await?;
        sqlx::query(OVERWRITE).execute(&mut *connection).await?;
        let erased = erase(&mut connection, pseudonym, worker, now).await;
        if erased.is_err() {
            let _ = sqlx::query(ROLLBACK).execute(&mut *connection).await;
        }
        sqlx::query(LEAVE).execute(&mut *connection).await?;
        erased?;
        sqlx::query(EMPTY_LOG).execute(&mut *connection).await?;
        Ok(())
    }
}

async fn erase(
    db: &mut SqliteConnection,
    pseudonym: &str,
    worker: Option<WorkerId>,
    now: Time,
) -> Result<(), sqlx::Error> {
    sqlx::query(BEGIN).execute(&mut *db).await?;
    sqlx::query(FORGET).bind(pseudonym).execute(&mut *db).await?;
    if let Some(worker) = worker {
        for list in LISTS {
            let query = sqlx::query(list).bind(worker.0).bind(format!("w{}", worker.0 + 1)).bind(now.0);
            query.execute(&mut *db).await?;
        }
    }
    sqlx::query(COMMIT).execute(&mut *db).await?;
    Ok(())
}
