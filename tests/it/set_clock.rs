//! A database that was written while the system's clock was a day ahead: a start refuses deadlines of that day, and
//! `giveway database set-clock` ends that without losing a job.

use crate::helper::{Folder, SCENARIO, eventually, floor, get, post, start};
use crate::run::{Keeper, Run, deliver, nothing};
use giveway::fleet::{Fleet, Input, JobAction};
use giveway::store::Store;
use giveway::time::{Span, Time};
use serde_json::{Value, json};
use std::process::{Command, Output};

/// Lets a floor work for half a minute from tomorrow on, with three jobs of which none is over.
async fn tomorrow(folder: &Folder) {
    let (map, scenario) = (floor().map, floor().source.scenario);
    let store = Store::open(&folder.database(), &map).await.unwrap();
    let now = Time(jiff::Timestamp::now().as_microsecond()) + Span::from_secs(86_400);
    let mut run = Run::new(&map, &scenario, Fleet::new(map.clone(), scenario.site.settings()), now);
    let mut keeper = Keeper::new(store, nothing(&map, &scenario));
    for i in 0..100_u32 {
        let token = u64::from(i) + 1;
        let extra = match i {
            5..8 => vec![Input::ask(token, JobAction::Submit(deliver(i, Some(&format!("k{i}")))))],
            _ => vec![],
        };
        let (entry, _) = run.step(extra);
        if !entry.facts.is_empty() {
            keeper.append(std::slice::from_ref(&entry)).await;
        }
    }
    assert_eq!(run.fleet.ledger().jobs.len(), 3);
    assert!(run.fleet.ledger().jobs.values().any(|job| job.state.robot().is_some()), "robots are at work");
    keeper.store.close().await;
}

fn set_clock(folder: &Folder) -> Output {
    Command::new(env!("CARGO_BIN_EXE_giveway"))
        .args(["database", "set-clock", "--scenario", SCENARIO, "--database"])
        .arg(folder.database())
        .output()
        .unwrap()
}

fn due_in_an_hour() -> Value {
    let due = jiff::Timestamp::now() + jiff::SignedDuration::from_hours(1);
    json!({"kind": "deliver", "rack": "K9", "station": "P", "pick_s": 1, "deadline": due.to_string()})
}

#[tokio::test(flavor = "multi_thread")]
async fn a_database_of_tomorrow_goes_on_today_with_all_its_jobs() {
    let folder = Folder::new();
    tomorrow(&folder).await;
    let server = start(&folder).await;
    let refused = post(server.address(), None, &due_in_an_hour()).await.unwrap().problem(422);
    assert_eq!(refused["errors"][0]["field"], "deadline", "{refused}");
    server.stop().await.unwrap();

    let said = set_clock(&folder);
    let text = String::from_utf8_lossy(&said.stdout).into_owned() + &String::from_utf8_lossy(&said.stderr);
    assert!(said.status.success() && text.contains("before-clock-"), "{text}");
    let again = set_clock(&folder);
    assert!(String::from_utf8_lossy(&again.stdout).contains("nothing to set"), "{again:?}");

    let server = start(&folder).await;
    let at = server.address();
    let made = post(at, None, &due_in_an_hour()).await.unwrap();
    assert_eq!(made.status, 201, "{}", made.text);
    let are_done = async || {
        let page = get(at, "/v1/jobs").await.json();
        let jobs = page["items"].as_array().unwrap();
        jobs.iter().all(|j| j["state"] == "done").then_some(jobs.len())
    };
    assert_eq!(eventually("all four are done", are_done).await, 4);
    let again =
        post(at, Some("k5"), &json!({"kind": "deliver", "rack": "K6", "station": "P", "priority": 5})).await;
    assert_eq!(again.unwrap().status, 200, "keys are known");
    server.stop().await.unwrap();
}
