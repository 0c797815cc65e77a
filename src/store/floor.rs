//! The map that the facts of a database refer to: kept whole beside them, so that a changed map can be compared.
//!
//! Main functions: `keep`, `stored`. It is written whenever a database is opened with a map of the same seal: databases
//! of earlier releases get it then. Refuses: a text that does not match the seal.

use super::{ABOUT, Store, StoreError, body_record, seal};
use giveway_floor::warehouse::Warehouse;
use giveway_floor::warehouse::formats::{MapError, json};
use sqlx::sqlite::{SqliteConnection, SqlitePool};

const PUT: &str = "INSERT OR REPLACE INTO about (key, value) VALUES ($1, $2)";

/// Stores the map, unless the same map is stored already. Its name or speed limits may change under one seal.
pub(super) async fn keep(db: &mut SqliteConnection, map: &Warehouse) -> Result<(), StoreError> {
    let text = json::write(map);
    for (key, value) in
        [("seal", &seal(map)), ("map", &map.name), ("floor", &text), ("kinds", &body_record::write(map))]
    {
        let there: Option<String> = sqlx::query_scalar(ABOUT).bind(key).fetch_optional(&mut *db).await?;
        if there.as_ref() != Some(value) {
            sqlx::query(PUT).bind(key).bind(value).execute(&mut *db).await?;
        }
    }
    Ok(())
}

/// The map stored in a database; nothing if no Giveway has stored one yet.
pub(super) async fn stored(db: &SqlitePool) -> Result<Option<Warehouse>, StoreError> {
    let text: Option<String> = sqlx::query_scalar(ABOUT).bind("floor").fetch_optional(db).await?;
    let sealed: Option<String> = sqlx::query_scalar(ABOUT).bind("seal").fetch_optional(db).await?;
    // Databases from before footprints by kind have no kinds: all robots took the map's square.
    let kinds: Option<String> = sqlx::query_scalar(ABOUT).bind("kinds").fetch_optional(db).await?;
    let kinds = kinds.and_then(|text| body_record::read(&text));
    let map = text.and_then(|text| read(&text));
    let map = map.map(|map| kinds.map_or_else(|| map.clone(), |kinds| map.with_bodies(kinds)));
    Ok(map.filter(|map| Some(seal(map)) == sealed))
}

/// Reads a map that was well-formed for the Giveway that wrote it. A later one may find fault with it, which may be why
/// the map was changed: here it only tells what is where.
fn read(text: &str) -> Option<Warehouse> {
    match json::parse(text) {
        Ok(map) => Some(map),
        Err(MapError::Findings(_)) => Some(json::parse_draft(text).ok()?.build_unchecked()),
        Err(MapError::Syntax { .. }) => None,
    }
}

impl Store {
    /// The map that the facts refer to; nothing if no Giveway has stored one yet.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn map(&self) -> Result<Option<Warehouse>, StoreError> {
        stored(&self.readers).await
    }
}
