//! The journal: cut at every commit, snapshots, what is deleted, and what is refused in words.

use crate::helper::{Folder, map};
use crate::run::{Keeper, Run, deliver, nothing};
use giveway::fleet::{
    Answer, AreaFact, AssignmentFact, Encounter, EncounterFact, EncounterQuery, Fact, Fleet, FloorFact,
    Input, JobAction, JobFact, JobQuery, JobState, Made, Reaction, Reply, RouteFact,
};
use giveway::geometry::Spot;
use giveway::id::{JobId, RobotId, WorkerId};
use giveway::sim::{Scenario, Simulation};
use giveway::store::{StepEntry, Store, StoreError, ledger_record};
use giveway::time::{Span, Time};
use giveway::warehouse::Warehouse;
use giveway::warehouse::thesis;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{AssertSqlSafe, Connection};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const BUSY: &str = r#"{"giveway_scenario": 1, "name": "busy", "map": "", "robots": 2, "period_ms": 100,
    "jobs": {"backlog": 3}, "faults": {"failures_per_hour": 60, "repair_s": 5},
    "fleet": {"speed_mps": 3, "accel_unloaded_mps2": 3, "accel_loaded_mps2": 3, "lift_s": 0.3}}"#;

const PEOPLE: &str = r#"{"giveway_scenario": 1, "name": "people", "map": "", "robots": 10, "period_ms": 100,
    "jobs": {"backlog": 12},
    "duration_s": 240, "faults": {"failures_per_hour": 20, "repair_s": 20, "message_loss": 0.05},
    "workers": {"count": 2, "enter_s": 10, "deviations": {"at_s": [40, 90, 150], "causes": "all"}},
    "closures": [{"outline": [[5.8, 0.8], [6.2, 0.8], [6.2, 6.2], [5.8, 6.2]], "from_s": 60, "until_s": 120,
        "reason": "repair"}]}"#;

fn floor(text: &str) -> (Arc<Warehouse>, Scenario) {
    (Arc::new(map()), Scenario::parse(text).unwrap())
}

async fn other(database: &Path) -> SqliteConnection {
    SqliteConnection::connect_with(&SqliteConnectOptions::new().filename(database)).await.unwrap()
}

async fn sql(database: &Path, statement: &'static str) {
    let mut connection = other(database).await;
    sqlx::query(statement).execute(&mut connection).await.unwrap();
    connection.close().await.unwrap();
}

async fn number(database: &Path, query: &'static str) -> i64 {
    let mut connection = other(database).await;
    let found = sqlx::query_scalar(query).fetch_one(&mut connection).await.unwrap();
    connection.close().await.unwrap();
    found
}

pub fn log_of(database: &Path) -> PathBuf {
    let mut name = database.as_os_str().to_owned();
    name.push("-wal");
    name.into()
}

/// Where the commits in a write-ahead log end, in bytes: after frames that say how large the database is then.
pub fn commits(log: &[u8]) -> Vec<usize> {
    let word = |at: usize| u32::from_be_bytes(log[at..at + 4].try_into().unwrap()) as usize;
    let (header, frame) = (32, 24 + word(8));
    assert!(log[header..].len().is_multiple_of(frame), "whole frames");
    (header..log.len()).step_by(frame).filter(|at| word(at + 4) != 0).map(|at| at + frame).collect()
}

/// A floor that was at work, as the disk had it: the main file before, the log, and for each commit's end how many jobs
/// had been acknowledged then.
struct Past {
    main: Vec<u8>,
    log: Vec<u8>,
    acknowledged: Vec<(usize, Vec<JobId>)>,
}

/// Lets a floor work and keeps the whole log: another connection reads, so that nothing is moved into the main file.
async fn work(map: &Arc<Warehouse>, scenario: &Scenario, seconds: i64) -> Past {
    let folder = Folder::new();
    let store = Store::open(&folder.database(), map).await.unwrap();
    let main = std::fs::read(folder.database()).unwrap();
    let mut reader = other(&folder.database()).await;
    sqlx::query("BEGIN").execute(&mut reader).await.unwrap();
    sqlx::query("SELECT count(*) FROM steps").execute(&mut reader).await.unwrap();
    let mut run = Run::restart(map, scenario, &store).await;
    let (mut steps, mut acknowledged, mut known) = (Vec::new(), Vec::new(), Vec::new());
    let (mut next, mut count, mut answers) = (1, 0_u32, Vec::new());
    let end = run.now + Span::from_secs(seconds);
    while run.now < end {
        count += 1;
        let request = deliver(count % 7, Some(&format!("key {count}")));
        let extra =
            if count.is_multiple_of(50) { vec![Input::ask(1, JobAction::Submit(request))] } else { vec![] };
        let (entry, step) = run.step(extra);
        answers.extend(step.replies);
        if !entry.facts.is_empty() {
            steps.push(entry);
        }
        // As the server: what waits becomes one transaction.
        if count.is_multiple_of(3) && !steps.is_empty() {
            store.append(next, &steps).await.unwrap();
            next += steps.len() as i64;
            steps.clear();
            known.extend(answers.drain(..).filter_map(|reply| match reply {
                Reply { answer: Ok(Answer::Job(Made { id: job, .. })), .. } => Some(job),
                _ => None,
            }));
            let length = std::fs::metadata(log_of(&folder.database())).unwrap().len() as usize;
            acknowledged.push((length, known.clone()));
        }
    }
    assert!(run.fleet.ledger().counts.robot_deliveries > 0, "it delivered");
    let log = std::fs::read(log_of(&folder.database())).unwrap();
    Past { main, log, acknowledged }
}

impl Past {
    /// A folder with the database as it is if the process is killed when so many bytes of the log were written.
    fn cut(&self, bytes: usize) -> Folder {
        let folder = Folder::new();
        std::fs::write(folder.database(), &self.main).unwrap();
        std::fs::write(log_of(&folder.database()), &self.log[..bytes]).unwrap();
        folder
    }

    /// Jobs that had been acknowledged when so many bytes of the log were written.
    fn acknowledged(&self, bytes: usize) -> &[JobId] {
        let known = self.acknowledged.iter().rev().find(|(length, _)| *length <= bytes);
        known.map_or(&[], |(_, jobs)| jobs)
    }
}

/// A start from such a database goes on, and has every job.
async fn goes_on(map: &Arc<Warehouse>, scenario: &Scenario, folder: &Folder, jobs: &[JobId]) -> i64 {
    let store = Store::open(&folder.database(), map).await.unwrap();
    let next = store.load(nothing(map, scenario)).await.unwrap().next;
    let mut run = Run::restart(map, scenario, &store).await;
    for job in jobs {
        let listed = store.job(*job).await.unwrap().expect("an acknowledged job is in the list").job;
        let live = run.fleet.ledger().jobs.get(job).map(|j| j.state);
        assert_eq!(live, (!listed.state.is_over()).then_some(listed.state), "{job:?}");
    }
    for _ in 0..30 {
        run.step(vec![]);
    }
    run.fleet.ledger().timeline().assert_sound();
    next
}

#[tokio::test]
async fn a_start_from_the_log_cut_at_any_commit_goes_on_and_has_every_acknowledged_job() {
    let (map, scenario) = floor(BUSY);
    let past = work(&map, &scenario, 150).await;
    let ends = commits(&past.log);
    assert!(ends.len() > 150, "only {} commits", ends.len());
    let mut most = 0;
    for &end in &ends {
        let next = goes_on(&map, &scenario, &past.cut(end), past.acknowledged(end)).await;
        assert!(next >= most, "a later commit has no fewer steps");
        most = next;
        // Within the commit that follows: as if it had not begun.
        let torn = (end + 24 + 1000).min(past.log.len());
        let folder = past.cut(torn);
        let store = Store::open(&folder.database(), &map).await.unwrap();
        assert_eq!(store.load(nothing(&map, &scenario)).await.unwrap().next, next, "cut at byte {torn}");
    }
    assert!(past.acknowledged(past.log.len()).len() > 8, "there were jobs");
}

#[test]
fn a_ledger_from_a_snapshot_and_the_facts_behind_it_is_the_fold_of_all_facts() {
    let (map, scenario) = (Arc::new(thesis()), Scenario::parse(PEOPLE).unwrap());
    for seed in [1, 2] {
        let mut sim = Simulation::new(map.clone(), &scenario, &[], seed, false, || 0);
        let (mut ledgers, mut pause, mut count) = (Vec::new(), 1, 0);
        let mut seen = [false; 4];
        while !sim.is_over() {
            let turn = sim.step();
            for fact in turn.facts() {
                ledgers.iter_mut().for_each(|l: &mut giveway::fleet::Ledger| l.evolve(fact));
                seen[0] |= matches!(fact, Fact::Route(RouteFact::Truncated { .. }));
                seen[1] |= matches!(fact, Fact::Assignment(AssignmentFact::Assigned { .. }));
                seen[2] |= matches!(fact, Fact::Area(AreaFact::Closed { .. }));
                seen[3] |= matches!(fact, Fact::Route(RouteFact::Retimed { .. }));
            }
            count += 1;
            if count == pause {
                (pause, count) = (pause * 29 % 211, 0);
                let text = ledger_record::encode(&sim.fleet().ledger().to_parts());
                let kinds = &scenario.site.kinds;
                let read = ledger_record::decode(ledger_record::VERSION, &text, &map, kinds).unwrap();
                read.timeline().assert_sound();
                ledgers.push(read);
            }
        }
        assert_eq!(seen, [true; 4], "robots failed and were late, people worked, an area was closed");
        assert!(ledgers.len() > 10);
        let apart = ledgers.iter().position(|l| l != sim.fleet().ledger());
        assert_eq!(apart, None, "the snapshot that leads elsewhere, seed {seed}");
        assert_eq!(sim.outcome().law_violations, 0);
    }
}

#[test]
fn a_snapshot_in_which_two_robots_hold_one_place_is_refused_in_words() {
    let (map, scenario) = floor(BUSY);
    let mut run = Run::new(&map, &scenario, Fleet::new(map.clone(), scenario.site.settings()), Time::ZERO);
    (0..100).for_each(|_| drop(run.step(vec![])));
    let kinds = &scenario.site.kinds;
    let mut parts = run.fleet.ledger().to_parts();
    let read = |parts: &_| {
        let text = ledger_record::encode(parts);
        ledger_record::decode(ledger_record::VERSION, &text, &map, kinds).map_err(|e| e.to_string())
    };
    assert_eq!(read(&parts).unwrap(), *run.fleet.ledger());
    let place = parts.chains[0].visits.last().unwrap().clone();
    *parts.chains[1].visits.last_mut().unwrap() = place;
    let error = read(&parts).unwrap_err();
    assert!(error.contains("restore the database from a backup"), "{error}");
    assert!(error.contains("out of order") || error.contains("is held by"), "{error}");
    let newer = ledger_record::decode(ledger_record::VERSION + 1, "{}", &map, kinds).unwrap_err();
    assert!(newer.to_string().contains("newer Giveway"), "{newer}");
}

/// Lets a floor work with a snapshot after every so many steps; gives the ledger in the end.
async fn keep(folder: &Folder, steps: usize, every: usize) -> giveway::fleet::Ledger {
    let (map, scenario) = floor(BUSY);
    let store = Store::open(&folder.database(), &map).await.unwrap();
    let mut run = Run::restart(&map, &scenario, &store).await;
    let mut keeper = Keeper::new(store, nothing(&map, &scenario));
    let mut written = 0;
    let until = run.now + Span::from_secs(3600);
    while written < steps {
        assert!(
            run.now < until,
            "after an hour {written} of {steps} steps had facts: the floor has nothing to do"
        );
        let (entry, _) = run.step(vec![]);
        if !entry.facts.is_empty() {
            written += 1;
            keeper.append(std::slice::from_ref(&entry)).await;
            if written.is_multiple_of(every) {
                keeper.snapshot(entry.at).await;
            }
        }
    }
    keeper.store.close().await;
    run.fleet.ledger().clone()
}

async fn reload(folder: &Folder) -> Result<giveway::fleet::Ledger, StoreError> {
    let (map, scenario) = floor(BUSY);
    let store = Store::open(&folder.database(), &map).await?;
    let (ledger, facts) = store.load(nothing(&map, &scenario)).await?.into_parts();
    Ok(Fleet::resume(ledger, scenario.site.settings(), facts).ledger().clone())
}

#[tokio::test]
async fn steps_behind_the_older_of_two_snapshots_go_and_a_damaged_snapshot_is_not_needed() {
    let folder = Folder::new();
    let ledger = keep(&folder, 130, 40).await;
    let at = folder.database();
    assert_eq!(number(&at, "SELECT count(*) FROM snapshots").await, 2, "the last two");
    assert_eq!(number(&at, "SELECT min(seq) FROM snapshots").await, 80);
    assert_eq!(number(&at, "SELECT min(seq) FROM steps").await, 81, "what no start needs is deleted");
    assert_eq!(reload(&folder).await.unwrap(), ledger);
    sql(&at, "UPDATE snapshots SET body = '{' WHERE seq = 120").await;
    assert_eq!(reload(&folder).await.unwrap(), ledger, "the one before and the steps behind it say the same");
    sql(&at, "UPDATE snapshots SET body = '{'").await;
    let error = reload(&folder).await.unwrap_err().to_string();
    assert!(
        error.contains("snapshot 120") && error.contains("restore the database from a backup"),
        "{error}"
    );
}

#[tokio::test]
async fn a_step_that_cannot_be_read_and_one_that_is_missing_are_refused_in_words() {
    let folder = Folder::new();
    keep(&folder, 20, 1000).await;
    sql(&folder.database(), "UPDATE steps SET facts = substr(facts, 1, 9) WHERE seq = 20").await;
    let error = reload(&folder).await.unwrap_err().to_string();
    assert!(error.contains("step 20") && error.contains("restore the database from a backup"), "{error}");
    sql(&folder.database(), "DELETE FROM steps WHERE seq = 9").await;
    let error = reload(&folder).await.unwrap_err().to_string();
    assert!(error.contains("step 10 where step 9 should be"), "{error}");
}

#[tokio::test]
async fn a_database_from_before_the_first_release_is_refused_with_what_to_do() {
    let folder = Folder::new();
    let mut old = other_new(&folder.database()).await;
    let journal = include_str!("../../migrations/sqlite/0001_journal.sql");
    sqlx::raw_sql(AssertSqlSafe(journal)).execute(&mut old).await.unwrap();
    let row = "INSERT INTO journal (seq, at, wire, fact) VALUES (1, 5, 1, '{}')";
    sqlx::query(row).execute(&mut old).await.unwrap();
    old.close().await.unwrap();
    let error = Store::open(&folder.database(), &map()).await.unwrap_err().to_string();
    assert!(
        error.contains("before the first release") && error.contains("use another --database"),
        "{error}"
    );
    assert_eq!(number(&folder.database(), "SELECT count(*) FROM journal").await, 1, "nothing was changed");
}

async fn other_new(database: &Path) -> SqliteConnection {
    let options = SqliteConnectOptions::new().filename(database).create_if_missing(true);
    SqliteConnection::connect_with(&options).await.unwrap()
}

#[tokio::test]
async fn a_process_whose_database_another_one_has_opened_since_writes_nothing_more() {
    let folder = Folder::new();
    let store = Store::open(&folder.database(), &map()).await.unwrap();
    let step = |i: i64| StepEntry {
        at: Time(i),
        facts: vec![Fact::Floor(FloorFact::Halted { robot: None, at: Time(i) })],
        causes: Vec::new(),
    };
    store.append(1, &[step(1)]).await.unwrap();
    let own = "SELECT count(*) FROM steps WHERE run = (SELECT value FROM about WHERE key = 'run')";
    assert_eq!(number(&folder.database(), own).await, 1, "each step says by whom it was written");
    sql(&folder.database(), "UPDATE about SET value = 'another' WHERE key = 'run'").await;
    let error = store.append(2, &[step(2)]).await.unwrap_err();
    assert!(matches!(error, StoreError::Taken(_)) && error.is_fatal(), "{error}");
    assert_eq!(number(&folder.database(), "SELECT max(seq) FROM steps").await, 1);
}

#[tokio::test]
async fn what_is_over_leaves_the_lists_after_the_days_of_the_settings_in_slices() {
    const DAY: Span = Span::from_secs(24 * 3600);
    let folder = Folder::new();
    let store = Store::open(&folder.database(), &map()).await.unwrap().keep_days(30);
    let met = |at: Time| Encounter {
        worker: WorkerId(0),
        robot: RobotId(0),
        began: at,
        ended: at,
        at: Spot { x_mm: 0, y_mm: 0 },
        radius_mm: 1,
        closest_mm: 1,
        robot_mmps: 1,
        worker_mmps: 1,
        reaction: Reaction::Kept,
        delay: Span::ZERO,
    };
    let over = |job: JobId, at: Time| {
        Fact::Job(JobFact::Progressed { job, state: JobState::Cancelled, tasked: None, at })
    };
    let accepted = |job: JobId, at: Time| Fact::Job(JobFact::Accepted { job, request: deliver(0, None), at });
    // Job 1 stays open, 2 to 500 are over on the first day, 501 on the 25th.
    let mut facts = vec![accepted(JobId(1), Time(0))];
    facts.extend((2..=500).flat_map(|i| [accepted(JobId(i), Time(0)), over(JobId(i), Time(0))]));
    facts.push(Fact::Encounter(EncounterFact::Met(met(Time(0)))));
    store.append(1, &[StepEntry { at: Time(0), facts, causes: Vec::new() }]).await.unwrap();
    let late = Time(0) + DAY * 25;
    let facts = vec![
        accepted(JobId(501), late),
        over(JobId(501), late),
        Fact::Encounter(EncounterFact::Met(met(late))),
    ];
    store.append(2, &[StepEntry { at: late, facts, causes: Vec::new() }]).await.unwrap();
    assert_eq!(store.count_jobs().await.unwrap(), (501, 1), "nothing is old yet");
    let tick = |i: i64| StepEntry {
        at: Time(0) + DAY * 31,
        facts: vec![Fact::Floor(FloorFact::Released { robot: None, at: Time(i) })],
        causes: Vec::new(),
    };
    store.append(3, &[tick(3)]).await.unwrap();
    assert_eq!(store.count_jobs().await.unwrap().0, 451, "a slice");
    for i in 4..13 {
        store.append(i, &[tick(i)]).await.unwrap();
    }
    let all = JobQuery { limit: 1000, ..JobQuery::default() };
    let left: Vec<JobId> = store.jobs(&all).await.unwrap().rows.iter().map(|row| row.id).collect();
    assert_eq!(left, [JobId(501), JobId(1)], "what is open stays, and what is not old");
    let all = EncounterQuery { limit: 10, ..EncounterQuery::default() };
    let left: Vec<_> =
        store.encounters(&all).await.unwrap().rows.iter().map(|row| (row.seq, row.encounter.began)).collect();
    assert_eq!(left, [(2, late)]);
}
