//! Sessions of browsers: digests of cookies, and the tokens or people that they stand for.
//!
//! Main type: [`SessionRow`]. Refuses: more than [`MOST_EACH`] sessions of one token or person; the oldest of that
//! token or person end first.

use super::{Store, StoreError};
use giveway_floor::time::Time;
use sqlx::Row;

/// Largest number of sessions of one token, or of one person.
pub const MOST_EACH: i64 = 100;

const ALL: &str = "SELECT hash, token, name, role, created, expires FROM sessions";
const ADD: &str =
    "INSERT INTO sessions (hash, token, name, role, created, expires) VALUES ($1, $2, $3, $4, $5, $6)";
const END: &str = "DELETE FROM sessions WHERE hash = $1";
const TIDY: &str = "DELETE FROM sessions WHERE expires <= $1 \
    OR hash IN (SELECT hash FROM sessions WHERE token = $2 AND name IS $3 ORDER BY created DESC, rowid DESC \
    LIMIT -1 OFFSET $4)";

/// What is kept of a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SessionRow {
    /// SHA-256 of the cookie, 32 bytes.
    pub hash: Vec<u8>,
    /// SHA-256 of the token, 32 bytes; empty if the session stands for a person.
    pub token: Vec<u8>,
    /// Name and role of the person.
    pub person: Option<(String, String)>,
    /// When the session began.
    pub created: Time,
    /// When the session expires.
    pub expires: Time,
}

impl Store {
    /// All sessions.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn sessions(&self) -> Result<Vec<SessionRow>, StoreError> {
        let rows = sqlx::query(ALL).fetch_all(&self.readers).await?;
        let read = |row: &sqlx::sqlite::SqliteRow| -> Result<SessionRow, sqlx::Error> {
            let (created, expires) = (Time(row.try_get("created")?), Time(row.try_get("expires")?));
            let (name, role): (Option<String>, Option<String>) = (row.try_get("name")?, row.try_get("role")?);
            let (hash, token, person) = (row.try_get("hash")?, row.try_get("token")?, name.zip(role));
            Ok(SessionRow { hash, token, person, created, expires })
        };
        Ok(rows.iter().map(read).collect::<Result<_, _>>()?)
    }

    /// Adds a session, and deletes those that are over.
    ///
    /// # Errors
    /// If the database refuses the write.
    pub async fn add_session(&self, new: &SessionRow) -> Result<(), StoreError> {
        debug_assert!(new.created < new.expires, "a session lasts for some time");
        let (name, role) = new.person.as_ref().map(|(name, role)| (name, role)).unzip();
        let mut tx = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        let query = sqlx::query(ADD).bind(&new.hash).bind(&new.token).bind(name).bind(role);
        query.bind(new.created.0).bind(new.expires.0).execute(&mut *tx).await?;
        let tidy = sqlx::query(TIDY).bind(new.created.0).bind(&new.token).bind(name);
        tidy.bind(MOST_EACH).execute(&mut *tx).await?;
        tx.commit().await?;
        Ok(())
    }

    /// Ends a session.
    ///
    /// # Errors
    /// If the database refuses the write.
    pub async fn end_session(&self, hash: &[u8]) -> Result<(), StoreError> {
        sqlx::query(END).bind(hash).execute(&self.writer).await?;
        Ok(())
    }
}
