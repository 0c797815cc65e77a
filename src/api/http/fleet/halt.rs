//! `/v1/fleet` and pausing: operators stop the whole fleet, or pause one robot, until they resume it.
//!
//! Main type: [`FleetDto`]. Refuses: to be an emergency stop, which is the robots' own.

use crate::dto::names::Names;
use crate::http::shared::done::done;
use crate::http::shared::named::parse_robot;
use crate::state::called::Called;
use crate::wire::error::Problem;
use crate::wire::extract::PathPart;
use crate::wire::text::time_text;
use axum::Json;
use axum::http::StatusCode;
use giveway_fleet::{Ask, Why};
use giveway_floor::id::{Dense, RobotId};
use serde::Serialize;
use utoipa::ToSchema;

/// What operators have stopped or paused.
#[derive(Debug, Serialize, ToSchema)]
pub struct FleetDto {
    /// Since when the whole fleet has been stopped, RFC 3339; null if it is not stopped.
    pub stopped: Option<String>,
    /// Robots that are paused individually.
    pub paused: Vec<String>,
    /// How many robots could take a job now.
    pub free: usize,
}

/// Get what operators have stopped or paused.
#[utoipa::path(get, path = "/v1/fleet", tag = "floor",
    operation_id = "getFleet", responses(
    (status = 200, body = FleetDto)))]
pub async fn fleet(Called(api): Called) -> Json<FleetDto> {
    let moment = api.moment();
    let names = Names { map: &api.map, view: &moment.view };
    let robots = moment.view.robots.iter().enumerate().filter(|(_, r)| r.why == Some(Why::Paused));
    let paused = robots.map(|(i, _)| names.robot(RobotId::at(i))).collect();
    Json(FleetDto {
        stopped: moment.view.stopped.map(time_text),
        paused,
        free: moment.view.free.values().sum(),
    })
}

/// Stop all robots. They are told at once, and stand still until the fleet is resumed, even across a restart. This is
/// not an emergency stop: a robot that cannot be reached drives on to the end of its grant.
#[utoipa::path(post, path = "/v1/fleet/stop", tag = "floor", operation_id = "stopFleet", responses(
    (status = 204, description = "All robots were told to stop, and that is durable"),
    (status = 503, description = "They were told, but that is not durable yet")))]
pub async fn stop(Called(api): Called) -> Result<StatusCode, Problem> {
    done(&api, Ask::halt(None)).await
}

/// Resume the fleet. Robots that were paused individually stay paused.
#[utoipa::path(post, path = "/v1/fleet/resume", tag = "floor", operation_id = "resumeFleet", responses(
    (status = 204, description = "Robots go on")))]
pub async fn resume(Called(api): Called) -> Result<StatusCode, Problem> {
    done(&api, Ask::release(None)).await
}

/// Pause one robot. It stops where it is, keeps its reservations, and gets no job; robots behind it wait.
#[utoipa::path(post, path = "/v1/robots/{id}/pause", tag = "floor", operation_id = "pauseRobot",
    params(("id" = String, Path, example = "robot-1")), responses(
    (status = 204, description = "It was told to stop, and that is durable")))]
pub async fn pause(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    let robot = parse_robot(&api, &id)?;
    done(&api, Ask::halt(Some(robot))).await
}

/// Resume a robot that is paused, or that was fenced because the facts about it contradicted one another.
#[utoipa::path(post, path = "/v1/robots/{id}/resume", tag = "floor", operation_id = "resumeRobot",
    params(("id" = String, Path, example = "robot-1")), responses(
    (status = 204, description = "It goes on, unless the whole fleet is stopped")))]
pub async fn go_on(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    let robot = parse_robot(&api, &id)?;
    done(&api, Ask::release(Some(robot))).await
}
