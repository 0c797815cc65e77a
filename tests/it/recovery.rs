//! `kill -9` under load: every acknowledged job is there, none twice, and all of them end.

use crate::helper::{Folder, SCENARIO, all_jobs, delivery, eventually, get, post};
use serde_json::Value;
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tokio::time::Instant;

/// How long the robots may take for all jobs.
const PATIENCE: Duration = Duration::from_secs(300);

/// The real program.
pub struct Program {
    child: Child,
    pub address: SocketAddr,
}

impl Program {
    pub fn start(folder: &Folder) -> Program {
        Program::with(folder, SCENARIO)
    }

    pub fn with(folder: &Folder, scenario: &str) -> Program {
        let mut child = Command::new(env!("CARGO_BIN_EXE_giveway"))
            .args(["serve", "--listen", "127.0.0.1:0", "--scenario", scenario, "--database"])
            .arg(folder.database())
            .current_dir(folder.path())
            .env("RUST_LOG", "warn")
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        let address = lines
            .by_ref()
            .map_while(Result::ok)
            .find_map(|line| line.strip_prefix("Giveway is at http://")?.trim_end_matches('/').parse().ok());
        std::thread::spawn(move || lines.map_while(Result::ok).for_each(drop));
        Program { child, address: address.expect("it says where it is") }
    }

    /// `kill -9`.
    pub fn kill(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Keys with the ids under which they were acknowledged.
type Acknowledged = Arc<Mutex<BTreeMap<String, String>>>;

/// A short pick, so that the test does not take long.
fn order(i: usize) -> Value {
    let mut job = delivery(i);
    job["pick_s"] = serde_json::json!(0.1);
    job
}

/// Hands in jobs until the server is gone.
async fn customer(at: SocketAddr, name: String, acknowledged: Acknowledged) {
    for i in 0.. {
        let key = format!("{name}-{i}");
        let Ok(answer) = post(at, Some(&key), &order(i)).await else { return };
        if answer.status == 201 {
            let id = answer.json()["id"].as_str().unwrap().to_owned();
            acknowledged.lock().unwrap().insert(key, id);
        }
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
}

fn count(jobs: &[Value], id: &str) -> usize {
    jobs.iter().filter(|j| j["id"] == id).count()
}

#[tokio::test(flavor = "multi_thread")]
async fn after_kill_9_every_acknowledged_job_is_there_once_and_gets_done() {
    let folder = Folder::new();
    let acknowledged = Acknowledged::default();
    for round in 0..3 {
        let program = Program::start(&folder);
        let at = program.address;
        let known = acknowledged.lock().unwrap().clone();
        if round > 0 {
            tokio::time::sleep(Duration::from_secs(3)).await;
        }
        let jobs = all_jobs(at, 500).await;
        for (key, id) in &known {
            assert_eq!(count(&jobs, id), 1, "{key} was acknowledged as {id} before the kill");
        }
        let customers: Vec<_> = (0..2)
            .map(|c| tokio::spawn(customer(at, format!("r{round}-c{c}"), acknowledged.clone())))
            .collect();
        // The kill comes amid requests; in later rounds robots have begun to carry, too.
        let is_loaded = async || (acknowledged.lock().unwrap().len() > known.len() + 2).then_some(());
        eventually("jobs are acknowledged", is_loaded).await;
        program.kill();
        for customer in customers {
            customer.await.unwrap();
        }
    }
    let known = acknowledged.lock().unwrap().clone();
    assert!(known.len() > 5, "there was load: {known:?}");

    let program = Program::start(&folder);
    let at = program.address;
    for (key, id) in &known {
        let i: usize = key.rsplit('-').next().unwrap().parse().unwrap();
        let again = post(at, Some(key), &order(i)).await.unwrap();
        assert_eq!((again.status, again.json()["id"].as_str()), (200, Some(id.as_str())), "{key}");
    }
    let deadline = Instant::now() + PATIENCE;
    loop {
        let jobs = all_jobs(at, 500).await;
        let open: Vec<_> = known
            .iter()
            .filter(|(_, id)| jobs.iter().any(|j| j["id"] == **id && j["state"] != "done"))
            .collect();
        assert!(jobs.iter().all(|j| j["state"] != "failed"), "{jobs:?}");
        if open.is_empty() {
            break;
        }
        assert!(Instant::now() < deadline, "not done in time: {open:?} of {jobs:#?}");
        tokio::time::sleep(Duration::from_millis(500)).await;
    }
    let jobs = all_jobs(at, 500).await;
    let mut keys = BTreeMap::new();
    for (key, id) in &known {
        assert_eq!(count(&jobs, id), 1, "{key}");
        assert_eq!(keys.insert(id, key), None, "one job for one key");
    }
    assert_eq!(get(at, "/v1/health").await.status, 200);
    program.kill();
    each_is_done_once(&folder, &known).await;
}

/// The journal says of each job once that it is done.
async fn each_is_done_once(folder: &Folder, known: &BTreeMap<String, String>) {
    use giveway::fleet::{Fact, JobFact, JobState};
    let store = giveway::store::Store::open(&folder.database(), &crate::helper::map()).await.unwrap();
    let loaded = store.load(crate::helper::empty_ledger()).await.unwrap();
    let facts: Vec<Fact> = loaded.into_parts().1.collect();
    for id in known.values() {
        let is_it = |fact: &&Fact| matches!(fact, Fact::Job(JobFact::Progressed { job, state: JobState::Done, .. }) if format!("j{}", job.0) == *id);
        assert_eq!(facts.iter().filter(is_it).count(), 1, "{id}");
    }
}

#[cfg(unix)]
#[tokio::test(flavor = "multi_thread")]
async fn a_signal_takes_the_program_down_in_order() {
    let folder = Folder::new();
    let mut program = Program::start(&folder);
    let made = post(program.address, None, &delivery(0)).await.unwrap().json();
    let id = program.child.id().to_string();
    assert!(Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
    assert_eq!(program.child.wait().unwrap().code(), Some(0));
    let again = Program::start(&folder);
    let path = format!("/v1/jobs/{}", made["id"].as_str().unwrap());
    assert_eq!(get(again.address, &path).await.json()["created"], made["created"]);
}

#[test]
fn a_program_that_cannot_start_says_why_and_fails() {
    let folder = Folder::new();
    let run = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_giveway"));
        let output = command.args(arguments).current_dir(folder.path()).output().unwrap();
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, text) = run(&["serve"]);
    assert_eq!(code, Some(1));
    assert!(text.contains("scenarios/first.json") && text.contains("--scenario"), "{text}");
    let (code, text) = run(&["--scenario", SCENARIO, "--listen", "0.0.0.0:0"]);
    assert_eq!(code, Some(1));
    assert!(text.contains("GIVEWAY_TOKEN"), "{text}");
    let map = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/maps/lab.json")).unwrap();
    let hole = map.replace("\"to\"", "\"too\"");
    std::fs::write(folder.path().join("hole.json"), hole).unwrap();
    let scenario = r#"{"giveway_scenario": 1, "name": "x", "map": "hole.json", "robots": 2}"#;
    std::fs::write(folder.path().join("scenario.json"), scenario).unwrap();
    let (code, text) = run(&["--scenario", "scenario.json"]);
    assert_eq!(code, Some(1));
    assert!(text.contains("hole.json") && text.contains("line"), "{text}");
    assert_eq!(run(&["serve", "--colour"]).0, Some(2));
}

/// Two robots and customers that want jobs of every kind, and change their minds.
const BUSY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/busy.json");

#[tokio::test(flavor = "multi_thread")]
async fn with_customers_of_every_kind_no_job_is_lost_over_kills_and_the_floor_goes_on() {
    let folder = Folder::new();
    let mut known: BTreeMap<String, Value> = BTreeMap::new();
    for round in 0..3 {
        let program = Program::with(&folder, BUSY);
        let at = program.address;
        let jobs = all_jobs(at, 500).await;
        for (id, old) in &known {
            let found: Vec<_> = jobs.iter().filter(|j| j["id"] == **id).collect();
            assert_eq!(found.len(), 1, "{id} was listed before the kill");
            let over = |j: &Value| ["done", "cancelled", "failed"].iter().any(|s| j["state"] == *s);
            assert!(!over(old) || found[0]["state"] == old["state"], "{old} became {}", found[0]);
        }
        // Simulated customers go on by themselves; what is listed is durable.
        let deadline = Instant::now() + PATIENCE;
        loop {
            let done =
                get(at, "/v1/jobs?state=done&limit=500").await.json()["items"].as_array().unwrap().len();
            if done >= 3 * (round + 1) {
                break;
            }
            assert!(Instant::now() < deadline, "only {done} are done in round {round}");
            tokio::time::sleep(Duration::from_millis(200)).await;
        }
        assert_eq!(get(at, "/v1/health").await.status, 200);
        known = all_jobs(at, 500).await.into_iter().map(|j| (j["id"].as_str().unwrap().into(), j)).collect();
        program.kill();
    }
    let kinds: std::collections::BTreeSet<&str> = known.values().filter_map(|j| j["kind"].as_str()).collect();
    assert!(kinds.len() >= 3, "{kinds:?}");
}
