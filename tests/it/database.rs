//! `giveway database`, and what the program does where files and pipes end: called like from a shell.

use crate::helper::{Answer, Folder, SCENARIO, all_jobs, delivery, eventually, get, post, start};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read};
use std::net::SocketAddr;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

const PROGRAM: &str = env!("CARGO_BIN_EXE_giveway");

/// Runs `giveway database` with JSON. Its exit code, and what it printed.
fn database(file: &Path, arguments: &[&str]) -> (Option<i32>, Value, String) {
    let Output { status, stdout, stderr } = Command::new(PROGRAM)
        .args(["database", "--json", "--scenario", SCENARIO, "--database"])
        .arg(file)
        .args(arguments)
        .output()
        .unwrap();
    let json = serde_json::from_slice(&stdout).unwrap_or(Value::Null);
    (status.code(), json, String::from_utf8_lossy(&stderr).into_owned())
}

/// Hands in jobs until told to stop; keeps the ids of those that were acknowledged.
async fn customer(at: SocketAddr, over: Arc<AtomicBool>, known: Arc<Mutex<Vec<String>>>) {
    for i in 0.. {
        if over.load(Ordering::Relaxed) {
            return;
        }
        let Answer { status, text, .. } = post(at, None, &delivery(i)).await.unwrap();
        if status == 201 {
            let made: Value = serde_json::from_str(&text).unwrap();
            known.lock().unwrap().push(made["id"].as_str().unwrap().to_owned());
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_backup_taken_under_load_starts_and_has_every_job_acknowledged_before_it_began() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let (over, known) = (Arc::new(AtomicBool::new(false)), Arc::new(Mutex::new(Vec::new())));
    let customers: Vec<_> = (0..3).map(|_| tokio::spawn(customer(at, over.clone(), known.clone()))).collect();
    let are_known = async || (known.lock().unwrap().len() >= 20).then_some(());
    eventually("twenty jobs are acknowledged", are_known).await;
    let copy = folder.path().join("copy.sqlite");
    let (file, target) = (folder.database(), copy.to_str().unwrap().to_owned());
    let before = known.lock().unwrap().clone();
    let backup = tokio::task::spawn_blocking(move || database(&file, &["backup", &target])).await.unwrap();
    assert_eq!((backup.0, &backup.1["ok"]), (Some(0), &Value::Bool(true)), "{backup:?}");
    assert!(backup.1["robots"].as_u64() > Some(0), "the journal of the copy was folded: {backup:?}");
    let file = folder.database();
    let check = tokio::task::spawn_blocking(move || database(&file, &["check"])).await.unwrap();
    assert_eq!(check.0, Some(0), "also while the server runs: {check:?}");
    let again = database(&folder.database(), &["backup", copy.to_str().unwrap()]);
    assert!(again.0 == Some(1) && again.2.contains("never overwrites"), "{again:?}");
    let busy = database(&folder.database(), &["restore", copy.to_str().unwrap()]);
    assert!(busy.0 == Some(1) && busy.2.contains("in use by another Giveway"), "{busy:?}");
    over.store(true, Ordering::Relaxed);
    for customer in customers {
        customer.await.unwrap();
    }
    server.stop().await.unwrap();

    let back = database(&folder.database(), &["restore", copy.to_str().unwrap()]);
    assert_eq!(back.0, Some(0), "{back:?}");
    let aside = back.1["files"][0].as_str().unwrap().to_owned();
    let server = start(&folder).await;
    let jobs = all_jobs(server.address(), 500).await;
    for id in &before {
        assert!(jobs.iter().any(|j| j["id"] == **id), "{id} was acknowledged before the backup began");
    }
    server.stop().await.unwrap();
    let (code, found, _) = database(Path::new(&aside), &["check"]);
    let all = known.lock().unwrap().len() as u64;
    assert_eq!((code, found["jobs"].as_u64()), (Some(0), Some(all)), "what was there is kept: {found}");
}

#[test]
fn a_damaged_file_a_missing_one_and_one_of_another_program_are_found_out_and_never_restored() {
    let folder = Folder::new();
    let runtime = tokio::runtime::Runtime::new().unwrap();
    runtime.block_on(async {
        let server = start(&folder).await;
        post(server.address(), None, &delivery(0)).await.unwrap();
        server.stop().await.unwrap();
    });
    let missing = database(&folder.path().join("none.sqlite"), &["check"]);
    assert!(missing.0 == Some(1) && missing.2.contains("there is no database"), "{missing:?}");
    let broken = folder.path().join("broken.sqlite");
    let mut bytes = std::fs::read(folder.database()).unwrap();
    let half = bytes.len() / 2;
    bytes[half..].fill(0x5a);
    std::fs::write(&broken, &bytes).unwrap();
    let (code, _, said) = database(&broken, &["check"]);
    assert_eq!(code, Some(1), "{said}");
    let before = std::fs::read(folder.database()).unwrap();
    let refused = database(&folder.database(), &["restore", broken.to_str().unwrap()]);
    assert_eq!(refused.0, Some(1), "{refused:?}");
    assert_eq!(std::fs::read(folder.database()).unwrap(), before, "nothing was touched");
    let text = folder.path().join("text.sqlite");
    std::fs::write(&text, "no database at all, but long enough to look like one".repeat(100)).unwrap();
    assert_eq!(database(&text, &["check"]).0, Some(1));
}

#[test]
fn a_command_whose_reader_has_left_ends_quietly_as_shells_expect() {
    let shell = |command: &str| {
        let script = format!("set -o pipefail; {command} | true; echo ${{PIPESTATUS[0]}}");
        let output = Command::new("bash").args(["-c", &script]).env("GIVEWAY", PROGRAM).output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        (text(output.stdout).trim().to_owned(), text(output.stderr))
    };
    let lab = concat!(env!("CARGO_MANIFEST_DIR"), "/maps/lab.json");
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/lab.json");
    for command in [
        format!("(sleep 0.5; exec $GIVEWAY map show {lab})"),
        format!("(sleep 0.5; exec $GIVEWAY map check {lab} --json)"),
        format!("(sleep 0.5; exec $GIVEWAY sim {scenario} --duration 2 --no-bound --json)"),
    ] {
        let (code, said) = shell(&command);
        assert_eq!((code.as_str(), said.contains("panicked")), ("141", false), "{command}: {said}");
    }
}

/// A server in a shell that limits its files, or closes its output.
struct Limited(Child);

impl Limited {
    fn start(folder: &Folder, before: &str) -> (Limited, SocketAddr) {
        let script = format!("{before} exec {PROGRAM} serve --listen 127.0.0.1:0 --past-hours 0");
        let mut child = Command::new("bash")
            .args([
                "-c",
                &format!("{script} --scenario {SCENARIO} --database {}", folder.database().display()),
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let address = line.trim().rsplit_once("http://").map(|(_, at)| at.trim_end_matches('/'));
        let address = address.and_then(|at| at.parse().ok());
        (Limited(child), address.unwrap_or_else(|| panic!("no address in {line:?}")))
    }
}

impl Drop for Limited {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Waits until health has this status, and says it.
async fn health(at: SocketAddr, status: u16) -> String {
    let becomes = async || Some(get(at, "/v1/health").await).filter(|answer| answer.status == status);
    eventually(&format!("health becomes {status}"), becomes).await.text
}

#[cfg(target_os = "linux")]
#[tokio::test(flavor = "multi_thread")]
async fn a_limit_on_the_size_of_files_is_a_full_disk_and_not_the_end() {
    let folder = Folder::new();
    // The log of a new database alone takes some 900 kB: each migration writes its pages.
    let (server, at) = Limited::start(&folder, "ulimit -S -f 1200;");
    let mut acknowledged = Vec::new();
    for i in 0..2000 {
        let answer = post(at, Some(&format!("{i:0200}")), &delivery(i)).await.unwrap();
        if answer.status != 201 {
            answer.problem(503);
            break;
        }
        acknowledged.push(answer.json()["id"].clone());
    }
    let text = health(at, 503).await;
    assert!(text.contains("ulimit"), "{text}");
    let process = server.0.id().to_string();
    let raised = Command::new("prlimit").args(["--pid", &process, "--fsize=unlimited"]).status().unwrap();
    assert!(raised.success());
    health(at, 200).await;
    acknowledged.push(post(at, None, &delivery(0)).await.unwrap().json()["id"].clone());
    let listed = all_jobs(at, 500).await;
    for id in acknowledged {
        assert_eq!(listed.iter().filter(|j| j["id"] == id).count(), 1, "{id}");
    }
}

#[cfg(unix)]
#[test]
fn a_server_whose_output_was_closed_goes_on_and_stops_in_order() {
    let folder = Folder::new();
    let (mut server, at) = Limited::start(&folder, "");
    let runtime = tokio::runtime::Runtime::new().unwrap();
    runtime.block_on(async { assert_eq!(post(at, None, &delivery(0)).await.unwrap().status, 201) });
    let id = server.0.id().to_string();
    assert!(Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
    assert_eq!(server.0.wait().unwrap().code(), Some(0), "it says \"stopped\" to no one");
    let mut left = String::new();
    assert!(server.0.stdout.as_mut().is_none_or(|out| out.read_to_string(&mut left).is_ok()));
}
