//! A database under a changed map: compared, backed up, and carried over in one transaction, or refused with reasons.
//!
//! Main types: [`CarryOver`] (what the caller wants), [`CarriedOver`] (what was done). The core carries the ledger over
//! ([`giveway_fleet::carry`]); the lists get the new map's ids, and anything they refer to that is gone keeps its name.
//! A kill at any instant leaves the old database or the new one. Refuses: obstacles always, losses unless they were
//! accepted, and to begin without a backup.

use super::check::{back_up, sync_folder};
use super::events::NOTE_JOBS;
use super::gone::{BEYOND, Gone, GoneKind};
use super::jobs::StopsRecord;
use super::opening::free_name;
use super::{
    MapNote, Opening, Store, StoreError, floor, job_record, last_step, ledger_record, published, seal, steps,
};
use giveway_fleet::carry::{Carried, Report, carry};
use giveway_fleet::{AssignmentState, JobFailure, JobState, Ledger, RobotKind, RobotKinds};
use giveway_floor::id::{Dense, IdVec};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;
use sqlx::sqlite::{SqliteConnection, SqlitePool};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const IDS: &str =
    "CREATE TEMP TABLE ids (kind TEXT, old INTEGER, new INTEGER, PRIMARY KEY (kind, old)) WITHOUT ROWID";
const MAP_ID: &str = "INSERT INTO temp.ids \
    SELECT $1, json_extract(value, '$[0]'), json_extract(value, '$[1]') FROM json_each($2)";
const DROP_IDS: &str = "DROP TABLE temp.ids";
const FORGET_GONE: &str = "DELETE FROM gone";
const NOTE_GONE: &str = "INSERT INTO gone (kind, id, name) VALUES ($1, $2, $3)";
/// Ids in rows that refer to something gone: ids from a number on.
const NAMED: &str = "SELECT 'rack', rack FROM jobs WHERE rack >= $1 \
    UNION SELECT 'station', station FROM jobs WHERE station >= $1 \
    UNION SELECT 'station', value FROM jobs, json_tree(stops) WHERE type = 'integer' AND value >= $1 \
    UNION SELECT 'station', subject FROM events WHERE kind = 'station' AND subject >= $1 \
    UNION SELECT 'node', node FROM jobs WHERE node >= $1 \
    UNION SELECT 'node', json_extract(why, '$.storage_taken') FROM jobs WHERE state = 'failed' \
        AND why LIKE '{\"storage_taken\"%' AND json_extract(why, '$.storage_taken') >= $1 \
    UNION SELECT 'node', place FROM assignments WHERE place >= $1 \
    UNION SELECT 'node', node FROM heat WHERE node >= $1";
/// Rows of the heat table have their node as key: each key is first made negative, so that no two rows share one
/// meanwhile.
const RENUMBER: [&str; 8] = [
    "UPDATE jobs SET rack = (SELECT new FROM temp.ids WHERE kind = 'rack' AND old = rack) \
     WHERE rack IN (SELECT old FROM temp.ids WHERE kind = 'rack')",
    "UPDATE jobs SET station = (SELECT new FROM temp.ids WHERE kind = 'station' AND old = station) \
     WHERE station IN (SELECT old FROM temp.ids WHERE kind = 'station')",
    "UPDATE jobs SET node = (SELECT new FROM temp.ids WHERE kind = 'node' AND old = node) \
     WHERE node IN (SELECT old FROM temp.ids WHERE kind = 'node')",
    "UPDATE jobs SET why = json_object('storage_taken', (SELECT new FROM temp.ids WHERE kind = 'node' \
     AND old = json_extract(why, '$.storage_taken'))) WHERE state = 'failed' AND why LIKE '{\"storage_taken\"%' \
     AND json_extract(why, '$.storage_taken') IN (SELECT old FROM temp.ids WHERE kind = 'node')",
    "UPDATE assignments SET place = (SELECT new FROM temp.ids WHERE kind = 'node' AND old = place) \
     WHERE place IN (SELECT old FROM temp.ids WHERE kind = 'node')",
    "UPDATE events SET subject = (SELECT new FROM temp.ids WHERE kind = 'station' AND old = subject) \
     WHERE kind = 'station' AND subject IN (SELECT old FROM temp.ids WHERE kind = 'station')",
    "UPDATE heat SET node = -1 - (SELECT new FROM temp.ids WHERE kind = 'node' AND old = node) \
     WHERE node IN (SELECT old FROM temp.ids WHERE kind = 'node')",
    "UPDATE heat SET node = -1 - node WHERE node < 0",
];
const STOPS: &str = "SELECT id, stops FROM jobs WHERE stops IS NOT NULL";
const SET_STOPS: &str = "UPDATE jobs SET stops = $2 WHERE id = $1";
const WAIT_AGAIN: &str = "UPDATE jobs SET state = 'waiting', why = NULL, worker = NULL, updated = $1, \
    assigned_at = NULL, lifted_at = NULL, arrived_at = NULL \
    WHERE id IN (SELECT value FROM json_each($2))";
const FAIL: &str = "UPDATE jobs SET state = $3, why = $4, updated = $1, ended_at = $1 \
    WHERE id IN (SELECT value FROM json_each($2))";
const CANCEL: &str =
    "UPDATE assignments SET state = $3, updated = $1 WHERE id IN (SELECT value FROM json_each($2))";
const FORGET: [&str; 2] = ["DELETE FROM steps", "DELETE FROM snapshots"];
const SNAPSHOT: &str = "INSERT INTO snapshots (seq, at, wire, body) VALUES ($1, $2, $3, $4)";

/// How to carry over a database that belongs to another map.
#[derive(Clone, Debug)]
pub struct CarryOver {
    /// The kinds of robots of the site, for which the map is made.
    pub kinds: Vec<RobotKind>,
    /// Whether losses are accepted.
    pub accept_losses: bool,
    /// Text that becomes part of the names of files kept from before.
    pub stamp: String,
}

/// A database that was carried over.
#[derive(Clone, Debug)]
pub struct CarriedOver {
    /// The name of the map to which the database belonged.
    pub from: String,
    /// The report of what was carried over and what was lost.
    pub report: Report,
    /// A whole copy of the database as it was; nothing if it was empty.
    pub backup: Option<PathBuf>,
}

/// The ledger of the old map, carried over, and where the journal ends.
struct Compared {
    carried: Carried,
    last: i64,
    at: Time,
}

/// Carries a database over to another map than its own.
pub(super) async fn carry_over(
    db: &SqlitePool,
    path: &Path,
    map: &Warehouse,
    theirs: String,
    opening: &Opening,
) -> Result<CarriedOver, StoreError> {
    let other = || StoreError::OtherMap { path: path.into(), theirs: theirs.clone(), ours: map.name.clone() };
    let wanted = opening.carry.as_ref().filter(|_| opening.new.is_none()).ok_or_else(other)?;
    if last_step(db).await? == 0 {
        // No promise was ever made.
        let mut tx = db.begin_with("BEGIN IMMEDIATE").await?;
        floor::keep(&mut tx, map).await?;
        published::note(&mut tx, &opening.note).await?;
        tx.commit().await?;
        return Ok(CarriedOver { from: theirs, report: Report::default(), backup: None });
    }
    let unknown =
        || StoreError::UnknownMap { path: path.into(), theirs: theirs.clone(), ours: map.name.clone() };
    let old = Arc::new(floor::stored(db).await?.ok_or_else(unknown)?);
    let compared = compare(db, path, old.clone(), Arc::new(map.clone()), &wanted.kinds).await?;
    let report = compared.carried.report.clone();
    if !report.obstacles.is_empty() || (!report.losses.is_empty() && !wanted.accept_losses) {
        let (ours, report) = (map.name.clone(), Box::new(report));
        return Err(StoreError::ChangedMap { path: path.into(), theirs, ours, report });
    }
    let backup = free_name(path, &format!("before-map-change-{}", wanted.stamp));
    back_up(db, &backup).await?;
    tracing::warn!("the map has changed; the database as it was is kept as {}", backup.display());
    if !compared.carried.ids.keeps_ids() {
        set_frames_aside(&opening.traces, &format!("before-map-change-{}", wanted.stamp))?;
    }
    write(db, (&old, map), compared, &opening.note).await?;
    tracing::warn!("the database was carried over from the map \"{theirs}\" to \"{}\":\n{report}", map.name);
    Ok(CarriedOver { from: theirs, report, backup: Some(backup) })
}

impl Store {
    /// What a start with this map would carry over, and what not; nothing if the map is the database's own. The map is
    /// made for `kinds`, the kinds of the site.
    ///
    /// # Errors
    /// If the database cannot be read, or does not have its own map.
    pub async fn compare(
        &self,
        map: &Arc<Warehouse>,
        kinds: &[RobotKind],
    ) -> Result<Option<Report>, StoreError> {
        let Some(about) = self.belongs().await?.filter(|about| about.seal != seal(map)) else {
            return Ok(None);
        };
        if last_step(&self.readers).await? == 0 {
            return Ok(Some(Report::default()));
        }
        let (path, ours) = (self.path().to_owned(), map.name.clone());
        let unknown = || StoreError::UnknownMap { path: path.clone(), theirs: about.map.clone(), ours };
        let old = Arc::new(self.map().await?.ok_or_else(unknown)?);
        let compared = compare(&self.readers, &path, old, map.clone(), kinds).await?;
        Ok(Some(compared.carried.report))
    }
}

/// Folds the journal under the old map and carries the ledger over. The result is read back before it is trusted.
async fn compare(
    db: &SqlitePool,
    path: &Path,
    old: Arc<Warehouse>,
    new: Arc<Warehouse>,
    kinds: &[RobotKind],
) -> Result<Compared, StoreError> {
    let kinds = kinds.to_vec();
    let before = kinds_of(&old, RobotKinds::of_site(&kinds).clearance());
    let loaded = steps::load(db, Ledger::new(old, &before, false)).await?;
    let (last, at) = (loaded.next - 1, loaded.last.unwrap_or(Time::ZERO));
    let fold = move || {
        let (mut ledger, facts) = loaded.into_parts();
        facts.into_iter().for_each(|fact| ledger.evolve(&fact));
        let carried = carry(&ledger, &new, at);
        let read = |parts| Ledger::from_parts(new.clone(), &kinds, parts).map(drop);
        let sound = carried.parts.clone().map_or(Ok(()), read);
        (carried, sound)
    };
    let broken = |why: String| StoreError::Carry { path: path.into(), why };
    let folded = tokio::task::spawn_blocking(fold).await;
    let (carried, sound) =
        folded.map_err(|_| broken("the journal contradicts itself, as said above".into()))?;
    sound.map_err(|why| broken(why.to_string()))?;
    Ok(Compared { carried, last, at })
}

/// The kinds of a building as far as the map alone tells: what holds depend on, with usual values for all else.
pub(super) fn kinds_of(map: &Warehouse, clearance: Span) -> Vec<RobotKind> {
    map.bodies().iter().map(|body| RobotKind::of_body(body, clearance)).collect()
}

/// Moves recordings of the past aside: they name places by the old map's positions, so they are kept but not shown.
pub(super) fn set_frames_aside(folders: &[PathBuf], stamp: &str) -> Result<(), StoreError> {
    for folder in folders.iter().filter(|folder| folder.exists()) {
        let aside = free_name(folder, stamp);
        std::fs::rename(folder, &aside).map_err(|why| StoreError::Aside { path: folder.clone(), why })?;
        let _ = sync_folder(folder);
        tracing::warn!("frames of the past are of before; they are kept in {}", aside.display());
    }
    Ok(())
}

/// Writes everything in one transaction.
async fn write(
    db: &SqlitePool,
    (old, new): (&Warehouse, &Warehouse),
    compared: Compared,
    note: &MapNote,
) -> Result<(), StoreError> {
    let Compared { carried, last, at } = compared;
    let parts = carried.parts.expect("nothing is in the way");
    let encode = move || ledger_record::encode(&parts);
    let body = tokio::task::spawn_blocking(encode).await.expect("writing text does not break");
    let mut tx = db.begin_with("BEGIN IMMEDIATE").await?;
    let found: i64 = sqlx::query_scalar(steps::LAST).fetch_one(&mut *tx).await?;
    if found != last {
        return Err(StoreError::OutOfStep { expected: last, found });
    }
    renumber(&mut tx, old, new).await?;
    let (jobs, failed) = (numbers(&carried.waiting, |j| j.0), numbers(&carried.failed, |j| j.0));
    let cancelled = numbers(&carried.cancelled, |a| a.0);
    let (state, why) =
        (JobState::Failed(JobFailure::MapChanged), job_record::encode_failure(JobFailure::MapChanged));
    sqlx::query(NOTE_JOBS).bind(at.0).bind(&jobs).bind(JobState::Waiting.word()).execute(&mut *tx).await?;
    sqlx::query(NOTE_JOBS).bind(at.0).bind(&failed).bind(state.word()).execute(&mut *tx).await?;
    sqlx::query(WAIT_AGAIN).bind(at.0).bind(jobs).execute(&mut *tx).await?;
    sqlx::query(FAIL).bind(at.0).bind(failed).bind(state.word()).bind(why).execute(&mut *tx).await?;
    let word = AssignmentState::Cancelled.word();
    sqlx::query(CANCEL).bind(at.0).bind(cancelled).bind(word).execute(&mut *tx).await?;
    for statement in FORGET {
        sqlx::query(statement).execute(&mut *tx).await?;
    }
    let row = sqlx::query(SNAPSHOT).bind(last).bind(at.0).bind(ledger_record::VERSION).bind(body);
    row.execute(&mut *tx).await?;
    floor::keep(&mut tx, new).await?;
    published::note(&mut tx, note).await?;
    tx.commit().await?;
    Ok(())
}

fn numbers<I: Copy>(ids: &[I], number: impl Fn(I) -> u64) -> String {
    let ids: Vec<u64> = ids.iter().map(|id| number(*id)).collect();
    serde_json::to_string(&ids).expect("a list of numbers is JSON")
}

/// Gives the rows of all lists the new map's ids, and notes the names of everything gone that some row refers to.
async fn renumber(db: &mut SqliteConnection, old: &Warehouse, new: &Warehouse) -> Result<(), StoreError> {
    let known = Gone::of(&mut *db).await?;
    let mut gone = Gone::default();
    sqlx::query(IDS).execute(&mut *db).await?;
    for kind in GoneKind::ALL {
        let changes = changes(kind, &names(kind, old), &names(kind, new), &known, &mut gone);
        if kind == GoneKind::Station {
            renumber_stops(&mut *db, &changes.iter().copied().collect()).await?;
        }
        let changes = serde_json::to_string(&changes).expect("a list of numbers is JSON");
        sqlx::query(MAP_ID).bind(kind.word()).bind(changes).execute(&mut *db).await?;
    }
    for statement in RENUMBER {
        sqlx::query(statement).execute(&mut *db).await?;
    }
    sqlx::query(DROP_IDS).execute(&mut *db).await?;
    sqlx::query(FORGET_GONE).execute(&mut *db).await?;
    let named: BTreeSet<(String, u32)> =
        sqlx::query_as(NAMED).bind(BEYOND).fetch_all(&mut *db).await?.into_iter().collect();
    gone.0.retain(|(kind, id), _| named.contains(&(kind.word().to_owned(), *id)));
    for ((kind, id), name) in &gone.0 {
        sqlx::query(NOTE_GONE).bind(kind.word()).bind(id).bind(name).execute(&mut *db).await?;
    }
    Ok(())
}

/// Gives the stations of deliveries with several stations their new ids.
async fn renumber_stops(db: &mut SqliteConnection, ids: &BTreeMap<u32, u32>) -> Result<(), StoreError> {
    for (job, text) in sqlx::query_as::<_, (i64, String)>(STOPS).fetch_all(&mut *db).await? {
        let broken = |e: serde_json::Error| StoreError::Job { id: job, why: e.to_string() };
        let mut stops: StopsRecord = serde_json::from_str(&text).map_err(broken)?;
        stops.renumber(|station| ids.get(&station).copied().unwrap_or(station));
        let text = serde_json::to_string(&stops).expect("lists of numbers are JSON");
        sqlx::query(SET_STOPS).bind(job).bind(text).execute(&mut *db).await?;
    }
    Ok(())
}

/// All names of a kind, in the order of their ids.
fn names(kind: GoneKind, map: &Warehouse) -> Vec<&str> {
    fn list<I: Dense, T>(things: &IdVec<I, T>, name: impl Fn(&T) -> &str) -> Vec<&str> {
        things.iter().map(name).collect()
    }
    match kind {
        GoneKind::Node => list(&map.nodes, |n| &n.name),
        GoneKind::Station => list(&map.stations, |s| &s.name),
        GoneKind::Rack => list(&map.racks, |r| &r.name),
    }
}

/// The changes of ids of one kind, old to new. A thing that is gone gets an id beyond the map; a thing that was gone
/// and has come back gets its place in the map.
fn changes(kind: GoneKind, old: &[&str], new: &[&str], known: &Gone, gone: &mut Gone) -> Vec<(u32, u32)> {
    let at: BTreeMap<&str, u32> = (0..).zip(new).map(|(id, name)| (*name, id)).collect();
    let before = known.0.iter().filter(|((k, _), _)| *k == kind).map(|((_, id), name)| (*id, name.as_str()));
    let mut beyond: BTreeMap<&str, u32> = BTreeMap::new();
    let mut changes = Vec::new();
    for (id, name) in (0..).zip(old.iter().copied()).chain(before) {
        let next = BEYOND + beyond.len() as u32;
        let to = at.get(name).copied().unwrap_or_else(|| *beyond.entry(name).or_insert(next));
        if to >= BEYOND {
            gone.0.insert((kind, to), name.to_owned());
        }
        if to != id {
            changes.push((id, to));
        }
    }
    debug_assert!(changes.is_sorted_by(|a, b| a.0 < b.0), "each number changes once");
    changes
}
