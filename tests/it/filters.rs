//! Filters of lists: each finds what it says, several words find each of them, and a wrong value is named.

use crate::helper::{Folder, eventually, get, map, send, start};
use serde_json::{Value, json};
use std::net::SocketAddr;

async fn post(at: SocketAddr, path: &str, body: &Value) -> Value {
    let headers = [("content-type", "application/json")];
    let answer = send(at, "POST", path, &headers, &body.to_string()).await.unwrap();
    assert!(answer.status < 300, "{answer:?}");
    if answer.text.is_empty() { Value::Null } else { answer.json() }
}

/// The ids in a list.
async fn ids(at: SocketAddr, path: &str) -> Vec<String> {
    let answer = get(at, path).await;
    assert_eq!(answer.status, 200, "{path}: {answer:?}");
    let items = answer.json()["items"].as_array().unwrap().clone();
    items.iter().map(|item| item["id"].as_str().unwrap().to_owned()).collect()
}

/// Waits until a list has these.
async fn until(at: SocketAddr, path: &str, wanted: &[&str]) {
    let has_these = async || (ids(at, path).await == wanted).then_some(());
    eventually(&format!("{path} has {wanted:?}"), has_these).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn robots_stations_and_workers_are_found_by_what_they_are_at() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let all = ["robot-1", "robot-2"];
    until(at, "/v1/robots?activity=idle,charging&state=idle,busy", &all).await;
    post(at, "/v1/robots/robot-2/pause", &json!({})).await;
    until(at, "/v1/robots?activity=paused", &["robot-2"]).await;
    until(at, "/v1/robots?activity=paused,idle,charging&kind=robot", &all).await;
    assert_eq!(ids(at, "/v1/robots?updated_since=2020-01-01T00:00:00Z").await, all);
    assert_eq!(ids(at, "/v1/robots?updated_since=2099-01-01T00:00:00Z").await, [""; 0]);

    let station = map().stations.iter().next().unwrap().name.clone();
    post(at, &format!("/v1/stations/{station}/pause"), &json!({})).await;
    until(at, "/v1/stations?paused=true", &[&station]).await;
    assert_eq!(ids(at, "/v1/stations?paused=true&picking=true").await, [""; 0]);
    assert!(!ids(at, "/v1/stations?paused=false").await.contains(&station));
    assert_eq!(ids(at, "/v1/stations?robot=robot-1").await, [""; 0]);

    for name in ["anna", "ben"] {
        post(at, "/v1/workers", &json!({ "name": name })).await;
    }
    until(at, "/v1/workers?presence=absent,lost&state=idle", &["w1", "w2"]).await;
    assert_eq!(ids(at, "/v1/workers?presence=tracked").await, [""; 0]);
    assert_eq!(ids(at, "/v1/workers?updated_since=2020-01-01T00:00:00Z").await, [""; 0], "nobody was seen");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn closures_and_assignments_are_found_by_state_time_and_place() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let corner = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
    post(at, "/v1/closures", &json!({"outline": corner, "reason": "oil", "binds": "people"})).await;
    let later = json!({"outline": corner, "reason": "later", "from": "2098-01-01T00:00:00Z"});
    post(at, "/v1/closures", &later).await;
    until(at, "/v1/closures", &["c1", "c2"]).await;
    for (query, found) in [
        ("state=closed", vec!["c1"]),
        ("state=closed,announced", vec!["c1", "c2"]),
        ("state=over", vec![]),
        ("binds=people", vec!["c1"]),
        ("to=2097-01-01T00:00:00Z", vec!["c1"]),
        ("from=2097-01-01T00:00:00Z", vec!["c1", "c2"]),
    ] {
        assert_eq!(ids(at, &format!("/v1/closures?{query}")).await, found, "{query}");
    }

    let map = map();
    let here = map.nodes[map.stations.iter().next().unwrap().node].name.clone();
    for _ in 0..3 {
        post(at, "/v1/assignments", &json!({ "place": here })).await;
    }
    assert_eq!(send(at, "DELETE", "/v1/assignments/a2", &[], "").await.unwrap().status, 200);
    for (query, found) in [
        ("state=waiting", vec!["a3", "a1"]),
        ("state=waiting,cancelled", vec!["a3", "a2", "a1"]),
        ("state=done", vec![]),
        ("updated_since=2099-01-01T00:00:00Z", vec![]),
        ("updated_since=2020-01-01T00:00:00Z&limit=2", vec!["a3", "a2"]),
        ("from=2020-01-01T00:00:00Z&to=2099-01-01T00:00:00Z", vec!["a3", "a2", "a1"]),
        ("to=2020-01-01T00:00:00Z", vec![]),
    ] {
        assert_eq!(ids(at, &format!("/v1/assignments?{query}")).await, found, "{query}");
    }
    assert_eq!(ids(at, &format!("/v1/assignments?place={here}")).await.len(), 3);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_wrong_value_is_refused_with_the_name_of_its_parameter() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    for (list, parameters) in [
        ("robots", &["activity", "state", "kind", "updated_since"][..]),
        ("stations", &["robot"]),
        ("workers", &["presence", "state", "updated_since"]),
        ("closures", &["state", "binds", "from", "to"]),
        ("assignments", &["state", "place", "updated_since", "from", "to"]),
        ("encounters", &["robot", "worker", "reaction", "updated_since", "from", "to"]),
        ("jobs", &["state", "rack", "station", "robot", "updated_since", "from", "to"]),
    ] {
        for parameter in parameters {
            let problem = get(at, &format!("/v1/{list}?{parameter}=no-such-thing")).await.problem(422);
            assert_eq!(problem["errors"][0]["field"], *parameter, "{list}: {problem}");
        }
        let unknown = get(at, &format!("/v1/{list}?no_such_parameter=1")).await.problem(400);
        assert!(unknown["detail"].as_str().unwrap().contains("no_such_parameter"), "{unknown}");
    }
    get(at, "/v1/stations?paused=perhaps").await.problem(400);
    let both = get(at, "/v1/robots?activity=idle,dancing&state=none").await.problem(422);
    assert_eq!(both["errors"].as_array().unwrap().len(), 2, "all that is wrong at once: {both}");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn jobs_are_found_by_any_part_of_their_reference_newest_first_and_page_by_page() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    until(at, "/v1/robots", &["robot-1", "robot-2"]).await;
    for reference in ["Order-4711/a", "order-4712", "50% \"off\" 4711", "wave 9"] {
        let job = json!({"kind": "charge", "robot": "robot-1", "reference": reference});
        post(at, "/v1/jobs", &job).await;
    }
    post(at, "/v1/jobs", &json!({"kind": "charge", "robot": "robot-1"})).await;
    for (part, found) in [
        ("471", vec!["j3", "j2", "j1"]),
        ("4711", vec!["j3", "j1"]),
        ("ORDER-4", vec!["j2", "j1"]),
        ("%22off%22", vec!["j3"]),
        ("50%25", vec!["j3"]),
        ("ve%209", vec!["j4"]),
        ("%2A%2A%2A", vec![]),
        ("4713", vec![]),
    ] {
        assert_eq!(ids(at, &format!("/v1/jobs?reference_part={part}")).await, found, "{part}");
    }
    assert_eq!(ids(at, "/v1/jobs?reference_part=471&state=cancelled").await, [""; 0]);
    let first = get(at, "/v1/jobs?reference_part=471&limit=2").await.json();
    let next = first["next"].as_str().expect("there is one more");
    assert_eq!(ids(at, &format!("/v1/jobs?reference_part=471&limit=2&cursor={next}")).await, ["j1"]);
    let short = get(at, "/v1/jobs?reference_part=47").await;
    assert_eq!(short.status, 422);
    assert_eq!(short.json()["errors"][0]["field"], "reference_part");
    server.stop().await.unwrap();
    let server = start(&folder).await;
    assert_eq!(ids(server.address(), "/v1/jobs?reference_part=4711").await, ["j3", "j1"]);
    server.stop().await.unwrap();
}
