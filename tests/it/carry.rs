//! A map changed under a database: what can be carried over is, the rest is refused in words, and nothing is lost.

use crate::helper::{Folder, SCENARIO, all_jobs, config, eventually, get, map, post};
use crate::journal::{commits, log_of};
use crate::run::{Keeper, Run, nothing};
use giveway::fleet::{Input, JobAction, JobKind, JobQuery, JobRequest, JobState, Ledger};
use giveway::id::{JobId, NodeId, RackId, RobotId};
use giveway::server::{ServedFloor, Server};
use giveway::sim::Scenario;
use giveway::store::{CarryOver, Opening, Store, StoreError};
use giveway::time::Time;
use giveway::warehouse::{Draft, DraftLane, DraftNode, Users, Warehouse, formats::json};
use serde_json::{Value, json};
use sqlx::Connection;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Arc;
use std::time::{Duration, Instant};

const BUSY: &str = include_str!("busy.json");

/// How long robots may take for all jobs.
const PATIENCE: Duration = Duration::from_secs(300);

/// The map of the tests, changed by hand.
pub fn changed(change: impl FnOnce(&mut Draft)) -> Warehouse {
    change_of(&map(), change)
}

fn change_of(map: &Warehouse, change: impl FnOnce(&mut Draft)) -> Warehouse {
    let mut draft = json::parse_draft(&json::write(map)).unwrap();
    change(&mut draft);
    draft.build().unwrap()
}

/// One node is 15 cm from where it was.
pub fn moved() -> Warehouse {
    changed(|draft| draft.nodes.iter_mut().find(|n| n.name == "R118").unwrap().at.y += 0.15)
}

/// A parking place more, before all other nodes: every id is another one.
pub fn grown() -> Warehouse {
    changed(|draft| {
        let at = draft.nodes.iter().find(|n| n.name == "R32").unwrap().at;
        let at = at + giveway::geometry::Vector::new(1.2, 0.0);
        draft.nodes.insert(0, DraftNode { name: "new".into(), at });
        draft.lanes.insert(0, DraftLane::both_ways("R32", "new", Users::ALL));
        draft.parking.insert(0, "new".into());
        draft.racks.reverse();
    })
}

pub fn without_rack(name: &str) -> Warehouse {
    changed(|draft| draft.racks.retain(|rack| rack.name != name))
}

/// Robots that are discs, and take more of the floor with a rack on them.
fn discs(map: Warehouse) -> Warehouse {
    let mut scenario: Value = serde_json::from_str(&std::fs::read_to_string(SCENARIO).unwrap()).unwrap();
    scenario["fleet"]["footprint"] = json!({"circle_m": 0.2});
    scenario["fleet"]["footprint_loaded"] = json!({"circle_m": 0.3});
    let scenario = Scenario::parse(&scenario.to_string()).unwrap();
    let fitted = scenario.site.fit(&Arc::new(map)).unwrap();
    Arc::unwrap_or_clone(fitted)
}

pub async fn start(folder: &Folder, map: Warehouse) -> anyhow::Result<Server> {
    let scenario = Scenario::parse(&std::fs::read_to_string(SCENARIO).unwrap()).unwrap();
    Server::start(&config(folder), ServedFloor::new(scenario, Arc::new(map))).await
}

fn opening(accept_losses: bool) -> Opening {
    let kinds = Scenario::parse(BUSY).unwrap().site.kinds;
    let carry = CarryOver { kinds, accept_losses, stamp: "2031-01-31".into() };
    Opening { carry: Some(carry), ..Opening::default() }
}

async fn open(folder: &Folder, map: &Warehouse, accept_losses: bool) -> Result<Store, StoreError> {
    Store::open_as(&folder.database(), map, &opening(accept_losses)).await
}

/// Files beside the database whose names say this.
fn beside(folder: &Folder, text: &str) -> Vec<PathBuf> {
    let all = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path());
    all.filter(|path| path.to_string_lossy().contains(text)).collect()
}

pub fn backups(folder: &Folder) -> Vec<PathBuf> {
    let mut all = beside(folder, "giveway.sqlite.before-map-change-");
    all.retain(|path| !["-wal", "-shm"].iter().any(|side| path.to_string_lossy().ends_with(side)));
    all.sort();
    all
}

/// Runs `giveway database` with a map. Its exit code, and what it printed.
pub fn database(file: &Path, map: &Warehouse, arguments: &[&str]) -> (Option<i32>, Value, String) {
    let text = file.with_extension("map.json");
    std::fs::write(&text, json::write(map)).unwrap();
    let Output { status, stdout, stderr } = Command::new(env!("CARGO_BIN_EXE_giveway"))
        .args(["database", "--json", "--scenario", SCENARIO, "--database"])
        .arg(file)
        .args(arguments)
        .arg("--map")
        .arg(text)
        .output()
        .unwrap();
    let json = serde_json::from_slice(&stdout).unwrap_or(Value::Null);
    (status.code(), json, String::from_utf8_lossy(&stderr).into_owned())
}

/// Jobs of every kind, each with a key.
pub fn orders() -> Vec<(String, Value)> {
    let jobs = [
        json!({"kind": "deliver", "rack": "K1", "station": "P", "pick_s": 0.2}),
        json!({"kind": "deliver", "rack": "K2", "station": "P", "pick_s": 0.2, "priority": 7}),
        json!({"kind": "return", "rack": "K4"}),
        json!({"kind": "go", "robot": "robot-1", "node": "R33"}),
        json!({"kind": "park", "robot": "robot-2"}),
        json!({"kind": "charge", "robot": "robot-1"}),
        json!({"kind": "deliver", "rack": "K12", "station": "P", "pick_s": 0.2, "after": ["j2"]}),
        json!({"kind": "deliver", "rack": "K1", "station": "P", "pick_s": 0.2, "after": ["j1"]}),
    ];
    (1..).map(|i| format!("order {i}")).zip(jobs).collect()
}

pub async fn until_robots_join(at: SocketAddr) {
    let have_joined = async || {
        let robots = get(at, "/v1/robots").await.json();
        (robots["items"].as_array().map(Vec::len) == Some(2)).then_some(())
    };
    eventually("the robots join", have_joined).await;
}

/// Hands all of them in, once the robots are known.
pub async fn submit(at: SocketAddr) {
    until_robots_join(at).await;
    for (i, (key, job)) in (1..).zip(orders()) {
        let answer = post(at, Some(&key), &job).await.unwrap();
        assert_eq!((answer.status, &answer.json()["id"]), (201, &json!(format!("j{i}"))), "{answer:?}");
    }
}

/// Waits until the jobs are so.
pub async fn until(at: SocketAddr, what: &str, so: impl Fn(&[Value]) -> bool) -> Vec<Value> {
    let end = Instant::now() + PATIENCE;
    loop {
        let jobs = all_jobs(at, 500).await;
        if so(&jobs) {
            return jobs;
        }
        assert!(Instant::now() < end, "{what}: {jobs:#?}");
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
}

pub fn is_over(job: &Value) -> bool {
    ["done", "cancelled", "failed"].contains(&job["state"].as_str().unwrap())
}

/// What a job asks for, by names.
pub fn wish(job: &Value) -> Value {
    json!([job["id"], job["kind"], job["rack"], job["station"], job["node"], job["after"], job["created"]])
}

/// A server under the map of the tests that is stopped in the middle of things. Its jobs.
async fn in_the_middle(folder: &Folder) -> Vec<Value> {
    let server = start(folder, map()).await.unwrap();
    let at = server.address();
    submit(at).await;
    let jobs = until(at, "a robot carries a rack", |jobs| {
        jobs.iter().any(|j| j["state"] == "carrying" && j["kind"] == "deliver")
    })
    .await;
    server.stop().await.unwrap();
    jobs
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_goes_on_with_a_map_on_which_a_node_was_moved_and_every_job_ends() {
    goes_on_with(moved(), true).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_goes_on_with_a_map_on_which_every_id_is_another_one_and_every_job_ends() {
    goes_on_with(grown(), false).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_goes_on_with_robots_of_other_footprints_and_every_job_ends() {
    goes_on_with(discs(map()), true).await;
}

async fn goes_on_with(map: Warehouse, keeps_ids: bool) {
    let folder = Folder::new();
    let before = in_the_middle(&folder).await;
    let server = start(&folder, map.clone()).await.unwrap();
    let at = server.address();
    assert!(server.store().carried().is_some_and(|c| c.report.is_clean()));
    assert_eq!(backups(&folder).len(), 1, "there is a backup");
    assert_eq!(
        beside(&folder, "giveway.past.before").is_empty(),
        keeps_ids,
        "pictures of other ids are kept apart"
    );
    for (i, (key, job)) in (1..).zip(orders()) {
        let answer = post(at, Some(&key), &job).await.unwrap();
        assert_eq!((answer.status, &answer.json()["id"]), (200, &json!(format!("j{i}"))), "{answer:?}");
    }
    let after = until(at, "every job ends", |jobs| jobs.iter().all(is_over)).await;
    assert!(after.iter().all(|j| j["state"] == "done"), "{after:#?}");
    let wishes = |jobs: &[Value]| jobs.iter().map(wish).collect::<Vec<_>>();
    assert_eq!(wishes(&before), wishes(&after), "the lists name the same things");
    server.stop().await.unwrap();
    let server = start(&folder, map).await.unwrap();
    assert!(server.store().carried().is_none(), "it belongs to the new map now");
    assert_eq!(get(server.address(), "/v1/jobs/j1").await.json()["state"], "done");
    assert_eq!(backups(&folder).len(), 1);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_rack_with_a_job_is_given_up_only_where_that_is_accepted_and_nothing_else_is_lost() {
    let folder = Folder::new();
    in_the_middle(&folder).await;
    let new = without_rack("K12");
    let error = start(&folder, new.clone()).await.err().expect("it is refused").to_string();
    assert!(error.contains("loss: job j7 (deliver) asks for rack K12, which is gone"), "{error}");
    assert!(error.contains("loss: rack K12, which stands on S12, is gone from the map"), "{error}");
    assert!(error.contains("Nothing was changed") && error.contains("--accept-losses"), "{error}");
    assert_eq!(backups(&folder), Vec::<PathBuf>::new());
    let server = start(&folder, map()).await.expect("the old map still starts");
    assert_eq!(get(server.address(), "/v1/jobs/j7").await.json()["rack"], "K12");
    server.stop().await.unwrap();

    let before = std::fs::read(folder.database()).unwrap();
    let (code, found, said) = database(&folder.database(), &new, &["check"]);
    assert_eq!(code, Some(1), "{said}");
    assert_eq!(found["changed_map"]["losses"].as_array().map(Vec::len), Some(2), "{found:#}");
    let refused = database(&folder.database(), &new, &["carry"]);
    assert_eq!(refused.0, Some(1), "{refused:?}");
    assert_eq!(refused.1["changed_map"]["losses"].as_array().map(Vec::len), Some(2), "{refused:?}");
    assert!(std::fs::read(folder.database()).unwrap() == before, "nothing was changed");
    let (code, found, said) = database(&folder.database(), &new, &["carry", "--accept-losses"]);
    assert_eq!((code, &found["ok"]), (Some(0), &json!(true)), "{found:#} {said}");
    assert_eq!(backups(&folder).len(), 1);

    let server = start(&folder, new).await.unwrap();
    let at = server.address();
    let jobs = until(at, "every job ends", |jobs| jobs.iter().all(is_over)).await;
    let (failed, done): (Vec<&Value>, Vec<&Value>) = jobs.iter().partition(|j| j["id"] == "j7");
    assert_eq!((&failed[0]["state"], &failed[0]["rack"]), (&json!("failed"), &json!("K12")), "{failed:#?}");
    assert!(failed[0]["why"]["text"].as_str().unwrap().contains("the map was changed"), "{failed:#?}");
    assert!(done.iter().all(|j| j["state"] == "done"), "{done:#?}");
    server.stop().await.unwrap();

    // What has come back is no longer gone.
    let server = start(&folder, map()).await.unwrap();
    let at = server.address();
    assert_eq!(get(at, "/v1/jobs/j7").await.json()["rack"], "K12");
    let racks = get(at, "/v1/racks").await.text;
    assert!(racks.contains("K12"), "{racks}");
    server.stop().await.unwrap();
    let backup = &backups(&folder)[0];
    let (code, found, said) = database(backup, &map(), &["check"]);
    assert!(code == Some(0) && found["robots"] == 2, "the backup is whole: {found:#} {said}");
}

/// Lets a floor work under a map, and closes its database. Its ledger.
async fn work(folder: &Folder, map: &Arc<Warehouse>, steps: usize, every: usize) -> Ledger {
    let scenario = Scenario::parse(BUSY).unwrap();
    let store = Store::open(&folder.database(), map).await.unwrap();
    let mut run = Run::restart(map, &scenario, &store).await;
    let mut keeper = Keeper::new(store, nothing(map, &scenario));
    for step in 0..steps {
        let relocate = JobKind::Go { robot: RobotId(0), node: NodeId(5) };
        let kind = if step == 900 { relocate } else { JobKind::Return { rack: RackId(3) } };
        let request = JobRequest { priority: 1, ..JobRequest::new(kind) };
        let wanted = [500, 900].contains(&step);
        let (entry, _) =
            run.step(wanted.then_some(Input::ask(1, JobAction::Submit(request))).into_iter().collect());
        if !entry.facts.is_empty() {
            keeper.append(std::slice::from_ref(&entry)).await;
            if keeper.next % every as i64 == 0 {
                keeper.snapshot(entry.at).await;
            }
        }
    }
    keeper.store.close().await;
    run.fleet.ledger().clone()
}

async fn loaded(store: &Store, map: &Arc<Warehouse>) -> (Ledger, i64, Option<Time>) {
    let loaded = store.load(nothing(map, &Scenario::parse(BUSY).unwrap())).await.unwrap();
    let (next, last) = (loaded.next, loaded.last);
    let (mut ledger, facts) = loaded.into_parts();
    facts.into_iter().for_each(|fact| ledger.evolve(&fact));
    (ledger, next, last)
}

#[tokio::test]
async fn a_kill_at_any_instant_leaves_the_old_database_or_the_new_one() {
    let (folder, old, new) = (Folder::new(), Arc::new(map()), Arc::new(grown()));
    let ledger = work(&folder, &old, 1500, 100).await;
    let main = std::fs::read(folder.database()).unwrap();
    // Another connection reads, so that nothing is moved from the log into the main file.
    let options = SqliteConnectOptions::new().filename(folder.database());
    let mut reader = SqliteConnection::connect_with(&options).await.unwrap();
    sqlx::query("BEGIN").execute(&mut reader).await.unwrap();
    sqlx::query("SELECT count(*) FROM steps").execute(&mut reader).await.unwrap();
    let store = open(&folder, &new, false).await.unwrap();
    assert!(store.carried().is_some());
    let (whole, next, last) = loaded(&store, &new).await;
    let log = std::fs::read(log_of(&folder.database())).unwrap();
    assert!(std::fs::read(folder.database()).unwrap() == main, "all of it is in the log");
    let frame = 24 + u32::from_be_bytes(log[8..12].try_into().unwrap()) as usize;
    let (mut kept, mut carried) = (0, 0);
    for end in (32..=log.len()).step_by(frame).chain(commits(&log)) {
        let cut = Folder::new();
        std::fs::write(cut.database(), &main).unwrap();
        std::fs::write(log_of(&cut.database()), &log[..end]).unwrap();
        match Store::open(&cut.database(), &old).await {
            Ok(store) => {
                assert_eq!(loaded(&store, &old).await, (ledger.clone(), next, last), "as it was, at {end}");
                kept += 1;
            }
            Err(StoreError::OtherMap { .. }) => {
                let store = Store::open(&cut.database(), &new).await.unwrap();
                assert_eq!(loaded(&store, &new).await, (whole.clone(), next, last), "all of it, at {end}");
                carried += 1;
            }
            Err(e) => panic!("{e} at {end}"),
        }
    }
    assert!(kept > 5 && carried > 0, "{kept} cuts before the commit, {carried} after it");
}

#[tokio::test]
async fn a_floor_goes_on_under_every_changed_map_and_its_lists_agree_with_its_ledger() {
    let folder = Folder::new();
    let scenario = Scenario::parse(BUSY).unwrap();
    work(&folder, &Arc::new(map()), 1300, 400).await;
    let turned = change_of(&grown(), |draft| {
        draft.nodes.reverse();
        draft.lanes.reverse();
    });
    for new in [moved(), grown(), turned] {
        let new = Arc::new(new);
        let store = open(&folder, &new, false).await.unwrap();
        let mut run = Run::restart(&new, &scenario, &store).await;
        let mut next = store.load(nothing(&new, &scenario)).await.unwrap().next;
        for (id, job) in &run.fleet.ledger().jobs {
            let listed = store.job(*id).await.unwrap().expect("it is in the list").job;
            assert_eq!((listed.state, &listed), (JobState::Waiting, job), "{id:?}");
        }
        let open: Vec<JobId> = run.fleet.ledger().jobs.keys().copied().collect();
        assert!(!open.is_empty(), "it was in the middle of things");
        let all = JobQuery { limit: 1000, ..JobQuery::default() };
        let rows = store.jobs(&all).await.unwrap().rows;
        assert!(rows.iter().all(|row| row.gone == giveway::fleet::GoneNames::default()));
        while open.iter().any(|job| run.fleet.ledger().jobs.contains_key(job)) {
            assert!(next < 60_000, "not done: {open:?}");
            let (entry, _) = run.step(vec![]);
            if !entry.facts.is_empty() {
                store.append(next, &[entry]).await.unwrap();
                next += 1;
            }
        }
        run.fleet.ledger().assert_sound();
        store.close().await;
    }
    assert_eq!(backups(&folder).len(), 3, "each has a name of its own");
}

#[tokio::test]
async fn a_database_of_a_build_that_did_not_keep_the_map_wants_its_old_map_once() {
    let folder = Folder::new();
    let fixture = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/fixtures/floor-2.db");
    std::fs::copy(fixture, folder.database()).unwrap();
    let error = open(&folder, &grown(), true).await.unwrap_err();
    assert!(matches!(error, StoreError::UnknownMap { .. }), "{error}");
    assert!(error.to_string().contains("open it once with the old map first"), "{error}");
    assert_eq!(backups(&folder), Vec::<PathBuf>::new());
    let (ledger, ..) = {
        let store = Store::open(&folder.database(), &map()).await.expect("it opens as before");
        let found = loaded(&store, &Arc::new(map())).await;
        store.close().await;
        found
    };
    let store = open(&folder, &grown(), false).await.expect("now the map is known");
    let (carried, ..) = loaded(&store, &Arc::new(grown())).await;
    assert_eq!(carried.jobs.keys().collect::<Vec<_>>(), ledger.jobs.keys().collect::<Vec<_>>());
    assert_eq!(carried.keys, ledger.keys);
    store.close().await;
}

/// The names of the racks that robots hold.
async fn racks_on_robots(folder: &Folder) -> Vec<String> {
    let scenario = Scenario::parse(BUSY).unwrap();
    let store = Store::open(&folder.database(), &map()).await.unwrap();
    let held = {
        let run = Run::restart(&Arc::new(map()), &scenario, &store).await;
        let racks = run.fleet.ledger().racks.pairs();
        let on = racks.filter(|(_, at)| matches!(at, giveway::fleet::RackAt::On(_)));
        on.map(|(rack, _)| map().racks[rack].name.clone()).collect()
    };
    store.close().await;
    held
}

#[tokio::test]
async fn names_that_are_gone_from_the_map_stay_in_the_lists_over_several_changes() {
    let folder = Folder::new();
    work(&folder, &Arc::new(map()), 1300, 400).await;
    let all = JobQuery { limit: 1000, ..JobQuery::default() };
    let named = |rows: Vec<giveway::fleet::JobRow>, map: &Warehouse| {
        let name = |row: &giveway::fleet::JobRow| {
            let rack = row.job.request.kind.rack()?;
            row.gone.rack.clone().or_else(|| map.racks.get(rack).map(|rack| rack.name.clone()))
        };
        rows.iter().map(|row| (row.id, name(row))).collect::<Vec<_>>()
    };
    let store = Store::open(&folder.database(), &map()).await.unwrap();
    let before = named(store.jobs(&all).await.unwrap().rows, &map());
    store.close().await;
    // No rack keeps its name, except those on robots, which cannot be given up.
    let held = racks_on_robots(&folder).await;
    let renamed = |suffix: &str| {
        changed(|draft| {
            let rename = |name: &mut String| *name += suffix;
            draft.racks.iter_mut().map(|r| &mut r.name).filter(|n| !held.contains(n)).for_each(rename);
            draft.racks.reverse();
        })
    };
    for suffix in ["-b", "-c", ""] {
        let new = renamed(suffix);
        let store = open(&folder, &new, true).await.unwrap();
        let rows = store.jobs(&all).await.unwrap().rows;
        let gone = rows.iter().filter(|row| row.gone.rack.is_some()).count();
        assert_eq!(gone == 0, suffix.is_empty(), "{gone} rows name what is gone");
        assert_eq!(named(rows, &new), before, "after {suffix:?}");
        store.close().await;
    }
}

/// How many names of what is gone the database has, and how many of racks its jobs speak of.
async fn gone_names(folder: &Folder) -> (i64, i64) {
    let options = SqliteConnectOptions::new().filename(folder.database());
    let mut db = SqliteConnection::connect_with(&options).await.unwrap();
    let noted = sqlx::query_scalar("SELECT count(*) FROM gone").fetch_one(&mut db).await.unwrap();
    let racks = "SELECT count(DISTINCT rack) FROM jobs WHERE rack >= 1 << 31";
    (noted, sqlx::query_scalar(racks).fetch_one(&mut db).await.unwrap())
}

#[tokio::test]
async fn names_that_no_row_has_any_more_go_with_the_next_change_of_the_map() {
    let folder = Folder::new();
    work(&folder, &Arc::new(map()), 1300, 400).await;
    let held = racks_on_robots(&folder).await;
    let renamed = |suffix: &str| {
        changed(|draft| {
            let names = draft.racks.iter_mut().map(|rack| &mut rack.name);
            names.filter(|name| !held.contains(name)).for_each(|name| *name += suffix);
        })
    };
    open(&folder, &renamed("-b"), true).await.unwrap().close().await;
    let (noted, named) = gone_names(&folder).await;
    assert!(named > 0 && noted == named, "{noted} names are noted, {named} are needed");
    let options = SqliteConnectOptions::new().filename(folder.database());
    let mut db = SqliteConnection::connect_with(&options).await.unwrap();
    sqlx::query("DELETE FROM jobs").execute(&mut db).await.unwrap();
    db.close().await.unwrap();
    open(&folder, &renamed("-c"), true).await.unwrap().close().await;
    assert_eq!(gone_names(&folder).await, (0, 0), "nothing speaks of them any more");
}
