//! Robots that join over HTTP, go to maintenance and come back.

use crate::helper::{Answer, Folder, get, map, send, start};
use giveway::warehouse::NodeKind;
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::time::Duration;

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
    for _ in 0..1200 {
        if robot(at, id).await.is_some_and(|r| so(&r)) {
            return;
        }
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    panic!("{id} never was {what}: {:?}", robot(at, id).await);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_robot_joins_over_http_once_and_is_still_there_after_a_restart() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    until(at, "robot-1", "there", |_| true).await;
    let held: Vec<usize> = get(at, "/v1/robots").await.json()["items"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|r| [&r["granted"], &r["held"]].map(|n| n.as_array().unwrap().clone()).concat())
        .map(|n| n.as_u64().unwrap() as usize)
        .collect();
    let map = map();
    let free = |(i, n): &(usize, &giveway::warehouse::Node)| n.kind == NodeKind::Storage && !held.contains(i);
    let (_, node) = map.nodes.iter().enumerate().rfind(free).expect("no robot holds some storage node");
    let new = json!({"name": "late-1", "node": node.name});
    let joined = register(at, &new).await;
    assert_eq!((joined.status, joined.json()["id"].as_str()), (201, Some("late-1")), "{}", joined.text);
    assert_eq!(register(at, &new).await.status, 200, "the same name is the same robot");
    until(at, "late-1", "seen on the floor", |r| r["kind"] == "robot").await;

    let taken = map.nodes.iter().nth(held[0]).unwrap().name.clone();
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
    until(at, "robot-1", "in maintenance", |r| r["why"] == "in maintenance" && r["maintenance"] == true)
        .await;
    server.stop().await.unwrap();
    let server = start(&folder).await;
    let at = server.address();
    until(at, "robot-1", "in maintenance still", |r| r["maintenance"] == true).await;
    assert_eq!(send(at, "DELETE", path, &[], "").await.unwrap().status, 204);
    until(at, "robot-1", "at work again", |r| r["maintenance"] == false && r["why"] != "in maintenance")
        .await;
    send(at, "PUT", "/v1/robots/robot-99/maintenance", &[], "").await.unwrap().problem(404);
    server.stop().await.unwrap();
}
