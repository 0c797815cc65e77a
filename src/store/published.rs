//! The map that was published to a running server, and the file in whose place it came.
//!
//! Main types: [`PublishedMap`], [`MapNote`]. What is noted goes into the transaction in which the database goes over
//! to the map: after a kill there is the old map, or the new one with its note. Refuses: to say which of the two a
//! start takes; the server does.

use super::{ABOUT, AuditRow, Store, StoreError, audit};
use giveway_floor::time::Time;
use giveway_floor::warehouse::Warehouse;
use giveway_floor::warehouse::formats::json;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use sqlx::sqlite::SqliteConnection;

const PUT: &str = "INSERT OR REPLACE INTO about (key, value) VALUES ('published', $1)";
const FORGET: &str = "DELETE FROM about WHERE key = 'published'";

/// Where the map of a database came from, if it was published.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PublishedMap {
    /// Which one it is, counted from 1.
    pub number: u32,
    /// When it was published.
    pub at: Time,
    /// Who did.
    pub by: String,
    /// The digest of the map file with which the server had been started; see [`map_digest`].
    pub file: String,
}

/// What the database has of it.
#[derive(Serialize, Deserialize)]
struct PublishedRecord {
    number: u32,
    at: i64,
    by: String,
    file: String,
}

/// What is noted about the map where a database is opened.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum MapNote {
    /// What was noted stays.
    #[default]
    Keep,
    /// It is published now, by this request.
    Publish(PublishedMap, AuditRow),
    /// It comes from a file again.
    Forget,
}

/// A digest over everything that the file of a map says.
pub fn map_digest(map: &Warehouse) -> String {
    Sha256::digest(json::write(map)).iter().map(|b| format!("{b:02x}")).collect()
}

/// Writes the note down, in the transaction of what it is about.
pub(super) async fn note(db: &mut SqliteConnection, note: &MapNote) -> Result<(), StoreError> {
    match note {
        MapNote::Keep => {}
        MapNote::Forget => _ = sqlx::query(FORGET).execute(&mut *db).await?,
        MapNote::Publish(map, request) => {
            let PublishedMap { number, at, by, file } = map.clone();
            let record = PublishedRecord { number, at: at.0, by, file };
            let text = serde_json::to_string(&record).expect("a record is plain");
            sqlx::query(PUT).bind(text).execute(&mut *db).await?;
            audit::note(db, request).await?;
        }
    }
    Ok(())
}

impl Store {
    /// Where the map came from, if it was published.
    ///
    /// # Errors
    /// Where the database does not answer, or the note cannot be read.
    pub async fn published(&self) -> Result<Option<PublishedMap>, StoreError> {
        let text: Option<String> =
            sqlx::query_scalar(ABOUT).bind("published").fetch_optional(&self.readers).await?;
        let damaged = |e: serde_json::Error| StoreError::Row { list: "map", id: 0, why: format!("{e}") };
        let record: Option<PublishedRecord> =
            text.map(|text| serde_json::from_str(&text).map_err(damaged)).transpose()?;
        Ok(record.map(|PublishedRecord { number, at, by, file }| PublishedMap {
            number,
            at: Time(at),
            by,
            file,
        }))
    }
}
