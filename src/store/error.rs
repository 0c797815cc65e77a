//! What can go wrong with the store, and how to fix it.
//!
//! Main type: [`StoreError`]. Refuses: to pass on a database's code without a remedy.

use super::ledger_record::SnapshotError;
use super::record::RecordError;
use giveway_fleet::carry::Report;
use std::io::ErrorKind;
use std::path::PathBuf;

/// Why the store cannot do what it should.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// The file cannot be opened.
    #[error("cannot open the database {path}: {why}{}", remedy(.why))]
    Open {
        /// Path of the file.
        path: PathBuf,
        /// The database's error.
        why: sqlx::Error,
    },
    /// Another process has the database open.
    #[error(
        "the database {0} is in use by another Giveway: stop that one, or choose another file with --database"
    )]
    InUse(PathBuf),
    /// The lock beside the database cannot be taken.
    #[error(
        "cannot lock {path}: {why}: the folder must exist and be writable, or choose another with --database"
    )]
    Lock {
        /// Path of the lock file.
        path: PathBuf,
        /// The system's error.
        why: std::io::Error,
    },
    /// There was a database here, and it is gone.
    #[error(
        "there is no database {path}, but there was one: {found} is still there. Put the file back, or run \
         `giveway database restore BACKUP`; to start empty, start with --new, which moves what is left aside"
    )]
    Missing {
        /// Path of the main file.
        path: PathBuf,
        /// What is left of the database.
        found: String,
    },
    /// The main file is alone, and was not closed cleanly.
    #[error(
        "the database {0} was not closed in order, and nothing is beside it: its write-ahead log {0}-wal, which has \
         the newest facts, and {0}-lock, which says how many there were, are missing. Put them back beside it (the \
         database is all of its files), or run `giveway database restore BACKUP`. To go on with what is there, though \
         acknowledged jobs may be missing, make an empty file {0}-lock"
    )]
    Alone(PathBuf),
    /// The database has fewer steps than were acknowledged.
    #[error(
        "the database {path} ends with step {found}, but {known} steps were written: its write-ahead log \
         {path}-wal was lost, or an older file was put in its place. Put the right files back, or run `giveway \
         database restore BACKUP`; to go on with what is there, empty {path}-lock; to start empty, start with \
         --new, which moves what is there aside"
    )]
    Lost {
        /// Path of the main file.
        path: PathBuf,
        /// Number of the last step in the database.
        found: i64,
        /// Number of the last step that was acknowledged.
        known: i64,
    },
    /// A new database is wanted where a whole one exists.
    #[error(
        "--new starts an empty database only if there is none, but {path} has {steps} steps: start without --new, \
         or choose another file with --database"
    )]
    NotNew {
        /// Path of the main file.
        path: PathBuf,
        /// Number of the last step in the database.
        steps: i64,
    },
    /// An open file is no longer where it was.
    #[error(
        "{path} {what} while Giveway has it open: nothing is acknowledged any more. Move the same file back, or \
         stop Giveway, put a backup in place with `giveway database restore BACKUP`, and start it again"
    )]
    Displaced {
        /// Path of the file.
        path: PathBuf,
        /// What happened to the file.
        what: &'static str,
    },
    /// A copy cannot be written.
    #[error("cannot write {path}: {why}: name a file that does not exist yet, in a writable folder")]
    Target {
        /// Path of the file.
        path: PathBuf,
        /// The system's error.
        why: std::io::Error,
    },
    /// A file cannot be moved aside.
    #[error("cannot move {path} aside: {why}")]
    Aside {
        /// Path of the file.
        path: PathBuf,
        /// The system's error.
        why: std::io::Error,
    },
    /// The tables cannot be brought up to date.
    #[error(
        "cannot bring the tables of {path} up to date: {why}: use the Giveway that wrote it, or another \
         --database"
    )]
    Migrate {
        /// Path of the file.
        path: PathBuf,
        /// The migration's error.
        why: sqlx::migrate::MigrateError,
    },
    /// The facts refer to another map.
    #[error(
        "the database {path} belongs to the map \"{theirs}\", which is not the map \"{ours}\" of this \
         scenario (nodes, where they are, lanes, racks or stations differ): use another --database, or the same map"
    )]
    OtherMap {
        /// Path of the file.
        path: PathBuf,
        /// Name of the map in the database.
        theirs: String,
        /// Name of the map given.
        ours: String,
    },
    /// The facts refer to another map, which the database does not have.
    #[error(
        "the database {path} belongs to the map \"{theirs}\", and was last opened by a Giveway that did not write its \
         map down, so it cannot be compared with the map \"{ours}\": open it once with the old map first (start this \
         Giveway with it, and stop it again), then start with the new one; or use another --database"
    )]
    UnknownMap {
        /// Path of the file.
        path: PathBuf,
        /// Name of the map in the database.
        theirs: String,
        /// Name of the map given.
        ours: String,
    },
    /// Not all that the facts refer to can be carried over to this map.
    #[error(
        "the database {path} belongs to the map \"{theirs}\", and not all of it can be carried over to the map \
         \"{ours}\". Nothing was changed; a start with the old map goes on as before.\n{report}\n{}",
        remedy_of(.report)
    )]
    ChangedMap {
        /// Path of the file.
        path: PathBuf,
        /// Name of the map in the database.
        theirs: String,
        /// Name of the map given.
        ours: String,
        /// What prevents it, and what would be lost.
        report: Box<Report>,
    },
    /// The carried-over ledger contradicts itself or the map.
    #[error(
        "the database {path} cannot be carried over to the changed map: {why}. Nothing was changed: start with the old \
         map, or use another --database"
    )]
    Carry {
        /// Path of the file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// The database is from before the first release.
    #[error(
        "the database {0} was made by a Giveway from before the first release, which this one cannot read: use \
         another --database; that Giveway still reads this one"
    )]
    Earlier(PathBuf),
    /// Another process has opened the database since.
    #[error(
        "another Giveway has opened the database {0} since this one did (by another name of the file?): stop one of \
         them"
    )]
    Taken(PathBuf),
    /// Steps are missing.
    #[error(
        "the journal goes on with step {found} where step {expected} should be: the database is damaged; restore it \
         from a backup"
    )]
    FreeWindow {
        /// Number of the step that should be there.
        expected: i64,
        /// Number of the step that is there.
        found: i64,
    },
    /// No snapshot can be read.
    #[error("snapshot {seq}: {why}")]
    Snapshot {
        /// Number of the step after which the snapshot was made.
        seq: i64,
        /// What is wrong with the snapshot.
        why: SnapshotError,
    },
    /// A step cannot be read.
    #[error("step {seq} of the journal: {why}")]
    Record {
        /// Number of the step.
        seq: i64,
        /// What is wrong with the step.
        why: RecordError,
    },
    /// A job cannot be read.
    #[error("job {id} in the database is damaged ({why}): restore the database from a backup")]
    Job {
        /// Number of the job.
        id: i64,
        /// What is wrong with the job.
        why: String,
    },
    /// A row of another list cannot be read.
    #[error("{list} {id} in the database is damaged ({why}): restore the database from a backup")]
    Row {
        /// The list of the row.
        list: &'static str,
        /// Number of the row.
        id: i64,
        /// What is wrong with the row.
        why: String,
    },
    /// Another program wrote into the journal.
    #[error(
        "the journal ends with step {found}, not with {expected}: another program wrote into it; restart \
         Giveway"
    )]
    OutOfStep {
        /// Number of the last step that this process wrote.
        expected: i64,
        /// Number of the last step that is there.
        found: i64,
    },
    /// The database reported an error.
    #[error("{}{}", .0, remedy(.0))]
    Sql(#[from] sqlx::Error),
}

impl StoreError {
    /// Whether retrying is useless, since the data to be written contradicts what is there.
    pub fn is_fatal(&self) -> bool {
        match self {
            StoreError::OutOfStep { .. } | StoreError::Taken(_) => true,
            StoreError::Sql(e) => primary_code(e) == Some(19),
            _ => false,
        }
    }

    /// Whether there is no room for what must be written: on the disk, in a quota, or below a limit on the size of
    /// files. The database is sound then, and continues once there is room.
    pub fn is_no_room(&self) -> bool {
        use sqlx::migrate::MigrateError::{Execute, ExecuteMigration};
        match self {
            StoreError::Sql(e) | StoreError::Open { why: e, .. } => lacks_room(e),
            StoreError::Migrate { why: Execute(e) | ExecuteMigration(e, _), .. } => lacks_room(e),
            StoreError::Lock { why, .. } | StoreError::Target { why, .. } | StoreError::Aside { why, .. } => {
                matches!(
                    why.kind(),
                    ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge
                )
            }
            _ => false,
        }
    }

    /// Whether the connection may be used again: the database was locked, full, or refused the statement.
    pub(super) fn leaves_connection_sound(&self) -> bool {
        match self {
            StoreError::OutOfStep { .. } | StoreError::Taken(_) | StoreError::Displaced { .. } => true,
            StoreError::Sql(e) => matches!(primary_code(e), Some(5 | 6 | 13 | 19)),
            _ => false,
        }
    }
}

/// What to do about a report, beyond what its entries say.
fn remedy_of(report: &Report) -> &'static str {
    match report.obstacles.is_empty() {
        true => {
            "To accept these losses, run `giveway database carry --map MAP --accept-losses`, then start again; a \
             backup is made first"
        }
        false => "Remove the obstacles first; `giveway database check --map MAP` lists what is left of them",
    }
}

/// SQLite's code without its extension.
fn primary_code(e: &sqlx::Error) -> Option<i64> {
    let code = e.as_database_error()?.code()?;
    code.parse::<i64>().ok().map(|c| c & 0xff)
}

/// Whether SQLite found no room: for pages (SQLITE_FULL), for the log, as beyond a limit on the size of files
/// (SQLITE_IOERR_WRITE), or for the index of the log (SQLITE_IOERR_SHMSIZE).
fn lacks_room(e: &sqlx::Error) -> bool {
    let code = e.as_database_error().and_then(|e| e.code()).and_then(|code| code.parse::<i64>().ok());
    matches!(code, Some(13 | 778 | 4874))
}

/// What to do about an error, as the end of a sentence.
fn remedy(e: &sqlx::Error) -> &'static str {
    match primary_code(e) {
        Some(5 | 6) => ": another program holds a lock on the database; end it or let it finish",
        Some(8) => ": the file or its folder is read-only; change that",
        Some(10) if lacks_room(e) => {
            ": the file cannot grow: the disk or a limit on the size of files (`ulimit -f`) is in the way; make room"
        }
        Some(10) => ": the disk does not answer properly; check it",
        Some(11) => ": the file is damaged; restore a backup",
        Some(13) => ": the disk is full; make room",
        Some(14) => ": does its folder exist, and may this user write there? --database names another file",
        Some(26) => ": this file is not a database; name another file with --database",
        _ => "",
    }
}
