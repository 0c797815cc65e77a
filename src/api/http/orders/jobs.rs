//! `/v1/jobs`: submit, list, get, change, cancel.
//!
//! Main types: [`JobParams`], [`JobPatch`]. A request is answered when its facts are durable. Refuses: to change a job
//! on which a robot works.

use super::new_job::NewJob;
use crate::dto::names::{JobDto, Names, Page};
use crate::http::shared::named::{robot_named, unknown};
use crate::http::shared::paging::{checked_limit, named, read_words};
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{IdempotencyKey, JsonBody, Params, PathPart, read_end, read_time};
use crate::wire::text::{job_name, parse_job_name};
use crate::wire::words::JobStateDto;
use axum::Json;
use axum::http::{HeaderName, StatusCode, header};
use giveway_fleet::{Ask, JOB_STATES, JobChange, JobQuery, JobRequest, JobRow, Listed, Made};
use giveway_floor::id::JobId;
use giveway_floor::text::sentence::requests;
use serde::{Deserialize, Deserializer};
use utoipa::{IntoParams, ToSchema};

/// The index of references stores runs of this many characters.
const SHORTEST_PART: usize = 3;

/// Filters for the list of jobs.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct JobParams {
    /// How many jobs at most, 1 to 500; 50 if absent.
    limit: Option<u32>,
    /// Only jobs in this state, or in any of several with commas between them.
    #[param(value_type = Option<Vec<JobStateDto>>, style = Form, explode = false)]
    state: Option<String>,
    /// Only jobs that move this rack.
    #[param(example = "K1")]
    rack: Option<String>,
    /// Only jobs for this station.
    #[param(example = "P1")]
    station: Option<String>,
    /// Only jobs that this robot has, or had last.
    #[param(example = "robot-1")]
    robot: Option<String>,
    /// Only jobs that changed at this time or later, RFC 3339.
    #[param(example = "2027-01-31T06:00:00Z")]
    updated_since: Option<String>,
    /// Only jobs that were accepted at this time or later, RFC 3339.
    from: Option<String>,
    /// Only jobs that were accepted before this time, RFC 3339.
    to: Option<String>,
    /// Only jobs with this reference.
    #[param(example = "order 4711", max_length = 200)]
    reference: Option<String>,
    /// Only jobs whose reference contains this text, in upper or lower case; three characters or more.
    #[param(example = "4711", min_length = 3, max_length = 200)]
    reference_part: Option<String>,
    /// Only jobs with this label, as KEY:VALUE.
    #[param(example = "wave:7")]
    label: Option<String>,
    /// `next` of the previous page.
    cursor: Option<String>,
}

/// List jobs, newest first.
#[utoipa::path(get, path = "/v1/jobs", tag = "jobs", operation_id = "listJobs", params(JobParams), responses(
    (status = 200, description = "Jobs, newest first", body = Page<JobDto>)))]
pub async fn list(Called(api): Called, Params(p): Params<JobParams>) -> Result<Json<Page<JobDto>>, Problem> {
    let limit = checked_limit(p.limit, 50)?;
    let mut errors = Vec::new();
    let before = p.cursor.as_deref().and_then(|cursor| {
        let id = parse_job_name(cursor);
        if id.is_none() {
            errors.push(FieldError::new("cursor", requests::not_a_cursor()));
        }
        id
    });
    let label = p.label.as_deref().and_then(|text| {
        let label = text.split_once(':').map(|(key, value)| (key.to_owned(), value.to_owned()));
        if label.is_none() {
            errors.push(FieldError::new("label", requests::give_key_and_value()));
        }
        label
    });
    if p.reference_part.as_ref().is_some_and(|part| part.chars().count() < SHORTEST_PART) {
        errors.push(FieldError::new("reference_part", requests::give_three_characters()));
    }
    let filter = read_filter(&api, &p, &mut errors);
    if !errors.is_empty() {
        return Err(Problem::invalid(errors));
    }
    let (reference, reference_part) = (p.reference, p.reference_part);
    let filter = JobQuery { reference, reference_part, label, before, limit, ..filter };
    let page = api.records.jobs(filter).await.map_err(Problem::of_records)?;
    let Listed { rows, next } = page;
    let next = next.map(job_name);
    let moment = api.moment();
    let names = Names { map: &api.map, view: &moment.view };
    Ok(Json(Page { items: rows.iter().map(|row| names.job(row)).collect(), next }))
}

/// The filters of a list except reference and label; adds an error for invalid words, names and times.
fn read_filter(api: &Api, p: &JobParams, errors: &mut Vec<FieldError>) -> JobQuery {
    let states = read_words("state", p.state.as_deref(), &JOB_STATES, errors);
    let moment = api.moment();
    let rack = named("rack", p.rack.as_deref(), |name| api.map.rack_named(name), errors);
    let station = named("station", p.station.as_deref(), |name| api.map.station_named(name), errors);
    let robot = named("robot", p.robot.as_deref(), |name| robot_named(&moment, name), errors);
    let mut time = |field: &str, text: &Option<String>| read_time(field, text.as_deref(), errors);
    let updated_since = time("updated_since", &p.updated_since);
    let from = time("from", &p.from);
    let to = read_end("to", p.to.as_deref(), errors);
    JobQuery { states, rack, station, robot, updated_since, from, to, ..JobQuery::default() }
}

/// Get one job.
#[utoipa::path(get, path = "/v1/jobs/{id}", tag = "jobs",
    operation_id = "getJob", params(("id" = String, Path, example = "j17")),
    responses(
    (status = 200, description = "The job", body = JobDto)))]
pub async fn get(Called(api): Called, PathPart(id): PathPart) -> Result<Json<JobDto>, Problem> {
    let row = read(&api, parse_id(&id)?).await?;
    Ok(Json(dto(&api, &row)))
}

/// Submit a job. When this call returns, the job is durable. With an `Idempotency-Key`, a retry never makes a
/// second job.
#[utoipa::path(post, path = "/v1/jobs", tag = "jobs", operation_id = "submitJob", request_body = NewJob,
    params(("Idempotency-Key" = Option<String>, Header, description = "Your own key, up to 255 characters")),
    responses(
    (status = 201, description = "Accepted and durable", body = JobDto, headers(("Location" = String))),
    (status = 200, description = "Accepted earlier under this key", body = JobDto),
    (status = 429)))]
pub async fn submit(
    Called(api): Called,
    IdempotencyKey(key): IdempotencyKey,
    JsonBody(new): JsonBody<NewJob>,
) -> Result<(StatusCode, [(HeaderName, String); 1], Json<JobDto>), Problem> {
    let key = key.map(|text| api.caller.client_key(text));
    let request = JobRequest { key, ..new.read(&api.map, &api.moment())? };
    let Made { id: job, new } = api.ask(Ask::submit(request.clone())).await?;
    let row = read(&api, job).await?;
    check_same(&row, request)?;
    let status = if new { StatusCode::CREATED } else { StatusCode::OK };
    Ok((status, [(header::LOCATION, format!("/v1/jobs/{}", job_name(job)))], Json(dto(&api, &row))))
}

/// Refuses a key that was used for another job. A job that was changed since may differ from its submission.
pub(super) fn check_same(row: &JobRow, asked: JobRequest) -> Result<(), Problem> {
    // The list does not record the owner of a key, so keys are not compared.
    let mut known = JobRequest { priority: asked.priority, key: asked.key.clone(), ..row.job.submitted() };
    if row.changed {
        let same_kind = std::mem::discriminant(&known.kind) == std::mem::discriminant(&asked.kind);
        if same_kind && known.kind.rack() == asked.kind.rack() {
            known.kind = asked.kind;
        }
        known.deadline = asked.deadline;
    }
    if known == asked {
        return Ok(());
    }
    let detail = requests::key_of_another(job_name(row.id));
    let status = StatusCode::UNPROCESSABLE_ENTITY;
    Err(Problem::new(status, "key-reused", "The key belongs to another job", detail))
}

/// Changes to a job that no robot has yet. Fields that are left out stay as they are.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct JobPatch {
    /// Priority from 0 to 9; 9 goes first.
    #[schema(minimum = 0, maximum = 9)]
    priority: Option<u8>,
    /// When the job should be done, RFC 3339, not before now; null for no deadline.
    #[serde(default, deserialize_with = "given")]
    #[schema(value_type = Option<String>, example = "2027-01-31T12:00:00Z")]
    deadline: Option<Option<String>>,
    /// Name of another station; `deliver` only.
    #[schema(example = "S1")]
    station: Option<String>,
    /// Name of another robot; `charge`, `park` and `go` only.
    #[schema(example = "robot-1")]
    robot: Option<String>,
}

/// Distinguishes null from a field that is left out.
fn given<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Option<String>>, D::Error> {
    Option::deserialize(deserializer).map(Some)
}

/// Change the deadline, the station, the robot or the priority of a job that no robot has yet: all given fields, or
/// none.
#[utoipa::path(patch, path = "/v1/jobs/{id}", tag = "jobs", operation_id = "changeJob", request_body = JobPatch,
    params(("id" = String, Path, example = "j17")), responses(
    (status = 200, description = "The job as it is now", body = JobDto),
    (status = 409, description = "A robot already works on it, or it is over")))]
pub async fn change(
    Called(api): Called,
    PathPart(id): PathPart,
    JsonBody(patch): JsonBody<JobPatch>,
) -> Result<Json<JobDto>, Problem> {
    let id = parse_id(&id)?;
    api.ask(Ask::change(id, patch.read(&api)?)).await?;
    Ok(Json(dto(&api, &read(&api, id).await?)))
}

impl JobPatch {
    fn read(&self, api: &Api) -> Result<JobChange, Problem> {
        let mut errors = Vec::new();
        let mut wrong = |field: &str, name: &str| errors.push(FieldError::new(field, unknown(field, name)));
        let station = self.station.as_deref().and_then(|name| {
            let station = api.map.station_named(name);
            if station.is_none() {
                wrong("station", name);
            }
            station
        });
        let robot = self.robot.as_deref().and_then(|name| {
            let robot = robot_named(&api.moment(), name);
            if robot.is_none() {
                wrong("robot", name);
            }
            robot
        });
        let deadline = self.deadline.as_ref().map(|text| read_end("deadline", text.as_deref(), &mut errors));
        if !errors.is_empty() {
            return Err(Problem::invalid(errors));
        }
        Ok(JobChange { priority: self.priority, deadline, station, robot })
    }
}

/// Cancel a job. A robot that carries its rack puts it back first.
#[utoipa::path(delete, path = "/v1/jobs/{id}", tag = "jobs",
    operation_id = "cancelJob", params(("id" = String, Path, example = "j17")),
    responses(
    (status = 200, description = "It is cancelled, or will be as soon as its rack is back", body = JobDto),
    (status = 409, description = "It is over already, or is part of a recording")))]
pub async fn cancel(Called(api): Called, PathPart(id): PathPart) -> Result<Json<JobDto>, Problem> {
    let id = parse_id(&id)?;
    api.ask(Ask::cancel(id)).await?;
    Ok(Json(dto(&api, &read(&api, id).await?)))
}

/// The choice of another robot for a job.
#[derive(Clone, Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Reassignment {
    /// Name of the robot; if absent, any robot except the current one, which may get the job again after two minutes.
    #[schema(example = "robot-1")]
    robot: Option<String>,
}

/// Take a job from its robot, or give it to another one. If the current robot carries the rack, it puts the rack down.
/// A job without a robot waits for the named robot; without a name, any robot may take it again. The choice ends when a
/// robot has the job, after five minutes, or when the chosen robot goes out of service.
#[utoipa::path(post, path = "/v1/jobs/{id}/reassign", tag = "jobs", operation_id = "reassignJob",
    request_body = Reassignment, params(("id" = String, Path, example = "j17")), responses(
    (status = 200, description = "The job as it is now", body = JobDto),
    (status = 409, description = "It is over, its rack is at its station, or it names its robot")))]
pub async fn reassign(
    Called(api): Called,
    PathPart(id): PathPart,
    JsonBody(to): JsonBody<Reassignment>,
) -> Result<Json<JobDto>, Problem> {
    let id = parse_id(&id)?;
    let mut errors = Vec::new();
    let moment = api.moment();
    let robot = named("robot", to.robot.as_deref(), |name| robot_named(&moment, name), &mut errors);
    if !errors.is_empty() {
        return Err(Problem::invalid(errors));
    }
    api.ask(Ask::reassign(id, robot)).await?;
    Ok(Json(dto(&api, &read(&api, id).await?)))
}

fn parse_id(text: &str) -> Result<JobId, Problem> {
    parse_job_name(text).ok_or_else(|| Problem::unknown("job", requests::not_a_job_id(text)))
}

pub(super) async fn read(api: &Api, id: JobId) -> Result<JobRow, Problem> {
    let row = api.records.job(id).await.map_err(Problem::of_records)?;
    row.ok_or_else(|| Problem::unknown("job", requests::does_not_exist(job_name(id))))
}

fn dto(api: &Api, row: &JobRow) -> JobDto {
    Names { map: &api.map, view: &api.moment().view }.job(row)
}
