//! Lists about people: assignments and encounters, as the facts leave them.
//!
//! Refuses: names, since the caller gives them to ids.

use super::gone::Gone;
use super::listing::{Arm, Given, LOOKED_AT, Listing, Reach, RowCondition, TimeStatements, count, first};
use super::{Store, StoreError};
use giveway_fleet::{
    Assignment, AssignmentFact, AssignmentQuery, AssignmentRequest, AssignmentRow, AssignmentState,
    ClientKey, Encounter, EncounterFact, EncounterQuery, EncounterRow, Fact, GoneNames, Listed, Reaction,
};
use giveway_floor::geometry::Spot;
use giveway_floor::id::{AssignmentId, NodeId, RobotId, WorkerId};
use giveway_floor::time::{Span, Time};
use sqlx::sqlite::{SqliteConnection, SqliteRow};
use sqlx::{QueryBuilder, Row, Sqlite};

const ASSIGN: &str = "INSERT INTO assignments \
    (id, worker, place, stay, what, key, state, created, updated) \
    VALUES ($1, $2, $3, $4, $5, $6, 'waiting', $7, $7)";
const ADVANCE: &str = "UPDATE assignments SET state = $2, updated = $3 WHERE id = $1";
const GIVE: &str = "UPDATE assignments SET worker = $2, updated = $3 WHERE id = $1";
const MEET: &str = "INSERT INTO encounters (worker, robot, began, ended, x, y, radius, closest, \
    robot_speed, worker_speed, reaction, delay) \
    VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12)";
/// The columns of assignments that are read, up to their numbers.
const ASSIGNMENTS: &str = "SELECT id, worker, place, stay, what, key, state, created, updated \
    FROM assignments WHERE id IN (";
const NEWEST_FIRST: &str = ") ORDER BY id DESC LIMIT ";
/// The first statement that narrows a page by times, as for jobs; two more follow.
const FIRST: &str = "SELECT id FROM assignments INDEXED BY assignments_by_acceptance \
    WHERE created >= $1 ORDER BY created, id LIMIT 1";
const FIRST_OF_DAYS: &str = "SELECT min(id) FROM assignments INDEXED BY assignments_of_days \
    WHERE updated - created > 86400000000 AND updated >= $1";
const CHANGED: &str = "SELECT count(*) FROM (SELECT 1 FROM assignments INDEXED BY assignments_by_change \
    WHERE updated >= $1 LIMIT $2)";

/// The columns of encounters that are read, up to their numbers.
const ENCOUNTERS: &str = "SELECT seq, worker, robot, began, ended, x, y, radius, closest, robot_speed, \
    worker_speed, reaction, delay FROM encounters WHERE seq IN (";
const LATEST_FIRST: &str = ") ORDER BY seq DESC LIMIT ";
/// The first encounter that ended at a time or later: encounters are recorded as they end.
const FIRST_ENDED: &str =
    "SELECT seq FROM encounters INDEXED BY encounters_by_end WHERE ended >= $1 ORDER BY ended, seq LIMIT 1";
/// One more than the last encounter of more than an hour that began before a time.
const LAST_OF_HOURS: &str = "SELECT 1 + max(seq) FROM encounters INDEXED BY encounters_of_hours \
    WHERE ended - began > 3600000000 AND began < $1";
/// Number of encounters that began in a time, or ended at a time or later, counted up to a limit.
const BEGAN: &str = "SELECT count(*) FROM (SELECT 1 FROM encounters INDEXED BY encounters_by_time \
    WHERE began >= $1 AND began < $2 LIMIT $3)";
const ENDED: &str =
    "SELECT count(*) FROM (SELECT 1 FROM encounters INDEXED BY encounters_by_end WHERE ended >= $1 LIMIT $2)";

/// Encounters that lasted longer than this have an index of their own (`encounters_of_hours`).
const HOUR: Span = Span::from_secs(3600);

/// All states of an assignment.
const STATES: [AssignmentState; 5] = [
    AssignmentState::Waiting,
    AssignmentState::Walking,
    AssignmentState::Working,
    AssignmentState::Done,
    AssignmentState::Cancelled,
];

/// All reactions of the fleet to a person.
const REACTIONS: [Reaction; 5] =
    [Reaction::Kept, Reaction::Slowed, Reaction::Held, Reaction::Rerouted, Reaction::Stopped];

impl Store {
    /// One assignment.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn assignment(&self, id: AssignmentId) -> Result<Option<AssignmentRow>, StoreError> {
        let Ok(id) = i64::try_from(id.0) else { return Ok(None) };
        let row = one_assignment(id).build().fetch_optional(&self.readers).await?;
        row.map(|row| assignment(&row, &self.gone)).transpose()
    }

    /// A page of assignments, newest first.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn assignments(
        &self,
        q: &AssignmentQuery,
    ) -> Result<Listed<AssignmentRow, AssignmentId>, StoreError> {
        let before = q.before.map_or(i64::MAX, |id| i64::try_from(id.0).unwrap_or(i64::MAX));
        let reach = ASSIGNMENT_TIMES.reach(self, (q.from, q.to, q.updated_since), before).await?;
        let (rows, rest) = list_assignments(q, &reach).read(&self.readers).await?;
        let rows = rows.iter().map(|row| assignment(row, &self.gone)).collect::<Result<Vec<_>, _>>()?;
        debug_assert!(rows.is_sorted_by(|a, b| a.id > b.id), "the newest come first, each once");
        Ok(Listed::cut(rows, q.limit, rest.map(|id| AssignmentId(id.unsigned_abs())), |row| row.id))
    }

    /// A page of encounters, newest first.
    ///
    /// # Errors
    /// If the database does not answer.
    pub async fn encounters(&self, q: &EncounterQuery) -> Result<Listed<EncounterRow, i64>, StoreError> {
        let (listing, db) = (list_encounters(q, &self.reach(q).await?), &self.readers);
        let (rows, rest) = listing.read(db).await?;
        let rows = rows.iter().map(encounter).collect::<Result<Vec<_>, _>>()?;
        debug_assert!(rows.is_sorted_by(|a, b| a.seq > b.seq), "the newest come first, each once");
        Ok(Listed::cut(rows, q.limit, rest, |row| row.seq))
    }

    /// The encounters that the times of a query allow.
    async fn reach(&self, q: &EncounterQuery) -> Result<EncounterReach, StoreError> {
        let db = &self.readers;
        let before = q.before.unwrap_or(i64::MAX);
        let mut reach = Reach { low: i64::MIN, before, is_short: false, is_orderly: self.is_orderly };
        let span = q.from.map(|from| (from, q.to.unwrap_or(Time::MAX)));
        let mut range = Vec::new();
        if let Some((from, to)) = span
            && count(db, BEGAN, &[from.0, to.0]).await? <= LOOKED_AT
        {
            range = vec![("began >= ", from.0), ("began < ", to.0)];
        } else if let Some(since) = q.updated_since
            && count(db, ENDED, &[since.0]).await? <= LOOKED_AT
        {
            range = vec![("ended >= ", since.0)];
        } else if self.is_orderly {
            if let Some(since) = q.from.max(q.updated_since) {
                reach.low = first(db, FIRST_ENDED, since).await?;
            }
            if let Some(to) = q.to {
                let last: Option<i64> = sqlx::query_scalar(LAST_OF_HOURS).bind(to.0).fetch_one(db).await?;
                let after = first(db, FIRST_ENDED, to + HOUR).await?;
                reach.before = before.min(after.max(last.unwrap_or(i64::MIN)));
            }
        }
        reach.is_short = !range.is_empty();
        Ok(EncounterReach { reach, range })
    }
}

/// The statements that narrow a page of assignments by times.
pub(super) const ASSIGNMENT_TIMES: TimeStatements =
    TimeStatements { first: FIRST, first_of_days: FIRST_OF_DAYS, changed: CHANGED };

/// The query of one assignment.
pub(super) fn one_assignment(id: i64) -> QueryBuilder<Sqlite> {
    let mut query = QueryBuilder::new(ASSIGNMENTS);
    query.push_bind(id).push(")");
    query
}

/// The source of a page of assignments, as for jobs.
pub(super) fn list_assignments(q: &AssignmentQuery, reach: &Reach) -> Listing {
    let all = STATES.map(|state| state.word());
    let states = if q.states.is_empty() { &all[..] } else { &q.states };
    let each = |from, first| Arm::for_each(from, "id", first, ("state", states));
    let (worker, place) = (q.worker.map(|w| i64::from(w.0)), q.place.map(|n| i64::from(n.0)));
    let mut rest = q.clone();
    let arms = if let (Some(since), true) = (q.updated_since, reach.is_short) {
        rest.updated_since = None;
        vec![Arm::short("assignments INDEXED BY assignments_by_change", "id", vec![("updated >= ", since.0)])]
    } else if let Some(worker) = worker {
        (rest.worker, rest.states) = (None, Vec::new());
        each("assignments INDEXED BY assignments_of_worker", Some(("worker", worker)))
    } else if let Some(place) = place {
        (rest.place, rest.states) = (None, Vec::new());
        each("assignments INDEXED BY assignments_at_place", Some(("place", place)))
    } else if !q.states.is_empty() {
        rest.states = Vec::new();
        each("assignments INDEXED BY assignments_by_state", None)
    } else {
        vec![Arm::of("assignments", "id", Vec::new())]
    };
    let numbers = [
        (" AND worker = ", rest.worker.map(|w| i64::from(w.0))),
        (" AND place = ", rest.place.map(|n| i64::from(n.0))),
    ];
    let numbers = numbers.into_iter().filter_map(|(sql, n)| n.map(|n| RowCondition::number(sql, n)));
    let times = reach.conditions((rest.from, rest.to, rest.updated_since));
    let states = RowCondition::one_of(" AND state IN (", &rest.states).into_iter();
    let conditions = states.chain(times).chain(numbers).collect();
    reach.listing((ASSIGNMENTS, NEWEST_FIRST), arms, conditions, q.limit + 1)
}

/// The encounters that times allow; and, if they are few, the range of an index to read.
#[derive(Clone, Debug)]
pub(super) struct EncounterReach {
    pub reach: Reach,
    pub range: Vec<(&'static str, i64)>,
}

/// The source of a page of encounters. They are in the order of their ends; their beginnings are a condition.
pub(super) fn list_encounters(
    q: &EncounterQuery,
    EncounterReach { reach, range }: &EncounterReach,
) -> Listing {
    let mut rest = q.clone();
    let one = |from, column, number| vec![Arm::of(from, "seq", vec![(column, Given::Number(number))])];
    let arms = if let Some((column, _)) = range.first() {
        let from = match column.starts_with("began") {
            true => "encounters INDEXED BY encounters_by_time",
            false => "encounters INDEXED BY encounters_by_end",
        };
        vec![Arm::short(from, "seq", range.clone())]
    } else if let Some(worker) = rest.worker.take() {
        one("encounters INDEXED BY encounters_of_worker", "worker >= 0 AND worker", i64::from(worker.0))
    } else if let Some(robot) = rest.robot.take() {
        one("encounters INDEXED BY encounters_of_robot", "robot", i64::from(robot.0))
    } else if !rest.reactions.is_empty() {
        let words = std::mem::take(&mut rest.reactions);
        Arm::for_each("encounters INDEXED BY encounters_by_reaction", "seq", None, ("reaction", &words))
    } else {
        vec![Arm::of("encounters", "seq", Vec::new())]
    };
    let numbers = [
        (" AND worker = ", rest.worker.map(|w| i64::from(w.0))),
        (" AND robot = ", rest.robot.map(|r| i64::from(r.0))),
        (" AND ended >= ", rest.updated_since.map(|t| t.0)),
        (" AND began >= ", rest.from.map(|t| t.0)),
        (" AND began < ", rest.to.map(|t| t.0)),
    ];
    let numbers = numbers.into_iter().filter_map(|(sql, n)| n.map(|n| RowCondition::number(sql, n)));
    let words = RowCondition::one_of(" AND reaction IN (", &rest.reactions).into_iter();
    reach.listing((ENCOUNTERS, LATEST_FIRST), arms, words.chain(numbers).collect(), q.limit + 1)
}

/// Writes what a fact means for the lists.
pub(super) async fn project(db: &mut SqliteConnection, fact: &Fact) -> Result<(), sqlx::Error> {
    let query = match fact {
        Fact::Assignment(AssignmentFact::Assigned { assignment, worker, request, at }) => sqlx::query(ASSIGN)
            .bind(assignment.0.cast_signed())
            .bind(worker.map(|w| w.0))
            .bind(request.place.0)
            .bind(request.stay.0)
            .bind(&request.what)
            .bind(request.key.as_ref().map(|key| &key.text))
            .bind(at.0),
        Fact::Assignment(AssignmentFact::Given { assignment, worker, at }) => {
            sqlx::query(GIVE).bind(assignment.0.cast_signed()).bind(worker.0).bind(at.0)
        }
        Fact::Assignment(AssignmentFact::Advanced { assignment, state, at }) => {
            sqlx::query(ADVANCE).bind(assignment.0.cast_signed()).bind(state.word()).bind(at.0)
        }
        Fact::Encounter(EncounterFact::Met(e)) => sqlx::query(MEET)
            .bind(e.worker.0)
            .bind(e.robot.0)
            .bind(e.began.0)
            .bind(e.ended.0)
            .bind(e.at.x_mm)
            .bind(e.at.y_mm)
            .bind(e.radius_mm)
            .bind(e.closest_mm)
            .bind(e.robot_mmps)
            .bind(e.worker_mmps)
            .bind(e.reaction.word())
            .bind(e.delay.0),
        _ => return Ok(()),
    };
    query.execute(db).await?;
    Ok(())
}

fn assignment(row: &SqliteRow, gone: &Gone) -> Result<AssignmentRow, StoreError> {
    let id: i64 = row.try_get("id")?;
    let word: &str = row.try_get("state")?;
    let state = STATES.into_iter().find(|s| s.word() == word);
    let state = state.ok_or_else(|| broken("assignment", id, word))?;
    let request = AssignmentRequest {
        place: NodeId(row.try_get("place")?),
        stay: Span(row.try_get("stay")?),
        what: row.try_get("what")?,
        key: row.try_get::<Option<String>, _>("key")?.map(ClientKey::from),
    };
    let worker: Option<u32> = row.try_get("worker")?;
    let (worker, accepted) = (worker.map(WorkerId), Time(row.try_get("created")?));
    Ok(AssignmentRow {
        gone: GoneNames { node: gone.node(request.place), ..GoneNames::default() },
        id: AssignmentId(id.unsigned_abs()),
        assignment: Assignment { worker, request, state, accepted },
        updated: Time(row.try_get("updated")?),
    })
}

pub(super) fn encounter(row: &SqliteRow) -> Result<EncounterRow, StoreError> {
    let seq: i64 = row.try_get("seq")?;
    let word: &str = row.try_get("reaction")?;
    let reaction = REACTIONS.into_iter().find(|r| r.word() == word);
    let worker: i64 = row.try_get("worker")?;
    let known = u32::try_from(worker).ok();
    let encounter = Encounter {
        worker: WorkerId(known.unwrap_or_default()),
        robot: RobotId(row.try_get("robot")?),
        began: Time(row.try_get("began")?),
        ended: Time(row.try_get("ended")?),
        at: Spot { x_mm: row.try_get("x")?, y_mm: row.try_get("y")? },
        radius_mm: row.try_get("radius")?,
        closest_mm: row.try_get("closest")?,
        robot_mmps: row.try_get("robot_speed")?,
        worker_mmps: row.try_get("worker_speed")?,
        reaction: reaction.ok_or_else(|| broken("encounter", seq, word))?,
        delay: Span(row.try_get("delay")?),
    };
    Ok(EncounterRow { seq, encounter, is_anonymous: known.is_none() })
}

fn broken(list: &'static str, id: i64, word: &str) -> StoreError {
    StoreError::Row { list, id, why: format!("\"{word}\" is a word that this Giveway does not know") }
}
