//! Order lines over HTTP: a visit ends with its last line; bad lines are refused by name; `kill -9` in mid-visit loses
//! nothing.

use crate::helper::{Answer, Folder, eventually, get, post, send};
use crate::recovery::Program;
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::path::PathBuf;

const JSON: (&str, &str) = ("content-type", "application/json");

/// A scenario with quick robots in the hall whose stations are work cells; nobody picks but the test.
pub fn scenario(folder: &Folder) -> String {
    let path = folder.path().join("cells.json");
    let scenario = json!({
        "giveway_scenario": 1, "name": "cells", "robots": 4, "period_ms": 20, "jobs": "none",
        "map": PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("maps/stations.json"),
        "fleet": {"speed_mps": 5, "accel_unloaded_mps2": 5, "accel_loaded_mps2": 5, "lift_s": 0.1},
    });
    std::fs::write(&path, scenario.to_string()).unwrap();
    path.to_str().unwrap().to_owned()
}

pub fn rack() -> String {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/maps/stations.json")).unwrap();
    giveway::warehouse::formats::json::parse(&text).unwrap().racks.iter().next().unwrap().name.clone()
}

fn wanted(lines: Value) -> Value {
    json!({"kind": "deliver", "rack": rack(), "station": "S1", "pick_s": 900, "lines": lines})
}

pub async fn until(at: SocketAddr, what: &str, path: &str, so: impl Fn(&Value) -> bool) -> Value {
    eventually(what, async || Some(get(at, path).await.json()).filter(&so)).await
}

async fn say(at: SocketAddr, n: &str, change: Value) -> Answer {
    send(at, "POST", &format!("/v1/stations/S1/lines/{n}"), &[JSON], &change.to_string()).await.unwrap()
}

fn states(of: &Value) -> Vec<(String, u64)> {
    let line = |l: &Value| (l["state"].as_str().unwrap().to_owned(), l["done"].as_u64().unwrap());
    of["lines"].as_array().unwrap().iter().map(line).collect()
}

fn is(state: &str, done: u64) -> (String, u64) {
    (state.into(), done)
}

#[tokio::test(flavor = "multi_thread")]
async fn lines_are_confirmed_over_http_and_a_kill_in_mid_visit_loses_none_and_doubles_none() {
    let folder = Folder::new();
    let scenario = scenario(&folder);
    let program = Program::with(&folder, &scenario);
    let at = program.address;
    let lines = json!([
        {"slot": "C3", "quantity": 2, "tote": "B", "item": "M6 bolts"},
        {"slot": "A1", "quantity": 1, "tote": "A", "by": "hand"},
        {"slot": "D5", "quantity": 3, "tote": "C"},
    ]);
    let made = post(at, None, &wanted(lines)).await.unwrap();
    assert_eq!(made.status, 201, "{}", made.text);
    let made = made.json();
    assert_eq!(states(&made), [is("open", 0), is("open", 0), is("open", 0)]);
    let job = format!("/v1/jobs/{}", made["id"].as_str().unwrap());
    say(at, "1", json!({"done": 1})).await.problem(409);
    let there = until(at, "the rack is there", "/v1/stations/S1", |s| !s["visit"].is_null()).await;
    assert_eq!((&there["visit"]["job"], &there["visit"]["pieces_left"]), (&made["id"], &json!(6)));
    let totes: Vec<&Value> = there["totes"].as_array().unwrap().iter().map(|t| &t["id"]).collect();
    assert_eq!(there["has_cell"], true);
    assert_eq!(totes, ["A", "B", "C"]);
    assert_eq!(there["visit"]["face"]["columns"], 4);
    assert!(there["visit"]["expected_end"]["p10"].as_f64() < there["visit"]["expected_end"]["p90"].as_f64());
    let placed = &there["visit"]["expected_placed"];
    assert!(placed["p50"].as_f64() >= there["visit"]["expected_end"]["p50"].as_f64(), "{there}");
    assert_eq!((&there["hands_seen"], &there["unconfirmed"]), (&json!(false), &Value::Null), "{there}");
    assert_eq!(there["ends"], json!({"visits": 0, "held": null, "off_s": null}), "no visit was over yet");
    assert_eq!((&there["arm"]["state"], &there["arm"]["line"]), (&json!("off"), &Value::Null), "{there}");
    assert_eq!(states(&there["visit"]), [is("lit", 0), is("open", 0), is("open", 0)]);

    let said = say(at, "1", json!({"done": 2})).await.json();
    assert_eq!((&said["state"], &said["changed"]), (&json!("done"), &json!(true)), "{said}");
    let again = say(at, "1", json!({"done": 2})).await.json();
    assert_eq!((&again["done"], &again["changed"]), (&json!(2), &json!(false)), "{again}");
    say(at, "2", json!({"short": true})).await.json();
    say(at, "3", json!({"done": 1})).await.json();
    say(at, "3", json!({"done": 3})).await.problem(422);
    for wrong in [json!({}), json!({"done": 1, "undo": true}), json!({"short": false}), json!({"done": -1})] {
        say(at, "3", wrong).await.problem(422);
    }
    for nowhere in ["0", "4", "x"] {
        say(at, nowhere, json!({"done": 1})).await.problem(404);
    }
    program.kill();

    let program = Program::with(&folder, &scenario);
    let at = program.address;
    let kept = until(at, "the rack is there still", "/v1/stations/S1", |s| !s["visit"].is_null()).await;
    assert_eq!(states(&kept["visit"]), [is("done", 2), is("short", 0), is("lit", 1)]);
    assert_eq!(say(at, "1", json!({"done": 2})).await.json()["changed"], false, "it was confirmed before");
    assert_eq!(say(at, "3", json!({"done": 2})).await.json()["state"], "done");
    let over = until(at, "the job is over", &job, |j| j["state"] == "done").await;
    assert_eq!(states(&over), [is("done", 2), is("short", 0), is("done", 3)]);
    let left =
        until(at, "the rack has left", "/v1/stations/S1", |s| s["robot"].is_null() && s["visit"].is_null());
    assert!(left.await["next"].is_null(), "nothing else was ordered");
    say(at, "3", json!({"undo": true})).await.problem(409);
    program.kill();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_line_that_was_confirmed_is_given_back_and_one_that_is_over_counts_once() {
    let folder = Folder::new();
    let program = Program::with(&folder, &scenario(&folder));
    let at = program.address;
    let lines =
        json!([{"slot": "C3", "quantity": 2, "tote": "B"}, {"slot": "A1", "quantity": 3, "tote": "A"}]);
    let made = post(at, None, &wanted(lines)).await.unwrap().json();
    let job = format!("/v1/jobs/{}", made["id"].as_str().unwrap());
    until(at, "the rack is there", "/v1/stations/S1", |s| !s["visit"].is_null()).await;
    let answer = |n: u64, state: &str, done: u64, changed: bool| json!({"job": made["id"], "n": n, "state": state, "done": done, "changed": changed});
    let seen = async |pieces_left: u64, expected: [(String, u64); 2]| {
        let so = |s: &Value| s["visit"]["pieces_left"] == pieces_left && states(&s["visit"]) == expected;
        until(at, &format!("{pieces_left} pieces are left: {expected:?}"), "/v1/stations/S1", so).await;
    };

    assert_eq!(say(at, "1", json!({"done": 2})).await.json(), answer(1, "done", 2, true));
    seen(3, [is("done", 2), is("lit", 0)]).await;
    for again in [json!({"done": 2}), json!({"done": 1}), json!({"short": true})] {
        assert_eq!(say(at, "1", again).await.json(), answer(1, "done", 2, false), "it is so already");
    }
    seen(3, [is("done", 2), is("lit", 0)]).await;

    let back = say(at, "1", json!({"undo": true})).await.json();
    assert_eq!(back, answer(1, "lit", 0, true), "it is picked anew, before lines that have not begun");
    seen(5, [is("lit", 0), is("open", 0)]).await;
    assert_eq!(
        say(at, "1", json!({"undo": true})).await.json(),
        answer(1, "lit", 0, false),
        "nothing is left to give"
    );
    say(at, "1", json!({"done": 2})).await.json();
    assert_eq!(say(at, "2", json!({"done": 1})).await.json(), answer(2, "lit", 1, true));
    let back = say(at, "1", json!({"undo": true})).await.json();
    assert_eq!(back, answer(1, "undone", 0, true), "what has begun goes on first");
    seen(4, [is("undone", 0), is("lit", 1)]).await;

    say(at, "2", json!({"done": 2})).await.json();
    seen(2, [is("lit", 0), is("done", 3)]).await;
    assert_eq!(get(at, &job).await.json()["state"], "picking", "the visit goes on");
    assert_eq!(say(at, "1", json!({"done": 2})).await.json(), answer(1, "done", 2, true));
    let over = until(at, "the job is over", &job, |j| j["state"] == "done").await;
    assert_eq!(states(&over), [is("done", 2), is("done", 3)]);
    program.kill();
}

#[tokio::test(flavor = "multi_thread")]
async fn lines_that_cannot_be_picked_are_refused_by_name_and_the_job_is_not_taken() {
    let folder = Folder::new();
    let scenario = scenario(&folder);
    let program = Program::with(&folder, &scenario);
    let at = program.address;
    let line =
        |slot: &str, quantity: i64, tote: &str| json!({"slot": slot, "quantity": quantity, "tote": tote});
    let good = line("C3", 1, "B");
    let by_arm = json!({"slot": "C3", "quantity": 1, "tote": "B", "by": "arm"});
    let stop = |station: &str, lines: Value| json!({"station": station, "lines": lines});
    let at_stops = |stops: Value| json!({"kind": "deliver", "rack": rack(), "stops": stops});
    let cases = [
        (wanted(json!([line("Z30", 1, "B")])), "lines[0].slot"),
        (wanted(json!([good, line("E1", 1, "B")])), "lines[1].slot"),
        (wanted(json!([line("C3", 1, "Q")])), "lines[0].tote"),
        (wanted(json!([line("C3", 0, "B")])), "lines[0].quantity"),
        (wanted(json!([good, good])), "lines[1].slot"),
        (at_stops(json!([stop("S1", json!([good])), stop("S4", json!([by_arm]))])), "stops[1].lines[0].by"),
    ];
    for (job, field) in cases {
        let problem = post(at, None, &job).await.unwrap().problem(400);
        assert_eq!(problem["errors"][0]["field"], field, "{problem}");
    }
    let plain = json!({"kind": "return", "rack": rack(), "lines": [good]});
    assert_eq!(post(at, None, &plain).await.unwrap().problem(422)["errors"][0]["field"], "lines");
    assert_eq!(get(at, "/v1/jobs").await.json()["items"], json!([]));
    get(at, "/v1/stations/nowhere").await.problem(404);
    program.kill();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_station_without_a_cell_takes_no_lines() {
    let folder = Folder::new();
    let server = crate::helper::start(&folder).await;
    let mut job = crate::helper::delivery(0);
    job["lines"] = json!([{"slot": "A1", "quantity": 1, "tote": "A"}]);
    let problem = post(server.address(), None, &job).await.unwrap().problem(400);
    assert_eq!(problem["errors"][0]["field"], "lines", "{problem}");
    assert!(problem["detail"].as_str().unwrap().contains("has no work cell"), "{problem}");
    server.stop().await.unwrap();
}
