//! Continues a database from now if its last step is in the future because the clock was wrong.
//!
//! Main function: [`Store::set_clock`]. Refuses: to do so without a backup, or if a promise would be lost.

use super::carry::{CarriedOver, set_frames_aside};
use super::check::back_up;
use super::events::NOTE_JOBS;
use super::opening::free_name;
use super::{SET_BACK, Store, StoreError, ledger_record, steps};
use giveway_fleet::carry::set_back;
use giveway_fleet::{JobState, Ledger, RobotKind};
use giveway_floor::time::Time;
use giveway_floor::warehouse::Warehouse;
use std::path::PathBuf;
use std::sync::Arc;

const WAIT_AGAIN: &str = "UPDATE jobs SET state = 'waiting', why = NULL, worker = NULL, updated = $1, \
    assigned_at = NULL, lifted_at = NULL, arrived_at = NULL WHERE id IN (SELECT value FROM json_each($2))";
/// Delete steps, snapshots and figures of the future. Lists of what happened keep their times; figures have theirs as
/// keys.
const FORGET: [&str; 4] = [
    "DELETE FROM steps WHERE $1 = $1",
    "DELETE FROM snapshots WHERE $1 = $1",
    "DELETE FROM history WHERE start + step > $1",
    "DELETE FROM heat WHERE start + 300000000 > $1",
];
const NOTE: &str = "INSERT OR REPLACE INTO about (key, value) VALUES ($1, 'yes')";
const SNAPSHOT: &str = "INSERT INTO snapshots (seq, at, wire, body) VALUES ($1, $2, $3, $4)";

impl Store {
    /// Continues the journal at `now`, before its last step: robots stand where they are, and the jobs that they had
    /// wait again. Figures of the future are deleted, frames of the past set aside, and `stamp` becomes part of the
    /// names of files kept from before. Gives nothing, and changes nothing, if the last step is not later.
    ///
    /// # Errors
    /// If the journal contradicts itself, or a promise would be lost.
    pub async fn set_clock(
        &self,
        map: &Arc<Warehouse>,
        site_kinds: &[RobotKind],
        now: Time,
        (folders, stamp): (&[PathBuf], &str),
    ) -> Result<Option<CarriedOver>, StoreError> {
        let loaded = steps::load(&self.readers, Ledger::new(map.clone(), site_kinds, false)).await?;
        let (last, at) = (loaded.next - 1, loaded.last.unwrap_or(Time::ZERO));
        if at <= now {
            return Ok(None);
        }
        let path = self.path();
        let broken = |why: String| StoreError::Carry { path: path.into(), why };
        let (new, fold_map, kinds) = (map.clone(), map.clone(), site_kinds.to_vec());
        let fold = move || {
            let (mut ledger, facts) = loaded.into_parts();
            facts.into_iter().for_each(|fact| ledger.evolve(&fact));
            let carried = set_back(&ledger, at, now);
            let read = |parts| Ledger::from_parts(fold_map.clone(), &kinds, parts).map(drop);
            let sound = carried.parts.clone().map_or(Ok(()), read);
            (carried, sound)
        };
        let folded = tokio::task::spawn_blocking(fold).await;
        let (carried, sound) =
            folded.map_err(|_| broken("the journal contradicts itself, as said above".into()))?;
        sound.map_err(|why| broken(why.to_string()))?;
        debug_assert!(carried.waiting.is_sorted(), "jobs wait in order");
        let report = carried.report.clone();
        let Some(parts) = carried.parts.filter(|_| report.losses.is_empty()) else {
            let (theirs, ours, report) = (new.name.clone(), new.name.clone(), Box::new(report));
            return Err(StoreError::ChangedMap { path: path.into(), theirs, ours, report });
        };
        let backup = free_name(path, &format!("before-clock-{stamp}"));
        back_up(&self.readers, &backup).await?;
        set_frames_aside(folders, &format!("before-clock-{stamp}"))?;
        let body = ledger_record::encode(&parts);
        let waiting: Vec<u64> = carried.waiting.iter().map(|job| job.0).collect();
        let waiting = serde_json::to_string(&waiting).expect("a list of numbers is JSON");
        let mut tx = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        sqlx::query(NOTE_JOBS)
            .bind(now.0)
            .bind(&waiting)
            .bind(JobState::Waiting.word())
            .execute(&mut *tx)
            .await?;
        sqlx::query(WAIT_AGAIN).bind(now.0).bind(waiting).execute(&mut *tx).await?;
        for statement in FORGET {
            sqlx::query(statement).bind(now.0).execute(&mut *tx).await?;
        }
        let row = sqlx::query(SNAPSHOT).bind(last).bind(now.0).bind(ledger_record::VERSION).bind(body);
        row.execute(&mut *tx).await?;
        sqlx::query(NOTE).bind(SET_BACK).execute(&mut *tx).await?;
        tx.commit().await?;
        Ok(Some(CarriedOver { from: new.name.clone(), report, backup: Some(backup) }))
    }
}
