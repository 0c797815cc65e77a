//! Which file a path names: a device and a number on it, whatever the file is called.
//!
//! Main types: [`FileKey`] (one file), [`OpenFiles`] (the files of an open database, where they must be). Refuses: to
//! take a file of the same name for the same file.

use super::StoreError;
use std::fs::Metadata;
use std::io;
use std::path::{Path, PathBuf};

/// One file, by device and number: the same under every name, symbolic link and hard link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct FileKey(u64, u64);

impl FileKey {
    /// The file that a path names.
    pub fn of(path: &Path) -> io::Result<FileKey> {
        Ok(FileKey::from(path, &std::fs::metadata(path)?))
    }

    #[cfg(unix)]
    fn from(_: &Path, found: &Metadata) -> FileKey {
        use std::os::unix::fs::MetadataExt;
        FileKey(found.dev(), found.ino())
    }

    /// The key without numbers of files: the path serves instead, and a missing file is noticed all the same.
    #[cfg(not(unix))]
    fn from(path: &Path, _: &Metadata) -> FileKey {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hash = DefaultHasher::new();
        path.hash(&mut hash);
        FileKey(0, hash.finish())
    }
}

/// A path beside the database: its own path with this suffix.
pub(super) fn beside(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    name.into()
}

/// The files that an open database writes to, as they were when it was opened.
#[derive(Debug, Default)]
pub(super) struct OpenFiles {
    files: Vec<(PathBuf, FileKey)>,
}

impl OpenFiles {
    /// The main file and the write-ahead log of an open database.
    pub fn of(path: &Path) -> io::Result<OpenFiles> {
        let key = |path: PathBuf| FileKey::of(&path).map(|key| (path, key));
        Ok(OpenFiles { files: vec![key(path.to_owned())?, key(beside(path, "-wal"))?] })
    }

    /// Checks that both are where they were: two system calls, some microseconds. SQLite keeps writing into files that
    /// no longer have a name, and all of that would be gone with the process.
    pub fn check(&self) -> Result<(), StoreError> {
        for (path, key) in &self.files {
            let what = match FileKey::of(path) {
                Ok(found) if found == *key => continue,
                Ok(_) => "was replaced by another file",
                Err(e) if e.kind() == io::ErrorKind::NotFound => "was deleted or moved away",
                Err(_) => "cannot be looked at",
            };
            return Err(StoreError::Displaced { path: path.clone(), what });
        }
        Ok(())
    }
}
