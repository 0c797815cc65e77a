//! Requests and messages of feeds that somebody broke: the server answers in words, stays up, and no robot is touched.
//!
//! `GIVEWAY_FUZZ_ROUNDS` and `GIVEWAY_FUZZ_SEED` as in `tests/fuzz`.

#[path = "../fuzz/mutate.rs"]
mod mutate;

use crate::helper::{Folder, get, send, start, until_ready};
use futures_util::{SinkExt, StreamExt};
use mutate::Mutator;
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::time::Duration;
use tokio_tungstenite::{connect_async, tungstenite::Message};

fn number(name: &str, usual: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(usual)
}

/// Requests in order, to be broken.
fn requests() -> Vec<(&'static str, &'static str, Value)> {
    let job = json!({"kind": "deliver", "rack": "K1", "station": "P", "priority": 3, "pick_s": 1.5,
        "deadline": "2099-01-31T12:00:00Z", "after": ["j1"], "reference": "r", "labels": {"wave": "7"}});
    let stops = json!({"kind": "deliver", "rack": "K2", "stops": [{"station": "P", "pick_s": 2}]});
    let area = json!({"outline": [[0.5, 0.5], [1.5, 0.5], [1.5, 1.5]], "reason": "a spill"});
    vec![
        ("POST", "/v1/jobs", job.clone()),
        ("POST", "/v1/jobs", stops.clone()),
        ("POST", "/v1/jobs", json!({"kind": "go", "robot": "robot-1", "node": "R100"})),
        ("POST", "/v1/jobs:batch", json!({"jobs": [{"key": "a", "job": job}, {"job": stops}]})),
        ("PATCH", "/v1/jobs/j1", json!({"priority": 1, "deadline": null, "station": "P"})),
        ("POST", "/v1/jobs/j1/reassign", json!({"robot": "robot-2"})),
        ("POST", "/v1/closures", area),
        ("POST", "/v1/workers", json!({"id": "picker-1"})),
        ("POST", "/v1/assignments", json!({"place": "R100", "what": "count", "stay_s": 5})),
        ("POST", "/v1/webhooks", json!({"url": "http://127.0.0.1:9/hook", "kinds": ["job"]})),
        ("POST", "/v1/maps:check", json!({"giveway_map": 1, "name": "m", "nodes": [], "lanes": []})),
        ("GET", "/v1/jobs?limit=50&state=waiting&from=2027-01-31T12:00:00Z&cursor=j5", Value::Null),
        ("GET", "/v1/report?from=2027-01-31T12:00:00Z&to=2027-01-31T13:00:00Z", Value::Null),
        ("GET", "/v1/history?from=2027-01-31T12:00:00Z&step_s=60", Value::Null),
    ]
}

async fn is_well(at: SocketAddr, after: &str) {
    let health = get(at, "/v1/health/ready").await;
    assert_eq!(health.status, 200, "after {after}: {}", health.text);
    let alarms = get(at, "/v1/alarms").await.json();
    let broken = ["broken", "ledger", "fenced", "loop", "journal"];
    let is_broken = |a: &&Value| broken.contains(&a["kind"].as_str().unwrap_or_default());
    let found: Vec<&Value> = alarms["items"].as_array().unwrap().iter().filter(is_broken).collect();
    assert!(found.is_empty(), "after {after}: {found:?}");
}

#[tokio::test(flavor = "multi_thread")]
async fn broken_requests_are_answered_in_words_and_break_nothing() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    until_ready(at).await;
    let (rounds, first) = (number("GIVEWAY_FUZZ_ROUNDS", 300), number("GIVEWAY_FUZZ_SEED", 1));
    let requests = requests();
    for seed in first..first + rounds {
        let mut mutator = Mutator::new(seed);
        let (method, path, body) = mutator.choose(&requests).clone();
        let (path, body) = match path.split_once('?') {
            Some((path, query)) => (format!("{path}?{}", plain(&mutator.text(query))), String::new()),
            None => (path.to_owned(), mutator.text(&body.to_string())),
        };
        let said = format!("GIVEWAY_FUZZ_SEED={seed} GIVEWAY_FUZZ_ROUNDS=1: {method} {path} {body}");
        let answer = send(at, method, &path, &[("content-type", "application/json")], &body).await;
        let answer = answer.unwrap_or_else(|e| panic!("no answer ({e}) to {said}"));
        assert!(answer.status < 500 || answer.status == 503, "{} to {said}: {}", answer.status, answer.text);
        if answer.status >= 400 {
            assert!(
                !answer.json()["detail"].as_str().unwrap_or_default().is_empty(),
                "{said}: {}",
                answer.text
            );
        }
    }
    is_well(at, "broken requests").await;
    server.stop().await.unwrap();
}

/// What may stand in a request line.
fn plain(query: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-._~&=%+:,;@!$*()/?".contains(c);
    let escaped = |c: char| if is_plain(c) { c.to_string() } else { "%EF%BF%BD".to_owned() };
    query.chars().map(escaped).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn broken_messages_of_a_feed_end_it_at_worst_and_robots_go_on() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let worker = crate::feed::hire(at, "picker").await;
    let (rounds, first) = (number("GIVEWAY_FUZZ_ROUNDS", 300), number("GIVEWAY_FUZZ_SEED", 1));
    let hello = json!({"type": "hello", "versions": [1, 7], "frame": "map"});
    let messages = [
        hello.clone(),
        json!({"type": "pose", "epoch": 1, "seq": 4, "t": 5000.0, "at": [1.0, 1.0], "heading": 0.3, "accuracy": 0.1}),
        json!({"type": "pose", "epoch": 1, "seq": 5, "t": 5020.0, "pos": [1.0, 1.6, -1.0], "quat": [0.0, 0.0, 0.0, 1.0]}),
        json!({"type": "anchors", "pairs": [{"device": [0.0, 0.0, 0.0], "mark": "R100"},
            {"device": [1.0, 0.0, 0.0], "map": [2.0, 1.0], "weight": 2.0}]}),
        json!({"type": "reset"}),
        json!({"type": "ack", "version": 2}),
        json!({"type": "done", "assignment": "a1"}),
        json!({"type": "bye"}),
        json!({"type": "pong", "id": 1, "t1": 5.0, "t2": 6.0}),
    ];
    let mut feed: Option<_> = None;
    for seed in first..first + rounds {
        let mut mutator = Mutator::new(seed);
        let mut socket = match feed.take() {
            Some(socket) => socket,
            None => {
                let Ok((mut socket, _)) = connect_async(format!("ws://{at}/v1/workers/{worker}/feed")).await
                else {
                    // Too many feeds in a short time: strangers are slowed down.
                    tokio::time::sleep(Duration::from_millis(200)).await;
                    continue;
                };
                socket.send(Message::Text(hello.to_string().into())).await.unwrap();
                socket
            }
        };
        let message = mutator.choose(&messages).clone().to_string();
        let text = mutator.text(&message);
        let message = if mutator.below(20) == 0 {
            Message::Binary(text.into_bytes().into())
        } else {
            Message::Text(text.into())
        };
        let is_sent = socket.send(message).await.is_ok();
        let ended = loop {
            match tokio::time::timeout(Duration::from_millis(2), socket.next()).await {
                Err(_) => break false,
                Ok(Some(Ok(Message::Close(_)) | Err(_)) | None) => break true,
                Ok(Some(Ok(_))) => {}
            }
        };
        if is_sent && !ended {
            feed = Some(socket);
        }
    }
    is_well(at, "broken messages").await;
    server.stop().await.unwrap();
}
