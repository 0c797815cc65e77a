//! Kinds of robots that were added over HTTP: name and figures, as the request gave them.
//!
//! Main type: [`KindText`]. Refuses: to know what the figures mean; the scenario's reader does.

use super::{Store, StoreError};
use sqlx::Row;

const ALL: &str = "SELECT name, figures FROM kinds ORDER BY name";
const TABLES: &str = "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name = 'kinds'";
const PUT: &str = "INSERT OR REPLACE INTO kinds (name, figures) VALUES ($1, $2)";
const REMOVE: &str = "DELETE FROM kinds WHERE name = $1";

/// A kind as it was added.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KindText {
    /// Its name.
    pub name: String,
    /// Its figures: a JSON object with the keys of `fleet` in scenarios.
    pub figures: String,
}

impl Store {
    /// All kinds that were added, by name. A database that no later Giveway has opened to write has none.
    ///
    /// # Errors
    /// Where the database does not answer.
    pub async fn kinds(&self) -> Result<Vec<KindText>, StoreError> {
        let tables: i64 = sqlx::query_scalar(TABLES).fetch_one(&self.readers).await?;
        if tables == 0 {
            return Ok(Vec::new());
        }
        let rows = sqlx::query(ALL).fetch_all(&self.readers).await?;
        let kind = |row: &sqlx::sqlite::SqliteRow| {
            Ok(KindText { name: row.try_get("name")?, figures: row.try_get("figures")? })
        };
        rows.iter().map(kind).collect()
    }

    /// Adds a kind, or replaces the one of its name. When this returns, it survives loss of power.
    ///
    /// # Errors
    /// Where the database takes nothing, or its file was taken away.
    pub async fn put_kind(&self, kind: &KindText) -> Result<(), StoreError> {
        self.check_place()?;
        sqlx::query(PUT).bind(&kind.name).bind(&kind.figures).execute(&self.writer).await?;
        self.check_place()
    }

    /// Removes a kind. Whether there was one of this name.
    ///
    /// # Errors
    /// Where the database takes nothing, or its file was taken away.
    pub async fn remove_kind(&self, name: &str) -> Result<bool, StoreError> {
        self.check_place()?;
        let done = sqlx::query(REMOVE).bind(name).execute(&self.writer).await?;
        self.check_place()?;
        Ok(done.rows_affected() > 0)
    }
}
