//! Measurements under load, from outside. Not part of the tests: `cargo test --release --test it load -- --ignored
//! --nocapture` prints what it measured.

use crate::feed::{Headset, hire};
use crate::hands::Wearer;
use crate::helper::{Folder, config, get, post};
use futures_util::StreamExt;
use giveway::cell::FacePlace;
use giveway::id::StationId;
use giveway::server::{ServedFloor, Server};
use giveway::sim::Scenario;
use giveway::time::Span;
use giveway::warehouse::{Warehouse, formats};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tokio::time::{Instant, MissedTickBehavior, interval};

const WORKERS: usize = 20;
const ROBOTS: usize = 200;
/// Length of a turn of the loop, which poses wait for.
const PERIOD_MS: i64 = 50;

/// The regions round people allow for two turns of the loop from a pose that came in to a robot's stop, seconds
/// (`aware/regions.rs`); so many may be later.
const BOUND_S: f64 = 0.1;
const MOST_LATE: f64 = 0.01;

/// How long it takes, without the first seconds.
fn seconds() -> u64 {
    std::env::var("GIVEWAY_LOAD_SECONDS").ok().and_then(|s| s.parse().ok()).unwrap_or(60)
}

/// How long somebody walks before the next appearance in front of a robot, and stands there then.
const WALKS: Duration = Duration::from_millis(3000);
const STANDS: Duration = Duration::from_millis(1000);
/// How far in front of the robot, metres: within region 1 of a robot that drives faster than half of what it can.
const IN_FRONT_M: f64 = 1.0;
const FAST_MPS: f64 = 0.7;

/// What one headset saw, in milliseconds.
#[derive(Default)]
struct Seen {
    /// Of every guidance: how old the newest pose was that it took into account.
    ages: Vec<f64>,
    /// From the first pose in front of a robot, sent, to "stop" because of it, received.
    stops: Vec<f64>,
    /// The same where "stop" came because of another robot, or where the live feed was late and this one was farther
    /// away than it said: they may have driven up afterwards.
    others: Vec<f64>,
    /// Appearances after which no "stop" came: the robot had turned or was told to stand before.
    without: u64,
    sent: u64,
}

/// Robots as the live feed shows them: x, y, heading and speed by name.
type Robots = Arc<Mutex<BTreeMap<String, BTreeMap<&'static str, f64>>>>;

async fn watch_robots(at: SocketAddr, robots: Robots) {
    let (mut socket, _) =
        tokio_tungstenite::connect_async(format!("ws://{at}/v1/live")).await.expect("opens");
    while let Some(Ok(message)) = socket.next().await {
        let Ok(text) = message.to_text() else { continue };
        let Ok(said) = serde_json::from_str::<serde_json::Value>(text) else { continue };
        let mut robots = robots.lock().expect("nobody panics");
        for robot in said["robots"].as_array().into_iter().flatten() {
            let known = robots.entry(robot["id"].as_str().expect("a name").to_owned()).or_default();
            for key in ["x", "y", "heading", "speed"] {
                if let Some(value) = robot[key].as_f64() {
                    known.insert(key, value);
                }
            }
        }
    }
}

/// A robot that drives, another one each time, and a place in front of it.
fn in_front(robots: &Robots, turn: usize) -> Option<(String, [f64; 2])> {
    let robots = robots.lock().expect("nobody panics");
    let driving: Vec<_> =
        robots.iter().filter(|(_, r)| r.get("speed").is_some_and(|v| *v > FAST_MPS)).collect();
    let (name, r) = driving.get(turn.wrapping_mul(7919) % driving.len().max(1))?;
    Some((
        (*name).clone(),
        [r["x"] + IN_FRONT_M * r["heading"].cos(), r["y"] + IN_FRONT_M * r["heading"].sin()],
    ))
}

/// The headset finds itself again. Whether no "stop" came meanwhile.
async fn begin_epoch(headset: &mut Headset) -> bool {
    let mut free = true;
    headset.say(json!({"type": "reset"})).await;
    loop {
        let message = headset.any().await.expect("the feed stays open");
        free &= message["state"] != "stop";
        if message["type"] == "epoch" {
            headset.epoch = message["epoch"].as_u64().unwrap();
            return free;
        }
    }
}

/// Walks to and fro across the hall at walking speed and appears in front of a robot now and then, as somebody does
/// whose headset finds itself again.
async fn walk(at: SocketAddr, (i, worker): (usize, String), way: [[f64; 2]; 2], robots: Robots) -> Seen {
    let mut headset = Headset::connect(at, &worker, "map").await;
    let mut tick = interval(Duration::from_micros(1_000_000 / 60));
    tick.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let (began, mut seen) = (Instant::now(), Seen::default());
    let mut sent: BTreeMap<(u64, u64), Instant> = BTreeMap::new();
    let [from, to] = way;
    let length = (to[0] - from[0]).hypot(to[1] - from[1]).max(1.0);
    // Not all at once.
    let (mut turn, mut next) = (i, began + Duration::from_secs(5) + WALKS * i as u32 / WORKERS as u32);
    // Before which robot somebody stands, where, since when, and whether "stop" has come.
    let mut stands: Option<(String, [f64; 2], Instant, bool)> = None;
    // A worker who was told already is not told anew.
    let mut free = false;
    while began.elapsed() < Duration::from_secs(seconds() + 5) {
        tokio::select! {
            _ = tick.tick() => {
                let place = in_front(&robots, turn).filter(|_| stands.is_none() && free && Instant::now() >= next);
                let over = stands.as_ref().is_some_and(|(_, _, since, _)| since.elapsed() > STANDS);
                if place.is_some() || over {
                    free &= begin_epoch(&mut headset).await;
                    seen.without += u64::from(over && stands.as_ref().is_some_and(|(.., told)| !told));
                    (turn, next) = (turn + WORKERS, Instant::now() + WALKS);
                    stands = place.filter(|_| free).map(|(robot, at)| (robot, at, Instant::now(), false));
                }
                let way = began.elapsed().as_secs_f64() * 1.2 / length;
                let u = 1.0 - (way % 2.0 - 1.0).abs();
                let walks = [from[0] + u * (to[0] - from[0]), from[1] + u * (to[1] - from[1])];
                let [x, y] = stands.as_ref().map_or(walks, |(_, at, ..)| *at);
                headset.stand(x, y).await;
                sent.insert((headset.epoch, headset.seq), Instant::now());
            }
            message = headset.any() => {
                let message = message.expect("the feed stays open");
                let pose = [&message["pose"]["epoch"], &message["pose"]["seq"]].map(serde_json::Value::as_u64);
                let [Some(epoch), Some(seq)] = pose else { continue };
                if let Some(sent) = sent.get(&(epoch, seq)).filter(|_| began.elapsed().as_secs() >= 5) {
                    seen.ages.push(sent.elapsed().as_secs_f64() * 1000.0);
                }
                free = message["state"] != "stop";
                if let Some((robot, _, since, told)) = &mut stands
                    && (!free && !*told && epoch == headset.epoch)
                {
                    let reason = message["reason"]["text"].as_str().unwrap_or_default();
                    let near = message["near"].as_array().into_iter().flatten();
                    let distance = near.filter(|n| n["id"] == robot.as_str()).find_map(|n| n["distance"].as_f64());
                    let because = reason.split(' ').next() == Some(robot.as_str())
                        && distance.is_some_and(|d| d < IN_FRONT_M + 0.3);
                    let list = if because { &mut seen.stops } else { &mut seen.others };
                    list.push(since.elapsed().as_secs_f64() * 1000.0);
                    *told = true;
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
    println!("{what:<48} n={n:<6} p50={p50:<7} p99={p99:<7} max={:<7} ms", text(1.0));
}

/// A scenario of the repository with its map.
fn shipped(name: &str) -> (Scenario, Warehouse) {
    let root = env!("CARGO_MANIFEST_DIR");
    let read = |path: &str| std::fs::read_to_string(format!("{root}/{path}")).unwrap();
    let scenario = Scenario::parse(&read(&format!("scenarios/{name}.json"))).unwrap();
    let (map, _) =
        formats::import(&read(&format!("scenarios/{}", scenario.site.map)), &Default::default()).unwrap();
    (scenario, map)
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "a measurement"]
async fn twenty_headsets_at_60_hz_beside_200_robots() {
    let (mut scenario, map) = shipped("kiva-100");
    scenario.robots = ROBOTS;
    scenario.site.period = Span::from_millis(PERIOD_MS);
    let (low, high) = map.bounds();
    let folder = Folder::new();
    let floor = ServedFloor::new(scenario, Arc::new(map));
    let server = Server::start(&config(&folder), floor).await.unwrap();
    let at = server.address();
    let (mut walks, robots) = (Vec::new(), Robots::default());
    let eyes = tokio::spawn(watch_robots(at, robots.clone()));
    for i in 0..WORKERS {
        let worker = hire(at, &format!("worker-{i}")).await;
        // Across the hall in turn along x and along y, so that every path meets robots.
        let u = (i as f64 + 0.5) / WORKERS as f64;
        let point = |v: f64| match i % 2 {
            0 => [low.x + v * (high.x - low.x), low.y + u * (high.y - low.y)],
            _ => [low.x + u * (high.x - low.x), low.y + v * (high.y - low.y)],
        };
        walks.push(tokio::spawn(walk(at, (i, worker), [point(0.1), point(0.9)], robots.clone())));
    }
    let mut all = Seen::default();
    for walk in walks {
        let seen = walk.await.unwrap();
        all.ages.extend(seen.ages);
        all.stops.extend(seen.stops);
        all.others.extend(seen.others);
        (all.sent, all.without) = (all.sent + seen.sent, all.without + seen.without);
    }
    eyes.abort();
    let rate = all.sent as f64 / WORKERS as f64 / (seconds() + 5) as f64;
    println!(
        "{WORKERS} headsets, {ROBOTS} robots, turns of {PERIOD_MS} ms, {rate:.1} poses a second each, for {} s",
        seconds()
    );
    told("every guidance: age of the newest pose in it", all.ages);
    told("first pose before a robot to \"stop\"", all.stops);
    told("the same, robots that drove up later", all.others);
    println!("{} appearances before robots that were about to turn or stand: no stop", all.without);
    let metrics = get(at, "/metrics").await.text;
    let figure = |l: &&str| l.starts_with("giveway_pose") || l.starts_with("giveway_step_seconds");
    metrics
        .lines()
        .filter(figure)
        .filter(|l| !l.contains("_bucket") || l.contains("to_robot_stop"))
        .for_each(|l| println!("{l}"));
    server.stop().await.unwrap();
    let late = late_stops(&metrics);
    println!("stops sent to robots later than {BOUND_S} s after the pose came in: {:.2} %", late * 100.0);
    assert!(late <= MOST_LATE, "regions are too small for so many late stops");
}

/// The share of stops that were sent to robots later than the bound after the first pose that asked for them came in.
fn late_stops(metrics: &str) -> f64 {
    let count = |bucket: &str| {
        let line = metrics.lines().find(|l| {
            l.starts_with("giveway_pose_to_robot_stop_seconds_bucket")
                && l.contains(&format!("le=\"{bucket}\""))
        });
        line.and_then(|l| l.rsplit(' ').next()?.parse::<f64>().ok()).expect("the histogram has this bucket")
    };
    let all = count("+Inf");
    assert!(all > 0.0, "no robot was sent a stop");
    1.0 - count(&BOUND_S.to_string()) / all
}

/// Headsets that send hands; one at each station reaches into wrong slots, the others walk.
const WEARERS: usize = 40;
const PICKING: usize = 4;

/// Reaches into a wrong slot again and again.
async fn reach(at: SocketAddr, map: Arc<Warehouse>, station: StationId) -> u64 {
    let mut wearer = Wearer::before(at, &map, station).await;
    let (began, mut reaches) = (Instant::now(), 0);
    let slots = ["B2", "D4", "A3"].map(|name| wearer.face.slot(name.parse().unwrap()));
    while began.elapsed() < Duration::from_secs(seconds()) {
        for front in slots {
            wearer.moves(front + FacePlace::new(0.0, 0.4, 0.0), 0.5).await;
            wearer.moves(front - FacePlace::new(0.0, 0.08, 0.0), 0.5).await;
            reaches += 1;
        }
        // What the server says is read, or it would end the feed.
        while tokio::time::timeout(Duration::from_millis(1), wearer.headset.any()).await.is_ok() {}
    }
    reaches
}

/// Walks to and fro, with both hands in sight, 60 poses a second.
async fn stroll(at: SocketAddr, i: usize, [from, to]: [[f64; 2]; 2]) {
    let worker = hire(at, &format!("stroller-{i}")).await;
    let mut headset = Headset::connect(at, &worker, "map").await;
    let mut tick = interval(Duration::from_micros(1_000_000 / 60));
    tick.set_missed_tick_behavior(MissedTickBehavior::Skip);
    let began = Instant::now();
    while began.elapsed() < Duration::from_secs(seconds()) {
        tokio::select! {
            _ = tick.tick() => {
                let u = 1.0 - ((began.elapsed().as_secs_f64() * 0.05) % 2.0 - 1.0).abs();
                let [x, y] = [0, 1].map(|k| from[k] + u * (to[k] - from[k]));
                let joint = |j: u32| json!([x + 0.3, 1.1, -y + 0.003 * f64::from(j), 0.01]);
                let hand: Vec<_> = (0..25).map(joint).collect();
                headset.seq += 1;
                let (epoch, seq, t) = (headset.epoch, headset.seq, headset.clock_ms());
                headset.say(json!({
                    "type": "pose", "epoch": epoch, "seq": seq, "t": t, "at": [x, y], "heading": 0.0,
                    "hands": {"l": hand, "r": hand},
                })).await;
            }
            message = headset.any() => {
                message.expect("the feed stays open");
            }
        }
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "a measurement"]
async fn forty_headsets_with_hands_of_which_four_reach_into_wrong_slots() {
    let folder = Folder::new();
    let (mut scenario, map) = shipped("kiva-100");
    scenario.robots = ROBOTS;
    let map = Arc::new(giveway::warehouse::with_cells(&map, 0));
    let (low, high) = map.bounds();
    let picked: Vec<_> = map.stations.iter().take(PICKING).cloned().collect();
    let racks: Vec<_> = map.racks.iter().take(PICKING).cloned().collect();
    let floor = ServedFloor::new(scenario, map.clone());
    let server = Server::start(&config(&folder), floor).await.unwrap();
    let at = server.address();
    for (rack, station) in racks.iter().zip(&picked) {
        let job = json!({
            "kind": "deliver", "rack": rack.name, "station": station.name, "pick_s": 900, "priority": 9,
            "lines": [{"slot": "C3", "quantity": 1, "tote": "B"}],
        });
        let answer = post(at, None, &job).await.unwrap();
        assert_eq!(answer.status, 201, "{answer:?}");
    }
    for station in &picked {
        let path = format!("/v1/stations/{}", station.name);
        let has_lines = |s: &Value| s["visit"]["lines"].as_array().is_some_and(|l| !l.is_empty());
        // Other robots queue before that one.
        let began = Instant::now();
        while !has_lines(&get(at, &path).await.json()) {
            assert!(began.elapsed() < Duration::from_secs(400), "no lines at {}", station.name);
            tokio::time::sleep(Duration::from_millis(500)).await;
        }
    }
    let strolls: Vec<_> = (PICKING..WEARERS)
        .map(|i| {
            let y = low.y + (high.y - low.y) * i as f64 / WEARERS as f64;
            tokio::spawn(stroll(at, i, [[low.x + 8.0, y], [high.x - 8.0, y]]))
        })
        .collect();
    let picks: Vec<_> =
        (0..PICKING).map(|s| tokio::spawn(reach(at, map.clone(), StationId(s as u32)))).collect();
    let mut reaches = 0;
    for pick in picks {
        reaches += pick.await.unwrap();
    }
    for stroll in strolls {
        stroll.await.unwrap();
    }
    let metrics = get(at, "/metrics").await.text;
    println!(
        "{WEARERS} headsets with hands, {ROBOTS} robots, {reaches} reaches into wrong slots in {} s",
        seconds()
    );
    metrics.lines().filter(|l| l.starts_with("giveway_hand")).for_each(|l| println!("{l}"));
    server.stop().await.unwrap();
    let warned = metrics.lines().find_map(|l| l.strip_prefix("giveway_hand_to_warning_seconds_count "));
    let warned: u64 = warned.and_then(|n| n.parse().ok()).expect("warnings are counted");
    assert!(warned * 10 >= reaches * 9, "{warned} of {reaches} were warned of");
}

const DASHBOARDS: usize = 200;
const TURNS: u64 = 10;

/// Reads the live feed as a dashboard does and adds up what came; never makes the server wait.
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

/// Seconds that the control loop's thread has spent on a processor, whatever else ran. Linux only.
fn loop_cpu() -> f64 {
    let tasks = std::fs::read_dir("/proc/self/task").expect("Linux").flatten().map(|t| t.path());
    let is_fleet =
        |t: &std::path::PathBuf| std::fs::read_to_string(t.join("comm")).is_ok_and(|c| c.trim() == "fleet");
    let task = tasks.into_iter().find(is_fleet).expect("the control loop");
    let text = std::fs::read_to_string(task.join("schedstat")).expect("Linux counts it");
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).expect("nanoseconds") / 1e9
}

/// A while with so many dashboards: milliseconds of a step by the clock, and of the processor.
async fn a_turn(at: SocketAddr, dashboards: usize, each: Duration) -> (f64, f64) {
    let (bytes, patches) = (Arc::new(AtomicU64::new(0)), Arc::new(AtomicU64::new(0)));
    let readers: Vec<_> =
        (0..dashboards).map(|_| tokio::spawn(watch_floor(at, bytes.clone(), patches.clone()))).collect();
    tokio::time::sleep(Duration::from_secs(2)).await;
    let ((n0, s0), b0) = (steps(at).await, bytes.load(Ordering::Relaxed));
    let (p0, c0) = (patches.load(Ordering::Relaxed), loop_cpu());
    tokio::time::sleep(each).await;
    let cpu = loop_cpu() - c0;
    let ((n1, s1), b1) = (steps(at).await, bytes.load(Ordering::Relaxed));
    let per = |sum: u64| sum as f64 / each.as_secs_f64() / (dashboards.max(1)) as f64;
    let (clock_ms, cpu_ms) = (1000.0 * (s1 - s0) / (n1 - n0), 1000.0 * cpu / (n1 - n0));
    println!(
        "{dashboards:>3} dashboards: a step {clock_ms:.2} ms, {cpu_ms:.2} ms of processor, {} steps; each dashboard \
         {:.1} kB/s in {:.1} patches/s",
        n1 - n0,
        per(b1 - b0) / 1000.0,
        per(patches.load(Ordering::Relaxed) - p0)
    );
    readers.iter().for_each(tokio::task::JoinHandle::abort);
    tokio::time::sleep(Duration::from_secs(1)).await;
    (clock_ms, cpu_ms)
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "a measurement"]
async fn two_hundred_dashboards_beside_800_robots() {
    let (scenario, map) = shipped("kiva-800");
    let folder = Folder::new();
    let floor = ServedFloor::new(scenario, Arc::new(map));
    let server = Server::start(&config(&folder), floor).await.unwrap();
    let at = server.address();
    tokio::time::sleep(Duration::from_secs(30)).await;
    let each = Duration::from_secs((seconds() / (2 * TURNS)).max(5));
    let (mut clock, mut processor) = (Vec::new(), Vec::new());
    // In turn, since steps do not cost the same all the time; and each first as often as second.
    for turn in 0..TURNS {
        let order = if turn % 2 == 0 { [0, DASHBOARDS] } else { [DASHBOARDS, 0] };
        let mut took = [(0.0, 0.0); 2];
        for dashboards in order {
            took[usize::from(dashboards > 0)] = a_turn(at, dashboards, each).await;
        }
        let [(c0, p0), (c1, p1)] = took;
        println!("    with dashboards {:.2} times by the clock, {:.2} times of processor", c1 / c0, p1 / p0);
        clock.push(c1 / c0);
        processor.push(p1 / p0);
    }
    for (what, mut ratios) in [("the clock", clock), ("the processor", processor)] {
        ratios.sort_by(f64::total_cmp);
        let at = |share: f64| ratios[((ratios.len() - 1) as f64 * share).round() as usize];
        println!("by {what}: median {:.2}, from {:.2} to {:.2}", at(0.5), at(0.0), at(1.0));
    }
    server.stop().await.unwrap();
}
