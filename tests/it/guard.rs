//! What guards a database: one Giveway at a time, the same file as before, and no silent start from nothing.

use crate::helper::{Folder, map};
use giveway::fleet::{EncounterFact, Fact};
use giveway::id::WorkerId;
use giveway::store::{Opening, StepEntry, Store, StoreError};
use giveway::time::Time;
use std::fs;
use std::path::{Path, PathBuf};

/// So many facts, of no consequence.
fn facts(n: usize) -> Vec<StepEntry> {
    let fact = Fact::Encounter(EncounterFact::Deviated { worker: WorkerId(0), at: Time(1) });
    vec![StepEntry { at: Time(1), facts: vec![fact], causes: Vec::new() }; n]
}

fn beside(path: &Path, suffix: &str) -> PathBuf {
    PathBuf::from(format!("{}{suffix}", path.display()))
}

async fn open(path: &Path) -> Result<Store, StoreError> {
    Store::open(path, &map()).await
}

/// Starting empty, with what is left moved aside under this name.
fn new(stamp: &str) -> Opening {
    Opening { new: Some(stamp.into()), ..Opening::default() }
}

/// The files of a database with some facts, as a crash leaves them: copied while it is open.
async fn crashed(folder: &Folder) -> PathBuf {
    let store = open(&folder.database()).await.unwrap();
    store.append(1, &facts(3)).await.unwrap();
    let copies = folder.path().join("crashed");
    fs::create_dir(&copies).unwrap();
    for suffix in ["", "-wal", "-lock"] {
        let name = format!("giveway.sqlite{suffix}");
        fs::copy(folder.path().join(&name), copies.join(&name)).unwrap();
    }
    store.close().await;
    copies.join("giveway.sqlite")
}

#[tokio::test]
async fn a_database_is_locked_under_all_its_names() {
    let folder = Folder::new();
    let store = open(&folder.database()).await.unwrap();
    let (link, hard) = (folder.path().join("link.sqlite"), folder.path().join("hard.sqlite"));
    std::os::unix::fs::symlink("giveway.sqlite", &link).unwrap();
    fs::hard_link(folder.database(), &hard).unwrap();
    let spelt = folder.path().join("crooked/..");
    fs::create_dir(folder.path().join("crooked")).unwrap();
    for name in [folder.database(), link.clone(), hard.clone(), spelt.join("giveway.sqlite")] {
        let error = open(&name).await.unwrap_err();
        assert!(matches!(error, StoreError::InUse(_)), "{name:?}: {error}");
    }
    // Looking at it in vain has not taken its locks away: SQLite holds a lock on the main file while it is open.
    store.append(1, &facts(1)).await.unwrap();
    store.close().await;
    let again = open(&link).await.unwrap();
    assert_eq!(again.scan().await.unwrap().0, 1);
    assert_ne!(again.run(), store.run(), "each run has a name of its own");
    again.close().await;
}

#[tokio::test]
async fn a_store_that_is_closed_has_let_go_though_others_still_know_it() {
    let folder = Folder::new();
    for _ in 0..10 {
        let store = std::sync::Arc::new(open(&folder.database()).await.unwrap());
        let known = store.clone();
        store.close().await;
        let again = open(&folder.database()).await.unwrap();
        drop(known);
        assert!(matches!(open(&folder.database()).await, Err(StoreError::InUse(_))), "the new one has it");
        again.close().await;
    }
}

#[tokio::test]
async fn a_crash_at_any_instant_is_no_loss() {
    let folder = Folder::new();
    let path = crashed(&folder).await;
    let store = open(&path).await.unwrap();
    assert_eq!(store.scan().await.unwrap().0, 3);
    drop(store);
    // A crash before the first record was written, in the middle of it, and while there was nothing but the lock file.
    for text in ["", "{\"run\":\"", "\n\n\n"] {
        fs::write(beside(&path, "-lock"), text).unwrap();
        open(&path).await.unwrap().close().await;
    }
    let empty = folder.path().join("empty.sqlite");
    fs::write(beside(&empty, "-lock"), "").unwrap();
    fs::write(&empty, "").unwrap();
    open(&empty).await.unwrap().close().await;
    // Another program may have written the log into the main file, and removed it.
    let store = open(&folder.database()).await.unwrap();
    store.append(4, &facts(2)).await.unwrap();
    store.close().await;
    assert!(!beside(&folder.database(), "-wal").exists());
    open(&folder.database()).await.unwrap().close().await;
}

#[tokio::test]
async fn a_lost_write_ahead_log_is_refused_in_words_until_a_new_database_is_wanted() {
    let folder = Folder::new();
    let path = crashed(&folder).await;
    fs::remove_file(beside(&path, "-wal")).unwrap();
    let error = open(&path).await.unwrap_err();
    assert!(matches!(error, StoreError::Lost { found: 0, known: 3, .. }), "{error}");
    for word in ["-wal was lost", "database restore", "--new"] {
        assert!(error.to_string().contains(word), "{error}");
    }
    assert!(open(&path).await.is_err(), "it is refused each time");
    let store = Store::open_as(&path, &map(), &new("2031-01-31")).await.unwrap();
    assert_eq!(store.scan().await.unwrap().0, 0);
    assert!(beside(&path, ".2031-01-31").exists(), "what was there is kept");
    store.append(1, &facts(1)).await.unwrap();
    store.close().await;
    open(&path).await.unwrap().close().await;
}

#[tokio::test]
async fn a_missing_main_file_is_refused_in_words_where_traces_of_it_are_left() {
    for kept in ["-wal", "-lock", ".past"] {
        let folder = Folder::new();
        let path = crashed(&folder).await;
        let past = path.with_extension("past");
        for file in [path.clone(), beside(&path, "-wal"), beside(&path, "-lock")] {
            if !file.ends_with(format!("giveway.sqlite{kept}")) {
                fs::remove_file(file).unwrap();
            }
        }
        if kept == ".past" {
            fs::create_dir(&past).unwrap();
            fs::write(past.join("1.reel"), "").unwrap();
        }
        let opening = Opening { traces: vec![past.clone()], ..Opening::default() };
        let error = Store::open_as(&path, &map(), &opening).await.unwrap_err();
        assert!(matches!(error, StoreError::Missing { .. }), "{kept}: {error}");
        assert!(error.to_string().contains("--new"), "{error}");
        assert!(!path.exists(), "nothing was made");
        let opening = Opening { new: Some("x".into()), ..opening };
        let store = Store::open_as(&path, &map(), &opening).await.unwrap();
        assert_eq!(store.scan().await.unwrap().0, 0);
        store.close().await;
        assert!(!past.exists(), "moved aside");
    }
}

#[tokio::test]
async fn an_older_file_in_its_place_is_refused_and_taken_when_the_lock_file_is_deleted() {
    let folder = Folder::new();
    let store = open(&folder.database()).await.unwrap();
    store.append(1, &facts(2)).await.unwrap();
    store.close().await;
    let old = folder.path().join("old");
    fs::copy(folder.database(), &old).unwrap();
    let store = open(&folder.database()).await.unwrap();
    store.append(3, &facts(2)).await.unwrap();
    store.close().await;
    fs::rename(&old, folder.database()).unwrap();
    let error = open(&folder.database()).await.unwrap_err();
    assert!(matches!(error, StoreError::Lost { found: 2, known: 4, .. }), "{error}");
    fs::remove_file(beside(&folder.database(), "-lock")).unwrap();
    open(&folder.database()).await.unwrap().close().await;
}

#[tokio::test]
async fn a_new_database_never_takes_the_place_of_a_whole_one() {
    let folder = Folder::new();
    let store = Store::open_as(&folder.database(), &map(), &new("x")).await.unwrap();
    store.append(1, &facts(5)).await.unwrap();
    store.close().await;
    let error = Store::open_as(&folder.database(), &map(), &new("y")).await.unwrap_err();
    assert!(matches!(error, StoreError::NotNew { steps: 5, .. }), "{error}");
    let store = open(&folder.database()).await.unwrap();
    assert_eq!(store.scan().await.unwrap().0, 5);
    store.close().await;
}

#[tokio::test]
async fn facts_for_a_file_that_was_taken_away_are_refused_and_taken_once_it_is_back() {
    let folder = Folder::new();
    let (path, away) = (folder.database(), folder.path().join("away"));
    let store = open(&path).await.unwrap();
    store.append(1, &facts(1)).await.unwrap();
    for file in [path.clone(), beside(&path, "-wal")] {
        fs::rename(&file, &away).unwrap();
        let error = store.append(2, &facts(1)).await.unwrap_err();
        assert!(matches!(error, StoreError::Displaced { .. }) && !error.is_fatal(), "{error}");
        assert!(error.to_string().contains("was deleted or moved away"), "{error}");
        fs::write(&file, "").unwrap();
        let error = store.append(2, &facts(1)).await.unwrap_err();
        assert!(error.to_string().contains("was replaced by another file"), "{error}");
        fs::rename(&away, &file).unwrap();
    }
    store.append(2, &facts(1)).await.unwrap();
    assert_eq!(store.scan().await.unwrap().0, 2);
    store.close().await;
}
