//! `/v1/stations/{id}/…`: the person at a station says when a pick has ended, and whether anybody picks at all.
//!
//! Main functions: [`done`], [`short`], [`pause`], [`resume`]. Refuses: to end a pick that has not begun.

use crate::api::Api;
use crate::api::called::Called;
use crate::api::error::Problem;
use crate::api::extract::PathPart;
use crate::api::port::What;
use crate::api::refusal::refused;
use crate::fleet::{Reply, StationOrder};
use crate::id::StationId;
use axum::http::StatusCode;

/// End a pick: the job ends as done, and the robot takes its rack away. A pick lasts until this call; `pick_s` of a job
/// is only how long it is planned to take.
#[utoipa::path(post, path = "/v1/stations/{id}/done", tag = "floor", operation_id = "finishPick",
    params(("id" = String, Path, example = "W")), responses(
    (status = 204, description = "The pick has ended, and that is durable"),
    (status = 404, description = "There is no such station", body = Problem,
     content_type = "application/problem+json"),
    (status = 409, description = "No rack stands there", body = Problem, content_type = "application/problem+json"),
    (status = 503, description = "It cannot be made durable now", body = Problem,
     content_type = "application/problem+json")))]
pub async fn done(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    say(&api, &id, StationOrder::Done).await
}

/// End a pick because goods were missing: the job ends as failed, with that reason, and the rack is taken away.
#[utoipa::path(post, path = "/v1/stations/{id}/short", tag = "floor", operation_id = "reportShortPick",
    params(("id" = String, Path, example = "W")), responses(
    (status = 204, description = "The pick has ended, and that is durable"),
    (status = 404, description = "There is no such station", body = Problem,
     content_type = "application/problem+json"),
    (status = 409, description = "No rack stands there", body = Problem, content_type = "application/problem+json"),
    (status = 503, description = "It cannot be made durable now", body = Problem,
     content_type = "application/problem+json")))]
pub async fn short(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    say(&api, &id, StationOrder::Short).await
}

/// Pause picking at a station: no more racks are fetched for it; those in its queue wait.
#[utoipa::path(post, path = "/v1/stations/{id}/pause", tag = "floor", operation_id = "pauseStation",
    params(("id" = String, Path, example = "W")), responses(
    (status = 204, description = "Picking is paused, and that is durable"),
    (status = 404, description = "There is no such station", body = Problem,
     content_type = "application/problem+json"),
    (status = 503, description = "It cannot be made durable now", body = Problem,
     content_type = "application/problem+json")))]
pub async fn pause(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    say(&api, &id, StationOrder::Pause).await
}

/// Resume picking at a station.
#[utoipa::path(post, path = "/v1/stations/{id}/resume", tag = "floor", operation_id = "resumeStation",
    params(("id" = String, Path, example = "W")), responses(
    (status = 204, description = "Picking goes on, and that is durable"),
    (status = 404, description = "There is no such station", body = Problem,
     content_type = "application/problem+json"),
    (status = 503, description = "It cannot be made durable now", body = Problem,
     content_type = "application/problem+json")))]
pub async fn resume(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    say(&api, &id, StationOrder::Resume).await
}

async fn say(api: &Api, name: &str, order: StationOrder) -> Result<StatusCode, Problem> {
    let station = parse_station(api, name)?;
    match api.ask(What::Station(station, order)).await? {
        Reply::Refused { why, .. } => Err(refused(&api.map, why)),
        _ => Ok(StatusCode::NO_CONTENT),
    }
}

fn parse_station(api: &Api, name: &str) -> Result<StationId, Problem> {
    let found = api.map.stations.pairs().find(|(_, s)| s.name == name).map(|(id, _)| id);
    found.ok_or_else(|| {
        Problem::unknown("station", format!("there is no station \"{name}\"; GET /v1/stations lists all"))
    })
}
