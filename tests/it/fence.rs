//! A journal that contradicts itself: the robot in question is fenced off, the others go on, the process stays up.

use crate::helper::{
    Folder, all_jobs, config, delivery, empty_ledger, eventually, floor, get, map, post, send,
    start_in_real_time,
};
use giveway::drive::{GuardedCall, Trap};
use giveway::fleet::{Fact, JobFact, JobState, RouteFact, Task};
use giveway::id::RobotId;
use giveway::server::Server;
use giveway::store::{StepEntry, Store};
use giveway::time::Time;
use serde_json::json;
use std::net::SocketAddr;

/// Asks until it is so.
async fn until(what: &str, mut so: impl AsyncFnMut() -> bool) {
    eventually(what, async || so().await.then_some(())).await;
}

async fn count(at: SocketAddr, state: &str) -> usize {
    all_jobs(at, 500).await.iter().filter(|j| j["state"] == state).count()
}

/// The facts of a floor up to and with the one by which a robot lifts a rack, and that robot: the job does not know of
/// it.
async fn cut_after_a_lift() -> (Vec<Fact>, RobotId) {
    let folder = Folder::new();
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    for rack in 0..6 {
        let mut job = delivery(rack);
        job["pick_s"] = json!(0.1);
        assert_eq!(post(at, None, &job).await.unwrap().status, 201);
    }
    until("a robot lifts a rack", async || {
        count(at, "waiting").await <= 4 && count(at, "assigned").await < 2
    })
    .await;
    server.stop().await.unwrap();
    let store = Store::open(&folder.database(), &map()).await.unwrap();
    let loaded = store.load(empty_ledger()).await.unwrap();
    let mut facts: Vec<Fact> = loaded.into_parts().1.collect();
    store.close().await;
    let lifts = |pair: &[Fact]| match pair {
        [
            Fact::Route(RouteFact::Acted { robot, .. }),
            Fact::Job(JobFact::Progressed { state: JobState::Carrying { .. }, .. }),
        ] => Some(*robot),
        _ => None,
    };
    let found = facts.windows(2).enumerate().find_map(|(i, pair)| lifts(pair).map(|robot| (i, robot)));
    let (last, robot) = found.expect("a robot lifted a rack");
    facts.truncate(last + 1);
    (facts, robot)
}

/// The rack that a robot was sent for last.
fn rack_of(facts: &[Fact], robot: RobotId) -> String {
    let fetch = |fact: &Fact| match fact {
        Fact::Job(JobFact::Progressed { tasked: Some((r, Task::Fetch { rack, .. })), .. }) if *r == robot => {
            Some(*rack)
        }
        _ => None,
    };
    map().racks[facts.iter().rev().find_map(fetch).expect("it was sent for a rack")].name.clone()
}

/// A folder with a database of these facts.
async fn database(facts: Vec<Fact>) -> Folder {
    let folder = Folder::new();
    let store = Store::open(&folder.database(), &map()).await.unwrap();
    let entries: Vec<StepEntry> = facts
        .into_iter()
        .map(|fact| StepEntry { at: Time(1), facts: vec![fact], causes: Vec::new() })
        .collect();
    store.append(1, &entries).await.unwrap();
    store.close().await;
    folder
}

#[tokio::test(flavor = "multi_thread")]
async fn a_robot_that_the_journal_contradicts_is_fenced_off_and_the_others_go_on_delivering() {
    let (facts, robot) = cut_after_a_lift().await;
    let rack = rack_of(&facts, robot);
    let folder = database(facts).await;
    let server = start_in_real_time(&folder).await;
    let at = server.address();
    // Jobs that the cut left out.
    for i in 1..6 {
        let mut job = delivery(i);
        job["pick_s"] = json!(0.1);
        if job["rack"] != *rack {
            // The step that panics has taken some of them in: nothing came of these, and clients try again.
            until("the job is accepted", async || post(at, None, &job).await.unwrap().status == 201).await;
        }
    }
    let name = format!("robot-{}", robot.0 + 1);
    until("an alarm names the robot", async || {
        let health = get(at, "/v1/health").await;
        health.status == 503 && health.text.contains(&format!("{name} contradicts itself: fenced off"))
    })
    .await;
    let before = count(at, "done").await;
    until("the other robot goes on delivering", async || count(at, "done").await >= before + 2).await;
    let robots = get(at, "/v1/robots").await.json();
    let states: Vec<_> =
        robots["items"].as_array().unwrap().iter().filter(|r| r["state"] == "failed").collect();
    assert_eq!((states.len(), &states[0]["id"]), (1, &json!(name)), "{robots}");
    server.stop().await.unwrap();

    let server = start_in_real_time(&folder).await;
    let at = server.address();
    until("it is fenced off after a restart, too", async || {
        get(at, "/v1/health").await.text.contains("fenced off")
    })
    .await;
    let released = send(at, "POST", &format!("/v1/robots/{name}/resume"), &[], "").await.unwrap();
    assert_eq!(released.status, 204, "{released:?}");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn a_journal_that_cannot_be_folded_leaves_a_server_that_says_so() {
    let (mut facts, robot) = cut_after_a_lift().await;
    facts.push(Fact::Route(RouteFact::Acted { robot, serial: 1_000_000 }));
    let folder = database(facts).await;
    for _ in 0..2 {
        let server = start_in_real_time(&folder).await;
        let at = server.address();
        let health = get(at, "/v1/health").await;
        health.problem(503);
        assert!(health.text.contains("contradicts itself") && health.text.contains("restore"), "{health:?}");
        post(at, None, &delivery(0)).await.unwrap().problem(503);
        assert_eq!(get(at, "/v1/health/live").await.status, 200);
        server.stop().await.unwrap();
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_panic_in_a_step_a_view_a_query_or_over_a_pose_fences_one_robot_off_and_jobs_go_on() {
    for call in [GuardedCall::Step, GuardedCall::View, GuardedCall::Query, GuardedCall::Pose] {
        let folder = Folder::new();
        let floor = floor();
        let planted = floor.planted.clone();
        let server = Server::start(&config(&folder), floor).await.unwrap();
        let at = server.address();
        until("robots have joined", async || {
            get(at, "/v1/robots").await.json()["items"].as_array().is_some_and(|robots| robots.len() >= 2)
        })
        .await;
        planted.lock().unwrap().push(Trap { call, robot: Some(RobotId(0)), times: 1 });
        until(&format!("one robot is fenced off: {call:?}"), async || {
            // A question over HTTP may meet the panic; the server goes on answering.
            let asked = get(at, "/v1/robots/robot-1/why").await.status;
            assert!([200, 503].contains(&asked), "{call:?}: {asked}");
            get(at, "/v1/health").await.text.contains("robot-1 contradicts itself: fenced off")
        })
        .await;
        let mut job = delivery(3);
        job["pick_s"] = json!(0.1);
        until("the job is accepted", async || post(at, None, &job).await.unwrap().status == 201).await;
        until("the other robots work", async || count(at, "done").await == 1).await;
        server.stop().await.unwrap();
    }
}
