//! Robots that join over HTTP, go to maintenance and come back.

use crate::helper::{Answer, Folder, eventually, get, map, send, start};
use giveway::fleet::{Fact, Ledger, RobotFact, RobotKind, fitted};
use giveway::id::{BodyId, RobotId};
use giveway::store::{StepEntry, Store};
use giveway::time::Time;
use giveway::warehouse::{Footprint, NodeKind};
use serde_json::{Value, json};
use sqlx::Connection;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use std::net::SocketAddr;
use std::sync::Arc;

const JSON: [(&str, &str); 1] = [("content-type", "application/json")];

async fn register(at: SocketAddr, robot: &Value) -> Answer {
    send(at, "POST", "/v1/robots", &JSON, &robot.to_string()).await.unwrap()
}

async fn robot(at: SocketAddr, id: &str) -> Option<Value> {
    let all = get(at, "/v1/robots").await.json();
    all["items"].as_array().unwrap().iter().find(|r| r["id"] == id).cloned()
}

/// Waits until a robot is so.
async fn until(at: SocketAddr, id: &str, what: &str, so: impl Fn(&Value) -> bool) {
    let is_so = async || robot(at, id).await.filter(&so);
    eventually(&format!("{id} is {what}"), is_so).await;
}

/// Waits until the server counts so many robots. On a busy machine an alarm about late steps may stand first.
async fn until_counted(at: SocketAddr, robots: u64) {
    let counts = async || {
        let health = get(at, "/v1/health").await;
        (health.status == 200 && health.json()["robots"] == robots).then_some(())
    };
    eventually(&format!("it counts {robots} robots"), counts).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_robot_joins_over_http_once_and_is_still_there_after_a_restart() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    until(at, "robot-1", "there", |_| true).await;
    let held: Vec<String> = get(at, "/v1/robots").await.json()["items"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|r| [&r["granted"], &r["held"]].map(|n| n.as_array().unwrap().clone()).concat())
        .map(|n| n.as_str().unwrap().to_owned())
        .collect();
    let map = map();
    let free = |n: &&giveway::warehouse::Node| n.kind == NodeKind::Storage && !held.contains(&n.name);
    let node = map.nodes.iter().rev().find(free).expect("no robot holds some storage node");
    let new = json!({"name": "late-1", "node": node.name});
    let joined = register(at, &new).await;
    assert_eq!((joined.status, joined.json()["id"].as_str()), (201, Some("late-1")), "{}", joined.text);
    assert_eq!(register(at, &new).await.status, 200, "the same name is the same robot");
    until(at, "late-1", "seen on the floor", |r| r["kind"] == "robot").await;

    let taken = held[0].clone();
    let problem = register(at, &json!({"name": "x", "node": taken})).await.problem(409);
    assert!(problem["detail"].as_str().unwrap().contains("choose another node"), "{problem}");
    for (wrong, field) in [
        (json!({"name": "a b", "node": node.name}), "name"),
        (json!({"name": "x", "node": "nowhere"}), "node"),
        (json!({"name": "x", "node": node.name, "kind": "forklift"}), "kind"),
    ] {
        let problem = register(at, &wrong).await.problem(422);
        assert_eq!(problem["errors"][0]["field"], field, "{problem}");
    }
    server.stop().await.unwrap();
    let server = start(&folder).await;
    until(server.address(), "late-1", "back", |_| true).await;
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_robot_goes_to_maintenance_over_http_and_comes_back() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let path = "/v1/robots/robot-1/maintenance";
    until(at, "robot-1", "there", |_| true).await;
    assert_eq!(send(at, "PUT", path, &[], "").await.unwrap().status, 204);
    until(at, "robot-1", "in maintenance", |r| {
        r["why"]["code"] == "in_maintenance" && r["maintenance"] == true
    })
    .await;
    server.stop().await.unwrap();
    let server = start(&folder).await;
    let at = server.address();
    until(at, "robot-1", "in maintenance still", |r| r["maintenance"] == true).await;
    assert_eq!(send(at, "DELETE", path, &[], "").await.unwrap().status, 204);
    until(at, "robot-1", "at work again", |r| {
        r["maintenance"] == false && r["why"]["code"] != "in_maintenance"
    })
    .await;
    send(at, "PUT", "/v1/robots/robot-99/maintenance", &[], "").await.unwrap().problem(404);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_robot_leaves_over_http_and_comes_back_under_its_name() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    until(at, "robot-1", "there", |_| true).await;
    until(at, "robot-2", "there", |_| true).await;
    assert_eq!(send(at, "DELETE", "/v1/robots/robot-1", &[], "").await.unwrap().status, 204);
    until(at, "robot-1", "leaving", |r| r["leaving"] == true).await;
    let is_gone = async || robot(at, "robot-1").await.is_none().then_some(());
    eventually("robot-1 is gone from the list", is_gone).await;
    until_counted(at, 1).await;
    let again = send(at, "DELETE", "/v1/robots/robot-1", &[], "").await.unwrap().problem(409);
    assert!(again["detail"].as_str().unwrap().contains("POST /v1/robots"), "{again}");
    let park = json!({"kind": "park", "robot": "robot-1"}).to_string();
    send(at, "POST", "/v1/jobs", &JSON, &park).await.unwrap().problem(409);
    server.stop().await.unwrap();
    let server = start(&folder).await;
    let at = server.address();
    until(at, "robot-2", "there", |_| true).await;
    assert_eq!(robot(at, "robot-1").await, None, "a restart does not bring it back");
    let racks = get(at, "/v1/racks").await.json();
    let taken = racks["items"].as_array().unwrap().iter().filter_map(|r| r["node"].as_str());
    let taken: Vec<&str> = taken.collect();
    let map = map();
    let is_free = |n: &str| !taken.contains(&n);
    let free: Vec<&str> = (map.nodes.iter())
        .filter(|n| n.kind == NodeKind::Parking || n.kind == NodeKind::Storage && is_free(&n.name))
        .map(|n| n.name.as_str())
        .collect();
    let mut statuses = Vec::new();
    for node in free {
        let joined = register(at, &json!({"name": "robot-1", "node": node})).await;
        statuses.push(joined.status);
        if joined.status == 201 {
            break;
        }
    }
    assert_eq!(statuses.last(), Some(&201), "some place was free: {statuses:?}");
    until(at, "robot-1", "back", |r| r["leaving"] == false && r["why"]["code"] != "has_left").await;
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn kinds_of_robots_are_listed_with_what_they_take_and_carry() {
    let folder = Folder::new();
    let mut mixed = crate::helper::floor();
    let text = include_str!("../../scenarios/mixed.json");
    mixed.source.scenario = giveway::sim::Scenario::parse(text).unwrap();
    mixed.source.scenario.robots = 4;
    mixed.map = std::sync::Arc::new(giveway::warehouse::mixed());
    mixed.map = mixed.source.scenario.site.fit(&mixed.map).unwrap();
    let server = giveway::server::Server::start(&crate::helper::config(&folder), mixed).await.unwrap();
    let at = server.address();
    let kinds = get(at, "/v1/kinds").await.json();
    assert_eq!(kinds[0]["name"], "shuttle", "{kinds}");
    assert_eq!(kinds[0]["footprint"]["circle_m"], 0.22);
    assert_eq!((&kinds[0]["carries"][0], &kinds[0]["payload_kg"]), (&json!("bin"), &json!(60.0)));
    assert_eq!(kinds[1]["footprint"]["polygon_m"].as_array().map(Vec::len), Some(4));
    until(at, "robot-1", "a shuttle", |r| r["kind"] == "shuttle").await;
    until(at, "robot-3", "a mover", |r| r["kind"] == "mover").await;
    server.stop().await.unwrap();
}

async fn put_kind(at: SocketAddr, name: &str, figures: &Value) -> Answer {
    send(at, "PUT", &format!("/v1/kinds/{name}"), &JSON, &figures.to_string()).await.unwrap()
}

/// The kinds, each with whether it was added.
async fn kinds(at: SocketAddr) -> Vec<(String, bool)> {
    let all = get(at, "/v1/kinds").await.json();
    let pair = |k: &Value| (k["name"].as_str().unwrap().to_owned(), k["added"].as_bool().unwrap());
    all.as_array().unwrap().iter().map(pair).collect()
}

/// Waits until these are the kinds that are shown.
async fn until_kinds(at: SocketAddr, wanted: &[(&str, bool)]) {
    let wanted: Vec<_> = wanted.iter().map(|(name, added)| ((*name).to_owned(), *added)).collect();
    let are_shown = async || (kinds(at).await == wanted).then_some(());
    eventually(&format!("the kinds are {wanted:?}"), are_shown).await;
}

fn late(kind: &str) -> Value {
    let place = map().nodes.iter().rfind(|n| n.kind == NodeKind::Storage).unwrap().name.clone();
    json!({"name": "late-1", "node": place, "kind": kind})
}

#[tokio::test(flavor = "multi_thread")]
async fn a_kind_is_added_over_http_a_robot_of_it_joins_at_once_and_both_outlive_restarts() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    until(at, "robot-1", "there", |_| true).await;
    let early = register(at, &late("shuttle")).await.problem(422);
    assert_eq!(early["errors"][0]["field"], "kind", "{early}");
    let disc = json!({"speed_mps": 1.8, "lift_s": 1.5, "footprint": {"circle_m": 0.2},
        "footprint_loaded": {"circle_m": 0.3}, "battery": {"driving_h": 4.0}});
    let added = put_kind(at, "shuttle", &disc).await;
    assert_eq!((added.status, added.json()["added"].as_bool()), (201, Some(true)), "{}", added.text);
    assert_eq!(added.json()["footprint"], json!({"circle_m": 0.2}));
    let joined = register(at, &late("shuttle")).await;
    assert_eq!(joined.status, 201, "{}", joined.text);
    until(at, "late-1", "seen on the floor", |r| r["kind"] == "shuttle").await;
    assert_eq!(put_kind(at, "shuttle", &disc).await.status, 200, "the same again");
    put_kind(at, "shuttle", &json!({})).await.problem(409);
    let used = send(at, "DELETE", "/v1/kinds/shuttle", &[], "").await.unwrap().problem(409);
    assert!(used["detail"].as_str().unwrap().contains("1 robots are of kind"), "{used}");
    until_kinds(at, &[("robot", false), ("shuttle", true)]).await;
    server.stop().await.unwrap();

    for _ in 0..2 {
        let server = start(&folder).await;
        let at = server.address();
        assert_eq!(kinds(at).await, [("robot".to_owned(), false), ("shuttle".to_owned(), true)]);
        until(at, "late-1", "back", |r| r["kind"] == "shuttle").await;
        send(at, "DELETE", "/v1/kinds/shuttle", &[], "").await.unwrap().problem(409);
        server.stop().await.unwrap();
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn kinds_that_cannot_be_are_refused_by_what_is_wrong_with_them() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    for (figures, field) in [
        (json!({"speed_mps": 9}), "speed_mps"),
        (json!({"battery": {"low": 2}}), "battery.low"),
        (json!({"footprint": {"circle_m": 3.0}}), "footprint"),
    ] {
        let problem = put_kind(at, "wrong", &figures).await.problem(422);
        assert_eq!(problem["errors"][0]["field"], field, "{problem}");
    }
    assert!([400, 422].contains(&put_kind(at, "wrong", &json!({"sped_mps": 1})).await.status));
    put_kind(at, "a%20b", &json!({})).await.problem(422);
    put_kind(at, "robot", &json!({})).await.problem(409);
    send(at, "DELETE", "/v1/kinds/robot", &[], "").await.unwrap().problem(409);
    send(at, "DELETE", "/v1/kinds/none", &[], "").await.unwrap().problem(404);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn no_robot_joins_of_a_kind_that_was_removed_until_it_is_added_again() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    assert_eq!(put_kind(at, "old", &json!({"speed_mps": 1.0})).await.status, 201);
    assert_eq!(put_kind(at, "old", &json!({"speed_mps": 0.5})).await.status, 200, "a slower one");
    assert_eq!(send(at, "DELETE", "/v1/kinds/old", &[], "").await.unwrap().status, 204);
    let problem = register(at, &late("old")).await.problem(422);
    assert_eq!(problem["errors"][0]["field"], "kind", "{problem}");
    until_kinds(at, &[("robot", false)]).await;
    server.stop().await.unwrap();
    let server = start(&folder).await;
    let at = server.address();
    assert_eq!(kinds(at).await, [("robot".to_owned(), false)]);
    assert_eq!(put_kind(at, "old", &json!({"speed_mps": 1.0})).await.status, 201, "it comes back");
    assert_eq!(register(at, &late("old")).await.status, 201);
    server.stop().await.unwrap();
}

/// A database as a Giveway before 0.4 left it, with kinds in a table of their own, some of which it had in force.
#[tokio::test(flavor = "multi_thread")]
async fn kinds_that_an_earlier_version_kept_in_a_table_become_facts_once() {
    let folder = Folder::new();
    let server = start(&folder).await;
    until(server.address(), "robot-1", "there", |_| true).await;
    server.stop().await.unwrap();
    let options = SqliteConnectOptions::new().filename(crate::helper::config(&folder).database);
    let mut db = SqliteConnection::connect_with(&options).await.unwrap();
    let rows = [
        ("shuttle", r#"{"footprint": {"circle_m": 0.2}, "footprint_loaded": {"circle_m": 0.3}}"#),
        ("robot", "{}"),
        ("wide", r#"{"footprint_loaded": {"circle_m": 3.0}}"#),
        ("fast", r#"{"speed_mps": 99}"#),
    ];
    for (name, figures) in rows {
        let put = "INSERT INTO kinds (name, figures) VALUES ($1, $2)";
        sqlx::query(put).bind(name).bind(figures).execute(&mut db).await.unwrap();
    }
    db.close().await.unwrap();
    for _ in 0..2 {
        let server = start(&folder).await;
        let at = server.address();
        assert_eq!(kinds(at).await, [("robot".to_owned(), false), ("shuttle".to_owned(), true)]);
        until(at, "robot-1", "there", |_| true).await;
        server.stop().await.unwrap();
        let mut db = SqliteConnection::connect_with(&options).await.unwrap();
        let left: i64 = sqlx::query_scalar("SELECT count(*) FROM kinds").fetch_one(&mut db).await.unwrap();
        assert_eq!(left, 0, "the table is empty");
        db.close().await.unwrap();
    }
    let server = start(&folder).await;
    let joined = register(server.address(), &late("shuttle")).await;
    assert_eq!(joined.status, 201, "{}", joined.text);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn robots_of_a_kind_that_was_in_the_old_table_stay_what_they_are() {
    let (folder, site, base) = (Folder::new(), [RobotKind::default()], Arc::new(map()));
    let path = crate::helper::config(&folder).database;
    let disc = |radius_m| Some(Footprint::Circle { radius_m });
    let footprints = [disc(0.2), disc(0.3)];
    let shuttle = RobotKind { name: "shuttle".into(), footprints, ..RobotKind::default() };
    let both = fitted(&base, &[site[0].clone(), shuttle.clone()]).unwrap();
    let store = Store::open(&path, &both).await.unwrap();
    let (robot, at) = (RobotId(0), Time(5));
    let node = both.nodes_where(|kind| kind == NodeKind::Storage)[0];
    let (name, kind) = ("old-1".into(), "shuttle".into());
    let joins = Fact::Robot(RobotFact::Registered { robot, name, kind, node, at });
    store.append(1, &[StepEntry { at, facts: vec![joins], causes: vec![] }]).await.unwrap();
    store.close().await;
    let options = SqliteConnectOptions::new().filename(&path);
    let mut db = SqliteConnection::connect_with(&options).await.unwrap();
    let row = r#"{"footprint": {"circle_m": 0.2}, "footprint_loaded": {"circle_m": 0.3}}"#;
    let put = "INSERT INTO kinds (name, figures) VALUES ('shuttle', $1)";
    sqlx::query(put).bind(row).execute(&mut db).await.unwrap();
    db.close().await.unwrap();
    for _ in 0..2 {
        let store = Store::open(&path, &base).await.unwrap();
        let loaded = store.load(Ledger::new(base.clone(), &site, false)).await.unwrap();
        assert_eq!(loaded.next, 3, "one step more, once");
        let (ledger, _) = loaded.into_parts();
        assert_eq!((ledger.kinds().added(), ledger.unknown_kinds()), (&[shuttle.clone()][..], vec![]));
        assert_eq!((ledger.timeline().body(robot), ledger.node_of(robot)), (BodyId(1), node));
        store.close().await;
    }
    let mut backup = path.into_os_string();
    backup.push(".before-kinds");
    assert!(std::path::Path::new(&backup).is_file(), "as it was before");
}
