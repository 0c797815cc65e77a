//! Alarms over HTTP: raised, acknowledged, kept over a restart, cleared, listed; and what health says meanwhile.

use crate::helper::{Folder, config, delivery, eventually, floor, get, post, send, start, until_ready};
use giveway::server::Server;
use giveway::sim::Faults;
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::time::Duration;

const JSON: &[(&str, &str)] = &[("content-type", "application/json")];

/// A server on whose floor every robot breaks down as soon as it has driven for a moment, and stays broken.
async fn start_where_robots_fail(folder: &Folder) -> Server {
    let mut floor = floor();
    floor.source.scenario.faults = Faults { failures_per_hour: 1e5, repair_s: 1e6, ..Faults::default() };
    Server::start(&config(folder), floor).await.unwrap()
}

/// The active alarms, asked again until they are so.
async fn alarms(at: SocketAddr, what: &str, so: impl Fn(&[Value]) -> bool) -> Vec<Value> {
    eventually(what, async || {
        let items = get(at, "/v1/alarms").await.json()["items"].as_array().unwrap().clone();
        so(&items).then_some(items)
    })
    .await
}

async fn acknowledge(at: SocketAddr, id: &str, body: &Value) -> crate::helper::Answer {
    send(at, "POST", &format!("/v1/alarms/{id}/acknowledge"), JSON, &body.to_string()).await.unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn an_alarm_is_acknowledged_outlasts_a_restart_and_ends_with_its_cause() {
    let folder = Folder::new();
    let server = start_where_robots_fail(&folder).await;
    let at = server.address();
    assert_eq!(post(at, None, &delivery(0)).await.unwrap().status, 201);
    let failed = |items: &[Value]| items.iter().any(|a| a["kind"] == "robot_failed");
    let items = alarms(at, "a robot fails", failed).await;
    let alarm = items.iter().find(|a| a["kind"] == "robot_failed").unwrap();
    let id = alarm["id"].as_str().unwrap();
    assert_eq!(alarm["subject"]["kind"], "robot", "{alarm}");
    let robot = alarm["subject"]["id"].as_str().unwrap();
    assert!(alarm["text"].as_str().unwrap().contains(robot), "{alarm}");
    assert!(
        alarm["x"].is_number() && alarm["acknowledged"].is_null() && alarm["cleared"].is_null(),
        "{alarm}"
    );
    let metrics = get(at, "/metrics").await.text;
    assert!(metrics.contains("giveway_alarms{kind=\"robot_failed\",severity="), "{metrics}");
    assert_eq!(get(at, "/v1/health/ready").await.status, 200, "the server promises as before");

    acknowledge(at, id, &json!({"by": " "})).await.problem(422);
    acknowledge(at, "al999", &json!({"by": "Ben"})).await.problem(404);
    acknowledge(at, "robot-1", &json!({"by": "Ben"})).await.problem(404);
    let noted = acknowledge(at, id, &json!({"by": "Ben"})).await;
    assert_eq!((noted.status, noted.json()["acknowledged"]["by"].clone()), (200, json!("Ben")));
    let again = acknowledge(at, id, &json!({"by": "Eve"})).await.json();
    assert_eq!(again["acknowledged"]["by"], "Ben", "who did first, did");
    server.stop().await.unwrap();

    // Simulated robots are as new after a restart, but it takes them a moment to say so.
    let server = start(&folder).await;
    let at = server.address();
    let restored = get(at, "/v1/alarms?state=any").await.json()["items"].clone();
    let same = restored.as_array().unwrap().iter().find(|a| a["id"] == id).expect("it outlasts a restart");
    assert_eq!((&same["acknowledged"]["by"], &same["since"]), (&json!("Ben"), &alarm["since"]));
    let of_robot = |items: &[Value]| items.iter().any(|a| a["id"] == id);
    alarms(at, "it ends", |items| !of_robot(items)).await;
    let since = alarm["since"].as_str().unwrap();
    let is_told = async || {
        let past = get(at, &format!("/v1/alarms?from={since}&limit=500")).await.json();
        let over = past["items"].as_array().unwrap().iter().find(|a| a["id"] == id).unwrap();
        (over["state"] == "cleared" && over["cleared"].is_string()).then_some(())
    };
    eventually("the history says that it ended", is_told).await;
    let before = get(at, &format!("/v1/alarms?to={since}")).await.json();
    assert!(!of_robot(before["items"].as_array().unwrap()), "it began at that time, not before");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn what_an_operator_wanted_is_a_notice_and_never_makes_health_fail() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    assert_eq!(post(at, None, &delivery(0)).await.unwrap().status, 201);
    let no_body = "";
    assert_eq!(send(at, "POST", "/v1/fleet/stop", &[], no_body).await.unwrap().status, 204);
    let items = alarms(at, "a notice", |items| !items.is_empty()).await;
    assert_eq!(
        (&items[0]["kind"], &items[0]["severity"]),
        (&json!("stopped"), &json!("notice")),
        "{items:?}"
    );
    tokio::time::sleep(Duration::from_secs(3)).await;
    for path in ["/v1/health/live", "/v1/health/ready"] {
        assert_eq!(get(at, path).await.status, 200, "{path}");
    }
    let operator = |a: &Value| a["kind"] == "stopped" || a["kind"] == "steps_late";
    let all = get(at, "/v1/alarms").await.json()["items"].as_array().unwrap().clone();
    assert!(all.iter().all(operator), "a stop raises nothing else: {all:?}");
    assert_eq!(send(at, "POST", "/v1/fleet/resume", &[], no_body).await.unwrap().status, 204);
    alarms(at, "it ends", |items| items.iter().all(|a| a["kind"] != "stopped")).await;
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_that_cannot_write_is_not_ready_and_says_why() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    until_ready(at).await;
    let away = folder.database().with_extension("away");
    std::fs::rename(folder.database(), &away).unwrap();
    let refuses = async || Some(get(at, "/v1/health/ready").await).filter(|answer| answer.status == 503);
    let answer = eventually("it is not ready", refuses).await;
    answer.problem(503);
    assert!(answer.text.contains("database"), "{answer:?}");
    assert_eq!(get(at, "/v1/health/live").await.status, 200, "a restart would not bring it back");
    alarms(at, "an alarm", |items| items.iter().any(|a| a["kind"] == "database")).await;
    std::fs::rename(&away, folder.database()).unwrap();
    let ends = |a: &Value| a["kind"] != "database" && a["kind"] != "journal";
    alarms(at, "it is back", |items| items.iter().all(ends)).await;
    assert_eq!(get(at, "/v1/health/ready").await.status, 200);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_list_that_cannot_be_is_refused_with_the_field() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    for (query, field) in [
        ("state=old", "state"),
        ("state=active&limit=3", "state"),
        ("from=yesterday", "from"),
        ("cursor=al1", "cursor"),
        ("group=robot-1", "group"),
        ("limit=0", "limit"),
    ] {
        let answer = get(at, &format!("/v1/alarms?{query}")).await;
        answer.problem(422);
        assert_eq!(answer.json()["errors"][0]["field"], field, "{query}: {answer:?}");
    }
    assert_eq!(get(at, "/v1/alarms?state=any").await.json(), json!({"items": [], "next": null}));
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn an_alarm_is_put_aside_for_a_time_and_has_notes_and_both_outlast_a_restart() {
    let folder = Folder::new();
    let server = start_where_robots_fail(&folder).await;
    let at = server.address();
    assert_eq!(post(at, None, &delivery(0)).await.unwrap().status, 201);
    let failed = |items: &[Value]| items.iter().any(|a| a["kind"] == "robot_failed");
    let items = alarms(at, "a robot fails", failed).await;
    let alarm = items.iter().find(|a| a["kind"] == "robot_failed").unwrap();
    let id = alarm["id"].as_str().unwrap();
    assert_eq!(alarm["acts"], json!(["start_maintenance", "remove_robot"]), "{alarm}");
    let tell = async |method: &str, what: &str, body: &Value| {
        send(at, method, &format!("/v1/alarms/{id}/{what}"), JSON, &body.to_string()).await.unwrap()
    };
    for (body, field) in [
        (json!({"by": "Ben", "for_s": 59, "reason": "x"}), "for_s"),
        (json!({"by": "Ben", "for_s": 43201, "reason": "x"}), "for_s"),
        (json!({"by": "", "for_s": 60, "reason": "x"}), "by"),
        (json!({"by": "Ben", "for_s": 60, "reason": "  "}), "reason"),
    ] {
        let answer = tell("POST", "shelve", &body).await;
        answer.problem(422);
        assert_eq!(answer.json()["errors"][0]["field"], field, "{answer:?}");
    }
    let aside = tell("POST", "shelve", &json!({"by": "Ben", "for_s": 3600, "reason": "being mended"})).await;
    assert_eq!((aside.status, &aside.json()["shelved"]["by"]), (200, &json!("Ben")), "{aside:?}");
    let back = tell("DELETE", "shelve", &Value::Null).await.json();
    assert_eq!(back["shelved"], Value::Null);
    tell("POST", "shelve", &json!({"by": "Ben", "for_s": 3600, "reason": "being mended"})).await;
    tell("POST", "notes", &json!({"by": "Ben", "text": " "})).await.problem(422);
    let noted = tell("POST", "notes", &json!({"by": "Ben", "text": "a wheel is loose"})).await.json();
    assert_eq!(noted["notes"][0]["text"], "a wheel is loose");
    server.stop().await.unwrap();

    let server = start_where_robots_fail(&folder).await;
    let kept = get(server.address(), "/v1/alarms?state=any").await.json()["items"].clone();
    let same = kept.as_array().unwrap().iter().find(|a| a["id"] == id).expect("it outlasts a restart");
    assert_eq!((&same["shelved"]["reason"], &same["notes"]), (&json!("being mended"), &noted["notes"]));
    server.stop().await.unwrap();
}
