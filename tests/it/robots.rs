//! Robots over HTTP: what each is at, one with what lists leave out, and what happened to it.

use crate::helper::{Folder, delivery, eventually, get, map, post, send, start, until_ready};
use serde_json::{Value, json};
use std::net::SocketAddr;

/// Asks until the answer is so.
async fn until(at: SocketAddr, path: &str, what: &str, so: impl Fn(&Value) -> bool) -> Value {
    eventually(&format!("{path} says {what}"), async || {
        let answer = get(at, path).await;
        (answer.status == 200).then(|| answer.json()).filter(&so)
    })
    .await
}

async fn order(at: SocketAddr, method: &str, path: &str) {
    let answer = send(at, method, path, &[], "").await.unwrap();
    assert_eq!(answer.status, 204, "{method} {path}: {answer:?}");
}

/// Robots begin at chargers or parking places.
fn both_rest(page: &Value) -> bool {
    let rests = |r: &Value| r["activity"] == "idle" || r["activity"] == "charging";
    page["items"].as_array().is_some_and(|robots| robots.len() == 2 && robots.iter().all(rests))
}

/// The entries of a history but for alarms, which a busy machine may raise.
fn entries(page: &Value) -> Vec<Value> {
    page["items"].as_array().unwrap().iter().filter(|e| e["kind"] != "alarm").cloned().collect()
}

fn words(page: &Value) -> Vec<String> {
    entries(page).iter().map(|e| e["what"].as_str().unwrap().to_owned()).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_that_says_that_it_is_ready_knows_each_robot_and_its_charge() {
    for _ in 0..5 {
        let folder = Folder::new();
        let server = start(&folder).await;
        let at = server.address();
        until_ready(at).await;
        let robots = get(at, "/v1/robots").await.json();
        let charged = |r: &Value| r["battery"].as_f64() > Some(0.0);
        let items = robots["items"].as_array().unwrap();
        assert!(items.len() == 2 && items.iter().all(charged), "{robots}");
        server.stop().await.unwrap();
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn robots_are_listed_by_what_they_are_at_and_nodes_by_name() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    until(at, "/v1/robots", "that both rest", both_rest).await;
    order(at, "POST", "/v1/robots/robot-2/pause").await;
    let paused = until(at, "/v1/robots?activity=paused", "one", |p| !p["items"][0].is_null()).await;
    let robot = &paused["items"][0];
    assert_eq!((&robot["id"], &robot["activity"]), (&json!("robot-2"), &json!("paused")), "{paused}");
    assert!(robot["since"].as_str().unwrap() > "2020", "{robot}");
    let names: Vec<String> = map().nodes.iter().map(|n| n.name.clone()).collect();
    let node = robot["granted"][0].as_str().expect("a robot holds the node on which it stands");
    assert!(names.iter().any(|name| name == node), "{node}");
    let rack = get(at, "/v1/racks?limit=1").await.json()["items"][0].clone();
    assert!(names.iter().any(|name| rack["node"] == json!(name)), "{rack}");
    let wrong = get(at, "/v1/robots?activity=asleep").await;
    wrong.problem(422);
    assert_eq!(wrong.json()["errors"][0]["field"], "activity");
    let figures = get(at, "/metrics").await.text;
    assert!(figures.contains("giveway_robot_activities{activity=\"paused\"} 1"), "{figures}");
    assert!(figures.contains("giveway_robot_activity_longest_seconds{activity=\"paused\"}"), "{figures}");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn the_life_of_a_robot_is_told_by_the_server_also_after_a_restart() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    until(at, "/v1/robots", "that both rest", both_rest).await;
    order(at, "POST", "/v1/robots/robot-2/pause").await;
    assert_eq!(post(at, None, &delivery(0)).await.unwrap().status, 201);
    let one = until(at, "/v1/robots/robot-1", "a job done", |r| r["jobs_done"] == 1).await;
    assert!(one["driven_m"].as_f64().unwrap() > 1.0, "{one}");
    assert!(one["heard"].is_string() && one["silent_s"].as_f64().unwrap() < 5.0, "{one}");
    let link =
        json!({"name": "sim", "connected": true, "reach": "by_reports", "capacity": null, "refuses": null});
    assert_eq!(one["link"], link, "how it is reached");
    assert_eq!((&one["jobs_failed"], &one["id"]), (&json!(0), &json!("robot-1")), "{one}");
    assert!(one["alarms"].is_array() && one["activity"].is_string(), "{one}");
    order(at, "POST", "/v1/robots/robot-2/resume").await;
    order(at, "PUT", "/v1/robots/robot-1/maintenance").await;
    order(at, "DELETE", "/v1/robots/robot-1/maintenance").await;
    server.stop().await.unwrap();

    let server = start(&folder).await;
    let at = server.address();
    let told = get(at, "/v1/robots/robot-1/history").await.json();
    let expected = ["back_in_service", "out_of_service", "done", "joined"];
    assert_eq!(words(&told), expected, "newest first: {told}");
    let job = &entries(&told)[2];
    assert_eq!((&job["kind"], &job["id"], &job["text"]), (&json!("job"), &json!("j1"), &json!("deliver")));
    let of_other = get(at, "/v1/robots/robot-2/history").await.json();
    assert_eq!(words(&of_other), ["resumed", "paused", "joined"], "{of_other}");

    // Page by page it is the same list.
    let mut paged = Vec::new();
    let mut path = "/v1/robots/robot-1/history?limit=1".to_owned();
    loop {
        let page = get(at, &path).await.json();
        assert_eq!(page["items"].as_array().unwrap().len(), 1);
        paged.extend(entries(&page));
        let Some(next) = page["next"].as_str() else { break };
        path = format!("/v1/robots/robot-1/history?limit=1&cursor={next}");
    }
    assert_eq!(paged, entries(&told));
    let done = job["at"].as_str().unwrap();
    let before = get(at, &format!("/v1/robots/robot-1/history?to={done}")).await.json();
    assert_eq!(words(&before), ["joined"], "what began at that time is not before it");
    get(at, "/v1/robots/robot-9").await.problem(404);
    get(at, "/v1/robots/robot-9/history").await.problem(404);
    for (query, field) in [("limit=501", "limit"), ("cursor=j1", "cursor"), ("from=now", "from")] {
        let answer = get(at, &format!("/v1/robots/robot-1/history?{query}")).await;
        answer.problem(422);
        assert_eq!(answer.json()["errors"][0]["field"], field, "{query}");
    }
    server.stop().await.unwrap();
}
