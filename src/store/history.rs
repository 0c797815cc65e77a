//! What happened over time, stored so that charts survive a restart.
//!
//! Main functions: [`Store::keep_history`], [`Store::load_history`]. Refuses: to be a dependency of anything else: rows
//! that cannot be read are left out.

use super::{BEGIN, COMMIT, Store, StoreError, settle};
use giveway_fleet::history::{Bucket, DAY, HEAT_STEP, HeatBucket, History, Lengths, RobotTimes};
use giveway_floor::id::NodeId;
use giveway_floor::time::{Span, Time};
use sqlx::Row;
use sqlx::sqlite::{SqliteConnection, SqliteRow};
use std::collections::BTreeMap;

const KEEP: &str = "INSERT OR REPLACE INTO history (step, start, covered, robot_deliveries, human_deliveries, \
    encounters, deviations, interruptions, replans, plans, plan_failures, worker_time, waiting_time, searches, \
    step_max, robots, lines, wrong_reaches, idle_time) \
    VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17, $18, $19)";
const FORGET: &str = "DELETE FROM history WHERE step = $1 AND start < $2";
const HISTORY: &str = "SELECT * FROM history ORDER BY step, start";
const COOL: &str = "DELETE FROM heat WHERE start < $1 OR start = $2";
const WARM: &str = "INSERT INTO heat (start, node, waited) VALUES ($1, $2, $3)";
const HEAT: &str = "SELECT start, node, waited FROM heat ORDER BY start, node";

impl Store {
    /// Writes buckets in place of the stored ones, and deletes buckets too old at `now`.
    ///
    /// # Errors
    /// If the database refuses the write. Then nothing was written.
    pub async fn keep_history(
        &self,
        now: Time,
        buckets: &[(Span, Bucket)],
        heat: &[HeatBucket],
    ) -> Result<(), StoreError> {
        let mut connection = self.writer.acquire().await?;
        let result = write(&mut connection, now, buckets, heat).await;
        settle(connection, result).await
    }

    /// All stored buckets with their lengths, and where robots waited.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn load_history(&self) -> Result<(Vec<(Span, Bucket)>, Vec<HeatBucket>), StoreError> {
        let rows = sqlx::query(HISTORY).fetch_all(&self.readers).await?;
        let buckets = rows.iter().filter_map(|row| bucket(row).ok()).collect();
        let mut heat: BTreeMap<Time, HeatBucket> = BTreeMap::new();
        for row in sqlx::query(HEAT).fetch_all(&self.readers).await? {
            let start = Time(row.try_get(0)?);
            let bucket = heat.entry(start).or_insert_with(|| HeatBucket { start, waited: BTreeMap::new() });
            bucket.waited.insert(NodeId(row.try_get(1)?), Span(row.try_get(2)?));
        }
        Ok((buckets, heat.into_values().collect()))
    }
}

async fn write(
    db: &mut SqliteConnection,
    now: Time,
    buckets: &[(Span, Bucket)],
    heat: &[HeatBucket],
) -> Result<(), StoreError> {
    sqlx::query(BEGIN).execute(&mut *db).await?;
    for (step, b) in buckets {
        debug_assert!(b.covered >= Span::ZERO && *step > Span::ZERO, "time passes in a bucket");
        let counts = [
            b.robot_deliveries,
            b.human_deliveries,
            b.encounters,
            b.deviations,
            b.interruptions,
            b.replans,
            b.plans,
            b.plan_failures,
        ];
        let row = sqlx::query(KEEP).bind(step.0).bind(b.start.0).bind(b.covered.0);
        let row = counts.into_iter().fold(row, |row, n| row.bind(n.cast_signed()));
        let row = row.bind(b.worker_time.0).bind(b.waiting_time.0);
        let row = row.bind(b.searches.text()).bind(b.step_max_us.cast_signed());
        let row = row.bind(b.robots.text());
        let row = row.bind(b.lines.cast_signed()).bind(b.wrong_reaches.cast_signed());
        row.bind(b.idle_time.0).execute(&mut *db).await?;
    }
    for (step, oldest) in History::kept_from(now) {
        sqlx::query(FORGET).bind(step.0).bind(oldest.0).execute(&mut *db).await?;
    }
    let oldest = now - HEAT_STEP * DAY as i64;
    for bucket in heat {
        sqlx::query(COOL).bind(oldest.0).bind(bucket.start.0).execute(&mut *db).await?;
        for (node, waited) in &bucket.waited {
            let row = sqlx::query(WARM).bind(bucket.start.0).bind(node.0).bind(waited.0);
            row.execute(&mut *db).await?;
        }
    }
    sqlx::query(COMMIT).execute(&mut *db).await?;
    Ok(())
}

fn bucket(row: &SqliteRow) -> Result<(Span, Bucket), sqlx::Error> {
    let span = |name: &str| -> Result<Span, sqlx::Error> { Ok(Span(row.try_get(name)?)) };
    let count = |name: &str| -> Result<u64, sqlx::Error> { Ok(row.try_get::<i64, _>(name)?.unsigned_abs()) };
    let searches: &str = row.try_get("searches")?;
    let robots: &str = row.try_get("robots")?;
    let bucket = Bucket {
        start: Time(row.try_get("start")?),
        covered: span("covered")?,
        robot_deliveries: count("robot_deliveries")?,
        human_deliveries: count("human_deliveries")?,
        encounters: count("encounters")?,
        deviations: count("deviations")?,
        interruptions: count("interruptions")?,
        replans: count("replans")?,
        plans: count("plans")?,
        plan_failures: count("plan_failures")?,
        worker_time: span("worker_time")?,
        waiting_time: span("waiting_time")?,
        lines: count("lines")?,
        wrong_reaches: count("wrong_reaches")?,
        idle_time: span("idle_time")?,
        robots: RobotTimes::parse(robots),
        searches: Lengths::parse(searches).unwrap_or_default(),
        step_max_us: count("step_max")?,
    };
    Ok((span("step")?, bucket))
}
