//! Deliveries to several stations, and jobs that operators give to other robots, over HTTP.

use crate::helper::{Answer, Folder, SCENARIO, config, eventually, get, post, send};
use giveway::server::{ServedFloor, Server};
use giveway::sim::Scenario;
use giveway::warehouse::formats;
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::sync::Arc;

const JSON: (&str, &str) = ("content-type", "application/json");

/// A server with quick robots in the hall of the thesis, which has two stations.
async fn two_stations(folder: &Folder) -> Server {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/maps/thesis.json")).unwrap();
    let map = formats::json::parse(&text).unwrap();
    let scenario = Scenario::parse(&std::fs::read_to_string(SCENARIO).unwrap()).unwrap();
    let floor = ServedFloor::new(scenario, Arc::new(map));
    Server::start(&config(folder), floor).await.unwrap()
}

async fn job(at: SocketAddr, id: &Value) -> Value {
    get(at, &format!("/v1/jobs/{}", id.as_str().unwrap())).await.json()
}

async fn until(at: SocketAddr, id: &Value, what: &str, so: impl Fn(&Value) -> bool) -> Value {
    eventually(what, async || Some(job(at, id).await).filter(&so)).await
}

async fn reassign(at: SocketAddr, id: &Value, to: Value) -> Answer {
    let path = format!("/v1/jobs/{}/reassign", id.as_str().unwrap());
    send(at, "POST", &path, &[JSON], &to.to_string()).await.unwrap()
}

/// How many racks all stations have served.
async fn picks(at: SocketAddr) -> u64 {
    let stations = get(at, "/v1/stations").await.json();
    stations["items"].as_array().unwrap().iter().map(|s| s["served"].as_u64().unwrap()).sum()
}

fn served(job: &Value) -> usize {
    job["stops"].as_array().unwrap().iter().filter(|s| !s["served"].is_null()).count()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_rack_goes_to_all_its_stations_also_over_a_restart_between_them() {
    let folder = Folder::new();
    let server = two_stations(&folder).await;
    let at = server.address();
    let stops =
        json!([{"station": "W", "pick_s": 1}, {"station": "E", "pick_s": 1}, {"station": "W", "pick_s": 2}]);
    let wanted = json!({"kind": "deliver", "rack": "K1", "stops": stops});
    let made = post(at, Some("k"), &wanted).await.unwrap();
    assert_eq!(made.status, 201, "{}", made.text);
    let made = made.json();
    assert_eq!((&made["station"], served(&made)), (&json!("W"), 0));
    until(at, &made["id"], "the first station has served it", |j| served(j) == 1).await;
    assert_eq!(post(at, Some("k"), &wanted).await.unwrap().status, 200, "the key still means this job");
    server.stop().await.unwrap();

    let server = two_stations(&folder).await;
    let at = server.address();
    let between = job(at, &made["id"]).await;
    assert!(served(&between) >= 1, "{between}");
    let done = until(at, &made["id"], "it is done", |j| j["state"] == "done").await;
    assert_eq!((served(&done), &done["station"]), (3, &json!("W")));
    assert_eq!(post(at, Some("k"), &wanted).await.unwrap().status, 200);
    let other = json!({"kind": "deliver", "rack": "K1", "station": "W", "pick_s": 1});
    assert_eq!(post(at, Some("k"), &other).await.unwrap().problem(422)["type"], "/problems/key-reused");
    // What stations show is of the last step, which a job that is over may be ahead of.
    eventually("each station counts", async || (picks(at).await == 3).then_some(())).await;
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn stops_that_cannot_be_are_refused_and_say_which() {
    let folder = Folder::new();
    let server = two_stations(&folder).await;
    let at = server.address();
    let many: Vec<Value> = (0..17).map(|i| json!({"station": if i % 2 == 0 { "W" } else { "E" }})).collect();
    for (stops, field) in [
        (json!([]), "stops"),
        (json!(many), "stops"),
        (json!([{"station": "W"}, {"station": "W"}]), "stops[1].station"),
        (json!([{"station": "W"}, {"station": "Nowhere"}]), "stops[1].station"),
        (json!([{"station": "W", "pick_s": 4000}]), "stops[0].pick_s"),
    ] {
        let wanted = json!({"kind": "deliver", "rack": "K1", "stops": stops});
        let problem = post(at, None, &wanted).await.unwrap().problem(422);
        let fields: Vec<&str> =
            problem["errors"].as_array().unwrap().iter().map(|e| e["field"].as_str().unwrap()).collect();
        assert!(fields.contains(&field), "{stops}: {problem}");
    }
    let both = json!({"kind": "deliver", "rack": "K1", "station": "W", "stops": [{"station": "E"}]});
    assert_eq!(post(at, None, &both).await.unwrap().problem(422)["errors"][0]["field"], "station");
    let put = json!({"kind": "return", "rack": "K1", "stops": [{"station": "E"}]});
    assert_eq!(post(at, None, &put).await.unwrap().problem(422)["errors"][0]["field"], "stops");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_is_given_to_the_robot_that_an_operator_names() {
    let folder = Folder::new();
    let server = two_stations(&folder).await;
    let at = server.address();
    let slow = json!({"kind": "deliver", "rack": "K1", "station": "W", "pick_s": 3600});
    let first = post(at, None, &slow).await.unwrap().json();
    let first = until(at, &first["id"], "somebody picks", |j| j["state"] == "picking").await;
    assert_eq!(
        reassign(at, &first["id"], json!({})).await.problem(409)["type"],
        "/problems/job-cannot-be-taken"
    );
    let wanted = json!({"kind": "deliver", "rack": "K2", "station": "E", "pick_s": 1});
    let second = post(at, None, &wanted).await.unwrap().json();
    let given = reassign(at, &second["id"], json!({"robot": first["robot"]})).await.json();
    assert_eq!((&given["only"], &given["state"]), (&first["robot"], &json!("waiting")));
    assert!(given["why"]["text"].as_str().unwrap().contains(first["robot"].as_str().unwrap()), "{given}");
    send(at, "POST", "/v1/stations/W/done", &[JSON], "{}").await.unwrap();
    let done = until(at, &second["id"], "it is done", |j| j["state"] == "done").await;
    assert_eq!((&done["robot"], &done["only"]), (&first["robot"], &Value::Null));
    let unknown = reassign(at, &second["id"], json!({"robot": "robot-99"})).await.problem(422);
    assert_eq!(unknown["errors"][0]["field"], "robot");
    assert_eq!(reassign(at, &second["id"], json!({})).await.problem(409)["type"], "/problems/job-is-over");
    reassign(at, &json!("j999"), json!({})).await.problem(404);
    server.stop().await.unwrap();
}
