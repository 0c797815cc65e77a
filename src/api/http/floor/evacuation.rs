//! `/v1/evacuation`: people are led to a door, robots clear the escape routes and stop.
//!
//! Main type: [`EvacuationDto`]. Refuses: to be an alarm system, or part of one.

use crate::http::shared::done::done;
use crate::state::called::Called;
use crate::wire::error::Problem;
use crate::wire::text::time_text;
use axum::Json;
use axum::http::StatusCode;
use giveway_fleet::{Ask, GuidanceReason, Presence, WorkerView};
use giveway_floor::id::{Dense, WorkerId};
use serde::Serialize;
use utoipa::ToSchema;

/// The state of an evacuation.
#[derive(Debug, Serialize, ToSchema)]
pub struct EvacuationDto {
    /// Since when the building is being evacuated, RFC 3339; null if nobody ordered an evacuation.
    pub since: Option<String>,
    /// Workers who are on the floor and not at a door yet: names, or pseudonyms for callers who may not see names.
    pub inside: Vec<String>,
}

/// Get whether the building is being evacuated, and which workers are still inside.
#[utoipa::path(get, path = "/v1/evacuation", tag = "people",
    operation_id = "getEvacuation", responses(
    (status = 200, body = EvacuationDto)))]
pub async fn get(Called(api): Called) -> Json<EvacuationDto> {
    let moment = api.moment();
    let view = &moment.view;
    let is_led = |w: &WorkerView| {
        let told = w.guidance.reason == Some(GuidanceReason::Evacuation);
        w.presence != Presence::Absent && !(told && w.guidance.path.is_empty())
    };
    let all = view.workers.iter().enumerate().filter(|(_, w)| is_led(w) && view.evacuation.is_some());
    let inside = all.map(|(i, w)| api.pseudonyms.shown(&api.caller, WorkerId::at(i), &w.name)).collect();
    Json(EvacuationDto { since: view.evacuation.map(time_text), inside })
}

/// Evacuate the building. Workers are led to the nearest reachable door; robots on the escape routes leave them, all
/// other robots stop; no job begins. The evacuation lasts until somebody ends it, even across a restart. This is not a
/// safety function: the alarm system of the building is.
#[utoipa::path(post, path = "/v1/evacuation", tag = "people", operation_id = "beginEvacuation", responses(
    (status = 204, description = "It has begun, and is durable"),
    (status = 409, description = "The map has no doors")))]
pub async fn begin(Called(api): Called) -> Result<StatusCode, Problem> {
    done(&api, Ask::evacuate()).await
}

/// End the evacuation. Robots go on with their loads, waiting jobs begin, and workers go on with their assignments.
#[utoipa::path(delete, path = "/v1/evacuation", tag = "people", operation_id = "endEvacuation", responses(
    (status = 204, description = "It is over")))]
pub async fn end(Called(api): Called) -> Result<StatusCode, Problem> {
    done(&api, Ask::end_evacuation()).await
}
