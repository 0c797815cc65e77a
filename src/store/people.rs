//! Lists about people: assignments and encounters, as the facts leave them.
//!
//! Refuses: names, which others give to ids.

use super::gone::Gone;
use super::{Store, StoreError};
use crate::fleet::{
    Assignment, AssignmentQuery, AssignmentRequest, AssignmentRow, AssignmentState, ClientKey, Encounter,
    EncounterQuery, EncounterRow, Fact, GoneNames, Reaction,
};
use crate::geometry::Spot;
use crate::id::{AssignmentId, NodeId, RobotId, WorkerId};
use crate::time::{Span, Time};
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
const ASSIGNMENT: &str = "SELECT id, worker, place, stay, what, key, state, created, updated \
    FROM assignments WHERE id = $1";
const ASSIGNMENTS: &str = "SELECT id, worker, place, stay, what, key, state, created, updated \
    FROM assignments WHERE id < ";
const ENCOUNTERS: &str = "SELECT seq, worker, robot, began, ended, x, y, radius, closest, robot_speed, \
    worker_speed, reaction, delay FROM encounters WHERE seq < ";

impl Store {
    /// One assignment.
    ///
    /// # Errors
    /// Where the database does not answer.
    pub async fn assignment(&self, id: AssignmentId) -> Result<Option<AssignmentRow>, StoreError> {
        let Ok(id) = i64::try_from(id.0) else { return Ok(None) };
        let row = sqlx::query(ASSIGNMENT).bind(id).fetch_optional(&self.readers).await?;
        row.map(|row| assignment(&row, &self.gone)).transpose()
    }

    /// Some assignments, newest first.
    ///
    /// # Errors
    /// Where the database does not answer.
    pub async fn assignments(&self, q: &AssignmentQuery) -> Result<Vec<AssignmentRow>, StoreError> {
        let before = q.before.map_or(i64::MAX, |id| i64::try_from(id.0).unwrap_or(i64::MAX));
        let mut query = QueryBuilder::new(ASSIGNMENTS);
        query.push_bind(before);
        narrow(
            &mut query,
            [
                (" AND worker = ", q.worker.map(|w| i64::from(w.0))),
                (" AND place = ", q.place.map(|n| i64::from(n.0))),
                (" AND updated >= ", q.updated_since.map(|t| t.0)),
                (" AND created >= ", q.from.map(|t| t.0)),
                (" AND created < ", q.to.map(|t| t.0)),
            ],
        );
        one_of(&mut query, " AND state IN (", &q.states);
        query.push(" ORDER BY id DESC LIMIT ").push_bind(q.limit);
        let rows = query.build().fetch_all(&self.readers).await?;
        rows.iter().map(|row| assignment(row, &self.gone)).collect()
    }

    /// Some encounters, newest first.
    ///
    /// # Errors
    /// Where the database does not answer.
    pub async fn encounters(&self, q: &EncounterQuery) -> Result<Vec<EncounterRow>, StoreError> {
        let mut query = QueryBuilder::new(ENCOUNTERS);
        query.push_bind(q.before.unwrap_or(i64::MAX));
        narrow(
            &mut query,
            [
                (" AND worker = ", q.worker.map(|w| i64::from(w.0))),
                (" AND robot = ", q.robot.map(|r| i64::from(r.0))),
                (" AND ended >= ", q.updated_since.map(|t| t.0)),
                (" AND began >= ", q.from.map(|t| t.0)),
                (" AND began < ", q.to.map(|t| t.0)),
            ],
        );
        one_of(&mut query, " AND reaction IN (", &q.reactions);
        query.push(" ORDER BY seq DESC LIMIT ").push_bind(q.limit);
        let rows = query.build().fetch_all(&self.readers).await?;
        rows.iter().map(encounter).collect()
    }
}

/// Adds the conditions whose number is given.
pub(super) fn narrow<const N: usize>(
    query: &mut QueryBuilder<Sqlite>,
    conditions: [(&'static str, Option<i64>); N],
) {
    for (condition, number) in conditions {
        if let Some(number) = number {
            query.push(condition).push_bind(number);
        }
    }
}

/// Adds that a word is one of these, if there are any.
pub(super) fn one_of(query: &mut QueryBuilder<Sqlite>, condition: &'static str, words: &[&'static str]) {
    if words.is_empty() {
        return;
    }
    let mut list = query.push(condition).separated(", ");
    for word in words {
        list.push_bind(*word);
    }
    query.push(")");
}

/// Writes what a fact means for the lists.
pub(super) async fn project(db: &mut SqliteConnection, fact: &Fact) -> Result<(), sqlx::Error> {
    let query = match fact {
        Fact::Assigned { assignment, worker, request, at } => sqlx::query(ASSIGN)
            .bind(assignment.0.cast_signed())
            .bind(worker.map(|w| w.0))
            .bind(request.place.0)
            .bind(request.stay.0)
            .bind(&request.what)
            .bind(request.key.as_ref().map(|key| &key.text))
            .bind(at.0),
        Fact::Given { assignment, worker, at } => {
            sqlx::query(GIVE).bind(assignment.0.cast_signed()).bind(worker.0).bind(at.0)
        }
        Fact::Advanced { assignment, state, at } => {
            sqlx::query(ADVANCE).bind(assignment.0.cast_signed()).bind(state.word()).bind(at.0)
        }
        Fact::Encountered(e) => sqlx::query(MEET)
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
    use AssignmentState::{Cancelled, Done, Waiting, Walking, Working};
    let id: i64 = row.try_get("id")?;
    let word: &str = row.try_get("state")?;
    let state = [Waiting, Walking, Working, Done, Cancelled].into_iter().find(|s| s.word() == word);
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
    use Reaction::{Held, Kept, Rerouted, Slowed, Stopped};
    let seq: i64 = row.try_get("seq")?;
    let word: &str = row.try_get("reaction")?;
    let reaction = [Kept, Slowed, Held, Rerouted, Stopped].into_iter().find(|r| r.word() == word);
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
