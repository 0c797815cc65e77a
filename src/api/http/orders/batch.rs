//! `POST /v1/jobs:batch`: many jobs in one request, each accepted or refused separately.
//!
//! Main types: [`NewJobs`], [`BatchDto`]. The accepted jobs share one step of the fleet and one transaction, so that a
//! thousand jobs take no longer than one. Refuses: to refuse jobs because of another wrong row.

use super::jobs::{check_same, read};
use super::new_job::NewJob;
use crate::dto::refusal::refused;
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{IdempotencyKey, JsonBody};
use crate::wire::text::job_name;
use axum::Json;
use axum::http::StatusCode;
use giveway_fleet::{Ask, JobRequest, JobTaken, Made};
use giveway_floor::id::JobId;
use giveway_floor::text::sentence::requests;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

/// The most jobs in one request.
const MOST_JOBS: usize = 1000;

/// The largest request, in bytes: a thousand jobs with long references and some labels.
const LIMIT: usize = 1024 * 1024;

/// The longest key, in characters.
const LONGEST_KEY: usize = 255;

/// Many jobs.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewJobs {
    /// The jobs, 1 to 1000.
    #[schema(value_type = Vec<BatchRow>, min_items = 1, max_items = 1000)]
    jobs: Vec<Value>,
}

/// One job of a batch.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BatchRow {
    /// Your own key for this job, 1 to 255 characters: the same key never makes a second job, as with the header of
    /// single submissions. If absent, the row's key is the request's key, if that has one, with the row's position.
    #[schema(example = "order-4711-line-1", min_length = 1, max_length = 255)]
    key: Option<String>,
    /// The job.
    job: NewJob,
}

/// The result of a batch.
#[derive(Debug, Serialize, ToSchema)]
pub struct BatchDto {
    /// How many jobs are accepted, now or earlier under the same key.
    accepted: usize,
    /// How many jobs are refused.
    refused: usize,
    /// The result of each job, in the order of the request.
    results: Vec<BatchResult>,
}

/// The result of one job of a batch: either an id or a problem.
#[derive(Debug, Serialize, ToSchema)]
pub struct BatchResult {
    /// The job's number.
    #[schema(example = "j17")]
    id: Option<String>,
    /// Whether the job was accepted now, not earlier under the same key.
    new: bool,
    /// Why the job is refused; null if it is accepted.
    problem: Option<Problem>,
}

/// Submit up to 1000 jobs. Each is accepted or refused separately; when this call returns, the accepted jobs are
/// durable, all in one transaction. With keys, a retry never makes a second job.
#[utoipa::path(post, path = "/v1/jobs:batch", tag = "jobs", operation_id = "submitJobs", request_body = NewJobs,
    params(("Idempotency-Key" = Option<String>, Header,
            description = "Your own key for the whole request, up to 200 characters")),
    responses(
    (status = 200, description = "What became of each", body = BatchDto),
    (status = 413, description = "The body is longer than 1 MiB"),
    (status = 422, description = "There are no jobs, or more than 1000")))]
pub async fn submit(
    Called(api): Called,
    IdempotencyKey(key): IdempotencyKey,
    JsonBody(new): JsonBody<NewJobs, LIMIT>,
) -> Result<Json<BatchDto>, Problem> {
    check_size(&new, key.as_deref())?;
    let rows: Vec<_> =
        new.jobs.into_iter().enumerate().map(|(i, row)| read_row(&api, row, i, &key)).collect();
    let requests: Vec<JobRequest> = rows.iter().filter_map(|row| row.as_ref().ok().cloned()).collect();
    let taken = if requests.is_empty() { Vec::new() } else { api.ask(Ask::submit_batch(requests)).await? };
    let mut taken = taken.into_iter();
    let mut results = Vec::with_capacity(rows.len());
    for row in rows {
        let outcome = match row {
            Ok(request) => finish(&api, request, taken.next().ok_or_else(Problem::internal)?).await,
            Err(problem) => Err(problem),
        };
        results.push(match outcome {
            Ok(Made { id, new }) => BatchResult { id: Some(job_name(id)), new, problem: None },
            Err(problem) => BatchResult { id: None, new: false, problem: Some(problem) },
        });
    }
    let accepted = results.iter().filter(|r| r.id.is_some()).count();
    Ok(Json(BatchDto { accepted, refused: results.len() - accepted, results }))
}

fn check_size(new: &NewJobs, key: Option<&str>) -> Result<(), Problem> {
    if !(1..=MOST_JOBS).contains(&new.jobs.len()) {
        let detail = requests::batch_out_of_range(new.jobs.len(), MOST_JOBS);
        return Err(Problem::invalid(vec![FieldError::new("jobs", detail)]));
    }
    // The position is appended to the key, so the key must leave room.
    if key.is_some_and(|key| key.len() > 200) {
        return Err(Problem::malformed("Idempotency-Key of a batch must be 1 to 200 characters"));
    }
    Ok(())
}

fn read_row(api: &Api, row: Value, i: usize, key: &Option<String>) -> Result<JobRequest, Problem> {
    let row: BatchRow = serde_json::from_value(row).map_err(|e| {
        Problem::new(
            StatusCode::UNPROCESSABLE_ENTITY,
            "invalid",
            "Some fields are wrong",
            requests::malformed(e.to_string()),
        )
    })?;
    if row.key.as_ref().is_some_and(|key| !(1..=LONGEST_KEY).contains(&key.len())) {
        return Err(Problem::invalid(vec![FieldError::new("key", requests::name_length(LONGEST_KEY))]));
    }
    let key = row.key.or_else(|| key.as_ref().map(|key| format!("{key}#{i}")));
    let key = key.map(|text| api.caller.client_key(text));
    Ok(JobRequest { key, ..row.job.read(&api.map, &api.moment())? })
}

/// Refuses a job that is not new if its key was used for a different job.
async fn finish(api: &Api, request: JobRequest, taken: JobTaken) -> Result<Made<JobId>, Problem> {
    let taken = taken.map_err(|why| refused(&api.map, why))?;
    if !taken.new {
        check_same(&read(api, taken.id).await?, request)?;
    }
    Ok(taken)
}
