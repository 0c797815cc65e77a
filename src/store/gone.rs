//! Names of things that old rows refer to and the map no longer has.
//!
//! Main type: `Gone`, all of them; [`GoneNames`] are the names for one row. Ids of gone things are beyond every map, so
//! that they never come to mean something else. Refuses: to name what the map has.

use super::StoreError;
use giveway_fleet::{GoneNames, Job, JobFailure, JobState};
use giveway_floor::id::{NodeId, StationId};
use sqlx::Row;
use sqlx::sqlite::{SqliteExecutor, SqlitePool};
use std::collections::BTreeMap;

/// Ids of gone things begin here: no map is that large.
pub(super) const BEYOND: u32 = 1 << 31;

const ALL: &str = "SELECT kind, id, name FROM gone";
const TABLES: &str = "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name = 'gone'";

/// Things that have positions in a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum GoneKind {
    Node,
    Station,
    Rack,
}

impl GoneKind {
    pub const ALL: [GoneKind; 3] = [GoneKind::Node, GoneKind::Station, GoneKind::Rack];

    pub fn word(self) -> &'static str {
        match self {
            GoneKind::Node => "node",
            GoneKind::Station => "station",
            GoneKind::Rack => "rack",
        }
    }
}

/// The names of all gone things.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Gone(pub BTreeMap<(GoneKind, u32), String>);

impl Gone {
    /// Reads the names from a database; none if its tables are older.
    pub async fn read(db: &SqlitePool) -> Result<Gone, StoreError> {
        let tables: i64 = sqlx::query_scalar(TABLES).fetch_one(db).await?;
        if tables == 0 { Ok(Gone::default()) } else { Gone::of(db).await }
    }

    /// Reads the names from the table.
    pub async fn of(db: impl SqliteExecutor<'_>) -> Result<Gone, StoreError> {
        let mut gone = BTreeMap::new();
        for row in sqlx::query(ALL).fetch_all(db).await? {
            let word: &str = row.try_get(0)?;
            if let Some(kind) = GoneKind::ALL.into_iter().find(|k| k.word() == word) {
                gone.insert((kind, row.try_get(1)?), row.try_get(2)?);
            }
        }
        Ok(Gone(gone))
    }

    fn name(&self, kind: GoneKind, id: u32) -> Option<String> {
        self.0.get(&(kind, id)).cloned()
    }

    /// The name of a gone node.
    pub fn node(&self, node: NodeId) -> Option<String> {
        self.name(GoneKind::Node, node.0)
    }

    /// The name of a gone station.
    pub fn station(&self, station: StationId) -> Option<String> {
        self.name(GoneKind::Station, station.0)
    }

    /// The names of the gone things that a job refers to.
    pub fn of_job(&self, job: &Job) -> GoneNames {
        let kind = &job.request.kind;
        let state = job.state;
        let stops = job.served.iter().map(|(v, _)| v).chain(&job.request.then);
        let station = |s: StationId| Some((s, self.station(s)?));
        let taken = match state {
            JobState::Failed(JobFailure::StorageTaken(node)) => Some(node),
            _ => None,
        };
        let node = kind.parts().node.or(taken).and_then(|node| self.node(node));
        GoneNames {
            rack: kind.rack().and_then(|r| self.name(GoneKind::Rack, r.0)),
            station: kind.station().and_then(|s| self.station(s)),
            node,
            stops: stops.filter_map(|v| station(v.station)).collect(),
        }
    }
}
