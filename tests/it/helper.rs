//! Folders, servers and a small HTTP client for the tests.

use crate::schema::{DOCUMENT, check_answer};
use giveway::server::{Config, ServedFloor, Server};
use giveway::sim::Scenario;
use serde_json::Value;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

/// The scenario that all tests run: fast robots, no customers but the test.
pub const SCENARIO: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/quiet.json");

/// A folder that goes with the test, and stays where it is if the test fails.
pub struct Folder(PathBuf);

impl Folder {
    pub fn new() -> Folder {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let name = format!("giveway-it-{}-{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    pub fn database(&self) -> PathBuf {
        self.0.join("giveway.sqlite")
    }

    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if std::thread::panicking() {
            eprintln!("What the test left is kept in {}", self.0.display());
        } else {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }
}

/// Settings for a server on any port.
pub fn config(folder: &Folder) -> Config {
    Config {
        scenario: Some(SCENARIO.into()),
        listen: "127.0.0.1:0".into(),
        database: folder.database(),
        // Receivers of webhooks are on this machine.
        webhook_inside: vec!["127.0.0.0/8".into(), "::1".into()],
        ..Config::default()
    }
}

/// A server on any port.
pub async fn start(folder: &Folder) -> Server {
    Server::start(&config(folder), floor()).await.unwrap()
}

/// A server on any port whose clock is the system's: for headsets, whose times the tests take from there; for times
/// that go on over a restart; and for so many readers that more messages a second would be another test.
pub async fn start_in_real_time(folder: &Folder) -> Server {
    Server::start(&config(folder), real_time_floor()).await.unwrap()
}

/// How many times as fast as the system's clock the clock of servers in tests goes: most tests wait for robots.
const SPEED: u32 = 4;

/// The floor of servers in tests, at [`SPEED`].
pub fn floor() -> ServedFloor {
    let mut floor = real_time_floor();
    floor.source.speed = SPEED;
    floor
}

/// The same floor at the speed of the system's clock.
pub fn real_time_floor() -> ServedFloor {
    let scenario = Scenario::parse(&std::fs::read_to_string(SCENARIO).unwrap()).unwrap();
    ServedFloor::new(scenario, Arc::new(map()))
}

/// The map of the scenario.
pub fn map() -> giveway::warehouse::Warehouse {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/maps/lab.json")).unwrap();
    giveway::warehouse::formats::json::parse(&text).unwrap()
}

/// A ledger of that map in which nothing is promised.
pub fn empty_ledger() -> giveway::fleet::Ledger {
    let kinds = [giveway::fleet::RobotKind::default()];
    giveway::fleet::Ledger::new(Arc::new(map()), &kinds, false)
}

/// A job that brings a rack of the map to a station of it.
pub fn delivery(rack: usize) -> Value {
    let map = map();
    let rack = map.racks.iter().nth(rack % map.racks.len()).unwrap();
    let station = map.stations.iter().next().unwrap();
    serde_json::json!({"kind": "deliver", "rack": rack.name, "station": station.name})
}

/// An answer.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub headers: Vec<(String, String)>,
    pub text: String,
}

impl Answer {
    pub fn header(&self, name: &str) -> Option<&str> {
        self.headers.iter().find(|(n, _)| n == name).map(|(_, v)| v.as_str())
    }

    pub fn json(&self) -> Value {
        serde_json::from_str(&self.text).unwrap_or_else(|e| panic!("{e}: {self:?}"))
    }

    /// The problem that this is, checked for what every problem has.
    pub fn problem(&self, status: u16) -> Value {
        assert_eq!(self.status, status, "{self:?}");
        assert_eq!(self.header("content-type"), Some("application/problem+json"), "{self:?}");
        let json = self.json();
        assert_eq!(json["status"], status);
        for key in ["type", "title", "detail", "instance"] {
            assert!(json[key].as_str().is_some_and(|t| !t.is_empty()), "{key} of {json}");
        }
        json
    }
}

/// One request on a connection of its own. The answer is compared with what the server's own description says.
pub async fn send(
    at: SocketAddr,
    method: &str,
    path: &str,
    headers: &[(&str, &str)],
    body: &str,
) -> std::io::Result<Answer> {
    let answer = exchange(at, method, path, headers, body).await?;
    if DOCUMENT.get().is_none() && path.starts_with("/v1/") {
        match exchange(at, "GET", "/openapi.json", &[], "").await {
            Ok(document) if document.status == 200 => _ = DOCUMENT.set(document.json()),
            _ => {}
        }
    }
    check_answer(method, path, &answer);
    Ok(answer)
}

async fn exchange(
    at: SocketAddr,
    method: &str,
    path: &str,
    headers: &[(&str, &str)],
    body: &str,
) -> std::io::Result<Answer> {
    let mut text = format!("{method} {path} HTTP/1.1\r\nconnection: close\r\n");
    for (name, value) in headers {
        text += &format!("{name}: {value}\r\n");
    }
    if !headers.iter().any(|(name, _)| *name == "host") {
        text += &format!("host: {at}\r\n");
    }
    text += &format!("content-length: {}\r\n\r\n{body}", body.len());
    let mut stream = TcpStream::connect(at).await?;
    stream.write_all(text.as_bytes()).await?;
    let mut bytes = Vec::new();
    stream.read_to_end(&mut bytes).await?;
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let cut = || std::io::Error::other("the answer is cut off");
    let (head, body) = text.split_once("\r\n\r\n").ok_or_else(cut)?;
    let mut lines = head.lines();
    let status =
        lines.next().and_then(|l| l.split(' ').nth(1)).and_then(|s| s.parse().ok()).ok_or_else(cut)?;
    let header = |l: &str| l.split_once(": ").map(|(n, v)| (n.to_lowercase(), v.to_owned()));
    let answer = Answer { status, headers: lines.filter_map(header).collect(), text: body.into() };
    match answer.header("content-length").and_then(|n| n.parse::<usize>().ok()) {
        Some(length) if method != "HEAD" && length != answer.text.len() => Err(cut()),
        _ => Ok(answer),
    }
}

pub async fn get(at: SocketAddr, path: &str) -> Answer {
    send(at, "GET", path, &[], "").await.unwrap()
}

/// Waits until the server says that it is ready.
pub async fn until_ready(at: SocketAddr) {
    let is_ready = async || (get(at, "/v1/health/ready").await.status == 200).then_some(());
    eventually("the server is ready", is_ready).await;
}

/// Hands in a job.
pub async fn post(at: SocketAddr, key: Option<&str>, job: &Value) -> std::io::Result<Answer> {
    let mut headers = vec![("content-type", "application/json")];
    headers.extend(key.map(|key| ("idempotency-key", key)));
    send(at, "POST", "/v1/jobs", &headers, &job.to_string()).await
}

/// All jobs, page by page.
pub async fn all_jobs(at: SocketAddr, limit: u32) -> Vec<Value> {
    let mut jobs = Vec::new();
    let mut path = format!("/v1/jobs?limit={limit}");
    loop {
        let page = get(at, &path).await.json();
        jobs.extend(page["items"].as_array().unwrap().clone());
        match page["next"].as_str() {
            Some(next) => path = format!("/v1/jobs?limit={limit}&cursor={next}"),
            None => return jobs,
        }
    }
}

/// How long a test waits for something that must come before it says that it never does. Generous, since a machine may
/// compile, draw and run thirty other tests meanwhile: what must be *fast* is measured by benches, not by tests.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// Asks every 50 ms until there is an answer, which it returns. Panics with `what` if none comes in [`PATIENCE`].
pub async fn eventually<T>(what: &str, mut ask: impl AsyncFnMut() -> Option<T>) -> T {
    let began = Instant::now();
    loop {
        if let Some(answer) = ask().await {
            return answer;
        }
        assert!(began.elapsed() < PATIENCE, "never: {what}");
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
}

/// What this future returns. Panics with `what` if it does not within [`PATIENCE`].
pub async fn in_time<T>(what: &str, it: impl Future<Output = T>) -> T {
    tokio::time::timeout(PATIENCE, it).await.unwrap_or_else(|_| panic!("never: {what}"))
}
