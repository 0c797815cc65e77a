//! Figures of the journal for docs/robustness.md: facts and bytes of a day, the disk of a week, the time of a restart.

use crate::helper::Folder;
use crate::run::{Keeper, Run, nothing};
use giveway::fleet::Fleet;
use giveway::sim::Scenario;
use giveway::store::{SNAPSHOT_AFTER, Store, ledger_record, record};
use giveway::time::{Span, Time};
use giveway::warehouse::{Warehouse, formats};
use sqlx::Connection;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use std::sync::Arc;
use std::time::Instant;

/// What a run wrote.
#[derive(Default)]
struct Written {
    facts: usize,
    steps: usize,
    bytes: usize,
    snapshots: usize,
    /// The largest that the files were together.
    disk: u64,
    /// How long appends took, milliseconds.
    appends: Vec<f64>,
}

fn read(name: &str) -> (Arc<Warehouse>, Scenario) {
    let root = env!("CARGO_MANIFEST_DIR");
    let read = |path: String| std::fs::read_to_string(path).unwrap();
    let scenario = Scenario::parse(&read(format!("{root}/scenarios/{name}.json"))).unwrap();
    let map = read(format!("{root}/scenarios/{}", scenario.site.map));
    (Arc::new(formats::import(&map, &Default::default()).unwrap().0), scenario)
}

fn disk(folder: &Folder) -> u64 {
    let files = std::fs::read_dir(folder.path()).unwrap().flatten();
    files.map(|f| f.metadata().map_or(0, |m| m.len())).sum()
}

fn number(name: &str, otherwise: i64) -> i64 {
    std::env::var(name).map_or(otherwise, |text| text.parse().unwrap())
}

/// Runs a floor through a store, an append for each step as a server that keeps up; ends when `over` says so.
async fn write(
    folder: &Folder,
    (map, scenario): &(Arc<Warehouse>, Scenario),
    over: impl Fn(&Keeper, Time) -> bool,
) -> (Written, Time) {
    let store = Store::open(&folder.database(), map).await.unwrap();
    let mut run = Run::new(
        map,
        scenario,
        Fleet::new(map.clone(), scenario.site.settings()),
        Time(1_800_000_000_000_000),
    );
    let mut keeper = Keeper::new(store, nothing(map, scenario));
    let mut out = Written::default();
    while !over(&keeper, run.now) {
        let (entry, _) = run.step(vec![]);
        if entry.facts.is_empty() {
            continue;
        }
        out.facts += entry.facts.len();
        out.steps += 1;
        out.bytes += record::encode(&entry.facts).len();
        let began = Instant::now();
        out.snapshots += keeper.append(std::slice::from_ref(&entry)).await;
        out.appends.push(began.elapsed().as_secs_f64() * 1000.0);
        if out.steps % 100 == 0 {
            out.disk = out.disk.max(disk(folder));
        }
    }
    out.disk = out.disk.max(disk(folder));
    out.appends.sort_by(f64::total_cmp);
    keeper.store.close().await;
    (out, run.now)
}

/// Leaves nothing but the lists in the database, and gives the number of jobs.
async fn lists_only(folder: &Folder) -> i64 {
    let options = SqliteConnectOptions::new().filename(folder.database());
    let mut connection = SqliteConnection::connect_with(&options).await.unwrap();
    for statement in ["DELETE FROM steps", "DELETE FROM snapshots", "VACUUM"] {
        sqlx::query(statement).execute(&mut connection).await.unwrap();
    }
    let jobs = sqlx::query_scalar("SELECT count(*) FROM jobs").fetch_one(&mut connection).await.unwrap();
    connection.close().await.unwrap();
    jobs
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "a measurement"]
async fn what_100_robots_write() {
    let floor = read("kiva-100");
    let folder = Folder::new();
    let (began, seconds) = (Time(1_800_000_000_000_000), number("GIVEWAY_SECONDS", 3600));
    let (out, now) = write(&folder, &floor, |_, now| now - began >= Span::from_secs(seconds)).await;
    let days = (now - began).as_secs_f64() / 86_400.0;
    let mb = |bytes: f64| bytes / 1e6;
    let (facts, bytes) = (out.facts as f64 / days, out.bytes as f64 / days);
    let at = |q: f64| out.appends[((out.appends.len() - 1) as f64 * q) as usize];
    println!("{} robots, {seconds} s simulated, {} facts in {} steps", floor.1.robots, out.facts, out.steps);
    println!("a day, extrapolated: {:.1} million facts, {:.0} MB of text", facts / 1e6, mb(bytes));
    println!("{:.0} bytes a fact, {} snapshots", out.bytes as f64 / out.facts as f64, out.snapshots);
    println!(
        "files of the database: at most {:.1} MB, {:.1} MB in the end",
        mb(out.disk as f64),
        mb(disk(&folder) as f64)
    );
    let jobs = lists_only(&folder).await;
    let (lists, per_day) = (disk(&folder) as f64, jobs as f64 / days);
    let week = mb(lists / days * 7.0);
    println!(
        "lists alone: {:.2} MB for {jobs} jobs; {per_day:.0} jobs a day, {week:.0} MB a week",
        mb(lists)
    );
    println!("append with its fold, ms: p50 {:.2}, p99 {:.2}, max {:.2}", at(0.5), at(0.99), at(1.0));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "a measurement"]
async fn how_long_800_robots_take_to_restart() {
    let (map, scenario) = read("kiva-800");
    let folder = Folder::new();
    // As late as can be: two snapshots, and the next one is nearly due.
    let due = |k: &Keeper, _| k.next > 1 && k.behind + 2_000 >= SNAPSHOT_AFTER && k.made >= 2;
    let floor = (map, scenario);
    let (out, now) = write(&folder, &floor, due).await;
    let (map, scenario) = floor;
    let simulated = (now - Time(1_800_000_000_000_000)).as_secs_f64();
    let began = Instant::now();
    let store = Store::open(&folder.database(), &map).await.unwrap();
    let opened = began.elapsed();
    let loaded = store.load(nothing(&map, &scenario)).await.unwrap();
    let read = began.elapsed();
    let (behind, last) = (loaded.facts(), loaded.last.unwrap());
    let (ledger, facts) = loaded.into_parts();
    let fleet = Fleet::resume(ledger, scenario.site.settings(), facts);
    let folded = began.elapsed();
    let snapshot = ledger_record::encode(&fleet.ledger().to_parts()).len();
    let mut run = Run::new(&map, &scenario, fleet, last + scenario.site.period);
    let step = Instant::now();
    run.step(vec![]);
    println!(
        "{} robots, {simulated:.0} s simulated, {} facts, {} snapshots",
        scenario.robots, out.facts, out.snapshots
    );
    println!(
        "files of the database: {:.1} MB; a snapshot {:.1} MB",
        disk(&folder) as f64 / 1e6,
        snapshot as f64 / 1e6
    );
    println!(
        "restart, {behind} facts behind the snapshot: opened {:.2} s, read {:.2} s, folded {:.2} s, first step {:.2} s",
        opened.as_secs_f64(),
        read.as_secs_f64(),
        folded.as_secs_f64(),
        step.elapsed().as_secs_f64()
    );
}
