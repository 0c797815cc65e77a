//! Measurements under load, from outside. Not part of the tests: `cargo test --release --test it load -- --ignored
//! --nocapture` prints what it measured.

use crate::feed::{Headset, hire};
use crate::helper::{Folder, config, get};
use futures_util::StreamExt;
use giveway::server::{Floor, Server};
use giveway::sim::Scenario;
use giveway::time::Span;
use giveway::warehouse::formats;
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;
use tokio::time::{Instant, MissedTickBehavior, interval};

const WORKERS: usize = 20;
const ROBOTS: usize = 200;
/// Length of a turn of the loop, which poses wait for.
const PERIOD_MS: i64 = 50;

/// How long it takes, without the first seconds.
fn seconds() -> u64 {
    std::env::var("GIVEWAY_LOAD_SECONDS").ok().and_then(|s| s.parse().ok()).unwrap_or(60)
}

/// What one headset saw: milliseconds from a pose that was sent to guidance that was decided with it.
#[derive(Default)]
struct Seen {
    /// By the state that began: stop, redirected, …
    turns: BTreeMap<String, Vec<f64>>,
    /// Of every guidance: how old the pose was.
    ages: Vec<f64>,
    sent: u64,
}

/// Walks to and fro across the hall at walking speed and notes what it is told.
async fn walk(at: SocketAddr, worker: String, from: [f64; 2], to: [f64; 2]) -> Seen {
    let mut headset = Headset::connect(at, &worker, "map").await;
    let mut tick = interval(Duration::from_micros(1_000_000 / 60));
    tick.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let (began, mut seen, mut state) = (Instant::now(), Seen::default(), String::new());
    let mut sent: Vec<Instant> = vec![began];
    let length = (to[0] - from[0]).hypot(to[1] - from[1]).max(1.0);
    while began.elapsed() < Duration::from_secs(seconds() + 5) {
        tokio::select! {
            _ = tick.tick() => {
                let way = began.elapsed().as_secs_f64() * 1.2 / length;
                let u = 1.0 - (way % 2.0 - 1.0).abs();
                sent.push(Instant::now());
                headset.stand(from[0] + u * (to[0] - from[0]), from[1] + u * (to[1] - from[1])).await;
            }
            message = headset.any() => {
                let message = message.expect("the feed stays open");
                if message["type"] != "guidance" || began.elapsed() < Duration::from_secs(5) {
                    continue;
                }
                let Some(seq) = message["pose"]["seq"].as_u64() else { continue };
                let age = sent[seq as usize].elapsed().as_secs_f64() * 1000.0;
                seen.ages.push(age);
                let now = message["state"].as_str().unwrap();
                if state != now {
                    seen.turns.entry(now.into()).or_default().push(age);
                    state = now.into();
                }
            }
        }
    }
    seen.sent = headset.seq;
    seen
}

fn told(what: &str, mut ms: Vec<f64>) {
    ms.sort_by(f64::total_cmp);
    let at = |q: f64| ms.get(((ms.len() as f64 * q) as usize).min(ms.len().saturating_sub(1))).copied();
    let text = |q| at(q).map_or("-".into(), |x| format!("{x:.1}"));
    let (n, p50, p99) = (ms.len(), text(0.5), text(0.99));
    println!("{what:<24} n={n:<6} p50={p50:<7} p99={p99:<7} max={:<7} ms", text(1.0));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "a measurement"]
async fn twenty_headsets_at_60_hz_beside_200_robots() {
    let root = env!("CARGO_MANIFEST_DIR");
    let read = |path: &str| std::fs::read_to_string(format!("{root}/{path}")).unwrap();
    let mut scenario = Scenario::parse(&read("scenarios/kiva-100.json")).unwrap();
    let (map, _) =
        formats::import(&read(&format!("scenarios/{}", scenario.map)), &Default::default()).unwrap();
    scenario.robots = ROBOTS;
    scenario.period = Span::from_millis(PERIOD_MS);
    let (low, high) = map.bounds();
    let folder = Folder::new();
    let floor = Floor { scenario, map: Arc::new(map), lines: Vec::new() };
    let server = Server::start(&config(&folder), floor).await.unwrap();
    let at = server.address();
    let mut walks = Vec::new();
    for i in 0..WORKERS {
        let worker = hire(at, &format!("worker-{i}")).await;
        // Across the hall in turn along x and along y, so that every path meets robots.
        let u = (i as f64 + 0.5) / WORKERS as f64;
        let point = |v: f64| match i % 2 {
            0 => [low.x + v * (high.x - low.x), low.y + u * (high.y - low.y)],
            _ => [low.x + u * (high.x - low.x), low.y + v * (high.y - low.y)],
        };
        walks.push(tokio::spawn(walk(at, worker, point(0.1), point(0.9))));
    }
    let mut all = Seen::default();
    for walk in walks {
        let seen = walk.await.unwrap();
        all.ages.extend(seen.ages);
        all.sent += seen.sent;
        seen.turns.into_iter().for_each(|(state, ms)| all.turns.entry(state).or_default().extend(ms));
    }
    let rate = all.sent as f64 / WORKERS as f64 / (seconds() + 5) as f64;
    println!(
        "{WORKERS} headsets, {ROBOTS} robots, turns of {PERIOD_MS} ms, {rate:.1} poses a second each, for {} s",
        seconds()
    );
    println!("from the newest pose that was taken into account to guidance received:");
    told("every guidance", all.ages);
    for (state, ms) in all.turns {
        told(&format!("the first of \"{state}\""), ms);
    }
    let metrics = get(at, "/metrics").await.text;
    let figure = |l: &&str| l.starts_with("giveway_pose") || l.starts_with("giveway_step_seconds");
    metrics
        .lines()
        .filter(figure)
        .filter(|l| !l.contains("_bucket") || l.contains("to_robot_stop"))
        .for_each(|l| println!("{l}"));
    server.stop().await.unwrap();
}

const DASHBOARDS: usize = 200;

/// Reads the live feed as a dashboard does and adds up what came; lets nobody wait for it.
async fn watch_floor(at: SocketAddr, bytes: Arc<AtomicU64>, patches: Arc<AtomicU64>) {
    let url = format!("ws://{at}/v1/live?thin=true");
    let (mut socket, _) = tokio_tungstenite::connect_async(url).await.expect("the feed opens");
    let _snapshot = socket.next().await;
    while let Some(Ok(message)) = socket.next().await {
        bytes.fetch_add(message.len() as u64, Ordering::Relaxed);
        patches.fetch_add(u64::from(message.is_text()), Ordering::Relaxed);
    }
}

/// How many steps there were, and how many seconds they took together.
async fn steps(at: SocketAddr) -> (f64, f64) {
    let text = get(at, "/metrics").await.text;
    let figure = |name: &str| {
        let line = text.lines().find(|l| l.starts_with(name)).expect("a figure");
        line.rsplit(' ').next().and_then(|n| n.parse::<f64>().ok()).expect("a number")
    };
    (figure("giveway_step_seconds_count"), figure("giveway_step_seconds_sum"))
}

/// Seconds that the control loop's thread has spent on a processor, whoever else wanted one. Linux only.
fn loop_cpu() -> f64 {
    let tasks = std::fs::read_dir("/proc/self/task").expect("Linux").flatten().map(|t| t.path());
    let is_fleet =
        |t: &std::path::PathBuf| std::fs::read_to_string(t.join("comm")).is_ok_and(|c| c.trim() == "fleet");
    let task = tasks.into_iter().find(is_fleet).expect("the control loop");
    let text = std::fs::read_to_string(task.join("schedstat")).expect("Linux counts it");
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).expect("nanoseconds") / 1e9
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "a measurement"]
async fn two_hundred_dashboards_beside_800_robots() {
    let root = env!("CARGO_MANIFEST_DIR");
    let read = |path: &str| std::fs::read_to_string(format!("{root}/{path}")).unwrap();
    let scenario = Scenario::parse(&read("scenarios/kiva-800.json")).unwrap();
    let (map, _) =
        formats::import(&read(&format!("scenarios/{}", scenario.map)), &Default::default()).unwrap();
    let folder = Folder::new();
    let floor = Floor { scenario, map: Arc::new(map), lines: Vec::new() };
    let server = Server::start(&config(&folder), floor).await.unwrap();
    let at = server.address();
    tokio::time::sleep(Duration::from_secs(30)).await;
    let turns = 4;
    let each = Duration::from_secs((seconds() / (2 * turns)).max(5));
    // In turn, since steps do not cost the same all the time.
    for _ in 0..turns {
        for dashboards in [0, DASHBOARDS] {
            let (bytes, patches) = (Arc::new(AtomicU64::new(0)), Arc::new(AtomicU64::new(0)));
            let readers: Vec<_> = (0..dashboards)
                .map(|_| tokio::spawn(watch_floor(at, bytes.clone(), patches.clone())))
                .collect();
            tokio::time::sleep(Duration::from_secs(2)).await;
            let ((n0, s0), b0) = (steps(at).await, bytes.load(Ordering::Relaxed));
            let (p0, c0) = (patches.load(Ordering::Relaxed), loop_cpu());
            tokio::time::sleep(each).await;
            let cpu = loop_cpu() - c0;
            let ((n1, s1), b1) = (steps(at).await, bytes.load(Ordering::Relaxed));
            let per = |sum: u64| sum as f64 / each.as_secs_f64() / (dashboards.max(1)) as f64;
            println!(
                "{dashboards:>3} dashboards: a step {:.2} ms, the loop {:.2} ms of processor a step, {} steps; \
                 each dashboard {:.1} kB/s in {:.1} patches/s",
                1000.0 * (s1 - s0) / (n1 - n0),
                1000.0 * cpu / (n1 - n0),
                n1 - n0,
                per(b1 - b0) / 1000.0,
                per(patches.load(Ordering::Relaxed) - p0)
            );
            readers.iter().for_each(tokio::task::JoinHandle::abort);
            tokio::time::sleep(Duration::from_secs(1)).await;
        }
    }
    server.stop().await.unwrap();
}
