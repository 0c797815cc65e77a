//! A database that is a year old costs what a new one does: what each call of the store makes SQLite do is counted.
//!
//! Work is steps of SQLite's virtual machine, the same on every machine. Times are for docs/robustness.md only.

use super::year::{self, LAST, NOW};
use crate::listing::LOOKED_AT;
use crate::{AuditFilter, StepEntry, Store};
use giveway_fleet::alarm::AlarmQuery;
use giveway_fleet::{
    AssignmentQuery, EncounterQuery, EventKind, EventQuery, Fact, JobFact, JobKind, JobQuery, JobRequest,
    JobState, Ledger, RobotEventQuery, RobotKind,
};
use giveway_floor::id::{JobId, NodeId, RackId, RobotId, StationId, WorkerId};
use giveway_floor::time::{Span, Time};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

const MINUTE: Span = Span::from_secs(60);

/// Counts the steps of SQLite in all calls of a store from now on.
async fn count_steps(store: &Store) -> Arc<AtomicU64> {
    let steps = Arc::new(AtomicU64::new(0));
    let mut all = vec![store.writer.acquire().await.unwrap()];
    for _ in 0..super::super::READERS {
        all.push(store.readers.acquire().await.unwrap());
    }
    for connection in &mut all {
        let steps = steps.clone();
        let one = move || {
            steps.fetch_add(1, Ordering::Relaxed);
            true
        };
        connection.lock_handle().await.unwrap().set_progress_handler(1, one);
    }
    steps
}

/// The cost of a call.
struct Cost {
    what: &'static str,
    steps: u64,
    time: Duration,
}

/// The queries of a store: every list with every filter by itself, and combined filters.
struct ListQueries {
    jobs: Vec<(&'static str, JobQuery)>,
    /// Filters that no index answers together.
    mixed: Vec<(&'static str, JobQuery)>,
    assignments: Vec<(&'static str, AssignmentQuery)>,
    encounters: Vec<(&'static str, EncounterQuery)>,
}

fn asked() -> ListQueries {
    let (ago, before) = (Some(NOW - MINUTE * 30), Some(NOW - MINUTE * 15));
    let jobs = JobQuery { limit: 50, ..JobQuery::default() };
    let tasks = AssignmentQuery { limit: 10, ..AssignmentQuery::default() };
    let met = EncounterQuery { limit: 10, ..EncounterQuery::default() };
    let rack = Some(RackId(8));
    ListQueries {
        jobs: vec![
            ("jobs", jobs.clone()),
            ("jobs: state=done", JobQuery { states: vec!["done"], ..jobs.clone() }),
            ("jobs: state=waiting", JobQuery { states: vec!["waiting"], ..jobs.clone() }),
            ("jobs: state=failed", JobQuery { states: vec!["failed"], ..jobs.clone() }),
            ("jobs: station", JobQuery { station: Some(StationId(3)), ..jobs.clone() }),
            ("jobs: robot", JobQuery { robot: Some(RobotId(7)), limit: 10, ..jobs.clone() }),
            ("jobs: rack", JobQuery { rack, limit: 1, ..jobs.clone() }),
            ("jobs: rack, state", JobQuery { rack, states: vec!["done"], limit: 1, ..jobs.clone() }),
            ("jobs: reference", JobQuery { reference: Some("order-5".into()), ..jobs.clone() }),
            ("jobs: label", JobQuery { label: Some(("wave".into(), "7".into())), ..jobs.clone() }),
            ("jobs: from, to", JobQuery { from: ago, to: before, ..jobs.clone() }),
            ("jobs: to", JobQuery { to: before, ..jobs.clone() }),
            ("jobs: updated_since", JobQuery { updated_since: ago, ..jobs.clone() }),
            ("jobs: one minute's changes", JobQuery { updated_since: Some(NOW - MINUTE), ..jobs.clone() }),
        ],
        mixed: vec![
            (
                "jobs: station and robot",
                JobQuery { station: Some(StationId(2)), robot: Some(RobotId(3)), ..jobs.clone() },
            ),
            ("jobs: rack and station", JobQuery { rack, station: Some(StationId(2)), ..jobs.clone() }),
            ("jobs: old changes of a rack", JobQuery { rack, updated_since: Some(Time(0)), ..jobs.clone() }),
            (
                "jobs: failed, old changes",
                JobQuery { states: vec!["failed"], updated_since: Some(Time(0)), ..jobs },
            ),
        ],
        assignments: vec![
            ("assignments", tasks.clone()),
            ("assignments: worker", AssignmentQuery { worker: Some(WorkerId(1)), limit: 1, ..tasks.clone() }),
            ("assignments: place", AssignmentQuery { place: Some(NodeId(17)), limit: 1, ..tasks.clone() }),
            ("assignments: state", AssignmentQuery { states: vec!["done"], ..tasks.clone() }),
            ("assignments: from", AssignmentQuery { from: ago, ..tasks.clone() }),
            ("assignments: updated_since", AssignmentQuery { updated_since: ago, ..tasks }),
        ],
        encounters: vec![
            ("encounters", met.clone()),
            ("encounters: worker", EncounterQuery { worker: Some(WorkerId(1)), limit: 1, ..met.clone() }),
            ("encounters: robot", EncounterQuery { robot: Some(RobotId(13)), limit: 1, ..met.clone() }),
            ("encounters: reaction", EncounterQuery { reactions: vec!["held"], ..met.clone() }),
            ("encounters: from, to", EncounterQuery { from: ago, to: before, ..met.clone() }),
            ("encounters: to", EncounterQuery { to: before, ..met.clone() }),
            ("encounters: updated_since", EncounterQuery { updated_since: ago, ..met }),
        ],
    }
}

/// Steps of a fleet that lead a job from its beginning to its end.
fn job_steps(first: i64, count: i64, at: Time) -> Vec<StepEntry> {
    let robot = RobotId(3);
    let of = |n: i64| {
        let (job, at) = (JobId(n.unsigned_abs()), at + Span(n));
        let kind = JobKind::Deliver { rack: RackId(1), station: StationId(1), pick: None };
        let progress = |state| Fact::Job(JobFact::Progressed { job, state, tasked: None, at });
        let facts = vec![
            Fact::Job(JobFact::Accepted { job, request: JobRequest::new(kind), at }),
            progress(JobState::Assigned { robot }),
            progress(JobState::Carrying { robot }),
            progress(JobState::Picking { robot }),
            progress(JobState::Done),
        ];
        StepEntry { at, facts, causes: Vec::new() }
    };
    (first..first + count).map(of).collect()
}

/// Calls everything, each call `rounds` times.
struct StoreCaller {
    store: Store,
    steps: Arc<AtomicU64>,
    rounds: u32,
    costs: Vec<Cost>,
}

impl StoreCaller {
    async fn call<T>(&mut self, what: &'static str, work: impl AsyncFn(&Store) -> T) {
        work(&self.store).await;
        let (mut steps, mut times) = (0, Vec::new());
        for _ in 0..self.rounds {
            let (before, began) = (self.steps.load(Ordering::Relaxed), Instant::now());
            work(&self.store).await;
            times.push(began.elapsed());
            steps = self.steps.load(Ordering::Relaxed) - before;
        }
        times.sort();
        self.costs.push(Cost { what, steps, time: times[times.len() / 2] });
    }

    async fn call_all(&mut self, jobs: i64) {
        let next = AtomicU64::new(0);
        self.call("append a step with a whole job", async |store| {
            let n = next.fetch_add(1, Ordering::Relaxed).cast_signed();
            store.append(LAST + 1 + n, &job_steps(jobs + 1 + n, 1, NOW)).await.unwrap();
        })
        .await;
        self.call("start: ledger, charts, alarms", async |store| {
            store.load(Ledger::new(year::map(), &[RobotKind::default()], false)).await.unwrap();
            store.active_alarms(NOW).await.unwrap();
            store.last_audit().await.unwrap();
        })
        .await;
        let ListQueries { jobs, mixed, assignments, encounters } = asked();
        for (what, q) in jobs.into_iter().chain(mixed) {
            self.call(what, async |store| store.jobs(&q).await.unwrap()).await;
        }
        for (what, q) in assignments {
            self.call(what, async |store| store.assignments(&q).await.unwrap()).await;
        }
        for (what, q) in encounters {
            self.call(what, async |store| store.encounters(&q).await.unwrap()).await;
        }
        self.call_others().await;
    }

    async fn call_others(&mut self) {
        let (ago, half) = (NOW - MINUTE * 50, NOW - MINUTE * 20);
        self.call("report of the last 20 minutes", async |store| {
            store.shift((half, NOW), NOW).await.unwrap()
        })
        .await;
        self.call("report of 30 minutes before", async |store| store.shift((ago, half), NOW).await.unwrap())
            .await;
        let events = |kinds, after| EventQuery { kinds, after, limit: 50 };
        self.call("events", async |store| store.events(&events(vec![], 100)).await.unwrap()).await;
        let rare = vec![EventKind::Worker, EventKind::Encounter];
        let q = events(rare, 0);
        self.call("events of rare kinds", async |store| store.events(&q).await.unwrap()).await;
        self.call("which events are kept", async |store| store.event_span().await.unwrap()).await;
        let life = RobotEventQuery {
            robot: RobotId(7),
            name: "robot-8".into(),
            from: None,
            to: None,
            before: None,
            limit: 1,
        };
        self.call("what happened to a robot", async |store| store.robot_events(&life).await.unwrap()).await;
        self.call("jobs of a robot", async |store| store.robot_jobs(RobotId(7)).await.unwrap()).await;
        let audit = AuditFilter { limit: 50, ..AuditFilter::default() };
        self.call("audit", async |store| store.audit(&audit).await.unwrap()).await;
        let actor = AuditFilter { actor: Some("wms".into()), from: Some(ago), ..audit.clone() };
        self.call("audit: actor, from", async |store| store.audit(&actor).await.unwrap()).await;
        let alarms = |from, to| AlarmQuery { from, to, group: None, before: None, limit: 5 };
        let q = alarms(None, None);
        self.call("alarms", async |store| store.alarms(&q).await.unwrap()).await;
        let q = AlarmQuery { limit: 20_000, ..alarms(Some(ago), Some(half)) };
        self.call("alarms of 30 minutes", async |store| store.alarms(&q).await.unwrap()).await;
    }
}

/// The cost of every call on a database.
async fn costs(path: &Path, jobs: i64, rounds: u32) -> Vec<Cost> {
    let store = Store::open(path, &year::map()).await.unwrap();
    let steps = count_steps(&store).await;
    let mut caller = StoreCaller { store, steps, rounds, costs: Vec::new() };
    caller.call_all(jobs).await;
    caller.store.close().await;
    caller.costs
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("giveway-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// The calls that cost too much: half as much again as on a new database, or, for filters that no index answers
/// together, more than the rows that may be looked at.
fn too_much(new: &[Cost], old: &[Cost]) -> Vec<String> {
    let mut mixed: Vec<&str> = asked().mixed.iter().map(|(what, _)| *what).collect();
    // Encounters are in the order of their ends: their beginnings are a condition.
    mixed.push("encounters: to");
    let mut found = Vec::new();
    for (new, old) in new.iter().zip(old) {
        let most =
            if mixed.contains(&new.what) { 100 * LOOKED_AT.unsigned_abs() } else { new.steps * 3 / 2 + 100 };
        if old.steps > most {
            found.push(format!(
                "{}: {} steps of SQLite on a new database, {} on an old one",
                old.what, new.steps, old.steps
            ));
        }
    }
    found
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_old_database_makes_no_more_work_than_a_new_one() {
    let folder = folder("aged");
    let (new, old) = (folder.join("new.sqlite"), folder.join("old.sqlite"));
    let (few, many) = (year::fill(&new, 2).await, year::fill(&old, 20).await);
    let (new, old) = (costs(&new, few, 1).await, costs(&old, many, 1).await);
    std::fs::remove_dir_all(folder).unwrap();
    let found = too_much(&new, &old);
    assert!(found.is_empty(), "{} of {}:\n{}", found.len(), new.len(), found.join("\n"));
}

/// Prints the table of docs/robustness.md. `GIVEWAY_HOURS` is the age of the database, a year if absent; with
/// `GIVEWAY_YEAR` it stays in that file, and a server with `scenarios/kiva-100.json` opens it.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "a measurement: half an hour and 15 GB of disk"]
async fn a_year_of_100_robots() {
    let hours = std::env::var("GIVEWAY_HOURS").map_or(365 * 24, |text| text.parse().unwrap());
    let folder = folder("year");
    let new = folder.join("new.sqlite");
    let old = std::env::var("GIVEWAY_YEAR").map_or(folder.join("old.sqlite"), PathBuf::from);
    let few = year::fill(&new, 2).await;
    let began = Instant::now();
    let many = year::fill(&old, hours).await;
    let size = std::fs::metadata(&old).unwrap().len() as f64 / 1e9;
    println!("{hours} hours, {many} jobs, {size:.1} GB, filled in {:.0} s", began.elapsed().as_secs_f64());
    for (name, path) in [("new", &new), ("old", &old)] {
        let began = Instant::now();
        let store = Store::open(path, &year::map()).await.unwrap();
        println!("{name}: opened in {:.1} ms", began.elapsed().as_secs_f64() * 1000.0);
        store.close().await;
    }
    let (new, old) = (costs(&new, few, 21).await, costs(&old, many, 21).await);
    println!("| | new: steps | ms | old: steps | ms | work |\n|---|---|---|---|---|---|");
    for (new, old) in new.iter().zip(&old) {
        let ms = |time: Duration| time.as_secs_f64() * 1000.0;
        let ratio = old.steps as f64 / new.steps as f64;
        println!(
            "| {} | {} | {:.2} | {} | {:.2} | {ratio:.2} |",
            new.what,
            new.steps,
            ms(new.time),
            old.steps,
            ms(old.time)
        );
    }
    let found = too_much(&new, &old);
    std::fs::remove_dir_all(folder).unwrap();
    assert!(found.is_empty(), "{} of {}:\n{}", found.len(), new.len(), found.join("\n"));
}
