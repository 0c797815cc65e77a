//! The map that was published to a running server, and the file that it replaced.
//!
//! Main types: [`PublishedMap`], [`MapNote`]. The note is part of the transaction in which the database changes to the
//! map: after a kill there is the old map, or the new one with its note. Refuses: to choose between the two at a start;
//! the server does.

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
    /// Number of the published map, counted from 1.
    pub number: u32,
    /// When the map was published.
    pub at: Time,
    /// Who published it.
    pub by: String,
    /// The digest of the map file with which the server had been started; see [`map_digest`].
    pub file: String,
}

/// The stored form of a published map's note.
#[derive(Serialize, Deserialize)]
struct PublishedRecord {
    number: u32,
    at: i64,
    by: String,
    file: String,
}

/// What to note about the map when a database is opened.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum MapNote {
    /// Keep the earlier note.
    #[default]
    Keep,
    /// The map is published now, by this request.
    Publish(PublishedMap, AuditRow),
    /// The map comes from a file again.
    Forget,
}

/// A digest over everything in a map file.
pub fn map_digest(map: &Warehouse) -> String {
    Sha256::digest(json::write(map)).iter().map(|b| format!("{b:02x}")).collect()
}

/// Writes the note, in the transaction that it belongs to.
pub(super) async fn note(db: &mut SqliteConnection, note: &MapNote) -> Result<(), StoreError> {
    match note {
        MapNote::Keep => {}
        MapNote::Forget => _ = sqlx::query(FORGET).execute(&mut *db).await?,
        MapNote::Publish(map, request) => {
            let PublishedMap { number, at, by, file } = map.clone();
            debug_assert!(number > 0, "published maps are numbered from 1");
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
    /// If the database does not answer, or the note cannot be read.
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
