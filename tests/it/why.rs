//! Why a robot or a job waits, and what holds which nodes, over HTTP.

use crate::helper::{Folder, delivery, eventually, get, map, post, send, start};
use serde_json::{Value, json};
use std::net::SocketAddr;

/// Asks until the answer is so.
async fn until(at: SocketAddr, path: &str, so: impl Fn(&Value) -> bool) -> Value {
    eventually(&format!("{path} is as it should be"), async || {
        let answer = get(at, path).await;
        (answer.status == 200).then(|| answer.json()).filter(&so)
    })
    .await
}

#[tokio::test(flavor = "multi_thread")]
async fn robots_and_jobs_say_why_they_wait_to_the_root() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let mut job = delivery(0);
    job["pick_s"] = json!(3600);
    let first = post(at, None, &job).await.unwrap().json()["id"].as_str().unwrap().to_owned();
    let mut follower = delivery(1);
    follower["after"] = json!([first]);
    let second = post(at, None, &follower).await.unwrap().json()["id"].as_str().unwrap().to_owned();
    let picked = |v: &Value| v["chain"].as_array().unwrap().last().is_some_and(|l| l["cause"] == "stop");
    let path = format!("/v1/jobs/{second}/why");
    let why = until(at, &path, |v| picked(v) && v["text"].as_str().unwrap().contains("picked from")).await;
    assert_eq!((why["id"].clone(), why["waiting"].clone()), (json!(second), json!(true)));
    let link = &why["chain"][0];
    assert_eq!((link["cause"].clone(), link["by"].clone()), (json!("job"), json!(first)), "{why}");
    assert_eq!(link["text"]["text"], format!("waits for {first} to be over"));
    let root = why["chain"].as_array().unwrap().last().unwrap();
    let left = root["until_s"].as_f64().unwrap();
    assert!((3000.0..=3700.0).contains(&left), "the pick lasts an hour: {root}");
    let robot = root["who"].as_str().unwrap();
    let of_robot = get(at, &format!("/v1/robots/{robot}/why")).await.json();
    assert_eq!(
        (of_robot["waiting"].clone(), of_robot["chain"][0]["who"].clone()),
        (json!(false), json!(robot))
    );
    get(at, "/v1/robots/nobody/why").await.problem(404);
    for unknown in ["j99", "robot-1"] {
        get(at, &format!("/v1/jobs/{unknown}/why")).await.problem(404);
    }
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn timelines_say_who_holds_the_nodes_of_an_area() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let robots = until(at, "/v1/robots", |v| v["items"].as_array().is_some_and(|r| !r.is_empty())).await;
    let robot = &robots["items"][0];
    let (x, y) = (robot["x"].as_f64().unwrap(), robot["y"].as_f64().unwrap());
    let area = |d: f64| format!("/v1/timelines?x0={}&y0={}&x1={}&y1={}", x + d, y - d, x - d, y + d);
    let seen = get(at, &area(0.1)).await.json();
    assert_eq!(seen["ahead_s"], 60.0);
    let holds = seen["nodes"][0]["holds"].as_array().unwrap();
    let own = holds.iter().find(|h| h["by"] == robot["id"]).unwrap_or_else(|| panic!("{seen}"));
    assert_eq!((own["granted"].clone(), own["kind"].clone()), (json!(true), json!("robot")));
    assert!(own["from_s"].as_f64().unwrap() <= 0.0 && own["conflict"] == false, "{own}");
    let nodes = map().nodes.len();
    let all = get(at, "/v1/timelines?x0=-900&y0=-900&x1=900&y1=900&ahead_s=120").await;
    if nodes > 200 {
        let problem = all.problem(422);
        assert!(problem["detail"].as_str().unwrap().contains("smaller area"), "{problem}");
    } else {
        assert_eq!(all.json()["nodes"].as_array().unwrap().len(), nodes);
    }
    for wrong in ["x0=0&y0=0&x1=1", "x0=0&y0=0&x1=1&y1=nan", "x0=0&y0=0&x1=1&y1=1&ahead_s=121"] {
        let answer = get(at, &format!("/v1/timelines?{wrong}")).await;
        assert!((400..=422).contains(&answer.status), "{answer:?}");
    }
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn the_fleet_and_single_robots_stand_until_resumed_over_a_restart_too() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    until(at, "/v1/robots", |v| v["items"].as_array().is_some_and(|r| !r.is_empty())).await;
    let go = |at, path: &'static str| async move { send(at, "POST", path, &[], "").await.unwrap() };
    assert_eq!(go(at, "/v1/fleet/stop").await.status, 204);
    assert_eq!(go(at, "/v1/fleet/stop").await.status, 204, "it stands already");
    assert_eq!(go(at, "/v1/robots/robot-1/pause").await.status, 204);
    go(at, "/v1/robots/nobody/pause").await.problem(404);
    until(at, "/v1/fleet", |v| v["stopped"].is_string() && v["paused"] == json!(["robot-1"])).await;
    server.stop().await.unwrap();
    let server = start(&folder).await;
    let at = server.address();
    let fleet = until(at, "/v1/fleet", |v| v["stopped"].is_string()).await;
    assert_eq!(fleet["paused"], json!(["robot-1"]), "nothing is forgotten");
    let job = post(at, None, &delivery(0)).await.unwrap().json();
    let path = format!("/v1/jobs/{}", job["id"].as_str().unwrap());
    let json = [("content-type", "application/json")];
    let changed = send(at, "PATCH", &path, &json, r#"{"priority": 7}"#).await.unwrap();
    assert_eq!((changed.status, changed.json()["priority"].clone()), (200, json!(7)), "{changed:?}");
    assert_eq!(get(at, &path).await.json()["priority"], 7);
    send(at, "PATCH", &path, &json, r#"{"priority": 10}"#).await.unwrap().problem(422);
    send(at, "PATCH", "/v1/jobs/j99", &json, r#"{"priority": 1}"#).await.unwrap().problem(404);
    assert_eq!(go(at, "/v1/fleet/resume").await.status, 204);
    assert_eq!(go(at, "/v1/robots/robot-1/resume").await.status, 204);
    until(at, "/v1/fleet", |v| v["stopped"].is_null() && v["paused"] == json!([])).await;
    until(at, &path, |v| v["state"] != "waiting").await;
    send(at, "PATCH", &path, &json, r#"{"priority": 1}"#).await.unwrap().problem(409);
    server.stop().await.unwrap();
}
