//! Stations over HTTP: a pick ends when the station says so, and a paused station gets no racks.

use crate::helper::{Answer, Folder, delivery, eventually, get, map, post, send, start};
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::time::{Duration, Instant};

async fn say(at: SocketAddr, station: &str, what: &str) -> Answer {
    send(at, "POST", &format!("/v1/stations/{station}/{what}"), &[], "").await.unwrap()
}

/// Asks until it is so.
async fn until(what: &str, at: SocketAddr, path: &str, so: impl Fn(&Value) -> bool) -> Value {
    eventually(what, async || Some(get(at, path).await.json()).filter(&so)).await
}

#[tokio::test(flavor = "multi_thread")]
async fn a_pick_ends_when_the_station_says_so_and_not_by_the_clock() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let station = map().stations.iter().next().unwrap().name.clone();
    say(at, &station, "done").await.problem(409);
    say(at, "nowhere", "done").await.problem(404);
    for (end, state) in [("done", "done"), ("short", "failed")] {
        let mut job = delivery(0);
        job["pick_s"] = json!(900);
        let made = post(at, None, &job).await.unwrap().json();
        let id = made["id"].as_str().unwrap();
        let picking = |s: &Value| s["items"][0]["picking"] == true;
        until("a rack stands there", at, "/v1/stations", picking).await;
        assert_eq!(say(at, &station, end).await.status, 204);
        let path = format!("/v1/jobs/{id}");
        let ended = until("the job is over", at, &path, |j| j["state"] == state).await;
        assert!(
            state == "done" || ended["why"]["text"].as_str().unwrap().contains("goods were missing"),
            "{ended}"
        );
        until("the robot has left", at, "/v1/stations", |s| s["items"][0]["robot"] == Value::Null).await;
    }
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_paused_station_gets_no_racks_and_stays_paused_over_a_restart() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let station = map().stations.iter().next().unwrap().name.clone();
    assert_eq!(say(at, &station, "pause").await.status, 204);
    server.stop().await.unwrap();
    let server = start(&folder).await;
    let at = server.address();
    until("it is paused", at, "/v1/stations", |s| s["items"][0]["paused"].is_string()).await;
    let made = post(at, None, &delivery(0)).await.unwrap().json();
    let path = format!("/v1/jobs/{}", made["id"].as_str().unwrap());
    let why = format!("waits for {station} to resume: it is paused");
    until("the job says why it waits", at, &path, |j| j["why"]["text"] == *why).await;
    assert_eq!(say(at, &station, "resume").await.status, 204);
    until("a robot has it", at, &path, |j| j["state"] != "waiting").await;
    server.stop().await.unwrap();
}

/// The place of the robot that does a job, once the robot has had it there for three seconds.
async fn stands(at: SocketAddr, job: &str) -> (f64, f64) {
    let mut since = (Instant::now(), None);
    eventually(&format!("the robot with {job} stands"), async || {
        let now = place_of(at, job).await;
        if now != since.1 {
            since = (Instant::now(), now);
        }
        now.filter(|_| since.0.elapsed() > Duration::from_secs(3))
    })
    .await
}

/// Where the robot is that carries the rack of a job.
async fn place_of(at: SocketAddr, job: &str) -> Option<(f64, f64)> {
    let robots = get(at, "/v1/robots").await.json();
    let carries = |r: &&Value| r["job"] == job && r["rack"].is_string();
    let robot = robots["items"].as_array().unwrap().iter().find(carries)?;
    Some((robot["x"].as_f64()?, robot["y"].as_f64()?))
}

/// Waits until the robot with a job moves, which takes a step and a message; the two seconds that are promised are
/// asserted in simulated time, in the tests of the fleet.
async fn sets_off(at: SocketAddr, job: &str, from: (f64, f64)) {
    eventually(&format!("the robot with {job} sets off from {from:?}"), async || {
        let now = place_of(at, job).await.expect("it carries the rack");
        ((now.0 - from.0).hypot(now.1 - from.1) > 0.02).then_some(())
    })
    .await;
}

#[tokio::test(flavor = "multi_thread")]
async fn the_next_robot_sets_off_when_a_pick_of_a_quarter_of_an_hour_is_cancelled() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let mut long = delivery(0);
    long["pick_s"] = json!(900);
    let long = post(at, None, &long).await.unwrap().json();
    until("a rack stands there", at, "/v1/stations", |s| s["items"][0]["picking"] == true).await;
    let next = post(at, None, &delivery(1)).await.unwrap().json();
    let next = next["id"].as_str().unwrap();
    let from = stands(at, next).await;
    let path = format!("/v1/jobs/{}", long["id"].as_str().unwrap());
    let cancelled = send(at, "DELETE", &path, &[], "").await.unwrap();
    assert!(cancelled.status < 300, "{}", cancelled.text);
    sets_off(at, next, from).await;
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_that_a_closed_area_cuts_off_begins_when_the_area_is_opened_long_before_its_time() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let station = map().stations.iter().next().unwrap().clone();
    let queue = map().nodes[station.queue[0]].name.clone();
    let end = (jiff::Timestamp::now() + jiff::SignedDuration::from_mins(10)).to_string();
    let closure = json!({"nodes": [queue], "until": end, "reason": "oil"}).to_string();
    let closed =
        send(at, "POST", "/v1/closures", &[("content-type", "application/json")], &closure).await.unwrap();
    assert_eq!(closed.status, 201, "{}", closed.text);
    let job = post(at, None, &delivery(0)).await.unwrap().json();
    let job = format!("/v1/jobs/{}", job["id"].as_str().unwrap());
    let area = closed.json()["id"].as_str().unwrap().to_owned();
    let why = format!("waits for closed area {area} to open: it cuts the rack off from its destination");
    until("the job says what cuts it off", at, &job, |j| j["why"]["text"] == *why).await;
    let opened = send(at, "DELETE", &format!("/v1/closures/{area}"), &[], "").await.unwrap();
    assert!(opened.status < 300, "{}", opened.text);
    until("a robot has it", at, &job, |j| j["state"] != "waiting").await;
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_station_that_is_paused_or_resumed_is_an_event() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let station = map().stations.iter().next().unwrap().name.clone();
    for what in ["pause", "pause", "resume"] {
        assert_eq!(say(at, &station, what).await.status, 204);
    }
    let page = get(at, "/v1/events?kind=station").await.json();
    let told: Vec<_> = page["items"]
        .as_array()
        .unwrap()
        .iter()
        .map(|e| [&e["kind"], &e["id"], &e["old"], &e["new"]])
        .collect();
    let (kind, id, paused) = (json!("station"), json!(station), json!("paused"));
    assert_eq!(told, [[&kind, &id, &Value::Null, &paused], [&kind, &id, &paused, &json!("resumed")]]);
    server.stop().await.unwrap();
}
