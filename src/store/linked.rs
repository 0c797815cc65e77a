//! Robots of other vendors that were listed over the API.
//!
//! Main type: [`LinkedRow`]. Refuses: robots of the site file, and to know whether a robot is there.

use super::{Store, StoreError};
use sqlx::Row;

const ALL: &str = "SELECT name, manufacturer, serial, kind, version FROM linked_robots ORDER BY name";
const KEEP: &str = "INSERT INTO linked_robots (name, manufacturer, serial, kind, version) VALUES ($1, $2, $3, $4, $5) \
    ON CONFLICT (name) DO UPDATE SET manufacturer = $2, serial = $3, kind = $4, version = $5";
const FORGET: &str = "DELETE FROM linked_robots WHERE name = $1";

/// A robot of another vendor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkedRow {
    /// Its name on the floor.
    pub name: String,
    /// Its manufacturer, as in its topics.
    pub manufacturer: String,
    /// Its serial number.
    pub serial: String,
    /// The name of its kind.
    pub kind: String,
    /// The version that is spoken with it; the one that it says if absent.
    pub version: Option<String>,
}

impl Store {
    /// All robots that were listed and not taken off the list.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn linked_robots(&self) -> Result<Vec<LinkedRow>, StoreError> {
        let rows = sqlx::query(ALL).fetch_all(&self.readers).await?;
        let row = |row: sqlx::sqlite::SqliteRow| {
            Ok(LinkedRow {
                name: row.try_get(0)?,
                manufacturer: row.try_get(1)?,
                serial: row.try_get(2)?,
                kind: row.try_get(3)?,
                version: row.try_get(4)?,
            })
        };
        rows.into_iter().map(row).collect()
    }

    /// Keeps a robot.
    ///
    /// # Errors
    /// If the database does not answer, or has the same robot under another name.
    pub async fn keep_linked_robot(&self, row: &LinkedRow) -> Result<(), StoreError> {
        self.check_place()?;
        let LinkedRow { name, manufacturer, serial, kind, version } = row;
        debug_assert!([name, manufacturer, serial, kind].iter().all(|text| !text.is_empty()), "it is named");
        let query = sqlx::query(KEEP).bind(name).bind(manufacturer).bind(serial).bind(kind).bind(version);
        query.execute(&self.writer).await?;
        self.check_place()
    }

    /// Forgets a robot. A name that is not kept is no error.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn forget_linked_robot(&self, name: &str) -> Result<(), StoreError> {
        self.check_place()?;
        sqlx::query(FORGET).bind(name).execute(&self.writer).await?;
        self.check_place()
    }
}
