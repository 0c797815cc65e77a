//! Databases last: one that an earlier build made opens, and what it promised is kept.
//!
//! `fixtures/floor-2.db` and what it holds, `floor-2.json`, were made by `cargo test --test it -- --ignored
//! a_database_is_made_for_later_builds`. A release makes one with a number of its own and keeps the earlier ones.

use crate::helper::{Folder, map};
use crate::run::{Keeper, Run, deliver, nothing};
use giveway::fleet::{
    Answer, AssignmentQuery, AssignmentRequest, Binds, Closure, Fleet, FloorAction, Input, JobAction,
    JobKind, JobQuery, JobRequest, Made, Reply, WorkerAction,
};
use giveway::geometry::Spot;
use giveway::id::{ClosureId, JobId, RackId, RobotId, WorkerId};
use giveway::sim::Scenario;
use giveway::store::Store;
use giveway::time::{Span, Time, Window};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::Arc;

const SCENARIO: &str =
    r#"{"giveway_scenario": 1, "name": "fixture", "map": "", "robots": 2, "period_ms": 100, "jobs": "none"}"#;

fn fixture(name: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/fixtures")).join(name)
}

/// What customers asked for, by step.
fn wishes(step: usize) -> Vec<Input> {
    let place = map().nodes.ids().nth(3).unwrap();
    let request =
        AssignmentRequest { place, stay: Span::from_secs(60), what: "count".into(), key: Some("a".into()) };
    let corner = |x_mm, y_mm| Spot { x_mm, y_mm };
    let outline = vec![corner(-900, -900), corner(-100, -900), corner(-100, -100)];
    let window = Window::from(Time(1_900_000_000_000_000));
    let area = Closure {
        outline,
        nodes: vec![],
        window,
        reason: "later".into(),
        binds: Binds::Robots,
        series: None,
    };
    let waits = |key: &str| JobRequest { after: vec![JobId(1)], ..deliver(2, Some(key)) };
    let moved = JobKind::Return { rack: RackId(4) };
    match step {
        1 => vec![Input::ask(1, JobAction::Submit(deliver(1, Some("first"))))],
        2 => vec![Input::ask(2, JobAction::Submit(JobRequest { kind: moved, ..waits("second") }))],
        3 => vec![Input::ask(3, WorkerAction::Register("anna".into()))],
        4 => vec![Input::ask(4, WorkerAction::Assign { worker: Some(WorkerId(0)), request })],
        5 => vec![Input::ask(5, FloorAction::Close(area.clone())), Input::ask(6, FloorAction::Close(area))],
        6 => vec![Input::ask(7, FloorAction::Reopen(ClosureId(1)))],
        7 => vec![Input::ask(8, JobAction::Cancel(JobId(2)))],
        700 => vec![Input::ask(9, JobAction::Submit(deliver(3, Some("third"))))],
        701 => {
            vec![Input::ask(10, JobAction::Submit(JobRequest { after: vec![JobId(3)], ..waits("fourth") }))]
        }
        900 => vec![Input::ask(11, FloorAction::Halt(Some(RobotId(1))))],
        _ => vec![],
    }
}

/// Everything that this database promises, and what its lists say.
async fn promised(store: &Store, fleet: &Fleet) -> Value {
    let ledger = fleet.ledger();
    let text = |value: &dyn std::fmt::Debug| format!("{value:?}");
    let jobs = store.jobs(&JobQuery { limit: 1000, ..JobQuery::default() }).await.unwrap().rows;
    let assignments = AssignmentQuery { limit: 1000, ..AssignmentQuery::default() };
    let assignments = store.assignments(&assignments).await.unwrap().rows;
    let place = |r: RobotId| json!([ledger.robots[r].name, ledger.warehouse().nodes[ledger.node_of(r)].name]);
    let keys = ["first", "second", "third", "fourth", "unknown"]
        .map(|key| ledger.keys.get(&key.into()).map(|job| job.0));
    json!({
        "open": ledger.jobs.iter().map(|(id, j)| json!([id.0, j.state.word(), j.request.key.as_ref().map(|key| &key.text)])).collect::<Vec<_>>(),
        "keys": keys,
        "assignment_key": ledger.assignment_keys.get(&"a".into()).map(|id| id.0),
        "racks": ledger.racks.iter().map(|at| text(at)).collect::<Vec<_>>(),
        "robots": ledger.robots.ids().map(place).collect::<Vec<_>>(),
        "paused": ledger.robots.iter().map(|r| r.paused.map(|t| t.0)).collect::<Vec<_>>(),
        "workers": ledger.workers.iter().collect::<Vec<_>>(),
        "assignments": ledger.assignments.iter().map(|(id, a)| json!([id.0, a.request.what])).collect::<Vec<_>>(),
        "closures": ledger.closures.iter().map(|(id, c)| json!([id.0, c.reason, c.outline.len()])).collect::<Vec<_>>(),
        "deliveries": ledger.counts.robot_deliveries,
        "listed": jobs.iter().map(|j| json!([j.id.0, j.job.state.word(), j.updated.0])).collect::<Vec<_>>(),
        "listed_assignments": assignments.iter().map(|a| json!([a.id.0, a.assignment.request.what])).collect::<Vec<_>>(),
    })
}

#[tokio::test]
#[ignore = "makes the fixture"]
async fn a_database_is_made_for_later_builds() {
    let (map, scenario, folder) = (Arc::new(map()), Scenario::parse(SCENARIO).unwrap(), Folder::new());
    let store = Store::open(&folder.database(), &map).await.unwrap();
    let fleet = Fleet::new(map.clone(), scenario.site.settings());
    let mut run = Run::new(&map, &scenario, fleet, Time(1_800_000_000_000_000));
    let mut keeper = Keeper::new(store, nothing(&map, &scenario));
    for step in 0..1000 {
        let (entry, _) = run.step(wishes(step));
        if !entry.facts.is_empty() {
            keeper.append(std::slice::from_ref(&entry)).await;
        }
        if [300, 600, 800].contains(&step) {
            keeper.snapshot(entry.at).await;
        }
    }
    let held = promised(&keeper.store, &run.fleet).await;
    keeper.store.close().await;
    std::fs::create_dir_all(fixture("")).unwrap();
    std::fs::copy(folder.database(), fixture("floor-2.db")).unwrap();
    std::fs::write(fixture("floor-2.json"), serde_json::to_string_pretty(&held).unwrap() + "\n").unwrap();
}

#[tokio::test]
async fn a_database_of_an_earlier_build_opens_and_what_it_promised_is_kept() {
    let (map, scenario, folder) = (Arc::new(map()), Scenario::parse(SCENARIO).unwrap(), Folder::new());
    std::fs::copy(fixture("floor-2.db"), folder.database()).unwrap();
    let store = Store::open(&folder.database(), &map).await.unwrap();
    let mut run = Run::restart(&map, &scenario, &store).await;
    let expected: Value =
        serde_json::from_str(&std::fs::read_to_string(fixture("floor-2.json")).unwrap()).unwrap();
    assert_eq!(promised(&store, &run.fleet).await, expected);
    let open: Vec<JobId> = run.fleet.ledger().jobs.keys().copied().collect();
    assert_eq!(open, [JobId(3), JobId(4)], "one at work and one that waits for it");
    let resume = Input::ask(1, FloorAction::Release(Some(RobotId(1))));
    let again = Input::ask(2, JobAction::Submit(deliver(1, Some("first"))));
    let (_, step) = run.step(vec![resume, again]);
    assert!(
        step.replies
            .contains(&Reply { token: 2.into(), answer: Ok(Answer::Job(Made { id: JobId(1), new: false })) }),
        "{:?}",
        step.replies
    );
    let end = run.now + Span::from_secs(600);
    while open.iter().any(|job| run.fleet.ledger().jobs.contains_key(job)) {
        assert!(run.now < end, "not done: {open:?}");
        run.step(vec![]);
    }
}
