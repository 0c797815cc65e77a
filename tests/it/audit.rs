//! Who asked for what is written down, with the facts that came of it.

use crate::helper::{Folder, delivery, eventually, start};
use crate::tokens::{ADMIN, make, start_closed, until_robots, with};
use serde_json::{Value, json};
use std::net::SocketAddr;

/// The entries of the audit for a query, as soon as there are so many.
async fn entries(at: SocketAddr, query: &str, count: usize) -> Vec<Value> {
    let found = eventually(&format!("the audit has {count} entries, all answered: {query}"), async || {
        let page = with(at, ADMIN, "GET", &format!("/v1/audit?limit=500{query}"), "").await.json();
        let found = page["items"].as_array().unwrap().clone();
        let is_whole = found.len() >= count && found.iter().all(|e| e["outcome"] != "unanswered");
        is_whole.then_some(found)
    })
    .await;
    assert_eq!(found.len(), count, "{found:#?}");
    found
}

/// Who did what to what, and what came of it.
fn told(entry: &Value) -> [&str; 5] {
    ["actor", "role", "what", "subject", "outcome"].map(|key| entry[key].as_str().unwrap_or("-"))
}

#[tokio::test(flavor = "multi_thread")]
async fn every_request_that_changes_something_is_told_with_who_asked_and_what_came_of_it() {
    let folder = Folder::new();
    let server = start_closed(&folder).await;
    let at = server.address();
    until_robots(at, ADMIN).await;
    let token = |made: Value| made["token"].as_str().unwrap().to_owned();
    let operator = token(make(at, "ben", "operator", None).await);
    let erp = token(make(at, "erp", "integrator", None).await);
    assert_eq!(with(at, &operator, "POST", "/v1/robots/robot-1/pause", "").await.status, 204);
    assert_eq!(with(at, &erp, "POST", "/v1/jobs", &delivery(0).to_string()).await.status, 201);
    assert_eq!(with(at, &erp, "POST", "/v1/robots/robot-1/resume", "").await.status, 403);
    assert_eq!(with(at, &operator, "POST", "/v1/robots/robot-9/pause", "").await.status, 404);
    assert_eq!(with(at, &operator, "GET", "/v1/robots", "").await.status, 200);
    let all = entries(at, "", 6).await;
    let expected = [
        ["ben", "operator", "POST /v1/robots/{id}/pause", "robot-9", "refused"],
        ["erp", "integrator", "POST /v1/robots/{id}/resume", "robot-1", "refused"],
        ["erp", "integrator", "POST /v1/jobs", "j1", "done"],
        ["ben", "operator", "POST /v1/robots/{id}/pause", "robot-1", "done"],
        ["configuration", "admin", "POST /v1/tokens", "t2", "done"],
        ["configuration", "admin", "POST /v1/tokens", "t1", "done"],
    ];
    assert_eq!(all.iter().map(told).collect::<Vec<_>>(), expected, "newest first");
    assert_eq!(all[1]["status"], 403);
    let acts: Vec<&str> = all.iter().map(|e| e["act"].as_str().expect("it has a word")).collect();
    assert_eq!(
        acts,
        ["pause_robot", "resume_robot", "submit_job", "pause_robot", "make_token", "make_token"]
    );
    let report = with(at, &operator, "GET", "/v1/report", "").await.json();
    let done: Vec<_> = report["acts"].as_array().unwrap().iter().map(|a| (&a["act"], &a["count"])).collect();
    assert!(done.contains(&(&json!("make_token"), &json!(2))), "{done:?}");
    assert!(done.contains(&(&json!("pause_robot"), &json!(1))), "what was refused was not done: {done:?}");
    assert!(all[0]["at"].as_str().unwrap() > "2020");

    assert_eq!(entries(at, "&actor=erp", 2).await, all[1..3]);
    let since = all[2]["at"].as_str().unwrap();
    assert_eq!(entries(at, &format!("&from={since}"), 3).await, all[..3]);
    assert_eq!(entries(at, &format!("&to={since}"), 3).await, all[3..]);
    let page = with(at, ADMIN, "GET", "/v1/audit?limit=4", "").await.json();
    let path = format!("/v1/audit?limit=4&cursor={}", page["next"].as_str().unwrap());
    let rest = with(at, ADMIN, "GET", &path, "").await.json();
    assert_eq!((rest["items"].as_array().unwrap().as_slice(), &rest["next"]), (&all[4..], &json!(null)));
    with(at, &operator, "GET", "/v1/audit", "").await.problem(403);
    with(at, ADMIN, "GET", "/v1/audit?cursor=x", "").await.problem(422);
    server.stop().await.unwrap();

    let server = start_closed(&folder).await;
    assert_eq!(entries(server.address(), "", 6).await, all, "they outlast a restart");
    server.stop().await.unwrap();
}

#[tokio::test(flavor = "multi_thread")]
async fn the_journal_knows_who_is_behind_the_facts_of_a_request() {
    let folder = Folder::new();
    let server = start(&folder).await;
    let at = server.address();
    until_robots(at, "none-is-needed").await;
    let paused = crate::helper::send(at, "POST", "/v1/robots/robot-1/pause", &[], "").await.unwrap();
    assert_eq!(paused.status, 204);
    let causes = server.store().causes(0).await.unwrap();
    let [(_, of_step)] = &causes[..] else { panic!("one step has a cause: {causes:?}") };
    let [cause] = &of_step[..] else { panic!("one request: {of_step:?}") };
    assert_eq!((cause.request.actor.as_str(), cause.facts.len()), ("this machine", 1));
    assert_eq!(cause.request.what, "POST /v1/robots/{id}/pause");
    assert_eq!(cause.request.subject.as_deref(), Some("robot-1"));
    server.stop().await.unwrap();
}
