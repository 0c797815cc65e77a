//! A database as it is after a long time: what retention keeps, filled in by SQL.
//!
//! Main function: [`fill`]. The amounts are those of `scenarios/kiva-100.json` by the hour (docs/robustness.md), so
//! that `--scenario scenarios/kiva-100.json` opens the filled database. Refuses: to be slow: indexes are made after the
//! rows.

use crate::{Store, ledger_record};
use giveway_fleet::{Job, JobKind, JobRequest, Ledger, RobotKind};
use giveway_floor::id::{Dense, JobId, RackId, StationId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::Warehouse;
use giveway_floor::warehouse::formats::json;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{AssertSqlSafe, Connection, Row};
use std::path::Path;
use std::sync::Arc;

/// The end of the time span: when everything was written.
pub const NOW: Time = Time(1_830_000_000_000_000);

const HOUR: i64 = 3_600_000_000;

/// Number of jobs that are not over, however old the database is.
pub const OPEN: i64 = 200;

/// Number of rows per hour.
struct Hourly {
    jobs: i64,
    assignments: i64,
    encounters: i64,
    events: i64,
    requests: i64,
    alarms: i64,
    changes: i64,
}

/// What a hundred robots write per hour; events are kept for a week.
const HOURLY: Hourly = Hourly {
    jobs: 3_068,
    assignments: 60,
    encounters: 120,
    events: 16_071,
    requests: 320,
    alarms: 12,
    changes: 100,
};

/// The floor that the database is about.
pub fn map() -> Arc<Warehouse> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../maps/kiva.json");
    Arc::new(json::parse(&std::fs::read_to_string(file).unwrap()).unwrap())
}

const JOBS: &str = "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < $1) \
    INSERT INTO jobs (id, kind, rack, station, robot, pick, priority, deadline, after, key, state, why, worker, \
    created, \
    updated, reference, assigned_at, lifted_at, arrived_at, ended_at) \
    SELECT i, 'deliver', i * 7919 % $4, i * 31 % $5, NULL, NULL, i % 10, iif(i % 5 = 0, at + 1800000000, NULL), '[]', \
    iif(i % 2 = 0, 'key-' || i, NULL), \
    CASE WHEN i > $1 - $6 THEN 'waiting' WHEN i % 31 = 0 THEN 'failed' WHEN i % 37 = 0 THEN 'cancelled' ELSE \
    'done' END, \
    iif(i <= $1 - $6 AND i % 31 = 0, '\"short\"', NULL), iif(i > $1 - $6, NULL, i * 13 % 100), at, \
    iif(i > $1 - $6, at, at + lasted), iif(i % 3 = 0, 'order-' || (i / 3), NULL), \
    iif(i > $1 - $6, NULL, at + 1000000), iif(i > $1 - $6, NULL, at + 30000000), \
    iif(i > $1 - $6, NULL, at + lasted - iif(i % 9973 = 0, 7200000000, 20000000)), iif(i > $1 - $6, NULL, at + lasted) \
    FROM (SELECT i, $2 + i * $3 AS at, iif(i % 9973 = 0, 90000000000, 120000000 + i % 97 * 1000000) AS lasted FROM n)";
const LABELS: &str =
    "INSERT INTO job_labels (job, key, value) SELECT id, 'wave', id / 300 FROM jobs WHERE id % 10 = 0";
const ASSIGNMENTS: &str = "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < $1) \
    INSERT INTO assignments (id, worker, place, stay, what, key, state, created, updated) \
    SELECT i, iif($2 + i * $3 < $4, NULL, i % 20), i * 17 % $5, 30000000, 'refill', NULL, \
    CASE WHEN i > $1 - 20 THEN 'waiting' WHEN i % 23 = 0 THEN 'cancelled' ELSE 'done' END, $2 + i * $3, \
    $2 + i * $3 + iif(i > $1 - 20, 0, 300000000) FROM n";
const ENCOUNTERS: &str = "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < $1) \
    INSERT INTO encounters (worker, robot, began, ended, x, y, radius, closest, robot_speed, worker_speed, reaction, \
    delay) SELECT iif($2 + i * $3 < $4, -1, i % 20), i * 13 % 100, \
    $2 + i * $3 - iif(i % 4999 = 0, 4000000000, 5000000 + i % 7 * 1000000), $2 + i * $3, i % 50000, i % 30000, \
    1500, 900, \
    800, 1100, CASE i % 11 WHEN 0 THEN 'stopped' WHEN 1 THEN 'held' WHEN 2 THEN 'rerouted' WHEN 3 THEN 'slowed' \
    ELSE 'kept' END, 0 FROM n";
const EVENTS: &str = "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < $1) \
    INSERT INTO events (seq, at, kind, subject, old, new, robot, worker, text) \
    SELECT i, $2 + i * $3, CASE WHEN i % 500 = 0 THEN 'encounter' WHEN i % 701 = 0 THEN 'worker' WHEN i % 997 = 0 \
    THEN 'station' WHEN i % 5 = 0 THEN 'robot' ELSE 'job' END, iif(i % 5 = 0, i % 100, $4 + i / 5), 'assigned', \
    'carrying', i * 13 % 100, iif(i % 701 = 0, i % 20, NULL), NULL FROM n";
const AUDIT: &str = "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < $1) \
    INSERT INTO audit (id, actor, role, what, subject, outcome) \
    SELECT $2 + i * $3, CASE WHEN i % 1009 = 0 THEN 'night shift' ELSE 'wms' END, 'operator', 'POST /v1/jobs', \
    'j' || i, \
    201 FROM n";
const ALARMS: &str = "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < $1) \
    INSERT INTO alarms (id, kind, severity, subject_kind, subject, text, remedy, waiting, since, cleared) \
    SELECT i, 'robot_failed', 'warning', 'robot', 'robot-' || (1 + i % 100), 'It is failed.', 'Repair it.', 0, \
    $2 + i * $3, iif(i > $1 - 5, NULL, $2 + i * $3 + iif(i % 501 = 0, 90000000000, 60000000)) FROM n";
const CHANGES: &str = "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < $1) \
    INSERT INTO robot_changes (id, robot, at, what) \
    SELECT i, iif(i % 50 = 0, NULL, i % 100), $2 + i * $3, 'paused' FROM n";
const STEPS: &str = "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < $1) \
    INSERT INTO steps (seq, at, wire, run, facts) SELECT $2 + i, $3, $4, 'filled', '[]' FROM n";
const HISTORY: &str = "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < $1) \
    INSERT INTO history (step, start, covered, robot_deliveries, human_deliveries, encounters, deviations, \
    interruptions, \
    replans, plans, plan_failures, worker_time, waiting_time, searches, step_max) \
    SELECT $2, $3 - i * $2, $2, 8, 0, 0, 0, 0, 0, 100, 0, 0, 0, '', 2000 FROM n";
const HEAT: &str = "WITH RECURSIVE n (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < $1) \
    INSERT INTO heat (start, node, waited) SELECT $2 - i / 200 * 300000000, i % 200, 5000000 FROM n";
const TALLY: &str = "INSERT OR REPLACE INTO robot_tallies (robot, done, failed) SELECT worker, sum(state = 'done'), \
    sum(state = 'failed') FROM jobs WHERE worker IS NOT NULL GROUP BY worker";
const SNAPSHOT: &str = "INSERT INTO snapshots (seq, at, wire, body) VALUES ($1, $2, $3, $4)";

/// Number of steps in the journal, and the number of the last one.
const JOURNAL: i64 = 2_000;
pub const LAST: i64 = 50_000;

/// Makes a database that has been in use for `hours` hours, with what is kept of them.
pub async fn fill(path: &Path, hours: i64) -> i64 {
    let map = map();
    Store::open(path, &map).await.unwrap().close().await;
    let options = SqliteConnectOptions::new().filename(path).pragma("synchronous", "OFF");
    let mut db = SqliteConnection::connect_with(&options.pragma("cache_size", "-400000")).await.unwrap();
    let indexes = "SELECT name, sql FROM sqlite_schema WHERE type = 'index' AND sql IS NOT NULL";
    let rows = sqlx::query(indexes).fetch_all(&mut db).await.unwrap();
    let indexes: Vec<(String, String)> = rows.iter().map(|row| (row.get(0), row.get(1))).collect();
    for (name, _) in &indexes {
        sqlx::query(AssertSqlSafe(format!("DROP INDEX {name}"))).execute(&mut db).await.unwrap();
    }
    let jobs = hours * HOURLY.jobs;
    rows_of(&mut db, &map, hours).await;
    snapshot(&mut db, &map, jobs).await;
    for (_, sql) in indexes {
        sqlx::query(AssertSqlSafe(sql)).execute(&mut db).await.unwrap();
    }
    db.close().await.unwrap();
    jobs
}

async fn rows_of(db: &mut SqliteConnection, map: &Warehouse, hours: i64) {
    let start = NOW.0 - hours * HOUR;
    let known = NOW.0 - 7 * 24 * HOUR;
    let (racks, stations) = (map.racks.len() as i64, map.stations.len() as i64);
    let jobs = hours * HOURLY.jobs;
    let lists: [(&'static str, Vec<i64>); 7] = [
        (JOBS, vec![jobs, start, HOUR / HOURLY.jobs, racks, stations, OPEN]),
        (LABELS, vec![]),
        (ASSIGNMENTS, of(hours, HOURLY.assignments, &[known, map.nodes.len() as i64])),
        (ENCOUNTERS, of(hours, HOURLY.encounters, &[known])),
        (EVENTS, of(hours.min(7 * 24), HOURLY.events, &[(jobs - 550_000).max(1)])),
        (AUDIT, of(hours, HOURLY.requests, &[])),
        (CHANGES, of(hours, HOURLY.changes, &[])),
    ];
    for (statement, given) in lists {
        run(db, statement, &given).await;
    }
    // No more than are kept.
    let alarms = hours.min(20_000 / HOURLY.alarms);
    run(db, ALARMS, &of(alarms, HOURLY.alarms, &[])).await;
    run(db, STEPS, &[JOURNAL, LAST - JOURNAL, NOW.0, crate::record::VERSION]).await;
    for (step, most) in giveway_fleet::history::TIERS {
        let rows = (hours * HOUR / step.0).min(most as i64);
        run(db, HISTORY, &[rows, step.0, NOW.0 / step.0 * step.0]).await;
    }
    run(db, HEAT, &[hours.min(24) * 12 * 200, NOW.0 / 300_000_000 * 300_000_000]).await;
    run(db, TALLY, &[]).await;
}

/// The parameters of a statement: number of rows, time of the first, interval, and `more`.
fn of(hours: i64, hourly: i64, more: &[i64]) -> Vec<i64> {
    let start = NOW.0 - hours * HOUR;
    [hours * hourly, start, HOUR / hourly].iter().chain(more).copied().collect()
}

async fn run(db: &mut SqliteConnection, statement: &'static str, given: &[i64]) {
    let query = given.iter().fold(sqlx::query(statement), |query, n| query.bind(*n));
    query.execute(db).await.unwrap();
}

/// Writes a ledger that matches the lists: `jobs` jobs were accepted, of which the last ones wait.
async fn snapshot(db: &mut SqliteConnection, map: &Arc<Warehouse>, jobs: i64) {
    let mut parts = Ledger::new(map.clone(), &[RobotKind::default()], false).to_parts();
    for id in jobs - OPEN + 1..=jobs {
        let rack = RackId::at((id * 7919 % map.racks.len() as i64) as usize);
        let station = StationId::at((id * 31 % map.stations.len() as i64) as usize);
        let request = JobRequest::new(JobKind::Deliver { rack, station, pick: None });
        parts.promises.jobs.insert(JobId(id.unsigned_abs()), Job::new(request, NOW));
    }
    parts.promises.next_job = jobs.unsigned_abs() + 1;
    parts.promises.next_assignment = 1_000_000_000;
    let body = ledger_record::encode(&parts);
    for seq in [LAST - JOURNAL, LAST - JOURNAL / 2] {
        let row = sqlx::query(SNAPSHOT).bind(seq).bind(NOW.0).bind(ledger_record::VERSION).bind(&body);
        row.execute(&mut *db).await.unwrap();
    }
}
