//! `/v1/people`: the people behind the pseudonyms of workers, and forgetting a person.
//!
//! Main type: [`PersonDto`]. Refuses: to erase a person who is on the floor or has an assignment.

use crate::dto::names::Page;
use crate::http::shared::done::done;
use crate::http::shared::paging::{Paging, page};
use crate::state::called::Called;
use crate::wire::error::Problem;
use crate::wire::extract::{Params, PathPart};
use crate::wire::text::{assignment_name, time_text, worker_name};
use axum::Json;
use axum::http::StatusCode;
use giveway_fleet::{Ask, AssignmentQuery, AssignmentState, Presence};
use giveway_floor::id::{Dense, WorkerId};
use giveway_floor::text::sentence::requests;
use serde::Serialize;
use utoipa::ToSchema;

/// A person, with the pseudonym that replaces the name everywhere else.
#[derive(Debug, Serialize, ToSchema)]
pub struct PersonDto {
    /// The worker.
    #[schema(example = "w1")]
    pub id: String,
    /// The pseudonym: what feeds, events, webhooks, recordings and the journal call this person.
    #[schema(example = "worker-3f2a")]
    pub pseudonym: String,
    /// The person's name.
    #[schema(example = "Anna Berg")]
    pub name: String,
    /// When the person was registered, RFC 3339.
    pub since: String,
}

/// List all people whose names are kept.
#[utoipa::path(get, path = "/v1/people", tag = "people", operation_id = "listPeople", params(Paging), responses(
    (status = 200, description = "People in order of joining", body = Page<PersonDto>)))]
pub async fn list(Called(api): Called, Params(p): Params<Paging>) -> Result<Json<Page<PersonDto>>, Problem> {
    let pseudonyms = api.feeds.names();
    let people = pseudonyms.iter().enumerate().filter_map(|(i, pseudonym)| {
        let person = api.pseudonyms.person(pseudonym)?;
        let (id, since) = (worker_name(WorkerId::at(i)), time_text(person.since));
        Some(PersonDto { id, pseudonym: person.pseudonym, name: person.name, since })
    });
    page(people.collect(), &p)
}

/// Erase a person: the name is forgotten, and the identity is removed from encounters, assignments, events and alarms.
/// Tokens of the person's devices are revoked. If the person is registered again, it is under another pseudonym. The id
/// becomes free and is given to another worker when no other ids are left.
#[utoipa::path(delete, path = "/v1/people/{id}", tag = "people", operation_id = "erasePerson",
    params(("id" = String, Path, example = "w1")), responses(
    (status = 204, description = "Erased, and that is durable"),
    (status = 409, description = "The person is on the floor, or has something to do")))]
pub async fn erase(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    api.queue()?;
    let worker = api.feeds.worker(&id)?;
    let seen = api.moment().view.workers.get(worker.ix()).map(|w| w.presence);
    if seen.is_some_and(|presence| presence != Presence::Absent) {
        let detail = requests::person_on_floor(&id);
        return Err(Problem::conflict("on-floor", "The person is on the floor", detail));
    }
    let open = [AssignmentState::Waiting, AssignmentState::Walking, AssignmentState::Working];
    let states = open.map(|state| state.word()).into();
    let query = AssignmentQuery { worker: Some(worker), states, limit: 1, ..AssignmentQuery::default() };
    let open = api.records.assignments(query).await.map_err(Problem::of_records)?.rows;
    if let Some(open) = open.first() {
        let detail = requests::person_assigned(&id, assignment_name(open.id));
        return Err(Problem::conflict("assigned", "The person has something to do", detail));
    }
    // Erase even if no name is kept: an earlier Giveway, which kept the place, may have erased the person, or the
    // person may be older than pseudonyms.
    let pseudonym = api.feeds.name(worker).unwrap_or_default();
    let erased = api.pseudonyms.erase(&pseudonym, Some(worker)).await;
    erased.map_err(Problem::of_records)?;
    done(&api, Ask::forget_worker(worker)).await
}
