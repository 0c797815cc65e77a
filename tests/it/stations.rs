//! Stations over HTTP: a pick ends when the station says so, and a paused station gets no racks.

use crate::helper::{Answer, Folder, delivery, get, map, post, send, start};
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::time::Duration;

async fn say(at: SocketAddr, station: &str, what: &str) -> Answer {
    send(at, "POST", &format!("/v1/stations/{station}/{what}"), &[], "").await.unwrap()
}

/// Asks until it is so, for half a minute.
async fn until(what: &str, at: SocketAddr, path: &str, so: impl Fn(&Value) -> bool) -> Value {
    let mut seen = Value::Null;
    for _ in 0..600 {
        seen = get(at, path).await.json();
        if so(&seen) {
            return seen;
        }
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    panic!("not in half a minute: {what}; {seen}");
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
        assert!(state == "done" || ended["why"].as_str().unwrap().contains("goods were missing"), "{ended}");
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
    let why = format!("waiting for {station} to resume: it is paused");
    until("the job says why it waits", at, &path, |j| j["why"] == *why).await;
    assert_eq!(say(at, &station, "resume").await.status, 204);
    until("a robot has it", at, &path, |j| j["state"] != "waiting").await;
    server.stop().await.unwrap();
}
