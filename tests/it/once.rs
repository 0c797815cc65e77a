//! Requests with an `Idempotency-Key` that make something besides jobs and assignments.

use crate::helper::{Answer, Folder, delivery, eventually, get, map, send, start};
use crate::tokens::{ADMIN, make, start_closed, until_robots};
use serde_json::json;
use std::net::SocketAddr;

async fn keyed(at: SocketAddr, path: &str, key: &str, body: &serde_json::Value) -> Answer {
    let headers = [("content-type", "application/json"), ("idempotency-key", key)];
    send(at, "POST", path, &headers, &body.to_string()).await.unwrap()
}

fn area(x: f64) -> serde_json::Value {
    json!({"outline": [[x, 1.0], [x + 1.0, 1.0], [x + 1.0, 2.0]], "reason": "a spill"})
}

#[tokio::test]
async fn a_repeat_with_the_same_key_closes_nothing_a_second_time_also_over_a_restart() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let first = keyed(at, "/v1/closures", "spill-1", &area(1.0)).await;
    assert_eq!(first.status, 201, "{}", first.text);
    assert_eq!(first.header("idempotency-replayed"), None);
    let again = keyed(at, "/v1/closures", "spill-1", &area(1.0)).await;
    assert_eq!((again.status, &again.text), (201, &first.text));
    assert_eq!(again.header("location"), first.header("location"));
    assert_eq!(again.header("idempotency-replayed"), Some("true"));
    let other = keyed(at, "/v1/closures", "spill-1", &area(3.0)).await;
    assert_eq!((other.status, &*other.json()["type"].to_string()), (422, "\"/problems/key-reused\""));
    server.stop().await.unwrap();

    let server = start(&folder).await;
    let at = server.address();
    let again = keyed(at, "/v1/closures", "spill-1", &area(1.0)).await;
    assert_eq!((again.status, &again.text), (201, &first.text));
    assert_eq!(keyed(at, "/v1/closures", "spill-2", &area(1.0)).await.status, 201);
    // The list is of a view, which is a step behind.
    let are_listed = async || {
        let closed = get(at, "/v1/closures").await.json()["items"].as_array().unwrap().len();
        (closed > 1).then_some(closed)
    };
    assert_eq!(eventually("both closures are listed", are_listed).await, 2);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn the_same_key_of_two_callers_is_two_keys_on_every_route_also_over_a_restart() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    until_robots(at, ADMIN).await;
    let mut tokens = Vec::new();
    for name in ["wms", "mes"] {
        tokens.push(make(at, name, "integrator", None).await["token"].as_str().unwrap().to_owned());
    }
    let ask = async |at, token: &str, path: &str, body: &serde_json::Value| {
        let bearer = format!("Bearer {token}");
        let headers =
            [("content-type", "application/json"), ("idempotency-key", "4711"), ("authorization", &*bearer)];
        send(at, "POST", path, &headers, &body.to_string()).await.unwrap()
    };
    let place =
        map().nodes.iter().find(|n| n.kind == giveway::warehouse::NodeKind::Aisle).unwrap().name.clone();
    let assignment = json!({"place": place, "stay_s": 5, "what": "count"});
    let batch = json!({"jobs": [{"job": delivery(1)}, {"key": "mine", "job": delivery(2)}]});
    let routes = [("/v1/jobs", delivery(0)), ("/v1/assignments", assignment), ("/v1/jobs:batch", batch)];
    let ids = |answer: &Answer| {
        let json = answer.json();
        let of_batch = json["results"].as_array().into_iter().flatten().map(|r| r["id"].clone());
        of_batch.chain(json.get("id").cloned()).map(|id| id.as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    let mut made = Vec::new();
    for (path, body) in &routes {
        let [wms, mes] = [ask(at, &tokens[0], path, body).await, ask(at, &tokens[1], path, body).await];
        assert_eq!(wms.status, mes.status, "both are new: {wms:?} {mes:?}");
        assert!(ids(&wms).iter().all(|id| !ids(&mes).contains(id)), "{path}: {wms:?} {mes:?}");
        // What another caller has used says nothing of what this one may.
        let other = if *path == "/v1/jobs" { delivery(3) } else { body.clone() };
        let status = ask(at, ADMIN, path, &other).await.status;
        assert_eq!(status, wms.status, "{path}");
        made.push((ids(&wms), ids(&mes)));
    }
    server.stop().await.unwrap();
    let server = start_closed(&folder).await;
    let at = server.address();
    for ((path, body), (wms, mes)) in routes.iter().zip(&made) {
        for (token, known) in tokens.iter().zip([wms, mes]) {
            let again = ask(at, token, path, body).await;
            assert_eq!((again.status, &ids(&again)), (200, known), "{path}: a retry makes nothing");
        }
    }
    server.stop().await.unwrap();
}

#[tokio::test]
async fn what_was_refused_may_be_tried_again_with_the_same_key() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    assert_eq!(keyed(at, "/v1/closures", "k", &json!({"outline": [[0.0, 0.0]]})).await.status, 422);
    assert_eq!(keyed(at, "/v1/closures", "k", &area(1.0)).await.status, 201);
    assert_eq!(keyed(at, "/v1/closures", "", &area(1.0)).await.status, 400);
    server.stop().await.unwrap();
}

#[tokio::test]
async fn two_at_the_same_time_with_one_key_make_one() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let hook = json!({"url": "http://127.0.0.1:9/nobody", "kinds": ["job"]});
    let (a, b) = tokio::join!(keyed(at, "/v1/webhooks", "k", &hook), keyed(at, "/v1/webhooks", "k", &hook));
    let mut statuses = [a.status, b.status];
    statuses.sort_unstable();
    assert!(statuses == [201, 409] || statuses == [201, 201], "{} {}", a.text, b.text);
    let hooks = get(at, "/v1/webhooks").await.json();
    assert_eq!(hooks.as_array().unwrap().len(), 1, "{hooks}");
    assert_eq!(keyed(at, "/v1/webhooks", "k", &hook).await.status, 201);
    server.stop().await.unwrap();
}

#[tokio::test]
async fn a_key_whose_request_had_begun_when_the_server_ended_is_told_that_nobody_knows() {
    let folder = Folder::new();
    let server = start(&folder).await;
    assert_eq!(keyed(server.address(), "/v1/closures", "k", &area(1.0)).await.status, 201);
    server.stop().await.unwrap();
    // As a server leaves it that is killed before its answer is kept.
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(folder.database());
    let database = sqlx::SqlitePool::connect_with(options).await.unwrap();
    sqlx::query("UPDATE answers SET status = NULL, location = NULL, body = NULL")
        .execute(&database)
        .await
        .unwrap();
    database.close().await;
    let server = start(&folder).await;
    let answer = keyed(server.address(), "/v1/closures", "k", &area(1.0)).await;
    assert_eq!((answer.status, &*answer.json()["type"].to_string()), (409, "\"/problems/outcome-unknown\""));
    server.stop().await.unwrap();
}
