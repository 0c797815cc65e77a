//! A map is published to a running server: every job ends, what is refused changes nothing, two editors do not
//! overwrite one another, and a kill leaves the old map or the new one.

use crate::carry::{
    backups, changed, database, grown, is_over, moved, orders, start, submit, until, until_robots_join, wish,
    without_rack,
};
use crate::helper::{Answer, Folder, PATIENCE, eventually, get, map, post, send};
use crate::recovery::Program;
use crate::tokens::{ADMIN, make, start_closed, until_robots, with};
use futures_util::StreamExt;
use giveway::warehouse::{Warehouse, formats::json as file};
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::time::{Duration, Instant};
use tokio_tungstenite::tungstenite::Message;

const JSON: (&str, &str) = ("content-type", "application/json");

async fn check(at: SocketAddr, map: &Warehouse) -> Value {
    let answer = send(at, "POST", "/v1/map:check", &[JSON], &file::write(map)).await.unwrap();
    assert_eq!(answer.status, 200, "{answer:?}");
    answer.json()
}

/// The version of the map in operation, as soon as the server answers.
async fn version(at: SocketAddr) -> String {
    let answers = async || Some(get(at, "/v1/map").await).filter(|answer| answer.status == 200);
    let answer = eventually("the server answers", answers).await;
    let version = answer.json()["version"].as_str().unwrap().to_owned();
    assert_eq!(answer.header("etag"), Some(format!("\"{version}\"").as_str()));
    version
}

async fn publish(at: SocketAddr, map: &Warehouse, version: &str, query: &str) -> Answer {
    let based = format!("\"{version}\"");
    let headers = [JSON, ("if-match", based.as_str())];
    send(at, "PUT", &format!("/v1/map{query}"), &headers, &file::write(map)).await.unwrap()
}

/// What a check says is different: what, how, and the names.
fn changes(check: &Value) -> Vec<String> {
    let line = |c: &Value| {
        let names: Vec<&str> = c["names"].as_array().unwrap().iter().map(|n| n.as_str().unwrap()).collect();
        format!("{} {}: {}", c["what"].as_str().unwrap(), c["how"].as_str().unwrap(), names.join(" "))
    };
    check["changes"].as_array().unwrap().iter().map(line).collect()
}

async fn carrying(at: SocketAddr) -> Vec<Value> {
    let carries = |j: &Value| j["state"] == "carrying" && j["kind"] == "deliver";
    until(at, "a robot carries a rack", |jobs| jobs.iter().any(carries)).await
}

async fn all_end(at: SocketAddr) -> Vec<Value> {
    until(at, "every job ends", |jobs| !jobs.is_empty() && jobs.iter().all(is_over)).await
}

#[tokio::test(flavor = "multi_thread")]
async fn with_jobs_under_way_the_server_goes_over_to_the_map_and_every_job_ends() {
    let folder = Folder::new();
    let server = start(&folder, map()).await.unwrap();
    let at = server.address();
    let (mut feed, _) = tokio_tungstenite::connect_async(format!("ws://{at}/v1/live")).await.unwrap();
    submit(at).await;
    let before = carrying(at).await;
    let old = version(at).await;

    let told = check(at, &grown()).await;
    assert_eq!(
        (&told["version"], &told["good"], &told["published"]),
        (&json!(old), &json!(true), &Value::Null)
    );
    assert_eq!(changes(&told), ["parking places added: new", "nodes added: new", "lanes added: R32–new"]);
    assert_eq!((&told["obstacles"], &told["losses"]), (&json!([]), &json!([])), "{told}");
    assert_eq!(version(at).await, old, "a check changes nothing");

    let answer = publish(at, &grown(), &old, "").await;
    assert_eq!(answer.status, 200, "{answer:?}");
    let done = answer.json();
    let new = version(at).await;
    assert_eq!((&done["version"], &done["published"]["number"]), (&json!(new), &json!(1)), "{done}");
    assert_ne!(new, old);
    assert_eq!(
        get(at, "/v1/map:file").await.json(),
        serde_json::from_str::<Value>(&file::write(&grown())).unwrap()
    );
    assert_eq!(backups(&folder).len(), 1, "there is a backup");

    // Feeds end, and what comes next says of which map it speaks.
    let mut last = String::new();
    while let Some(Ok(message)) = feed.next().await {
        if let Message::Text(text) = message {
            last = text.to_string();
        }
    }
    assert!(!last.is_empty(), "the feed was open, and ended");
    let (mut feed, _) = tokio_tungstenite::connect_async(format!("ws://{at}/v1/live")).await.unwrap();
    let Some(Ok(Message::Text(first))) = feed.next().await else { panic!("a snapshot") };
    let snapshot: Value = serde_json::from_str(&first).unwrap();
    assert_eq!((&snapshot["type"], &snapshot["map"]), (&json!("snapshot"), &json!(new)));

    for (i, (key, job)) in (1..).zip(orders()) {
        let again = post(at, Some(&key), &job).await.unwrap();
        assert_eq!((again.status, &again.json()["id"]), (200, &json!(format!("j{i}"))), "{again:?}");
    }
    let after = all_end(at).await;
    assert!(after.iter().all(|j| j["state"] == "done"), "{after:#?}");
    let wishes = |jobs: &[Value]| jobs.iter().map(wish).collect::<Vec<_>>();
    assert_eq!(wishes(&before), wishes(&after), "the lists name the same things");
    let audit = get(at, "/v1/audit?limit=50").await.json();
    let entry = audit["items"].as_array().unwrap().iter().find(|e| e["what"] == "PUT /v1/map").unwrap();
    assert_eq!((&entry["actor"], &entry["status"]), (&json!("this machine"), &json!(200)), "{entry}");

    let again = publish(at, &grown(), &new, "").await.json();
    assert_eq!((&again["version"], &again["published"]), (&json!(new), &Value::Null), "nothing was done");
    let back = publish(at, &moved(), &new, "").await;
    assert_eq!((back.status, &back.json()["published"]["number"]), (200, &json!(2)), "{back:?}");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn the_next_start_takes_the_published_map_and_not_the_file_in_whose_place_it_came() {
    let folder = Folder::new();
    let server = start(&folder, map()).await.unwrap();
    let at = server.address();
    until_robots_join(at).await;
    let old = version(at).await;
    assert_eq!(publish(at, &grown(), &old, "").await.status, 200);
    let new = version(at).await;
    server.stop().await.unwrap();

    for map in [map(), grown()] {
        let server = start(&folder, map).await.expect("the same file, or the published map as a file");
        assert_eq!(version(server.address()).await, new);
        let published = server.summary().published.clone().expect("it says so");
        assert_eq!((published.number, published.by.as_str()), (1, "this machine"));
        server.stop().await.unwrap();
    }
    let error = start(&folder, moved()).await.err().expect("two maps claim the server").to_string();
    assert!(error.contains("two maps claim this server") && error.contains("database map"), "{error}");
    let (code, found, said) = database(&folder.database(), &moved(), &["carry"]);
    assert_eq!((code, &found["ok"]), (Some(0), &json!(true)), "{found:#} {said}");
    let server = start(&folder, moved()).await.expect("the file is chosen");
    assert!(server.summary().published.is_none());
    assert_eq!(get(server.address(), "/v1/map:file").await.text, file::write(&moved()));
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn what_cannot_be_carried_over_is_refused_with_reasons_and_leaves_everything_as_it_was() {
    let folder = Folder::new();
    let server = start(&folder, map()).await.unwrap();
    let at = server.address();
    submit(at).await;
    carrying(at).await;
    let old = version(at).await;

    // Rack K3 stands on S3.
    let gone = changed(|draft| {
        draft.nodes.retain(|n| n.name != "S3");
        draft.lanes.retain(|l| l.from != "S3" && l.to != "S3");
        draft.storage.retain(|n| n != "S3");
        draft.racks.iter_mut().find(|r| r.name == "K3").unwrap().node = "S12".into();
        draft.racks.retain(|r| r.name != "K12");
    });
    let told = check(at, &gone).await;
    assert_eq!(told["good"], false, "{told}");
    let obstacle = told["obstacles"].as_array().unwrap().iter().find(|o| {
        o["text"].as_str().unwrap().contains("rack K3 stands on S3, which the new map does not have")
    });
    let at_s3 = map().nodes.iter().find(|n| n.name == "S3").unwrap().at;
    assert_eq!(obstacle.unwrap()["at"], json!([[at_s3.x, at_s3.y]]), "{told}");
    let refused = publish(at, &gone, &old, "?accept_losses=true").await.problem(409);
    assert!(refused["errors"].as_array().unwrap().iter().any(|e| e["field"] == "obstacle"), "{refused}");

    let mut broken: Value = serde_json::from_str(&file::write(&map())).unwrap();
    broken["nodes"].as_array_mut().unwrap().push(json!({"id": "island", "x": 90, "y": 91.5}));
    let headers = [JSON, ("if-match", "*")];
    let refused = send(at, "PUT", "/v1/map", &headers, &broken.to_string()).await.unwrap().problem(409);
    assert!(refused["detail"].as_str().unwrap().contains("nodes island"), "{refused}");

    let refused = publish(at, &without_rack("K12"), &old, "").await.problem(409);
    assert!(refused["errors"].as_array().unwrap().iter().all(|e| e["field"] == "loss"), "{refused}");
    assert_eq!(version(at).await, old);
    assert_eq!(backups(&folder).len(), 0, "nothing was changed");
    let jobs = all_end(at).await;
    assert!(jobs.iter().all(|j| j["state"] == "done"), "{jobs:#?}");
    server.stop().await.unwrap();
    let server = start(&folder, map()).await.unwrap();
    assert!(server.store().carried().is_none() && server.summary().published.is_none());
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn losses_are_published_only_where_they_are_accepted() {
    let folder = Folder::new();
    let server = start(&folder, map()).await.unwrap();
    let at = server.address();
    submit(at).await;
    carrying(at).await;
    let told = check(at, &without_rack("K12")).await;
    assert_eq!((&told["good"], told["losses"].as_array().unwrap().len()), (&json!(true), 2), "{told}");
    let answer =
        publish(at, &without_rack("K12"), told["version"].as_str().unwrap(), "?accept_losses=true").await;
    assert_eq!((answer.status, answer.json()["losses"].as_array().unwrap().len()), (200, 2), "{answer:?}");
    let jobs = all_end(at).await;
    let (failed, done): (Vec<&Value>, Vec<&Value>) = jobs.iter().partition(|j| j["id"] == "j7");
    assert!(failed[0]["why"]["text"].as_str().unwrap().contains("the map was changed"), "{failed:#?}");
    assert!(done.iter().all(|j| j["state"] == "done"), "{done:#?}");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn two_editors_do_not_overwrite_one_another() {
    let folder = Folder::new();
    let server = start(&folder, map()).await.unwrap();
    let at = server.address();
    until_robots_join(at).await;
    let both = version(at).await;
    assert_eq!(publish(at, &grown(), &both, "").await.status, 200);
    let first = version(at).await;
    let second = publish(at, &moved(), &both, "").await.problem(412);
    assert_eq!(second["type"], "/problems/other-version");
    assert!(second["detail"].as_str().unwrap().contains(&first), "{second}");
    let blind = send(at, "PUT", "/v1/map", &[JSON], &file::write(&moved())).await.unwrap();
    assert_eq!(blind.problem(428)["type"], "/problems/if-match");
    assert_eq!(version(at).await, first, "the first one stands");
    assert_eq!(publish(at, &moved(), &first, "").await.status, 200, "who knows it may");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn administrators_alone_publish() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    until_robots(at, ADMIN).await;
    let map = file::write(&grown());
    for role in ["viewer", "operator", "integrator"] {
        let token = make(at, role, role, None).await["token"].as_str().unwrap().to_owned();
        with(at, &token, "POST", "/v1/map:check", &map).await.problem(403);
        let refused = with(at, &token, "PUT", "/v1/map", &map).await.problem(403);
        assert!(refused["detail"].as_str().unwrap().contains("needs the role admin"), "{refused}");
    }
    assert_eq!(with(at, ADMIN, "POST", "/v1/map:check", &map).await.status, 200);
    let bearer = format!("Bearer {ADMIN}");
    let headers = [JSON, ("if-match", "*"), ("authorization", bearer.as_str())];
    assert_eq!(send(at, "PUT", "/v1/map", &headers, &map).await.unwrap().status, 200);
    let audit = with(at, ADMIN, "GET", "/v1/audit?limit=50", "").await.json();
    let published = audit["items"].as_array().unwrap().iter().filter(|e| e["what"] == "PUT /v1/map");
    let outcomes: Vec<&Value> = published.map(|e| &e["status"]).collect();
    assert_eq!(outcomes, [200, 403, 403, 403], "newest first");
    server.stop().await.unwrap();
}

/// When the program is killed.
#[derive(Clone, Copy, Debug)]
enum KillAt {
    /// Shortly after the order.
    Once,
    /// So many milliseconds after it takes no more requests, as the core goes down and the database goes over.
    DoorShut(u64),
    /// When the order was answered.
    Answered,
}

async fn until_the_door_is_shut(at: SocketAddr) {
    let end = Instant::now() + PATIENCE;
    while get(at, "/v1/kinds").await.status == 200 {
        assert!(Instant::now() < end, "it takes no more requests");
        tokio::time::sleep(Duration::from_millis(2)).await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_kill_while_a_map_is_published_leaves_the_old_map_or_the_new_one() {
    let after_the_door_shut = [0, 10, 30, 60, 100, 200, 400].map(KillAt::DoorShut);
    let instants = [KillAt::Once].into_iter().chain(after_the_door_shut).chain([KillAt::Answered]);
    let kills = futures_util::future::join_all(instants.map(is_new_after_a_kill)).await;
    let published = kills.into_iter().filter(|is_new| *is_new).count();
    assert!((1..9).contains(&published), "{published} of nine kills came after it");
}

/// Whether the map of a program that is killed while it publishes one is the new one. Looks whether all else is there.
async fn is_new_after_a_kill(instant: KillAt) -> bool {
    // The start waits for the program, and none of the others is to wait for that.
    let started = |folder: Folder| tokio::task::spawn_blocking(move || (Program::start(&folder), folder));
    let (program, folder) = started(Folder::new()).await.unwrap();
    let at = program.address;
    until_robots_join(at).await;
    let job = json!({"kind": "deliver", "rack": "K1", "station": "P", "pick_s": 0.2});
    assert_eq!(post(at, Some("order"), &job).await.unwrap().status, 201);
    let old = version(at).await;
    let mut order = tokio::spawn(async move {
        let text = file::write(&grown());
        send(at, "PUT", "/v1/map", &[JSON, ("if-match", "*")], &text).await.ok().map(|a| a.status)
    });
    let mut known = None;
    match instant {
        KillAt::Once => tokio::time::sleep(Duration::from_millis(5)).await,
        KillAt::DoorShut(delay) => {
            until_the_door_is_shut(at).await;
            tokio::time::sleep(Duration::from_millis(delay)).await;
        }
        KillAt::Answered => known = Some((&mut order).await.unwrap()),
    }
    program.kill();
    let answered = match known {
        Some(answered) => answered,
        None => order.await.unwrap(),
    };
    let (program, _folder) = started(folder).await.unwrap();
    let at = program.address;
    let is_new = version(at).await != old;
    let file = if is_new { file::write(&grown()) } else { file::write(&map()) };
    assert_eq!(get(at, "/v1/map:file").await.text, file, "{instant:?}");
    assert!(is_new || answered != Some(200), "what was acknowledged is there: {instant:?}");
    let jobs = all_end(at).await;
    assert_eq!((jobs.len(), &jobs[0]["state"]), (1, &json!("done")), "{instant:?}: {jobs:#?}");
    program.kill();
    is_new
}
