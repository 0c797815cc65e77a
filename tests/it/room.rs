//! A server that finds no room on the disk when it starts, and a main file without what belongs beside it.

use crate::helper::{Folder, SCENARIO, all_jobs, delivery, empty_ledger, eventually, get, map, post, start};
use giveway::store::{Store, StoreError};
use std::fs;
use std::net::{SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

const PROGRAM: &str = env!("CARGO_BIN_EXE_giveway");

/// A server whose files may not grow beyond so many kilobytes, or as far as the disk lets them.
struct Cramped(Child, SocketAddr);

impl Cramped {
    fn start(database: &Path, kilobytes: Option<u32>) -> Cramped {
        let at = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
        let limit = kilobytes.map(|n| format!("ulimit -S -f {n};")).unwrap_or_default();
        let serve = format!("exec {PROGRAM} serve --listen {at} --past-hours 0 --scenario {SCENARIO}");
        let script = format!("{limit} {serve} --database {}", database.display());
        let mut bash = Command::new("bash");
        let child = bash.args(["-c", &script]).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        Cramped(child, at)
    }

    fn is_running(&mut self) -> bool {
        self.0.try_wait().unwrap().is_none()
    }

    /// Waits until an address answers with this status; gives the text.
    async fn answers(&mut self, path: &str, status: u16) -> String {
        eventually(&format!("{path} answers {status}"), async || {
            assert!(self.is_running(), "the server has ended");
            if tokio::net::TcpStream::connect(self.1).await.is_err() {
                return None;
            }
            let answer = get(self.1, path).await;
            (answer.status == status && !answer.text.contains("/problems/starting")).then_some(answer.text)
        })
        .await
    }

    fn kill(mut self) {
        self.0.kill().unwrap();
        self.0.wait().unwrap();
    }
}

impl Drop for Cramped {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Hands jobs in; the ids of those that were acknowledged.
async fn submit(at: SocketAddr, keys: std::ops::Range<u32>) -> Vec<String> {
    let mut acknowledged = Vec::new();
    for i in keys {
        let answer = post(at, Some(&format!("key-{i}")), &delivery(i as usize)).await.unwrap();
        if answer.status == 201 {
            acknowledged.push(answer.json()["id"].as_str().unwrap().to_owned());
        }
    }
    acknowledged
}

async fn has_all(at: SocketAddr, acknowledged: &[String]) {
    let listed = all_jobs(at, 500).await;
    for id in acknowledged {
        assert_eq!(listed.iter().filter(|j| j["id"] == *id).count(), 1, "{id}");
    }
}

/// Says why, promises nothing, and does not end.
async fn waits_for_room(server: &mut Cramped) {
    let text = server.answers("/v1/health", 503).await;
    assert!(text.contains("/problems/no-room") && text.contains("Make room"), "{text}");
    let refused = post(server.1, Some("in vain"), &delivery(0)).await.unwrap();
    assert_eq!(refused.status, 503);
    assert!(refused.text.contains("/problems/no-room"), "{}", refused.text);
    server.answers("/v1/health/live", 200).await;
}

#[cfg(target_os = "linux")]
#[tokio::test(flavor = "multi_thread")]
async fn a_server_that_was_killed_comes_up_where_there_is_no_room_and_goes_on_when_there_is() {
    let folder = Folder::new();
    let mut before = Cramped::start(&folder.database(), None);
    before.answers("/v1/health", 200).await;
    let acknowledged = submit(before.1, 0..60).await;
    assert_eq!(acknowledged.len(), 60);
    before.kill();
    // The log has more than this already.
    let mut server = Cramped::start(&folder.database(), Some(64));
    waits_for_room(&mut server).await;
    let process = server.0.id().to_string();
    let raised = Command::new("prlimit").args(["--pid", &process, "--fsize=unlimited"]).status().unwrap();
    assert!(raised.success());
    server.answers("/v1/health", 200).await;
    has_all(server.1, &acknowledged).await;
    assert_eq!(submit(server.1, 60..61).await.len(), 1, "it takes jobs again");
}

#[cfg(target_os = "linux")]
#[tokio::test(flavor = "multi_thread")]
async fn a_first_start_without_room_waits_for_it_and_ends_when_it_is_told_to() {
    let folder = Folder::new();
    let mut server = Cramped::start(&folder.database(), Some(64));
    waits_for_room(&mut server).await;
    let process = server.0.id().to_string();
    assert!(Command::new("kill").args(["-TERM", &process]).status().unwrap().success());
    assert_eq!(server.0.wait().unwrap().code(), Some(0));
}

/// A file system of four megabytes.
struct SmallDisk(PathBuf);

impl SmallDisk {
    fn mount(folder: &Folder) -> SmallDisk {
        let path = folder.path().join("disk");
        fs::create_dir_all(&path).unwrap();
        let mount = Command::new("mount").args(["-t", "tmpfs", "-o", "size=4m", "tmpfs"]).arg(&path).status();
        assert!(mount.unwrap().success(), "this test mounts a file system: run it as root");
        SmallDisk(path)
    }

    /// Writes until there is no room for another byte.
    fn fill(&self) -> PathBuf {
        let (path, mut size) = (self.0.join("filler"), 1 << 20);
        let mut file = fs::File::create(&path).unwrap();
        while size > 0 {
            if std::io::Write::write_all(&mut file, &vec![1; size]).is_err() {
                size /= 2;
            }
        }
        path
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(&self.0).status();
    }
}

#[cfg(target_os = "linux")]
#[tokio::test(flavor = "multi_thread")]
#[ignore = "mounts a file system: root alone may"]
async fn on_a_disk_that_is_full_a_server_comes_up_after_a_kill_and_after_it_was_stopped() {
    for signal in ["-KILL", "-TERM"] {
        let folder = Folder::new();
        let disk = SmallDisk::mount(&folder);
        let database = disk.0.join("giveway.sqlite");
        let mut before = Cramped::start(&database, None);
        before.answers("/v1/health", 200).await;
        let mut acknowledged = submit(before.1, 0..40).await;
        let filler = disk.fill();
        acknowledged.extend(submit(before.1, 40..45).await);
        let process = before.0.id().to_string();
        assert!(Command::new("kill").args([signal, &process]).status().unwrap().success());
        before.0.wait().unwrap();
        disk.fill();
        let mut server = Cramped::start(&database, None);
        waits_for_room(&mut server).await;
        fs::remove_file(filler).unwrap();
        let _ = fs::remove_file(disk.0.join("filler"));
        server.answers("/v1/health", 200).await;
        has_all(server.1, &acknowledged).await;
        assert_eq!(submit(server.1, 60..61).await.len(), 1, "{signal}");
    }
}

/// Opens a database; what is wrong with it.
async fn refused(path: &Path) -> String {
    match Store::open(path, &map()).await {
        Err(e @ StoreError::Alone(_)) => e.to_string(),
        other => panic!("{other:?}"),
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_main_file_without_its_log_and_its_lock_is_refused_at_every_start_until_somebody_says_so() {
    let folder = Folder::new();
    let server = start(&folder).await;
    assert_eq!(submit(server.address(), 0..50).await.len(), 50);
    let elsewhere = Folder::new();
    let copy = elsewhere.database();
    // As `cp` of the main file beside a running server.
    fs::copy(folder.database(), &copy).unwrap();
    for _ in 0..2 {
        let text = refused(&copy).await;
        for said in ["giveway.sqlite-wal", "giveway.sqlite-lock", "database restore", "may be missing"] {
            assert!(text.contains(said), "{text}");
        }
    }
    fs::write(elsewhere.path().join("giveway.sqlite-lock"), "").unwrap();
    let store = Store::open(&copy, &map()).await.unwrap();
    store.load(empty_ledger()).await.unwrap();
    store.close().await;
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_main_file_that_was_closed_in_order_and_a_backup_of_an_open_one_are_whole_by_themselves() {
    let folder = Folder::new();
    let server = start(&folder).await;
    assert_eq!(submit(server.address(), 0..5).await.len(), 5);
    let backup = folder.path().join("backup.sqlite");
    server.store().copy_to(&backup).await.unwrap();
    server.stop().await.unwrap();
    let elsewhere = Folder::new();
    for whole in [folder.database(), backup] {
        let copy = elsewhere.path().join(whole.file_name().unwrap());
        fs::copy(&whole, &copy).unwrap();
        let store = Store::open(&copy, &map()).await.unwrap();
        assert_eq!(store.count_jobs().await.unwrap().0, 5, "{}", whole.display());
        store.close().await;
    }
}
