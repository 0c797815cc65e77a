//! People over HTTP: workers, assignments, closed areas, positions of tags, encounters.

use crate::helper::{Answer, Folder, config, eventually, floor, get, map, send, start, start_in_real_time};
use giveway::server::{Config, Server};
use serde_json::{Value, json};
use std::net::SocketAddr;

const JSON: (&str, &str) = ("content-type", "application/json");

pub async fn post(at: SocketAddr, path: &str, body: &Value) -> Answer {
    send(at, "POST", path, &[JSON], &body.to_string()).await.unwrap()
}

pub async fn delete(at: SocketAddr, path: &str) -> Answer {
    send(at, "DELETE", path, &[], "").await.unwrap()
}

async fn hire(at: SocketAddr, name: &str) -> String {
    post(at, "/v1/workers", &json!({"name": name})).await.json()["id"].as_str().unwrap().to_owned()
}

/// A place where people can walk: beside a station.
fn place() -> String {
    let map = map();
    map.nodes[map.stations.iter().next().unwrap().node].name.clone()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_worker_is_known_once_and_after_a_restart() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let first = post(at, "/v1/workers", &json!({"name": "picker-7"})).await;
    assert_eq!((first.status, first.header("location")), (201, Some("/v1/workers/w1")), "{first:?}");
    let again = post(at, "/v1/workers", &json!({"name": " picker-7 "})).await;
    assert_eq!((again.status, again.json()["id"].clone()), (200, json!("w1")));
    assert_eq!(hire(at, "picker-8").await, "w2");
    for bad in ["", "  ", "line\nbreak", &"x".repeat(65)] {
        post(at, "/v1/workers", &json!({"name": bad})).await.problem(422);
    }
    assert_eq!(delete(at, "/v1/workers/w1").await.problem(405)["status"], 405);
    server.stop().await.unwrap();
    let server = start(&folder).await;
    let at = server.address();
    let list = get(at, "/v1/workers?limit=1").await.json();
    assert_eq!((list["items"][0]["name"].clone(), list["next"].clone()), (json!("picker-7"), json!("1")));
    let worker = get(at, "/v1/workers/w2").await.json();
    assert_eq!((worker["name"].clone(), worker["connected"].clone()), (json!("picker-8"), json!(false)));
    for unknown in ["w3", "w0", "picker-7", "w99999999999"] {
        let problem = get(at, &format!("/v1/workers/{unknown}")).await.problem(404);
        assert!(problem["detail"].as_str().unwrap().contains("GET /v1/workers"), "{problem}");
    }
    let ben = json!({"by": "Ben"});
    assert_eq!(post(at, "/v1/workers/w2/clear", &ben).await.status, 204);
    post(at, "/v1/workers/w9/clear", &ben).await.problem(404);
    for nobody in [json!({"by": " "}), json!({}), json!({"by": "x".repeat(81)})] {
        post(at, "/v1/workers/w2/clear", &nobody).await.problem(422);
    }
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn an_assignment_is_durable_made_once_and_cancelled_once() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let worker = hire(at, "anna").await;
    let path = format!("/v1/workers/{worker}/assignments");
    let wanted = json!({"place": place(), "stay_s": 12.5, "what": "count K1"});
    let key = ("idempotency-key", "shift-1-line-1");
    let first = send(at, "POST", &path, &[JSON, key], &wanted.to_string()).await.unwrap();
    assert_eq!((first.status, first.header("location")), (201, Some("/v1/assignments/a1")), "{first:?}");
    let made = first.json();
    assert_eq!((made["stay_s"].clone(), made["worker"].clone()), (json!(12.5), json!("w1")));
    let again = send(at, "POST", &path, &[JSON, key], &wanted.to_string()).await.unwrap();
    assert_eq!((again.status, again.json()["id"].clone()), (200, json!("a1")));
    let other = json!({"place": place(), "what": "something else"});
    let problem = send(at, "POST", &path, &[JSON, key], &other.to_string()).await.unwrap().problem(422);
    assert_eq!(problem["type"], "/problems/key-reused");
    assert_eq!(post(at, &path, &other).await.json()["id"], "a2");
    for (bad, field) in [
        (json!({"place": "nowhere"}), "place"),
        (json!({"place": place(), "stay_s": -1}), "stay_s"),
        (json!({"place": place(), "stay_s": 1e9}), "stay_s"),
        (json!({"place": place(), "what": "x".repeat(501)}), "what"),
    ] {
        assert_eq!(post(at, &path, &bad).await.problem(422)["errors"][0]["field"], field);
    }
    post(at, "/v1/workers/w7/assignments", &wanted).await.problem(404);
    server.stop().await.unwrap();

    let server = start(&folder).await;
    let at = server.address();
    let listed = get(at, &path).await.json();
    let ids: Vec<&str> =
        listed["items"].as_array().unwrap().iter().map(|a| a["id"].as_str().unwrap()).collect();
    assert_eq!(ids, ["a2", "a1"], "newest first");
    assert_eq!(get(at, "/v1/assignments?limit=1").await.json()["next"], "a2");
    assert_eq!(get(at, "/v1/assignments?limit=1&cursor=a2").await.json()["items"][0]["id"], "a1");
    let gone = delete(at, "/v1/assignments/a2").await;
    assert_eq!((gone.status, gone.json()["state"].clone()), (200, json!("cancelled")));
    assert_eq!(delete(at, "/v1/assignments/a2").await.problem(409)["type"], "/problems/assignment-is-over");
    delete(at, "/v1/assignments/a99").await.problem(404);
    delete(at, "/v1/assignments/17").await.problem(404);
    let cancelled = get(at, "/v1/assignments?state=cancelled").await.json();
    assert_eq!(cancelled["items"].as_array().unwrap().len(), 1);
    get(at, "/v1/assignments?state=odd").await.problem(422);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn an_assignment_without_a_worker_waits_is_made_once_listed_and_cancelled() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    hire(at, "anna").await;
    let (path, wanted) = ("/v1/assignments", json!({"place": place(), "stay_s": 10, "what": "count K1"}));
    let key = ("idempotency-key", "shift-1-line-2");
    let first = send(at, "POST", path, &[JSON, key], &wanted.to_string()).await.unwrap();
    assert_eq!((first.status, first.header("location")), (201, Some("/v1/assignments/a1")), "{first:?}");
    assert_eq!(
        (first.json()["worker"].clone(), first.json()["state"].clone()),
        (json!(null), json!("waiting"))
    );
    let again = send(at, "POST", path, &[JSON, key], &wanted.to_string()).await.unwrap();
    assert_eq!((again.status, again.json()["id"].clone()), (200, json!("a1")));
    assert_eq!(
        post(at, path, &json!({"place": "nowhere"})).await.problem(422)["errors"][0]["field"],
        "place"
    );
    assert_eq!(post(at, path, &wanted).await.json()["id"], "a2");
    server.stop().await.unwrap();

    let server = start(&folder).await;
    let at = server.address();
    let listed = get(at, "/v1/assignments?state=waiting").await.json();
    assert_eq!(listed["items"][1]["worker"], json!(null), "{listed}");
    assert_eq!(get(at, "/v1/workers/w1/assignments").await.json()["items"], json!([]), "she has none");
    let early = post(at, "/v1/assignments/a1/done", &json!({})).await.problem(409);
    assert_eq!(early["type"], "/problems/assignment-waits");
    assert_eq!(delete(at, "/v1/assignments/a1").await.json()["state"], "cancelled");
    // Somebody comes in, and gets what waits.
    let map = map();
    let door = map.nodes[map.stations.iter().next().unwrap().node].at;
    assert_eq!(post(at, "/v1/workers/w1/position", &json!({"x": door.x, "y": door.y})).await.status, 202);
    let has_worker = async || {
        let worker = get(at, "/v1/assignments/a2").await.json()["worker"].clone();
        (!worker.is_null()).then_some(worker)
    };
    assert_eq!(eventually("somebody gets a2", has_worker).await, "w1");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn an_area_is_closed_and_opened_again() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let square = json!([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
    let made = post(at, "/v1/closures", &json!({"outline": square, "reason": "oil"})).await;
    assert_eq!((made.status, made.header("location")), (201, Some("/v1/closures/c1")), "{made:?}");
    assert_eq!((made.json()["outline"].clone(), made.json()["until"].clone()), (square.clone(), Value::Null));
    let node = place();
    let timed = json!({"nodes": [node], "from": "2031-01-01T00:00:00Z", "until": "2031-01-02T00:00:00Z",
        "reason": "repair"});
    let timed = post(at, "/v1/closures", &timed).await.json();
    assert_eq!(
        (timed["nodes"].clone(), timed["until"].clone()),
        (json!([node]), json!("2031-01-02T00:00:00Z"))
    );
    // R30, R31 and R32 are in a row: what lies between two named nodes stays open.
    let apart = post(at, "/v1/closures", &json!({"nodes": ["R30", "R32"], "reason": "posts"})).await.json();
    assert_eq!(apart["nodes"], json!(["R32", "R30"]));
    delete(at, &format!("/v1/closures/{}", apart["id"].as_str().unwrap())).await;
    for (bad, field) in [
        (json!({"reason": "x"}), "outline"),
        (json!({"outline": square, "nodes": [node], "reason": "x"}), "outline"),
        (json!({"outline": [[0, 0], [1, 1]], "reason": "x"}), "outline"),
        (json!({"outline": [[0, 0], [1, 1], [2, 2]], "reason": "x"}), "outline"),
        (json!({"outline": [[0, 0], [1e9, 1], [2, 2]], "reason": "x"}), "outline"),
        (json!({"nodes": ["nowhere"], "reason": "x"}), "nodes[0]"),
        (json!({"nodes": [], "reason": "x"}), "nodes"),
        (json!({"outline": square, "reason": " "}), "reason"),
        (json!({"outline": square, "from": "tomorrow", "reason": "x"}), "from"),
        (json!({"outline": square, "until": "2020-01-01T00:00:00Z", "reason": "x"}), "until"),
    ] {
        assert_eq!(post(at, "/v1/closures", &bad).await.problem(422)["errors"][0]["field"], field, "{bad}");
    }
    tokio::time::sleep(std::time::Duration::from_millis(300)).await;
    let listed = get(at, "/v1/closures").await.json();
    assert_eq!(listed["items"].as_array().unwrap().len(), 2, "{listed}");
    assert_eq!(get(at, "/v1/closures/c1").await.json()["reason"], "oil");
    assert_eq!(delete(at, "/v1/closures/c1").await.status, 204);
    assert_eq!(delete(at, "/v1/closures/c1").await.problem(404)["type"], "/problems/unknown-closure");
    delete(at, "/v1/closures/x").await.problem(404);
    server.stop().await.unwrap();
    let server = start(&folder).await;
    let left = get(server.address(), "/v1/closures").await.json();
    assert_eq!((left["items"].as_array().unwrap().len(), &left["items"][0]["id"]), (1, &json!("c2")));
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_closure_is_announced_then_closed_then_over_by_itself_and_known_after_a_restart() {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    let in_s = |s: i64| (jiff::Timestamp::now() + jiff::SignedDuration::from_secs(s)).to_string();
    let body = |from, until| json!({"nodes": [place()], "from": from, "until": until, "reason": "cleaning"});
    let day = post(at, "/v1/closures", &body(in_s(86_400), in_s(90_000))).await;
    assert_eq!((day.status, day.json()["state"].clone()), (201, json!("announced")));
    let now = json!({"nodes": [place()], "reason": "a spill"});
    assert_eq!(post(at, "/v1/closures", &now).await.json()["state"], "closed");
    let short = post(at, "/v1/closures", &body(in_s(4), in_s(8))).await.json();
    assert_eq!((short["id"].clone(), short["state"].clone()), (json!("c3"), json!("announced")));
    let mut states: Vec<Value> = Vec::new();
    let is_over = async || {
        let state = get(at, "/v1/closures/c3").await.json()["state"].clone();
        // Lists follow the fleet a few times a second: at first it may not be there.
        if !state.is_null() && states.last() != Some(&state) {
            states.push(state.clone());
        }
        (state == "over").then_some(())
    };
    eventually("the closure is over", is_over).await;
    assert_eq!(states, [json!("announced"), json!("closed"), json!("over")]);
    server.stop().await.unwrap();
    let server = start_in_real_time(&folder).await;
    let listed = get(server.address(), "/v1/closures").await.json();
    let states: Vec<&Value> = listed["items"].as_array().unwrap().iter().map(|c| &c["state"]).collect();
    assert_eq!(states, ["announced", "closed", "over"]);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn positions_of_tags_are_taken_one_by_one_or_many_at_once() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    hire(at, "anna").await;
    let path = "/v1/workers/w1/position";
    assert_eq!(post(at, path, &json!({"x": 1.5, "y": 2})).await.status, 202);
    assert_eq!(post(at, path, &json!({"x": 1.5, "y": 2, "accuracy_m": 0.2, "heading": 3})).await.status, 202);
    for (bad, field) in [
        (json!({"x": 1e9, "y": 0}), "x"),
        (json!({"x": 1, "y": 0, "accuracy_m": -1}), "accuracy_m"),
        (json!({"x": 1, "y": 0, "heading": 1e9}), "heading"),
        (json!({"x": 1, "y": 0, "at": "now"}), "at"),
        (json!({"x": 1, "y": 0, "at": "2099-01-01T00:00:00Z"}), "at"),
        (json!({"x": 1, "y": 0, "at": "2020-01-01T00:00:00Z"}), "at"),
    ] {
        let problem = post(at, path, &bad).await.problem(422);
        assert_eq!(problem["errors"][0]["field"], field, "{problem}");
    }
    post(at, "/v1/workers/w2/position", &json!({"x": 1, "y": 2})).await.problem(404);
    let many = json!({"positions": [
        {"worker": "w1", "x": 1, "y": 2}, {"worker": "w5", "x": 1, "y": 2}, {"worker": "w1", "x": 1e9, "y": 2},
    ]});
    let answer = post(at, "/v1/positions", &many).await.json();
    assert_eq!(
        (answer["taken"].clone(), answer["refused"][0]["field"].clone()),
        (json!(1), json!("positions[1]"))
    );
    assert_eq!(answer["refused"].as_array().unwrap().len(), 2, "{answer}");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn massrobotics_reports_are_taken_of_workers_only() {
    let folder = Folder::new();
    let uuid = "6948DF80-14BD-4E04-8842-7668D9C001F5";
    let interop = format!("{{\"workers\": {{\"{}\": \"anna\"}}}}", uuid.to_lowercase());
    let interop = serde_json::from_str(&interop).unwrap();
    let server = Server::start(&Config { massrobotics: interop, ..config(&folder) }, floor()).await.unwrap();
    let at = server.address();
    let now = format!("{}", jiff::Timestamp::now());
    let status = |uuid: &str, datum: &str| {
        json!({"uuid": uuid, "timestamp": now, "operationalState": "navigating", "location": {
            "x": 0.5, "y": 1, "angle": {"w": 1, "x": 0, "y": 0, "z": 0}, "planarDatum": datum}})
    };
    let early = post(at, "/v1/massrobotics", &status(uuid, "d")).await.problem(404);
    assert!(early["detail"].as_str().unwrap().contains("POST /v1/workers"), "{early}");
    hire(at, "anna").await;
    assert_eq!(post(at, "/v1/massrobotics", &status(uuid, "d")).await.status, 202);
    let identity = json!({"uuid": uuid, "timestamp": now, "manufacturerName": "M", "robotModel": "X"});
    assert_eq!(post(at, "/v1/massrobotics", &identity).await.status, 202);
    let other = "00000000-14bd-4e04-8842-7668d9c001f5";
    post(at, "/v1/massrobotics", &status(other, "d")).await.problem(404);
    hire(at, other).await;
    assert_eq!(post(at, "/v1/massrobotics", &status(other, "d")).await.status, 202, "its name is the uuid");
    let old = json!({"uuid": other, "timestamp": "2012-04-21T18:25:43-05:00", "location": {
        "x": 0.5, "y": 1, "angle": {"w": 1, "x": 0, "y": 0, "z": 0}, "planarDatum": "d"}});
    assert_eq!(post(at, "/v1/massrobotics", &old).await.problem(422)["errors"][0]["field"], "timestamp");
    get(at, "/v1/massrobotics").await.problem(426);
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn encounters_are_listed_filtered_and_exported() {
    let folder = Folder::new();
    {
        use giveway::fleet::{Encounter, EncounterFact, Fact, Reaction, WorkerFact};
        use giveway::geometry::Spot;
        use giveway::id::{RobotId, WorkerId};
        use giveway::store::{StepEntry, Store};
        use giveway::time::{Span, Time};
        let store = Store::open(&folder.database(), &map()).await.unwrap();
        let met = |i: i64| Encounter {
            worker: WorkerId((i % 2) as u32),
            robot: RobotId(0),
            began: Time(1_800_000_000_000_000 + i * 60_000_000),
            ended: Time(1_800_000_000_000_000 + i * 60_000_000 + 1_500_000),
            at: Spot { x_mm: 1250, y_mm: -500 },
            radius_mm: 1400,
            closest_mm: 900 + i,
            robot_mmps: 500,
            worker_mmps: 1200,
            reaction: Reaction::Stopped,
            delay: Span::from_millis(2500),
        };
        let worker = |i: u32, name: &str| {
            Fact::Worker(WorkerFact::Registered { worker: WorkerId(i), name: name.into(), at: Time(1) })
        };
        let facts = [worker(0, "anna"), worker(1, "ben")]
            .into_iter()
            .chain((0..5).map(|i| Fact::Encounter(EncounterFact::Met(met(i)))));
        let step = StepEntry { at: Time(1), facts: facts.collect(), causes: Vec::new() };
        store.append(1, &[step]).await.unwrap();
        store.close().await;
    }
    // Whenever this runs: the server does not forget who it was.
    let settings = Config { people_keep_days: 36_500, ..config(&folder) };
    let server = Server::start(&settings, floor()).await.unwrap();
    let at = server.address();
    let closest = async |query: &str| -> Vec<f64> {
        let page = get(at, &format!("/v1/encounters{query}")).await.json();
        page["items"].as_array().unwrap().iter().map(|e| e["closest"].as_f64().unwrap()).collect()
    };
    assert_eq!(closest("").await, [0.904, 0.903, 0.902, 0.901, 0.9], "newest first");
    assert_eq!(closest("?worker=w2").await, [0.903, 0.901]);
    assert_eq!(closest("?from=2027-01-15T08:02:00Z&to=2027-01-15T08:04:00Z").await, [0.903, 0.902]);
    let page = get(at, "/v1/encounters?limit=2").await.json();
    let next = page["next"].as_str().unwrap();
    assert_eq!(closest(&format!("?limit=2&cursor={next}")).await, [0.902, 0.901]);
    for bad in ["?from=x", "?worker=w9", "?robot=nobody", "?cursor=x", "?format=xml", "?limit=0"] {
        get(at, &format!("/v1/encounters{bad}")).await.problem(422);
    }
    let table = get(at, "/v1/encounters?format=csv&limit=3").await;
    assert_eq!(table.header("content-type"), Some("text/csv; charset=utf-8"));
    assert!(table.header("link").unwrap().contains("rel=\"next\""), "{table:?}");
    assert_eq!(table.text.lines().count(), 4);
    let accepted = send(at, "GET", "/v1/encounters", &[("accept", "text/csv")], "").await.unwrap();
    assert_eq!(accepted.text.lines().count(), 6);
    let last = accepted.text.lines().last().unwrap();
    assert!(last.ends_with(",1.5,1.25,-0.5,1,1.4,0.9,0.5,1.2,stopped,2.5"), "{last}");
    let text = get(at, "/metrics").await.text;
    assert!(text.contains("giveway_encounters 5"), "{text}");
    server.stop().await.unwrap();
}

/// What is answered as soon as it is so: lists follow the fleet a few times a second.
async fn once(at: SocketAddr, path: &str, is_so: impl Fn(&Value) -> bool) -> Value {
    let ask = async || Some(get(at, path).await.json()).filter(&is_so);
    eventually(&format!("{path} is as it should be"), ask).await
}

#[tokio::test(flavor = "multi_thread")]
async fn a_closure_says_whom_it_binds_and_binds_both_unless_told() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let square = json!([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
    for (binds, is) in [(json!(null), "both"), (json!("people"), "people"), (json!("robots"), "robots")] {
        let made =
            post(at, "/v1/closures", &json!({"outline": square, "reason": "oil", "binds": binds})).await;
        assert_eq!(made.json()["binds"], is, "{made:?}");
    }
    let odd = post(at, "/v1/closures", &json!({"outline": square, "reason": "oil", "binds": "cats"})).await;
    assert_eq!(odd.problem(422)["errors"][0]["field"], "binds");
    server.stop().await.unwrap();
    let server = start(&folder).await;
    let listed = get(server.address(), "/v1/closures").await.json();
    let binds: Vec<&Value> = listed["items"].as_array().unwrap().iter().map(|c| &c["binds"]).collect();
    assert_eq!(binds, ["both", "people", "robots"], "also over a restart");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_closure_recurs_over_a_restart_until_it_is_ended() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let wanted = json!({"nodes": [place()], "reason": "cleaning", "from": "2031-01-01T00:00:00Z",
        "recurs": {"weekdays": ["monday", "thursday"], "from": "22:00", "to": "22:30", "utc_offset": "+01:00"}});
    let made = post(at, "/v1/closures", &wanted).await;
    assert_eq!((made.status, made.header("location")), (201, Some("/v1/closures/s1")), "{made:?}");
    // The first day of 2031 is a Wednesday.
    assert_eq!(made.json()["next"], "2031-01-02T21:00:00Z");
    let first =
        once(at, "/v1/closures/s1", |s| s["occurrences"][0]["id"] == "c1").await["occurrences"][0].clone();
    assert_eq!(
        (first["from"].clone(), first["series"].clone()),
        (json!("2031-01-02T21:00:00Z"), json!("s1"))
    );
    assert_eq!(first["until"], "2031-01-02T21:30:00Z");
    server.stop().await.unwrap();

    let server = start(&folder).await;
    let at = server.address();
    let listed = get(at, "/v1/closures/recurring").await.json();
    assert_eq!(listed["items"][0]["weekdays"], json!(["monday", "thursday"]), "{listed}");
    assert_eq!(listed["items"][0]["occurrences"][0]["id"], "c1");
    assert_eq!(delete(at, "/v1/closures/c1").await.status, 204);
    let monday = |s: &Value| s["occurrences"][0]["from"] == "2031-01-06T21:00:00Z";
    once(at, "/v1/closures/s1", monday).await;
    assert_eq!(delete(at, "/v1/closures/s1").await.status, 204);
    once(at, "/v1/closures", |c| c["items"] == json!([])).await;
    delete(at, "/v1/closures/s1").await.problem(404);
    get(at, "/v1/closures/s1").await.problem(404);
    let odd = json!({"nodes": [place()], "reason": "x", "recurs": {"from": "8", "to": "09:00"}});
    assert_eq!(post(at, "/v1/closures", &odd).await.problem(422)["errors"][0]["field"], "recurs.from");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn an_evacuation_lasts_over_a_restart_until_it_is_ended() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    assert_eq!(get(at, "/v1/evacuation").await.json(), json!({"since": null, "inside": []}));
    assert_eq!(post(at, "/v1/evacuation", &json!({})).await.status, 204);
    let since = once(at, "/v1/evacuation", |e| e["since"].is_string()).await["since"].clone();
    assert_eq!(post(at, "/v1/evacuation", &json!({})).await.status, 204, "said again, it changes nothing");
    server.stop().await.unwrap();
    let server = start(&folder).await;
    let at = server.address();
    once(at, "/v1/evacuation", |e| e["since"] == since).await;
    assert_eq!(delete(at, "/v1/evacuation").await.status, 204);
    once(at, "/v1/evacuation", |e| e["since"].is_null()).await;
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_forklift_is_registered_changed_and_known_after_a_restart() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    let truck = json!({"length_m": 2.4, "width_m": 1.0, "behind_m": 1.0, "speed_mps": 3});
    let made = post(at, "/v1/workers", &json!({"name": "driver-2", "vehicle": truck})).await;
    assert_eq!(made.status, 201, "{made:?}");
    let vehicle = made.json()["vehicle"].clone();
    let whole = json!({"length_m": 2.4, "width_m": 1.0, "behind_m": 1.0, "speed_mps": 3.0, "accel_mps2": 1.0,
        "brake_mps2": 2.0});
    assert_eq!(vehicle, whole);
    assert_eq!(hire(at, "driver-2").await, "w1", "the same name is the same worker, still in the vehicle");
    let anna = hire(at, "anna").await;
    let path = format!("/v1/workers/{anna}");
    let patch = async |body: Value| send(at, "PATCH", &path, &[JSON], &body.to_string()).await.unwrap();
    let wrong =
        patch(json!({"vehicle": {"length_m": 24, "width_m": 0.1, "speed_mps": 9}})).await.problem(422);
    let fields: Vec<&str> =
        wrong["errors"].as_array().unwrap().iter().map(|e| e["field"].as_str().unwrap()).collect();
    assert_eq!(fields, ["vehicle.length_m", "vehicle.width_m", "vehicle.speed_mps"]);
    patch(json!({})).await.problem(422);
    patch(json!({"vehicle": {"length_m": 2}})).await.problem(422);
    send(at, "PATCH", "/v1/workers/w9", &[JSON], r#"{"vehicle": null}"#).await.unwrap().problem(404);
    let stacker = patch(json!({"vehicle": {"length_m": 1.9, "width_m": 0.8}})).await.json();
    assert_eq!(stacker["vehicle"]["speed_mps"], 4.0, "nobody said that it is slower");
    assert_eq!(patch(json!({"vehicle": null})).await.json()["vehicle"], Value::Null);
    server.stop().await.unwrap();

    let server = start(&folder).await;
    let at = server.address();
    let vehicles = async || {
        let list = get(at, "/v1/workers").await.json();
        [0, 1].map(|i| list["items"][i]["vehicle"].clone())
    };
    let as_before = [whole, Value::Null];
    let known = async || (vehicles().await == as_before).then_some(());
    eventually("the vehicles are known again", known).await;
    server.stop().await.unwrap();
}
