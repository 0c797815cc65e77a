//! What is found where a database should be: a whole one, none, or the remains of one.
//!
//! Main type: [`Opening`]. A database that was here and is gone, or that has fewer steps than were acknowledged, is not
//! taken for a new one. Refuses: to start empty without being told so, and to delete anything.

use super::carry::CarryOver;
use super::identity::beside;
use super::lock::{Lock, LockRecord};
use super::{MapNote, Store, StoreError};
use giveway_floor::warehouse::Warehouse;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Files of SQLite beside the main one.
pub(super) const SIDES: [&str; 2] = ["-wal", "-shm"];

/// How to open a database.
#[derive(Clone, Debug, Default)]
pub struct Opening {
    /// Start empty, though there are traces of a database: its remains are moved aside, with this text as part of their
    /// names.
    pub new: Option<String>,
    /// Folders that exist only where a database was.
    pub traces: Vec<PathBuf>,
    /// How to carry the database over if it belongs to another map; without this it is refused.
    pub carry: Option<CarryOver>,
    /// The note about the map.
    pub note: MapNote,
}

impl Store {
    /// Opens the database; see [`Store::open`].
    ///
    /// # Errors
    /// Also if there are traces of a missing database, or the database has fewer steps than were acknowledged, unless
    /// the caller wants a new one; and if the caller wants a new one where a whole one exists.
    pub async fn open_as(path: &Path, map: &Warehouse, opening: &Opening) -> Result<Store, StoreError> {
        let lock = Arc::new(Lock::take(path)?);
        let traces = traces(&lock, &opening.traces);
        match (&opening.new, traces.is_empty()) {
            (_, true) => {}
            (None, false) => {
                return Err(StoreError::Missing { path: lock.path().into(), found: traces.join(", ") });
            }
            (Some(stamp), false) => _ = set_aside(&lock, &opening.traces, stamp)?,
        }
        lock.hold_main()?;
        let Some(stamp) = &opening.new else {
            return Store::connect(&lock, lock.found(), map, opening).await;
        };
        match Store::connect(&lock, lock.found().filter(|_| traces.is_empty()), map, opening).await {
            Err(StoreError::Lost { .. }) => {
                set_aside(&lock, &opening.traces, stamp)?;
                lock.hold_main()?;
                Store::connect(&lock, None, map, opening).await
            }
            Ok(store) if store.last > 0 => {
                let steps = store.last;
                store.close().await;
                Err(StoreError::NotNew { path: lock.path().into(), steps })
            }
            other => other,
        }
    }
}

/// Traces of a missing database, in words. An empty main file is no trace: SQLite makes it before anything else, and
/// throws away a log that it finds beside it.
fn traces(lock: &Lock, folders: &[PathBuf]) -> Vec<String> {
    let size = |path: &Path| std::fs::metadata(path).map_or(0, |m| m.len());
    let mut found = Vec::new();
    if size(lock.path()) > 0 {
        return found;
    }
    if let Some(LockRecord { last, .. }) = lock.found().filter(|r| r.last > 0) {
        found.push(format!("the lock file, which knows of {last} facts"));
    }
    let wal = beside(lock.path(), "-wal");
    if size(&wal) > 0 {
        found.push(format!("the write-ahead log {}", wal.display()));
    }
    for folder in folders {
        if std::fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) {
            found.push(format!("the folder {}", folder.display()));
        }
    }
    found
}

/// Moves all remains of a database aside, the main file first, so that the rest cannot pass for a whole one.
pub(super) fn set_aside(lock: &Lock, folders: &[PathBuf], stamp: &str) -> Result<Vec<PathBuf>, StoreError> {
    lock.note(0);
    lock.let_main_go();
    let path = lock.path();
    let aside = free_name(path, stamp);
    let mut moved = Vec::new();
    let mut go = |from: PathBuf, to: PathBuf| -> Result<(), StoreError> {
        if from.exists() {
            std::fs::rename(&from, &to).map_err(|why| StoreError::Aside { path: from, why })?;
            tracing::warn!("moved aside: {}", to.display());
            moved.push(to);
        }
        Ok(())
    };
    go(path.into(), aside.clone())?;
    for side in SIDES {
        go(beside(path, side), beside(&aside, side))?;
    }
    for folder in folders {
        go(folder.clone(), free_name(folder, stamp))?;
    }
    Ok(moved)
}

/// A dated path beside a file that is not in use yet.
pub(super) fn free_name(path: &Path, stamp: &str) -> PathBuf {
    let name = |n: u32| if n == 0 { format!(".{stamp}") } else { format!(".{stamp}-{n}") };
    (0..).map(|n| beside(path, &name(n))).find(|p| !p.exists()).expect("some number is free")
}
