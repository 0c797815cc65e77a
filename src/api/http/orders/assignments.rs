//! `/v1/workers/{id}/assignments` and `/v1/assignments`: tasks for workers.
//!
//! Main type: [`NewAssignment`]. A request is answered when its facts are durable. Refuses: to reorder a worker's
//! assignments, and to tell roles below admin both the worker and the times of an assignment that is over: that would
//! reveal how fast a person works.

use crate::access::caller::Role;
use crate::dto::names::{Names, Page};
use crate::dto::people::{ASSIGNMENT_STATES, AssignmentDto};
use crate::http::shared::named::unknown;
use crate::http::shared::paging::{checked_limit, read_words, refuse_wrong};
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{IdempotencyKey, JsonBody, Params, PathPart, read_end, read_time};
use crate::wire::text::{assignment_name, parse_assignment, worker_name};
use crate::wire::words::AssignmentStateDto;
use axum::Json;
use axum::http::{HeaderName, StatusCode, header};
use giveway_fleet::{Ask, AssignmentQuery, AssignmentRequest, AssignmentRow, Made};
use giveway_floor::id::{AssignmentId, WorkerId};
use giveway_floor::text::sentence::requests;
use giveway_floor::time::Span;
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};

/// The longest stay, in seconds: a shift.
const LONGEST_STAY_S: f64 = 8.0 * 3600.0;

/// States in which nothing is known yet about how long the assignment took.
const OPEN: [&str; 3] = ["waiting", "walking", "working"];

/// How long a stay is if the request does not say, seconds.
const USUAL_STAY_S: f64 = 30.0;

/// The longest text, in characters.
const LONGEST_TEXT: usize = 500;

/// A task for a worker.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewAssignment {
    /// Name of the node to go to; at a storage node, the nearest place from which its rack can be reached.
    #[schema(example = "A12")]
    place: String,
    /// How long the worker stays there, seconds; 30 if absent.
    #[schema(minimum = 0, maximum = 28800)]
    stay_s: Option<f64>,
    /// The task, in your words, up to 500 characters.
    what: Option<String>,
}

/// Filters for the list of assignments.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct AssignmentParams {
    /// How many assignments at most, 1 to 500; 50 if absent.
    limit: Option<u32>,
    /// Only assignments in this state, or in any of several with commas between them.
    #[param(value_type = Option<Vec<AssignmentStateDto>>, style = Form, explode = false)]
    state: Option<String>,
    /// Only assignments at this node.
    #[param(example = "A12")]
    place: Option<String>,
    /// Only assignments whose state changed at this time or later, RFC 3339.
    #[param(example = "2027-01-31T06:00:00Z")]
    updated_since: Option<String>,
    /// Only assignments that were accepted at this time or later, RFC 3339.
    from: Option<String>,
    /// Only assignments that were accepted before this time, RFC 3339.
    to: Option<String>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// List a worker's assignments, newest first. Ended assignments, with their times, would reveal how fast a person
/// works: administrators see them, and a device sees its own worker's; other callers get only open assignments.
#[utoipa::path(get, path = "/v1/workers/{id}/assignments", tag = "people", operation_id = "listAssignmentsOfWorker",
    params(("id" = String, Path, example = "w1"), AssignmentParams), responses(
    (status = 200, description = "Assignments, newest first", body = Page<AssignmentDto>),
    (status = 403, description = "Only administrators may ask for a person's assignments that are over")))]
pub async fn of_worker(
    Called(api): Called,
    PathPart(id): PathPart,
    Params(p): Params<AssignmentParams>,
) -> Result<Json<Page<AssignmentDto>>, Problem> {
    let worker = api.feeds.worker(&id)?;
    let mut query = read_query(&api, &p)?;
    if !may_know_pace(&api, worker) {
        let is_open = |word: &&str| OPEN.contains(word);
        if !query.states.iter().all(is_open) {
            let detail = requests::pace_is_private();
            return Err(Problem::new(StatusCode::FORBIDDEN, "role", "Another role is needed", detail));
        }
        if query.states.is_empty() {
            query.states = OPEN.into();
        }
    }
    list(&api, AssignmentQuery { worker: Some(worker), ..query }).await
}

/// List all assignments, newest first. For roles below admin, `worker` is null if an assignment is over: with its times
/// it would reveal how fast a person works.
#[utoipa::path(get, path = "/v1/assignments", tag = "people",
    operation_id = "listAssignments", params(AssignmentParams), responses(
    (status = 200, description = "Assignments, newest first", body = Page<AssignmentDto>)))]
pub async fn all(
    Called(api): Called,
    Params(p): Params<AssignmentParams>,
) -> Result<Json<Page<AssignmentDto>>, Problem> {
    list(&api, read_query(&api, &p)?).await
}

/// Get one assignment.
#[utoipa::path(get, path = "/v1/assignments/{id}", tag = "people", operation_id = "getAssignment",
    params(("id" = String, Path, example = "a3")), responses(
    (status = 200, description = "The assignment", body = AssignmentDto)))]
pub async fn get(Called(api): Called, PathPart(id): PathPart) -> Result<Json<AssignmentDto>, Problem> {
    let record = read(&api, parse_id(&id)?).await?;
    Ok(Json(dto(&api, &record)))
}

/// Give a worker an assignment. When this call returns, the assignment is durable. With an `Idempotency-Key`, a
/// retry never makes a second assignment.
#[utoipa::path(post, path = "/v1/workers/{id}/assignments", tag = "people",
    operation_id = "assignToWorker", request_body = NewAssignment,
    params(("id" = String, Path, example = "w1"),
    ("Idempotency-Key" = Option<String>, Header, description = "Your own key, up to 255 characters")),
    responses(
    (status = 201, description = "Accepted and durable", body = AssignmentDto, headers(("Location" = String))),
    (status = 200, description = "Accepted earlier under this key", body = AssignmentDto),
    (status = 429)))]
pub async fn assign(
    Called(api): Called,
    PathPart(id): PathPart,
    IdempotencyKey(key): IdempotencyKey,
    JsonBody(new): JsonBody<NewAssignment>,
) -> Result<(StatusCode, [(HeaderName, String); 1], Json<AssignmentDto>), Problem> {
    let worker = api.feeds.worker(&id)?;
    let key = key.map(|text| api.caller.client_key(text));
    hand_in(&api, Some(worker), AssignmentRequest { key, ..new.read(&api)? }).await
}

/// Give the nearest free worker an assignment. The assignment waits (`worker` is null) until a worker on the floor
/// has nothing else to do; then it goes to the one with the shortest walk, the oldest assignment first. When this call
/// returns, the assignment is durable. With an `Idempotency-Key`, a retry never makes a second assignment.
#[utoipa::path(post, path = "/v1/assignments", tag = "people",
    operation_id = "assignToNearestWorker", request_body = NewAssignment,
    params(("Idempotency-Key" = Option<String>, Header, description = "Your own key, up to 255 characters")),
    responses(
    (status = 201, description = "Accepted and durable", body = AssignmentDto, headers(("Location" = String))),
    (status = 200, description = "Accepted earlier under this key", body = AssignmentDto),
    (status = 429)))]
pub async fn assign_nearest(
    Called(api): Called,
    IdempotencyKey(key): IdempotencyKey,
    JsonBody(new): JsonBody<NewAssignment>,
) -> Result<(StatusCode, [(HeaderName, String); 1], Json<AssignmentDto>), Problem> {
    let key = key.map(|text| api.caller.client_key(text));
    hand_in(&api, None, AssignmentRequest { key, ..new.read(&api)? }).await
}

async fn hand_in(
    api: &Api,
    worker: Option<WorkerId>,
    request: AssignmentRequest,
) -> Result<(StatusCode, [(HeaderName, String); 1], Json<AssignmentDto>), Problem> {
    let Made { id, new } = api.ask(Ask::assign(worker, request.clone())).await?;
    let record = read(api, id).await?;
    // The list does not record the owner of a key, so keys are not compared.
    let known = AssignmentRequest { key: request.key.clone(), ..record.assignment.request.clone() };
    // An assignment that waited for a worker may have got one since.
    let other = worker.is_some() && record.assignment.worker != worker;
    if known != request || other {
        let detail = requests::key_of_another(assignment_name(id));
        let status = StatusCode::UNPROCESSABLE_ENTITY;
        return Err(Problem::new(status, "key-reused", "The key belongs to another assignment", detail));
    }
    let status = if new { StatusCode::CREATED } else { StatusCode::OK };
    let place = format!("/v1/assignments/{}", assignment_name(id));
    Ok((status, [(header::LOCATION, place)], Json(dto(api, &record))))
}

/// Cancel an assignment.
#[utoipa::path(delete, path = "/v1/assignments/{id}", tag = "people", operation_id = "cancelAssignment",
    params(("id" = String, Path, example = "a3")), responses(
    (status = 200, description = "It is cancelled", body = AssignmentDto),
    (status = 409, description = "It is over already")))]
pub async fn cancel(Called(api): Called, PathPart(id): PathPart) -> Result<Json<AssignmentDto>, Problem> {
    let id = parse_id(&id)?;
    read(&api, id).await?;
    end(&api, id, Ask::unassign(id)).await
}

/// Report that the worker has finished an assignment, wherever the worker was seen. Headsets report it over their feed.
#[utoipa::path(post, path = "/v1/assignments/{id}/done", tag = "people", operation_id = "finishAssignment",
    params(("id" = String, Path, example = "a3")), responses(
    (status = 200, description = "It is done", body = AssignmentDto),
    (status = 409, description = "It is over already, or no worker has it yet")))]
pub async fn finish(Called(api): Called, PathPart(id): PathPart) -> Result<Json<AssignmentDto>, Problem> {
    let id = parse_id(&id)?;
    let Some(worker) = read(&api, id).await?.assignment.worker else {
        let name = assignment_name(id);
        let detail = requests::assignment_waits(name);
        let title = "Nobody has the assignment yet";
        return Err(Problem::new(StatusCode::CONFLICT, "assignment-waits", title, detail));
    };
    end(&api, id, Ask::finish(worker, id)).await
}

/// Ends an assignment: done or cancelled, as `how` says.
async fn end(api: &Api, id: AssignmentId, how: Ask<()>) -> Result<Json<AssignmentDto>, Problem> {
    api.ask(how).await?;
    Ok(Json(dto(api, &read(api, id).await?)))
}

/// The query of a list; an error if words, names or times are invalid.
fn read_query(api: &Api, p: &AssignmentParams) -> Result<AssignmentQuery, Problem> {
    let limit = checked_limit(p.limit, 50)?;
    let mut errors = Vec::new();
    let words = ASSIGNMENT_STATES.map(|s| s.word());
    let states = read_words("state", p.state.as_deref(), &words, &mut errors);
    let place = p.place.as_deref().and_then(|name| {
        let place = api.map.node_named(name);
        if place.is_none() {
            errors.push(no_place(name));
        }
        place
    });
    let mut time = |field: &str, text: &Option<String>| read_time(field, text.as_deref(), &mut errors);
    let updated_since = time("updated_since", &p.updated_since);
    let from = time("from", &p.from);
    let to = read_end("to", p.to.as_deref(), &mut errors);
    let before = p.cursor.as_deref().and_then(|cursor| {
        let id = parse_assignment(cursor);
        if id.is_none() {
            errors.push(FieldError::new("cursor", requests::not_a_cursor()));
        }
        id
    });
    refuse_wrong(errors)?;
    Ok(AssignmentQuery { worker: None, states, place, updated_since, from, to, before, limit })
}

async fn list(api: &Api, query: AssignmentQuery) -> Result<Json<Page<AssignmentDto>>, Problem> {
    let page = api.records.assignments(query).await.map_err(Problem::of_records)?;
    let items = page.rows.iter().map(|row| dto(api, row)).collect();
    Ok(Json(Page { items, next: page.next.map(assignment_name) }))
}

fn parse_id(text: &str) -> Result<AssignmentId, Problem> {
    parse_assignment(text).ok_or_else(|| Problem::unknown("assignment", requests::not_an_assignment_id(text)))
}

async fn read(api: &Api, id: AssignmentId) -> Result<AssignmentRow, Problem> {
    let record = api.records.assignment(id).await.map_err(Problem::of_records)?;
    record.ok_or_else(|| Problem::unknown("assignment", requests::does_not_exist(assignment_name(id))))
}

/// Whether the caller may know how long a worker took for something: an administrator, or the worker's own device.
fn may_know_pace(api: &Api, worker: WorkerId) -> bool {
    let caller = &api.caller;
    let is_own = caller.role == Role::Device && caller.subject.as_deref() == Some(&worker_name(worker));
    caller.role == Role::Admin || is_own
}

/// An assignment as the caller may see it: once it is over, only administrators and the worker's own device see the
/// worker.
fn dto(api: &Api, record: &AssignmentRow) -> AssignmentDto {
    let dto = Names { map: &api.map, view: &api.moment().view }.assignment(record);
    let is_open = OPEN.contains(&dto.state.word());
    let is_shown = is_open || record.assignment.worker.is_some_and(|worker| may_know_pace(api, worker));
    AssignmentDto { worker: dto.worker.filter(|_| is_shown), ..dto }
}

fn no_place(name: &str) -> FieldError {
    FieldError::new("place", unknown("node", name))
}

impl NewAssignment {
    fn read(&self, api: &Api) -> Result<AssignmentRequest, Problem> {
        let mut errors = Vec::new();
        let place = api.map.node_named(&self.place);
        if place.is_none() {
            errors.push(no_place(&self.place));
        }
        let stay_s = self.stay_s.unwrap_or(USUAL_STAY_S);
        if !(0.0..=LONGEST_STAY_S).contains(&stay_s) {
            errors.push(FieldError::new("stay_s", requests::seconds_out_of_range(LONGEST_STAY_S as i64)));
        }
        let what = self.what.clone().unwrap_or_default();
        if what.chars().count() > LONGEST_TEXT {
            errors.push(FieldError::new("what", requests::too_many_characters(LONGEST_TEXT)));
        }
        match place {
            Some(place) if errors.is_empty() => {
                Ok(AssignmentRequest { place, stay: Span::from_secs_f64(stay_s), what, key: None })
            }
            _ => Err(Problem::invalid(errors)),
        }
    }
}
