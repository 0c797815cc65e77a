//! `/v1/robots/{id}/why` and `/v1/jobs/{id}/why`: why a robot or a job waits, down to the root cause.
//!
//! Main functions: [`robot`], [`job`]. Refuses: unknown names.

use crate::dto::names::Names;
use crate::dto::waits::WhyDto;
use crate::http::shared::named::parse_robot;
use crate::port::questions::Question;
use crate::state::called::Called;
use crate::wire::error::Problem;
use crate::wire::extract::PathPart;
use crate::wire::text::{job_name, parse_job_name};
use axum::Json;
use giveway_floor::text::sentence::requests;

/// Explain why a robot waits: the resource, what holds it, until when, and what that holder waits for, down to the root
/// cause.
#[utoipa::path(get, path = "/v1/robots/{id}/why", tag = "floor", operation_id = "explainRobot",
    params(("id" = String, Path, example = "robot-1")), responses(
    (status = 200, description = "The chain; for a robot that does not wait, what it is doing", body = WhyDto)))]
pub async fn robot(Called(api): Called, PathPart(id): PathPart) -> Result<Json<WhyDto>, Problem> {
    let robot = parse_robot(&api, &id)?;
    let waits = api.query(|reply| Question::Robot(robot, reply)).await?;
    Ok(Json(Names { map: &api.map, view: &api.moment().view }.chain(id, &waits)))
}

/// Explain why a job waits: for another job, its rack, a robot, or what its robot waits for, down to the root cause.
#[utoipa::path(get, path = "/v1/jobs/{id}/why", tag = "jobs",
    operation_id = "explainJob", params(("id" = String, Path, example = "j17")),
    responses(
    (status = 200, description = "The chain; empty for a job that is over, or that a robot is about to take",
     body = WhyDto)))]
pub async fn job(Called(api): Called, PathPart(id): PathPart) -> Result<Json<WhyDto>, Problem> {
    let job = parse_job_name(&id).ok_or_else(|| Problem::unknown("job", requests::not_a_job_id(&id)))?;
    let known = api.records.job(job).await.map_err(Problem::of_records)?;
    known.ok_or_else(|| Problem::unknown("job", requests::does_not_exist(job_name(job))))?;
    let waits = api.query(|reply| Question::Job(job, reply)).await?;
    Ok(Json(Names { map: &api.map, view: &api.moment().view }.chain(id, &waits)))
}
