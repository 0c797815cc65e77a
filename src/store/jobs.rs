//! The list of jobs: what the facts say about each, ready to be listed.
//!
//! Refuses: names, since the map gives them to ids elsewhere.

use super::gone::Gone;
use super::job_record::{ChoiceRecord, StationRecord, visiting};
use super::line_record::LinesRecord;
use super::listing::{Arm, Given, Listing, Reach, RowCondition, TimeStatements};
use super::{Store, StoreError, job_record};
use giveway_cell::{LineChange, LineOutcome, Lines};
use giveway_fleet::{
    ClientKey, Fact, JOB_STATES, Job, JobFact, JobKind, JobParts, JobQuery, JobRequest, JobRow, JobState,
    JobTimes, JobWord, Listed, RobotChoice,
};
use giveway_floor::id::{JobId, NodeId, RackId, RobotId, StationId};
use giveway_floor::time::{Span, Time};
use serde::{Deserialize, Serialize};
use sqlx::sqlite::{SqliteConnection, SqliteRow};
use sqlx::{QueryBuilder, Row, Sqlite};

/// The stations of a delivery besides the one at which the rack is wanted now, or was wanted last.
#[derive(Default, Serialize, Deserialize)]
pub(super) struct StopsRecord {
    /// The stations that were served, and when.
    served: Vec<(StationRecord, i64)>,
    /// The stations that follow.
    then: Vec<StationRecord>,
}

impl StopsRecord {
    /// Replaces the ids of stations.
    pub fn renumber(&mut self, id: impl Fn(u32) -> u32) {
        let visits = self.served.iter_mut().map(|(visit, _)| visit).chain(&mut self.then);
        visits.for_each(|(station, _)| *station = id(*station));
    }
}

/// The columns of jobs that are read, up to their numbers.
const SOME: &str = "SELECT id, kind, rack, station, node, robot, pick, priority, deadline, after, key, state, why, \
    worker, created, updated, reference, stops, lines, choice, assigned_at, lifted_at, arrived_at, ended_at, changed, \
    (SELECT json_group_object(key, value) FROM job_labels WHERE job = jobs.id) AS labels FROM jobs WHERE id IN (";
/// The order of a page of jobs.
const NEWEST_FIRST: &str = ") ORDER BY id DESC LIMIT ";
/// The first job accepted at a time or later.
const FIRST: &str =
    "SELECT id FROM jobs INDEXED BY jobs_by_acceptance WHERE created >= $1 ORDER BY created, id LIMIT 1";
/// The first job that was open for days and changed at a time or later.
const FIRST_OF_DAYS: &str = "SELECT min(id) FROM jobs INDEXED BY jobs_of_days \
    WHERE updated - created > 86400000000 AND updated >= $1";
/// Number of jobs that changed at a time or later, counted up to a limit.
const CHANGED: &str =
    "SELECT count(*) FROM (SELECT 1 FROM jobs INDEXED BY jobs_by_change WHERE updated >= $1 LIMIT $2)";

const ACCEPT: &str = "INSERT INTO jobs \
    (id, kind, rack, station, node, robot, pick, priority, deadline, after, key, state, created, updated, reference, \
    stops, lines) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, 'waiting', $12, $12, $13, $14, $15)";
const LABEL: &str = "INSERT INTO job_labels (job, key, value) VALUES ($1, $2, $3)";
const PROGRESS: &str = "UPDATE jobs SET state = $2, why = $3, worker = $4, updated = $5, \
    choice = CASE $2 WHEN 'waiting' THEN choice ELSE NULL END, \
    assigned_at = CASE $2 WHEN 'waiting' THEN NULL WHEN 'assigned' THEN $5 ELSE assigned_at END, \
    lifted_at = CASE $2 WHEN 'carrying' THEN $5 WHEN 'picking' THEN lifted_at ELSE NULL END, \
    arrived_at = CASE $2 WHEN 'picking' THEN $5 ELSE NULL END WHERE id = $1";
const FINISH: &str = "UPDATE jobs SET state = $2, why = $3, updated = $4, ended_at = $4 WHERE id = $1";
const STOPS: &str = "SELECT station, pick, stops FROM jobs WHERE id = $1";
const SERVE: &str = "UPDATE jobs SET state = 'carrying', station = $2, pick = $3, stops = $4, updated = $5, \
    arrived_at = NULL WHERE id = $1";
const LINES: &str = "SELECT lines, stops FROM jobs WHERE id = $1";
const SET_LINES: &str = "UPDATE jobs SET lines = $2, updated = $3 WHERE id = $1";
const CHOOSE: &str = "UPDATE jobs SET choice = $2, updated = $3 WHERE id = $1";
const PRIORITISE: &str = "UPDATE jobs SET priority = $2, updated = $3, changed = 1 WHERE id = $1";
const CHANGE: &str = "UPDATE jobs SET station = $2, robot = $3, priority = $4, deadline = $5, updated = $6, \
    changed = 1 WHERE id = $1";
const COUNT: &str =
    "SELECT count(*), coalesce(sum(state NOT IN ('done', 'cancelled', 'failed')), 0) FROM jobs";

impl Store {
    /// One job.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn job(&self, id: JobId) -> Result<Option<JobRow>, StoreError> {
        let Ok(id) = i64::try_from(id.0) else { return Ok(None) };
        let row = one(id).build().fetch_optional(&self.readers).await?;
        row.map(|row| decode(&row, &self.gone)).transpose()
    }

    /// A page of jobs, newest first.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn jobs(&self, q: &JobQuery) -> Result<Listed<JobRow, JobId>, StoreError> {
        let before = q.before.map_or(i64::MAX, |id| i64::try_from(id.0).unwrap_or(i64::MAX));
        let reach = TIMES.reach(self, (q.from, q.to, q.updated_since), before).await?;
        let (rows, rest) = listing(q, &reach).read(&self.readers).await?;
        let rows = rows.iter().map(|row| decode(row, &self.gone)).collect::<Result<Vec<_>, _>>()?;
        debug_assert!(rows.is_sorted_by(|a, b| a.id > b.id), "the newest come first, each once");
        Ok(Listed::cut(rows, q.limit, rest.map(|id| JobId(id.unsigned_abs())), |row| row.id))
    }

    /// Number of all jobs, and of the jobs that are not over.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn count_jobs(&self) -> Result<(u64, u64), StoreError> {
        let row = sqlx::query(COUNT).fetch_one(&self.readers).await?;
        let (all, open): (i64, i64) = (row.try_get(0)?, row.try_get(1)?);
        debug_assert!(0 <= open && open <= all, "open jobs are jobs");
        Ok((all.unsigned_abs(), open.unsigned_abs()))
    }
}

/// The statements that narrow a page of jobs by times.
pub(super) const TIMES: TimeStatements =
    TimeStatements { first: FIRST, first_of_days: FIRST_OF_DAYS, changed: CHANGED };

/// The query of one job.
pub(super) fn one(id: i64) -> QueryBuilder<Sqlite> {
    let mut query = QueryBuilder::new(SOME);
    query.push_bind(id).push(")");
    query
}

/// The source of a page of jobs: the filter with the fewest rows uses an index, the others are conditions.
pub(super) fn listing(q: &JobQuery, reach: &Reach) -> Listing {
    let id = "jobs.id";
    let states = if q.states.is_empty() { &JOB_STATES[..] } else { &q.states };
    let each = |from, first| Arm::for_each(from, id, Some(first), ("state", states));
    let (rack, robot, station) =
        (q.rack.map(|r| i64::from(r.0)), q.robot.map(|r| i64::from(r.0)), q.station.map(|s| i64::from(s.0)));
    let (mut rest, mut label) = (q.clone(), q.label.clone());
    let arms = if let (Some(since), true) = (q.updated_since, reach.is_short) {
        rest.updated_since = None;
        vec![Arm::short("jobs INDEXED BY jobs_by_change", id, vec![("updated >= ", since.0)])]
    } else if let Some(reference) = rest.reference.take() {
        let equal = vec![("reference", Given::Word(reference))];
        vec![Arm::of("jobs INDEXED BY jobs_by_reference", id, equal)]
    } else if let Some(part) = rest.reference_part.take() {
        // A phrase in quotation marks is searched verbatim; the index is read from its newest entry on.
        let phrase = format!("\"{}\"", part.replace('"', "\"\""));
        let from = "job_references CROSS JOIN jobs ON jobs.id = job_references.rowid";
        vec![Arm::of(from, "job_references.rowid", vec![("job_references", Given::Word(phrase))])]
    } else if let Some((key, value)) = label.take() {
        let equal = vec![("job_labels.key", Given::Word(key)), ("value", Given::Word(value))];
        let from = "job_labels INDEXED BY job_labels_by_value CROSS JOIN jobs ON jobs.id = job_labels.job";
        vec![Arm::of(from, "job_labels.job", equal)]
    } else if let Some(rack) = rack {
        (rest.rack, rest.states) = (None, Vec::new());
        each("jobs INDEXED BY jobs_by_rack", ("rack", rack))
    } else if let Some(robot) = robot {
        (rest.robot, rest.states) = (None, Vec::new());
        each("jobs INDEXED BY jobs_by_robot", ("worker", robot))
    } else if let Some(station) = station {
        (rest.station, rest.states) = (None, Vec::new());
        each("jobs INDEXED BY jobs_by_station", ("station", station))
    } else if !q.states.is_empty() {
        rest.states = Vec::new();
        Arm::for_each("jobs INDEXED BY jobs_by_state", id, None, ("state", states))
    } else {
        vec![Arm::of("jobs", id, Vec::new())]
    };
    let times = reach.conditions((rest.from, rest.to, rest.updated_since));
    let numbers = [
        (" AND rack = ", rest.rack.map(|rack| i64::from(rack.0))),
        (" AND station = ", rest.station.map(|station| i64::from(station.0))),
        (" AND worker = ", rest.robot.map(|robot| i64::from(robot.0))),
    ];
    let numbers = numbers.into_iter().filter_map(|(sql, n)| n.map(|n| RowCondition::number(sql, n)));
    let reference = rest.reference.map(|text| RowCondition::words(vec![(" AND reference = ", text)], ""));
    let part = rest.reference_part;
    let part =
        part.map(|text| RowCondition::words(vec![(" AND instr(lower(reference), lower(", text)], ")) > 0"));
    let has =
        " AND EXISTS (SELECT 1 FROM job_labels INDEXED BY job_labels_by_value WHERE job = jobs.id AND key = ";
    let label =
        label.map(|(key, value)| RowCondition::words(vec![(has, key), (" AND value = ", value)], ")"));
    let conditions = RowCondition::one_of(" AND state IN (", &rest.states).into_iter();
    let conditions =
        conditions.chain(times).chain(numbers).chain(reference).chain(part).chain(label).collect();
    reach.listing((SOME, NEWEST_FIRST), arms, conditions, q.limit + 1)
}

/// Writes what a fact means for the list.
pub(super) async fn project(db: &mut SqliteConnection, fact: &Fact) -> Result<(), sqlx::Error> {
    match fact {
        Fact::Job(JobFact::Accepted { job, request, at }) => accept(db, *job, request, *at).await,
        Fact::Job(JobFact::Progressed { job, state, at, .. }) => progress(db, *job, *state, *at).await,
        Fact::Job(JobFact::Served { job, at, .. }) => serve(db, *job, *at).await,
        Fact::Job(JobFact::LineChanged { job, line, change, at }) => {
            change_line(db, *job, (*line, *change), *at).await
        }
        Fact::Job(JobFact::Chosen { job, choice, at }) => {
            let choice = serde_json::to_string(&ChoiceRecord::from(*choice)).expect("a choice is JSON");
            let query = sqlx::query(CHOOSE).bind(job.0.cast_signed()).bind(choice).bind(at.0);
            query.execute(db).await.map(|_| ())
        }
        Fact::Job(JobFact::Prioritised { job, priority, at }) => prioritise(db, *job, *priority, *at).await,
        Fact::Job(JobFact::Changed { job, kind, priority, deadline, at }) => {
            let query = sqlx::query(CHANGE).bind(job.0.cast_signed()).bind(kind.station().map(|s| s.0));
            let query = query.bind(kind.robot().map(|r| r.0)).bind(priority).bind(deadline.map(|t| t.0));
            query.bind(at.0).execute(db).await.map(|_| ())
        }
        _ => Ok(()),
    }
}

async fn accept(
    db: &mut SqliteConnection,
    id: JobId,
    request: &JobRequest,
    at: Time,
) -> Result<(), sqlx::Error> {
    let JobParts { rack, station, node, robot, pick } = request.kind.parts();
    let after: Vec<u64> = request.after.iter().map(|j| j.0).collect();
    sqlx::query(ACCEPT)
        .bind(id.0.cast_signed())
        .bind(request.kind.word())
        .bind(rack.map(|r| r.0))
        .bind(station.map(|s| s.0))
        .bind(node.map(|n| n.0))
        .bind(robot.map(|r| r.0))
        .bind(pick.map(|p| p.0))
        .bind(request.priority)
        .bind(request.deadline.map(|t| t.0))
        .bind(serde_json::to_string(&after).expect("a list of numbers is JSON"))
        .bind(request.key.as_ref().map(|key| &key.text))
        .bind(at.0)
        .bind(&request.reference)
        .bind(stops_text(&StopsRecord { served: Vec::new(), then: then_of(request) }))
        .bind(lines_text(&Job::new(request.clone(), at).lines))
        .execute(&mut *db)
        .await?;
    for (key, value) in &request.labels {
        sqlx::query(LABEL).bind(id.0.cast_signed()).bind(key).bind(value).execute(&mut *db).await?;
    }
    Ok(())
}

/// Advances a rack from a station to the next one.
async fn serve(db: &mut SqliteConnection, id: JobId, at: Time) -> Result<(), sqlx::Error> {
    let row = sqlx::query(STOPS).bind(id.0.cast_signed()).fetch_one(&mut *db).await?;
    let mut stops = stops_of(&row)?;
    let (station, pick): (Option<u32>, Option<i64>) = (row.try_get("station")?, row.try_get("pick")?);
    let Some(station) = station.filter(|_| !stops.then.is_empty()) else {
        return Err(sqlx::Error::Decode(format!("job {} has no station to go on to", id.0).into()));
    };
    stops.served.push(((station, pick), at.0));
    let (next, pick) = stops.then.remove(0);
    let query = sqlx::query(SERVE).bind(id.0.cast_signed()).bind(next).bind(pick).bind(stops_text(&stops));
    query.bind(at.0).execute(db).await.map(|_| ())
}

/// Changes a line of the present visit.
async fn change_line(
    db: &mut SqliteConnection,
    id: JobId,
    (line, change): (usize, LineChange),
    at: Time,
) -> Result<(), sqlx::Error> {
    let row = sqlx::query(LINES).bind(id.0.cast_signed()).fetch_one(&mut *db).await?;
    let (mut lines, visit) = (lines_of(&row)?, stops_of(&row)?.served.len());
    let changed = lines.get_mut(visit).map(|lines| lines.change(line, change));
    if changed != Some(Ok(LineOutcome::Changed)) {
        return Err(sqlx::Error::Decode(format!("job {} has no line {line} to change there", id.0).into()));
    }
    let query = sqlx::query(SET_LINES).bind(id.0.cast_signed()).bind(lines_text(&lines)).bind(at.0);
    query.execute(db).await.map(|_| ())
}

/// The lines as text; nothing for jobs without lines, as most are.
fn lines_text(lines: &[Lines]) -> Option<String> {
    let records: Vec<LinesRecord> = lines.iter().cloned().map(LinesRecord).collect();
    (!records.is_empty())
        .then(|| serde_json::to_string(&records).expect("lists of numbers and texts are JSON"))
}

fn lines_of(row: &SqliteRow) -> Result<Vec<Lines>, sqlx::Error> {
    let Some(text) = row.try_get::<Option<&str>, _>("lines")? else { return Ok(Vec::new()) };
    let records: Vec<LinesRecord> = serde_json::from_str(text).map_err(|e| sqlx::Error::Decode(e.into()))?;
    Ok(records.into_iter().map(|LinesRecord(lines)| lines).collect())
}

fn then_of(request: &JobRequest) -> Vec<StationRecord> {
    request.then.iter().map(job_record::visit_record).collect()
}

/// The stops as text; nothing for jobs with one station, as most are.
fn stops_text(stops: &StopsRecord) -> Option<String> {
    let is_one = stops.served.is_empty() && stops.then.is_empty();
    (!is_one).then(|| serde_json::to_string(stops).expect("lists of numbers are JSON"))
}

fn stops_of(row: &SqliteRow) -> Result<StopsRecord, sqlx::Error> {
    let Some(text) = row.try_get::<Option<&str>, _>("stops")? else { return Ok(StopsRecord::default()) };
    serde_json::from_str(text).map_err(|e| sqlx::Error::Decode(e.into()))
}

async fn prioritise(db: &mut SqliteConnection, id: JobId, priority: u8, at: Time) -> Result<(), sqlx::Error> {
    let query = sqlx::query(PRIORITISE).bind(id.0.cast_signed()).bind(priority).bind(at.0);
    query.execute(db).await.map(|_| ())
}

async fn progress(
    db: &mut SqliteConnection,
    id: JobId,
    state: JobState,
    at: Time,
) -> Result<(), sqlx::Error> {
    let why = match state {
        JobState::Failed(failure) => Some(job_record::encode_failure(failure)),
        _ => None,
    };
    let id = id.0.cast_signed();
    let query = if state.is_over() {
        sqlx::query(FINISH).bind(id).bind(state.word()).bind(why).bind(at.0)
    } else {
        sqlx::query(PROGRESS)
            .bind(id)
            .bind(state.word())
            .bind(why)
            .bind(state.robot().map(|r| r.0))
            .bind(at.0)
    };
    query.execute(db).await?;
    Ok(())
}

fn decode(row: &SqliteRow, gone: &Gone) -> Result<JobRow, StoreError> {
    let id: i64 = row.try_get("id")?;
    let broken = |why: &str| StoreError::Job { id, why: why.into() };
    let worker = row.try_get::<Option<u32>, _>("worker")?.map(RobotId);
    let after: Vec<u64> = serde_json::from_str(row.try_get("after")?).map_err(|e| broken(&e.to_string()))?;
    let stops = stops_of(row)?;
    let choice = match row.try_get::<Option<&str>, _>("choice")? {
        Some(text) => serde_json::from_str::<ChoiceRecord>(text).map_err(|e| broken(&e.to_string()))?.into(),
        None => RobotChoice::Any,
    };
    let lines = lines_of(row)?;
    let ordered = |lines: &Lines| lines.all().iter().map(|p| p.line.clone()).collect();
    let request = JobRequest {
        kind: decode_kind(row)?.ok_or_else(|| broken("its kind and its columns do not go together"))?,
        priority: row.try_get("priority")?,
        deadline: row.try_get::<Option<i64>, _>("deadline")?.map(Time),
        then: stops.then.into_iter().map(visiting).collect(),
        after: after.into_iter().map(JobId).collect(),
        key: row.try_get::<Option<String>, _>("key")?.map(ClientKey::from),
        reference: row.try_get("reference")?,
        labels: serde_json::from_str(row.try_get("labels")?).map_err(|e| broken(&e.to_string()))?,
        lines: lines.iter().map(ordered).collect(),
    };
    let why: Option<&str> = row.try_get("why")?;
    let state = match (row.try_get("state")?, worker, why) {
        ("waiting", _, _) => JobState::Waiting,
        ("assigned", Some(robot), _) => JobState::Assigned { robot },
        ("carrying", Some(robot), _) => JobState::Carrying { robot },
        ("picking", Some(robot), _) => JobState::Picking { robot },
        ("done", _, _) => JobState::Done,
        ("cancelled", _, _) => JobState::Cancelled,
        ("failed", _, Some(why)) => {
            JobState::Failed(job_record::decode_failure(why).map_err(|e| broken(&e.to_string()))?)
        }
        (state, _, _) => return Err(broken(&format!("state {state} and its columns do not go together"))),
    };
    let job = Job {
        request,
        state,
        accepted: Time(row.try_get("created")?),
        served: stops.served.into_iter().map(|(v, at)| (visiting(v), Time(at))).collect(),
        choice,
        lines,
    };
    let time = |column| Ok::<_, sqlx::Error>(row.try_get::<Option<i64>, _>(column)?.map(Time));
    Ok(JobRow {
        times: JobTimes {
            assigned: time("assigned_at")?,
            lifted: time("lifted_at")?,
            arrived: time("arrived_at")?,
            ended: time("ended_at")?,
        },
        changed: row.try_get("changed")?,
        gone: gone.of_job(&job),
        id: JobId(id.unsigned_abs()),
        job,
        robot: worker,
        updated: Time(row.try_get("updated")?),
    })
}

fn decode_kind(row: &SqliteRow) -> Result<Option<JobKind>, sqlx::Error> {
    let parts = JobParts {
        rack: row.try_get::<Option<u32>, _>("rack")?.map(RackId),
        station: row.try_get::<Option<u32>, _>("station")?.map(StationId),
        node: row.try_get::<Option<u32>, _>("node")?.map(NodeId),
        robot: row.try_get::<Option<u32>, _>("robot")?.map(RobotId),
        pick: row.try_get::<Option<i64>, _>("pick")?.map(Span),
    };
    Ok(JobWord::of_word(row.try_get("kind")?).and_then(|word| word.with(parts).ok()))
}
