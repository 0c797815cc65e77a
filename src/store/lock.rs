//! The lock: one Giveway at a time has a database, whatever name it was given; and what is known about the database
//! beside it.
//!
//! Main types: [`Lock`], [`LockRecord`] (the text in the lock file). Two files are locked: `FILE-lock`, which is there
//! before the database is, and on Linux the main file itself, which has one identity under all its names. The record
//! tells how many steps were durable; it is written after each commit and before that is acknowledged, and never before
//! the commit, so that a crash at any instant leaves a number that the database has reached. Refuses: a second holder,
//! in this process or another.

use super::StoreError;
use super::identity::{FileKey, beside};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::fs::{File, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};
use uuid::Uuid;

/// Main files that this process holds. A second look at one of them must not even open it: closing any handle of a file
/// gives up all of the process's locks on it, including those of SQLite (POSIX).
static HELD: Mutex<BTreeSet<FileKey>> = Mutex::new(BTreeSet::new());

/// Fixed length of the record, bytes, so that rewriting it needs no new disk space.
const RECORD_BYTES: usize = 256;

/// Largest number of symbolic links to a database that is not there yet.
const MOST_LINKS: usize = 8;

/// What the lock file says about the database beside it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct LockRecord {
    /// Id of the run that wrote the record.
    pub run: String,
    /// The number of the last durable step, or of one shortly before it.
    pub last: i64,
    /// Whether the database was closed cleanly.
    pub closed: bool,
}

/// The files that are released together with the lock.
#[derive(Debug)]
struct LockHeld {
    side: File,
    main: Option<(FileKey, File)>,
    record: LockRecord,
}

/// The right to write to one database, until it is released or the process ends.
#[derive(Debug)]
pub(super) struct Lock {
    path: PathBuf,
    /// Whether there was neither a lock file nor a write-ahead log beside the database.
    is_bare: bool,
    found: Option<LockRecord>,
    run: Uuid,
    held: Mutex<Option<LockHeld>>,
}

impl Lock {
    /// Takes the lock of a database that need not be there yet.
    pub fn take(path: &Path) -> Result<Lock, StoreError> {
        let path = canonical(path)?;
        let name = beside(&path, "-lock");
        let is_bare = !name.exists() && !beside(&path, "-wal").exists();
        let fail = |why| StoreError::Lock { path: name.clone(), why };
        let mut options = File::options();
        let mut side =
            options.read(true).write(true).create(true).truncate(false).open(&name).map_err(fail)?;
        lock(&side, &path, &name)?;
        let mut text = String::new();
        // Anything but a record claims nothing: an older Giveway left the file empty.
        let found = side.read_to_string(&mut text).ok().and_then(|_| serde_json::from_str(&text).ok());
        let run = Uuid::new_v4();
        let record = LockRecord { run: run.to_string(), last: 0, closed: false };
        let lock =
            Lock { path, is_bare, found, run, held: Mutex::new(Some(LockHeld { side, main: None, record })) };
        if lock.path.exists() {
            lock.hold_main()?;
        }
        Ok(lock)
    }

    /// Locks the main file itself, unless it is locked already; makes it if there is none.
    pub fn hold_main(&self) -> Result<(), StoreError> {
        let fail = |why| StoreError::Lock { path: self.path.clone(), why };
        if self.held().as_ref().is_some_and(|h| h.main.is_some()) {
            return Ok(());
        }
        if let Ok(key) = FileKey::of(&self.path)
            && held().contains(&key)
        {
            return Err(StoreError::InUse(self.path.clone()));
        }
        let mut options = File::options();
        let main =
            options.read(true).write(true).create(true).truncate(false).open(&self.path).map_err(fail)?;
        let key = FileKey::of(&self.path).map_err(fail)?;
        // On other systems such a lock and those of SQLite would exclude each other.
        if cfg!(target_os = "linux") {
            lock(&main, &self.path, &self.path)?;
        }
        held().insert(key);
        if let Some(held) = &mut *self.held() {
            held.main = Some((key, main));
        }
        Ok(())
    }

    /// A lock that holds nothing, for programs that only read.
    pub fn none(path: &Path) -> Lock {
        Lock { path: path.into(), is_bare: false, found: None, run: Uuid::nil(), held: Mutex::new(None) }
    }

    /// Releases the main file, since it is being moved away.
    pub fn let_main_go(&self) {
        if let Some(held) = &mut *self.held() {
            held.let_main_go();
        }
    }

    /// The path of the database with all links resolved.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the main file was found alone: nothing beside it tells how far it had come.
    pub fn is_bare(&self) -> bool {
        self.is_bare
    }

    /// Removes the lock file that this lock made, so that the next start finds what this one found.
    pub fn leave_bare(&self) {
        if self.is_bare {
            let _ = std::fs::remove_file(beside(&self.path, "-lock"));
        }
    }

    /// The record that was found in the lock file.
    pub fn found(&self) -> Option<&LockRecord> {
        self.found.as_ref()
    }

    /// An id for everything written while this lock is held.
    pub fn run(&self) -> Uuid {
        self.run
    }

    /// Notes that steps up to this one are durable. If the write fails, the older record stays, which is also true.
    pub fn note(&self, last: i64) {
        if let Some(held) = &mut *self.held() {
            debug_assert!(last >= held.record.last, "the journal grows");
            held.record.last = last;
            held.write();
        }
    }

    /// Makes the record survive a loss of power.
    pub fn sync(&self) -> io::Result<()> {
        let side = self.held().as_ref().map(|h| h.side.try_clone()).transpose()?;
        side.map_or(Ok(()), |file| file.sync_data())
    }

    /// Releases the lock. It is explicit, since a child process that is being started has a copy of each open file, and
    /// with it the lock, for a moment.
    pub fn release(&self) {
        let Some(mut held) = self.held().take() else { return };
        held.record.closed = true;
        held.write();
        let _ = held.side.sync_data();
        held.let_main_go();
        let _ = held.side.unlock();
    }

    fn held(&self) -> MutexGuard<'_, Option<LockHeld>> {
        self.held.lock().expect("nothing panics with this lock")
    }
}

impl LockHeld {
    fn write(&mut self) {
        let mut text = serde_json::to_vec(&self.record).expect("a record is plain");
        assert!(text.len() <= RECORD_BYTES, "a record has room in its file");
        text.resize(RECORD_BYTES, b'\n');
        if let Err(e) = self.side.seek(SeekFrom::Start(0)).and_then(|_| self.side.write_all(&text)) {
            tracing::debug!("the lock file is not written: {e}");
        }
    }

    fn let_main_go(&mut self) {
        if let Some((key, main)) = self.main.take() {
            let _ = main.unlock();
            held().remove(&key);
        }
    }
}

impl Drop for LockHeld {
    fn drop(&mut self) {
        self.let_main_go();
    }
}

fn held() -> MutexGuard<'static, BTreeSet<FileKey>> {
    HELD.lock().expect("nothing panics with this lock")
}

fn lock(file: &File, database: &Path, name: &Path) -> Result<(), StoreError> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(StoreError::InUse(database.into())),
        Err(TryLockError::Error(why)) => Err(StoreError::Lock { path: name.into(), why }),
    }
}

/// The path with links resolved, even if no file is at its end yet.
fn canonical(path: &Path) -> Result<PathBuf, StoreError> {
    let fail = |why| StoreError::Lock { path: path.into(), why };
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        match path.canonicalize() {
            Err(e) if e.kind() == io::ErrorKind::NotFound => {}
            found => return found.map_err(fail),
        }
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
            _ => PathBuf::from("."),
        };
        let Some(name) = path.file_name() else { return Err(fail(io::ErrorKind::InvalidFilename.into())) };
        let Ok(target) = path.read_link() else {
            return Ok(folder.canonicalize().map_err(fail)?.join(name));
        };
        path = folder.join(target);
    }
    Err(fail(io::Error::other("too many symbolic links")))
}
