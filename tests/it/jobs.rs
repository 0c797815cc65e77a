//! Jobs over HTTP as customers mean them: what they call them, many at once, and changed before a robot has them.

use crate::helper::{Answer, Folder, delivery, eventually, get, map, post, send, start};
use serde_json::{Value, json};
use std::net::SocketAddr;

const JSON: (&str, &str) = ("content-type", "application/json");

async fn batch(at: SocketAddr, key: Option<&str>, rows: &[Value]) -> Answer {
    let mut headers = vec![JSON];
    headers.extend(key.map(|key| ("idempotency-key", key)));
    send(at, "POST", "/v1/jobs:batch", &headers, &json!({"jobs": rows}).to_string()).await.unwrap()
}

async fn patch(at: SocketAddr, id: &str, change: &Value) -> Answer {
    send(at, "PATCH", &format!("/v1/jobs/{id}"), &[JSON], &change.to_string()).await.unwrap()
}

async fn ids(at: SocketAddr, query: &str) -> Vec<String> {
    let page = get(at, &format!("/v1/jobs?{query}")).await.json();
    page["items"].as_array().unwrap().iter().map(|j| j["id"].as_str().unwrap().to_owned()).collect()
}

fn with(mut job: Value, key: &str, value: Value) -> Value {
    job[key] = value;
    job
}

/// A job that waits for ever: until one that comes later is over.
async fn waiting(at: SocketAddr, rack: usize) -> String {
    let first = post(at, None, &with(delivery(0), "pick_s", json!(3600))).await.unwrap().json();
    let follower = with(delivery(rack), "after", json!([first["id"]]));
    post(at, None, &follower).await.unwrap().json()["id"].as_str().unwrap().to_owned()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_is_found_by_its_reference_and_its_labels_even_after_a_restart() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let named = with(delivery(0), "reference", json!("order 4711 äöü"));
    let named = with(named, "labels", json!({"wave": "7", "customer": "north: east"}));
    let made = post(at, Some("k"), &named).await.unwrap().json();
    assert_eq!((&made["reference"], &made["labels"]), (&named["reference"], &named["labels"]));
    let other = with(delivery(1), "labels", json!({"wave": "8"}));
    post(at, None, &other).await.unwrap();
    assert_eq!(post(at, Some("k"), &named).await.unwrap().status, 200, "the same job");
    let renamed = with(named.clone(), "reference", json!("order 4712"));
    assert_eq!(post(at, Some("k"), &renamed).await.unwrap().problem(422)["type"], "/problems/key-reused");
    server.stop().await.unwrap();

    let server = start(&folder).await;
    let at = server.address();
    let id = made["id"].as_str().unwrap();
    assert_eq!(get(at, &format!("/v1/jobs/{id}")).await.json()["labels"], named["labels"]);
    for query in ["reference=order+4711+%C3%A4%C3%B6%C3%BC", "label=wave:7", "label=customer:north:+east"] {
        assert_eq!(ids(at, query).await, [id], "{query}");
    }
    assert_eq!(ids(at, "label=wave:7&reference=order+4712").await, [""; 0]);
    assert_eq!(ids(at, "label=wave:9").await, [""; 0]);
    get(at, "/v1/jobs?label=wave").await.problem(422);
    let seventeen: serde_json::Map<String, Value> = (0..17).map(|i| (format!("k{i}"), json!("v"))).collect();
    for (key, value) in [
        ("reference", json!("")),
        ("reference", json!("x".repeat(201))),
        ("reference", json!("two\nlines")),
        ("labels", json!({"": "v"})),
        ("labels", json!({"a key": "v"})),
        ("labels", json!({"k": "x".repeat(101)})),
        ("labels", json!(seventeen)),
    ] {
        let problem = post(at, None, &with(delivery(2), key, value)).await.unwrap().problem(422);
        assert!(problem["errors"][0]["field"].as_str().unwrap().starts_with(key), "{problem}");
    }
    assert_eq!(
        post(at, None, &with(delivery(2), "reference", json!("x".repeat(200)))).await.unwrap().status,
        201
    );
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn each_row_of_a_batch_is_accepted_or_refused_for_itself_and_a_retry_makes_nothing_new() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let rows = [
        json!({"key": "line-1", "job": delivery(0)}),
        json!({"job": delivery(1)}),
        json!({"job": {"kind": "deliver", "rack": "nope"}}),
        json!({"job": {"kind": "fly"}}),
        json!({"key": "line-1", "job": delivery(2)}),
        json!({"job": with(delivery(3), "deadline", json!("2001-01-01T00:00:00Z"))}),
    ];
    let told = batch(at, Some("file-1"), &rows).await.json();
    assert_eq!((told["accepted"].clone(), told["refused"].clone()), (json!(2), json!(4)), "{told}");
    let results = told["results"].as_array().unwrap();
    assert_eq!((&results[0]["id"], &results[0]["new"]), (&json!("j1"), &json!(true)));
    assert_eq!((&results[1]["id"], &results[1]["problem"]), (&json!("j2"), &Value::Null));
    let fields = |i: usize| -> Vec<&str> {
        let errors = results[i]["problem"]["errors"].as_array().unwrap();
        errors.iter().map(|e| e["field"].as_str().unwrap()).collect()
    };
    assert_eq!((fields(2), fields(5)), (vec!["rack", "station"], vec!["deadline"]));
    assert!(results[3]["problem"]["detail"].as_str().unwrap().contains("fly"), "{told}");
    assert_eq!(results[4]["problem"]["type"], "/problems/key-reused");
    let again = batch(at, Some("file-1"), &rows).await.json();
    assert_eq!(again["results"][1], json!({"id": "j2", "new": false, "problem": null}));
    assert_eq!(
        post(at, Some("line-1"), &delivery(0)).await.unwrap().status,
        200,
        "keys are those of single jobs"
    );
    assert_eq!(ids(at, "limit=500").await.len(), 2);

    let many: Vec<Value> = (0..1000).map(|i| json!({"job": delivery(i)})).collect();
    let told = batch(at, Some("file-2"), &many).await.json();
    assert_eq!(told["accepted"], 1000);
    let told = batch(at, Some("file-2"), &many).await.json();
    assert!(
        told["results"].as_array().unwrap().iter().all(|r| r["new"] == false),
        "a retry makes nothing new"
    );
    let too_many: Vec<Value> = (0..1001).map(|_| json!({})).collect();
    batch(at, None, &too_many).await.problem(422);
    batch(at, None, &[]).await.problem(422);
    batch(at, Some(&"k".repeat(201)), &rows).await.problem(400);
    let huge = json!({"job": with(delivery(0), "reference", json!("x".repeat(1 << 20)))});
    batch(at, None, &[huge]).await.problem(413);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_that_waits_is_changed_and_one_that_a_robot_has_is_not() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let id = waiting(at, 1).await;
    let station = map().stations.iter().last().unwrap().name.clone();
    let change = json!({"deadline": "2031-01-31T13:00:00+01:00", "station": station, "priority": 7});
    let told = patch(at, &id, &change).await.json();
    assert_eq!((&told["deadline"], &told["priority"]), (&json!("2031-01-31T12:00:00Z"), &json!(7)), "{told}");
    assert_eq!(told["station"], json!(station));
    assert_eq!(patch(at, &id, &json!({"deadline": null})).await.json()["deadline"], Value::Null);
    assert_eq!(patch(at, &id, &json!({})).await.json()["priority"], 7, "what is left out stays");
    for (change, field) in [
        (json!({"deadline": "2001-01-01T00:00:00Z"}), "deadline"),
        (json!({"deadline": "soon"}), "deadline"),
        (json!({"station": "nope"}), "station"),
        (json!({"robot": "robot-1"}), "robot"),
        (json!({"robot": "nope"}), "robot"),
        (json!({"priority": 10}), "priority"),
    ] {
        let problem = patch(at, &id, &change).await.problem(422);
        assert_eq!(problem["errors"][0]["field"], field, "{problem}");
    }
    patch(at, &id, &json!({"rack": "K1"})).await.problem(422);
    patch(at, "j99", &json!({"priority": 1})).await.problem(404);
    let change = json!({"priority": 1});
    let is_refused = async || Some(patch(at, "j1", &change).await).filter(|answer| answer.status == 409);
    let problem = eventually("a robot has j1", is_refused).await.problem(409);
    assert!(problem["detail"].as_str().unwrap().contains("cancel it and submit another"), "{problem}");
    server.stop().await.unwrap();

    let server = start(&folder).await;
    let kept = get(server.address(), &format!("/v1/jobs/{id}")).await.json();
    assert_eq!((&kept["station"], &kept["priority"]), (&json!(station), &json!(7)), "it is durable");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_repeated_submission_is_the_same_job_also_after_it_was_changed() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let first = post(at, None, &with(delivery(0), "pick_s", json!(3600))).await.unwrap().json();
    let job = with(delivery(1), "after", json!([first["id"]]));
    let id = post(at, Some("order-1"), &job).await.unwrap().json()["id"].as_str().unwrap().to_owned();
    let station = map().stations.iter().last().unwrap().name.clone();
    patch(at, &id, &json!({"deadline": "2031-01-31T12:00:00Z", "station": station})).await.json();
    let again = post(at, Some("order-1"), &job).await.unwrap();
    assert_eq!((again.status, again.json()["id"].as_str()), (200, Some(id.as_str())));
    let other = with(delivery(2), "after", json!([first["id"]]));
    post(at, Some("order-1"), &other).await.unwrap().problem(422);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_says_when_it_came_to_each_state_and_none_is_due_before_now() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let past = with(delivery(0), "deadline", json!("2001-01-01T00:00:00Z"));
    let problem = post(at, None, &past).await.unwrap().problem(422);
    assert_eq!(problem["errors"][0]["field"], "deadline");
    let made = post(at, None, &with(delivery(0), "pick_s", json!(0.1))).await.unwrap().json();
    assert_eq!(made["times"]["accepted"], made["created"]);
    let path = format!("/v1/jobs/{}", made["id"].as_str().unwrap());
    let is_done = async || Some(get(at, &path).await.json()).filter(|job| job["state"] == "done");
    let job = eventually("the job is done", is_done).await;
    let names = ["accepted", "assigned", "lifted", "at_station", "ended"];
    let times: Vec<&str> = names.iter().map(|n| job["times"][n].as_str().unwrap_or("")).collect();
    assert!(times.iter().all(|t| !t.is_empty()) && times.is_sorted(), "{job}");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_list_of_jobs_is_limited_by_states_rack_station_robot_and_time() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let first = post(at, None, &delivery(0)).await.unwrap().json();
    let second = post(at, None, &delivery(1)).await.unwrap().json();
    let cancelled = format!("/v1/jobs/{}", second["id"].as_str().unwrap());
    send(at, "DELETE", &cancelled, &[], "").await.unwrap();
    let ids = async |query: &str| -> Vec<String> {
        let page = get(at, &format!("/v1/jobs?{query}")).await.json();
        page["items"].as_array().unwrap().iter().map(|job| job["id"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(ids("state=waiting,assigned,carrying,picking,done").await, ["j1"]);
    assert_eq!(ids("state=cancelled,failed").await, ["j2"]);
    assert_eq!(ids(&format!("rack={}", first["rack"].as_str().unwrap())).await, ["j1"]);
    assert_eq!(ids(&format!("station={}", first["station"].as_str().unwrap())).await, ["j2", "j1"]);
    let changed = get(at, &cancelled).await.json()["updated"].as_str().unwrap().to_owned();
    assert!(ids(&format!("updated_since={changed}")).await.contains(&"j2".to_owned()));
    assert_eq!(ids(&format!("to={}", first["created"].as_str().unwrap())).await, [""; 0]);
    assert_eq!(ids(&format!("from={}", first["created"].as_str().unwrap())).await, ["j2", "j1"]);
    // Robots have names once the first picture of the floor is there.
    crate::tokens::until_robots(at, "").await;
    let are_served = async || {
        let served = [ids("robot=robot-1").await, ids("robot=robot-2").await].concat();
        (!served.is_empty()).then_some(served)
    };
    let served = eventually("a robot has a job", are_served).await;
    assert!(served.contains(&"j1".to_owned()), "one robot has it: {served:?}");
    for wrong in ["state=waiting,lost", "rack=K99", "station=S9", "robot=r2d2", "from=now", "updated_since=1"]
    {
        get(at, &format!("/v1/jobs?{wrong}")).await.problem(422);
    }
    server.stop().await.unwrap();
}
