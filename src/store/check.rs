//! A database that is only inspected, copied, or put in the place of another.
//!
//! Main functions: [`Store::inspect`], [`Store::integrity`], [`Store::copy_to`], [`Store::restore`]. A copy has what
//! was committed when it began, even while a server writes. Refuses: to overwrite anything.

use super::gone::Gone;
use super::identity::{OpenFiles, beside};
use super::lock::Lock;
use super::opening::set_aside;
use super::{ABOUT, BUSY, SHUT, Store, StoreError, last_step};
use sqlx::Connection;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection, SqlitePool, SqlitePoolOptions};
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tokio::sync::watch;

const INTEGRITY: &str = "PRAGMA integrity_check(20)";
const COPY: &str = "VACUUM INTO $1";

/// The map to which a database belongs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Belongs {
    /// The map's name.
    pub map: String,
    /// The map's seal; see [`super::seal()`].
    pub seal: String,
}

impl Store {
    /// Opens a database for reading only, even while a server has it open.
    ///
    /// # Errors
    /// If there is none, or it cannot be read.
    pub async fn inspect(path: &Path) -> Result<Store, StoreError> {
        match Store::inspect_as(path, false).await {
            // Without a log, the main file is the whole database: it can be read without writing anything.
            Err(e) if e.is_no_room() && !beside(path, "-wal").metadata().is_ok_and(|m| m.len() > 0) => {
                Store::inspect_as(path, true).await
            }
            other => other,
        }
    }

    async fn inspect_as(path: &Path, is_still: bool) -> Result<Store, StoreError> {
        let open = |why| StoreError::Open { path: path.into(), why };
        let options = SqliteConnectOptions::new().filename(path).read_only(true).busy_timeout(BUSY);
        let options = options.immutable(is_still);
        let pool = SqlitePoolOptions::new().max_connections(1).connect_with(options).await.map_err(open)?;
        let (last, gone) = (last_step(&pool).await?, Gone::read(&pool).await?);
        let lock = Arc::new(Lock::none(path));
        let (run, keep) = (String::new(), super::days(super::KEEP_DAYS));
        let (writer, readers, place) = (pool.clone(), pool, OpenFiles::default());
        Ok(Store {
            writer,
            readers,
            place,
            last,
            run,
            keep,
            keep_people: keep,
            is_orderly: false,
            lock,
            gone,
            carried: None,
            news: watch::Sender::new(()),
        })
    }

    /// The number of the last step when the database was opened.
    pub fn last(&self) -> i64 {
        self.last
    }

    /// The faults that SQLite finds in the file; none if it is intact.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub async fn integrity(&self) -> Result<Vec<String>, StoreError> {
        let found: Vec<String> = sqlx::query_scalar(INTEGRITY).fetch_all(&self.readers).await?;
        Ok(found.into_iter().filter(|line| line != "ok").collect())
    }

    /// The map to which the database belongs; nothing if it is not a database of Giveway.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub async fn belongs(&self) -> Result<Option<Belongs>, StoreError> {
        let about = async |key| -> Result<Option<String>, StoreError> {
            Ok(sqlx::query_scalar(ABOUT).bind(key).fetch_optional(&self.readers).await?)
        };
        let (map, seal) = (about("map").await?, about("seal").await?);
        Ok(map.zip(seal).map(|(map, seal)| Belongs { map, seal }))
    }

    /// Writes everything that is committed into a new file that survives a loss of power.
    ///
    /// # Errors
    /// If the file is there already, or cannot be written.
    pub async fn copy_to(&self, target: &Path) -> Result<(), StoreError> {
        copy(&self.readers, target).await
    }

    /// Puts a copy of this database in the place of another, whose files are all moved aside. Gives their new names. A
    /// crash half-way leaves no database in the place, and a start refuses that.
    ///
    /// # Errors
    /// If a server has the other database, or a file cannot be written or moved.
    pub async fn restore(&self, path: &Path, stamp: &str) -> Result<Vec<PathBuf>, StoreError> {
        let lock = Lock::take(path)?;
        let path = lock.path().to_owned();
        let fail = |why| StoreError::Target { path: path.clone(), why };
        let fresh = beside(&path, ".restoring");
        match std::fs::remove_file(&fresh) {
            Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(fail(e)),
            _ => {}
        }
        self.copy_to(&fresh).await?;
        let moved = set_aside(&lock, &[], stamp)?;
        std::fs::rename(&fresh, &path).and_then(|()| sync_folder(&path)).map_err(fail)?;
        lock.note(self.last);
        lock.release();
        Ok(moved)
    }
}

/// Writes everything that is committed into a new file that survives a loss of power.
async fn copy(db: &SqlitePool, target: &Path) -> Result<(), StoreError> {
    let fail = |why| StoreError::Target { path: target.into(), why };
    let name = target.to_str().ok_or_else(|| fail(io::ErrorKind::InvalidFilename.into()))?;
    if target.exists() {
        return Err(fail(io::ErrorKind::AlreadyExists.into()));
    }
    sqlx::query(COPY).bind(name).execute(db).await?;
    // The copy is complete, though the database may be open.
    let mut whole = SqliteConnection::connect_with(&SqliteConnectOptions::new().filename(target)).await?;
    let shut = sqlx::query(SHUT).bind(None::<String>).execute(&mut whole).await;
    whole.close().await?;
    if let Err(e) = shut {
        tracing::debug!("what was copied says nothing about being closed: {e}");
    }
    File::open(target).and_then(|f| f.sync_all()).map_err(fail)?;
    sync_folder(target).map_err(fail)
}

/// Makes a copy that is checked for damage before it gets its name.
pub(super) async fn back_up(db: &SqlitePool, target: &Path) -> Result<(), StoreError> {
    let fail = |why| StoreError::Target { path: target.into(), why };
    let partial = beside(target, ".partial");
    match std::fs::remove_file(&partial) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(fail(e)),
        _ => {}
    }
    copy(db, &partial).await?;
    let store = Store::inspect(&partial).await?;
    let problems = store.integrity().await;
    store.close().await;
    if let Some(problem) = problems?.first() {
        return Err(fail(io::Error::other(format!("the copy is damaged: {problem}"))));
    }
    std::fs::rename(&partial, target).and_then(|()| sync_folder(target)).map_err(fail)
}

/// Makes the names in the folder of a file survive a loss of power.
pub(super) fn sync_folder(path: &Path) -> io::Result<()> {
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}
