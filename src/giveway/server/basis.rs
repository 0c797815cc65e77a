//! What a server is started with, and the map that it uses: the file's, or the one that was published to it.
//!
//! Main types: [`FloorBasis`]; main function [`FloorBasis::choose`]. Refuses: to choose if the file was changed and
//! another map was published.

use super::{FloorSource, ServedFloor};
use anyhow::{Context, bail};
use giveway_fleet::RobotKind;
use giveway_floor::warehouse::Warehouse;
use giveway_store::{PublishedMap, Store, map_digest};
use std::path::Path;
use std::sync::Arc;

/// What stays the same from one map to the next.
#[derive(Clone)]
pub struct FloorBasis {
    /// The floor as its file describes it.
    pub source: FloorSource,
    /// The digest of the map with which the server was started.
    pub file: String,
    /// The publication of the map in operation, if it was published.
    pub published: Option<PublishedMap>,
}

impl FloorBasis {
    /// The basis of a floor whose map comes from a file.
    pub fn of(floor: &ServedFloor) -> FloorBasis {
        FloorBasis { source: floor.source.clone(), file: map_digest(&floor.map), published: None }
    }

    /// Uses the database's map instead of the file's, if it was published since the server was started with this file,
    /// or is the same map.
    ///
    /// # Errors
    /// If the file was changed, too, or the published map does not suit this fleet.
    pub async fn choose(floor: ServedFloor, database: &Path) -> anyhow::Result<(ServedFloor, FloorBasis)> {
        let mut basis = FloorBasis::of(&floor);
        let Some((published, map)) = published_in(database).await? else { return Ok((floor, basis)) };
        if basis.file != published.file && basis.file != map_digest(&map) {
            bail!("{}", conflict(&floor.map, &map, &published));
        }
        let map = basis.fit(&Arc::new(map)).map_err(|why| {
            anyhow::anyhow!(
                "the map {:?} was published to this server, but is not for this fleet: {}. Start with the scenario \
                 with which it was published, or take the map of the file: `giveway database carry`",
                floor.map.name,
                why.join("; ")
            )
        })?;
        basis.published = Some(published);
        Ok((ServedFloor { map, ..floor }, basis))
    }

    /// The map fitted to the robots of the site and to what is simulated.
    ///
    /// # Errors
    /// Why the map does not suit them.
    pub fn fit(&self, map: &Arc<Warehouse>) -> Result<Arc<Warehouse>, Vec<String>> {
        let mut why: Vec<String> = self.source.unfit(map);
        let fitted = match self.source.site().fit(map) {
            Ok(fitted) => fitted,
            Err(findings) => {
                why.extend(findings.0.iter().map(ToString::to_string));
                return Err(why);
            }
        };
        why.extend(self.source.site().check_method(&fitted, "method").err().map(|e| e.to_string()));
        if why.is_empty() { Ok(fitted) } else { Err(why) }
    }

    /// The map fitted to the fleet of the scenario, if it also suits the added kinds: the fleet adds those.
    ///
    /// # Errors
    /// Why the map does not suit them.
    pub fn fit_all(&self, map: &Arc<Warehouse>, added: &[RobotKind]) -> Result<Arc<Warehouse>, Vec<String>> {
        let fitted = self.fit(map)?;
        let lost = not_for(&fitted, added);
        if lost.is_empty() { Ok(fitted) } else { Err(lost) }
    }

    /// The floor with this map.
    pub fn with(&self, map: Arc<Warehouse>) -> ServedFloor {
        ServedFloor::new(self.source.clone(), map)
    }
}

/// Why the map does not suit added robot kinds: one text for each such kind.
pub fn not_for(map: &Warehouse, added: &[RobotKind]) -> Vec<String> {
    let lost = added.iter().filter(|kind| map.check_body(&kind.body()).is_err());
    lost.map(|kind| format!("the map is not for robots of the kind {:?}, which was added", kind.name))
        .collect()
}

/// The map that was published to a server with this database, if any.
async fn published_in(database: &Path) -> anyhow::Result<Option<(PublishedMap, Warehouse)>> {
    if !std::fs::metadata(database).is_ok_and(|m| m.is_file() && m.len() > 0) {
        return Ok(None);
    }
    // A database that cannot be read is refused when it is opened.
    let store = match Store::inspect(database).await {
        Ok(store) => store,
        Err(e) if e.is_no_room() => return Err(e.into()),
        Err(_) => return Ok(None),
    };
    let found = read_published(&store).await;
    store.close().await;
    found
}

/// Whether the database has switched to this published map.
pub async fn has_gone_over(database: &Path, note: &PublishedMap) -> bool {
    matches!(published_in(database).await, Ok(Some((published, _))) if published == *note)
}

async fn read_published(store: &Store) -> anyhow::Result<Option<(PublishedMap, Warehouse)>> {
    // A database that was never used has no tables.
    let Ok(Some(published)) = store.published().await else { return Ok(None) };
    let damaged =
        "the database says that its map was published, but the map in it cannot be read: restore a backup";
    Ok(Some((published, store.map().await?.context(damaged)?)))
}

fn conflict(file: &Warehouse, map: &Warehouse, published: &PublishedMap) -> String {
    let at = jiff::Timestamp::from_microsecond(published.at.0).map_or_else(|_| "?".into(), |t| t.to_string());
    format!(
        "two maps claim this server: {:?} was published to it by {} at {at}, and the map file, {:?}, is another one \
         than the one with which it was started then. Nothing was changed. To keep the published map, write it into \
         the file: `giveway database map --output FILE`. To take the map of the file: `giveway database carry --map \
         FILE`. Then start again",
        map.name, published.by, file.name
    )
}
