//! Kinds of robots that a Giveway before 0.4 kept in a table of their own: they become facts when the database is
//! opened.
//!
//! Main function: [`take_up`]. Their robots are in the journal already, so the ledger is folded in the building as it
//! was and written anew with the kinds in it: a step, a snapshot after it, and the emptied table are one transaction,
//! and a kill leaves all of it or nothing. Refuses: invalid kinds, kinds whose name the site has by now, and kinds for
//! which the map is not made; it reports them and leaves them out.

use super::carry::kinds_of;
use super::check::back_up;
use super::opening::free_name;
use super::{BEGIN, COMMIT, ROLLBACK, Store, StoreError, floor, ledger_record, record, steps};
use giveway_fleet::{Fact, FloorFact, Ledger, Parts, RobotKind};
use giveway_floor::time::Time;
use giveway_floor::warehouse::{Body, Warehouse};
use giveway_site::read_kind;
use sqlx::sqlite::{SqliteConnection, SqlitePool};
use std::path::Path;
use std::sync::Arc;

const ALL: &str = "SELECT name, figures FROM kinds ORDER BY name";
const NAMES: &str = "SELECT name FROM kinds ORDER BY name";
const TABLES: &str = "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name = 'kinds'";
const STEP: &str = "INSERT INTO steps (seq, at, wire, run, facts, causes) VALUES ($1, $2, $3, $4, $5, '[]')";
const SNAPSHOT: &str = "INSERT INTO snapshots (seq, at, wire, body) VALUES ($1, $2, $3, $4)";
/// Older snapshots lack the kinds, and nothing may be folded from them.
const FORGET: &str = "DELETE FROM snapshots WHERE seq < $1";
const EMPTY: &str = "DELETE FROM kinds";

/// The ledger with the kinds in it, and its step.
struct TakenUp {
    /// The building for the kinds of the site as they were.
    base: Arc<Warehouse>,
    kinds: Vec<RobotKind>,
    parts: Parts,
    last: i64,
    at: Time,
}

impl Store {
    /// The names of kinds that are not facts yet: the database is of an earlier Giveway, and was not opened for
    /// writing.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn old_kinds(&self) -> Result<Vec<String>, StoreError> {
        let tables: i64 = sqlx::query_scalar(TABLES).fetch_one(&self.readers).await?;
        if tables == 0 {
            return Ok(Vec::new());
        }
        Ok(sqlx::query_scalar(NAMES).fetch_all(&self.readers).await?)
    }
}

/// Turns the kinds in the table into facts, if there are any. `map` is made for the kinds of the site; `last` is the
/// number of the last step. Gives the new number of the last step.
pub(super) async fn take_up(
    db: &SqlitePool,
    path: &Path,
    (map, run): (&Warehouse, &str),
    last: i64,
) -> Result<i64, StoreError> {
    let rows: Vec<(String, String)> = sqlx::query_as(ALL).fetch_all(db).await?;
    if rows.is_empty() {
        return Ok(last);
    }
    let kinds: Vec<RobotKind> = rows.iter().filter_map(|(name, text)| readable(map, name, text)).collect();
    let Some(before) = (if last == 0 { Some(map.clone()) } else { floor::stored(db).await? }) else {
        // The check that follows reports that the database has no map of its own.
        return Ok(last);
    };
    if last > 0 {
        back_up(db, &free_name(path, "before-kinds")).await?;
    }
    let taken = fold(db, path, before, kinds).await?;
    let mut connection = db.acquire().await?;
    let written = write(&mut connection, &taken, run, last > 0).await;
    if written.is_err() {
        let _ = sqlx::query(ROLLBACK).execute(&mut *connection).await;
    }
    written?;
    for kind in &taken.kinds {
        tracing::info!("the added kind {:?} is a fact from now on", kind.name);
    }
    Ok(taken.last + 1)
}

/// The kind of a row, if it is a valid kind.
fn readable(map: &Warehouse, name: &str, text: &str) -> Option<RobotKind> {
    if map.bodies().iter().any(|body| body.kind == name) {
        tracing::warn!("the added kind {name:?} is left out: the site's file has one of this name");
        return None;
    }
    let kind = read_kind(name, text);
    kind.inspect_err(|why| tracing::warn!("the added kind {name:?} is left out: {why}; it was {text}")).ok()
}

/// Folds the journal in the building as it was, with the kinds that were in force, and adds all of them.
async fn fold(
    db: &SqlitePool,
    path: &Path,
    before: Warehouse,
    mut kinds: Vec<RobotKind>,
) -> Result<TakenUp, StoreError> {
    let clearance = RobotKind::default().kinematics.clearance;
    let (in_force, before) = (kinds_of(&before, clearance), Arc::new(before));
    let loaded = steps::load(db, Ledger::new(before.clone(), &in_force, false)).await?;
    let (last, at) = (loaded.next - 1, loaded.last.unwrap_or(Time::ZERO));
    let work = move || {
        let (mut ledger, facts) = loaded.into_parts();
        facts.into_iter().for_each(|fact| ledger.evolve(&fact));
        let of_site = |body: &&Body| !kinds.iter().any(|kind| kind.name == body.kind);
        let bodies: Vec<Body> = before.bodies().iter().filter(of_site).cloned().collect();
        let base = Arc::new(before.with_bodies(bodies));
        kinds.retain(|kind| {
            let body = kind.body();
            let was_in_force = before.bodies().iter().any(|known| *known == body);
            was_in_force || base.check_body(&body).inspect_err(|why| not_for_map(kind, why)).is_ok()
        });
        let parts = Parts { added_kinds: kinds.clone(), ..ledger.to_parts() };
        let sound = Ledger::from_parts(base.clone(), &kinds_of(&base, clearance), parts.clone());
        sound.map(|_| TakenUp { base, kinds, parts, last, at })
    };
    let broken = |why: String| StoreError::Carry { path: path.into(), why };
    let folded = tokio::task::spawn_blocking(work).await;
    let folded = folded.map_err(|_| broken("the journal contradicts itself, as said above".into()))?;
    folded.map_err(|why| broken(why.to_string()))
}

fn not_for_map(kind: &RobotKind, why: &impl std::fmt::Display) {
    tracing::warn!("the added kind {:?} is left out, since the map is not for it: {why}", kind.name);
}

/// Writes everything in one transaction. A database without any promise has no map of its own yet.
async fn write(
    db: &mut SqliteConnection,
    taken: &TakenUp,
    run: &str,
    keeps_map: bool,
) -> Result<(), StoreError> {
    let (seq, at) = (taken.last + 1, taken.at);
    let put = |kind: &RobotKind| Fact::Floor(FloorFact::KindPut { kind: Box::new(kind.clone()), at });
    let facts: Vec<Fact> = taken.kinds.iter().map(put).collect();
    sqlx::query(BEGIN).execute(&mut *db).await?;
    let step = sqlx::query(STEP).bind(seq).bind(at.0).bind(record::VERSION).bind(run);
    step.bind(record::encode(&facts)).execute(&mut *db).await?;
    let body = ledger_record::encode(&taken.parts);
    let snapshot = sqlx::query(SNAPSHOT).bind(seq).bind(at.0).bind(ledger_record::VERSION).bind(body);
    snapshot.execute(&mut *db).await?;
    sqlx::query(FORGET).bind(seq).execute(&mut *db).await?;
    if keeps_map {
        floor::keep(&mut *db, &taken.base).await?;
    }
    sqlx::query(EMPTY).execute(&mut *db).await?;
    sqlx::query(COMMIT).execute(&mut *db).await?;
    Ok(())
}
