//! `/v1/stations/{id}` and below: the pick at a station; the person there reports progress on it, and pauses or resumes
//! picking.
//!
//! Main functions: [`one`], [`line()`], [`release`], [`done()`], [`short`], [`pause`], [`resume`]. Refuses: to end a
//! pick that has not begun, and to count a piece twice.

use crate::dto::cell::LineChangedDto;
use crate::dto::cell::station::StationDetailDto;
use crate::dto::names::Names;
use crate::http::shared::done;
use crate::http::shared::named::parse_station;
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{JsonBody, PathPair, PathPart};
use crate::wire::text::job_name;
use axum::Json;
use axum::http::StatusCode;
use giveway_cell::{LineChange, LineOutcome};
use giveway_fleet::{Ask, LineNoted, StationOrder};
use giveway_floor::id::StationId;
use giveway_floor::text::sentence::requests;
use serde::Deserialize;
use utoipa::ToSchema;

/// Get one station with the rack that stands there and the lines to pick from it.
#[utoipa::path(get, path = "/v1/stations/{id}", tag = "floor", operation_id = "getStation",
    params(("id" = String, Path, example = "W")), responses(
    (status = 200, description = "The station", body = StationDetailDto)))]
pub async fn one(Called(api): Called, PathPart(id): PathPart) -> Result<Json<StationDetailDto>, Problem> {
    let station = parse_station(&api, &id)?;
    let moment = api.moment();
    Ok(Json(Names { map: &api.map, view: &moment.view }.station_detail(station)))
}

/// A report on a line; exactly one of the three fields.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct LineChangeDto {
    /// How many more pieces are in the tote.
    #[schema(minimum = 1, maximum = 10000)]
    done: Option<i64>,
    /// True: the slot has no more pieces.
    short: Option<bool>,
    /// True: earlier reports are taken back, and no piece counts.
    undo: Option<bool>,
}

impl LineChangeDto {
    fn read(&self) -> Result<LineChange, Problem> {
        match (self.done, self.short, self.undo) {
            (Some(done), None, None) => u32::try_from(done).map(LineChange::Done).map_err(|_| {
                Problem::invalid(vec![FieldError::new("done", requests::pieces_at_least_one())])
            }),
            (None, Some(true), None) => Ok(LineChange::Short),
            (None, None, Some(true)) => Ok(LineChange::Undo),
            _ => {
                let detail = "give one of {\"done\": pieces}, {\"short\": true} and {\"undo\": true}";
                let detail = requests::malformed(detail);
                Err(Problem::invalid(vec![FieldError::new("done", detail)]))
            }
        }
    }
}

/// Report progress on a line: a button, a scanner or a scale confirms pieces, reports that the slot is empty, or takes
/// back earlier reports. Lines count from 1. The visit ends with its last line, and then the rack leaves. Pieces that
/// were confirmed already are not counted again: `changed` is then false.
#[utoipa::path(post, path = "/v1/stations/{id}/lines/{n}", tag = "floor", operation_id = "changeLine",
    params(("id" = String, Path, example = "W"), ("n" = usize, Path, minimum = 1, example = 1)),
    request_body = LineChangeDto, responses(
    (status = 200, description = "It is noted, and that is durable", body = LineChangedDto),
    (status = 404, description = "There is no such station or line"),
    (status = 409, description = "No rack stands there, or its job has no lines"),
    (status = 413, description = "The request is too long"),
    (status = 422, description = "That cannot be said about a line, or not about this one")))]
pub async fn line(
    Called(api): Called,
    PathPair(id, n): PathPair,
    JsonBody(change): JsonBody<LineChangeDto>,
) -> Result<Json<LineChangedDto>, Problem> {
    let station = parse_station(&api, &id)?;
    let no_line = || Problem::unknown("line", requests::line_unknown(&n));
    let n: usize = n.parse().ok().filter(|n| *n > 0).ok_or_else(no_line)?;
    change_line(&api, station, Some(n - 1), change.read()?).await
}

/// Report on the line that was not confirmed when its rack left at the last grasp; another rack may be at the station
/// already. The body is as for a line of the visit.
#[utoipa::path(post, path = "/v1/stations/{id}/last", tag = "floor", operation_id = "changeLastLine",
    params(("id" = String, Path, example = "W")), request_body = LineChangeDto, responses(
    (status = 200, description = "It is noted, and that is durable", body = LineChangedDto),
    (status = 409, description = "Every line was confirmed before its rack left"),
    (status = 413, description = "The request is too long"),
    (status = 422, description = "That cannot be said about this line")))]
pub async fn last(
    Called(api): Called,
    PathPart(id): PathPart,
    JsonBody(change): JsonBody<LineChangeDto>,
) -> Result<Json<LineChangedDto>, Problem> {
    let station = parse_station(&api, &id)?;
    change_line(&api, station, None, change.read()?).await
}

async fn change_line(
    api: &Api,
    station: StationId,
    line: Option<usize>,
    change: LineChange,
) -> Result<Json<LineChangedDto>, Problem> {
    let LineNoted { job, line, outcome, state, pieces } = api.ask(Ask::line(station, line, change)).await?;
    Ok(Json(LineChangedDto {
        job: job_name(job),
        n: line + 1,
        state: state.into(),
        done: pieces,
        changed: outcome == LineOutcome::Changed,
    }))
}

/// Let the rack leave although lines are left: these lines are short, and the job ends as done.
#[utoipa::path(post, path = "/v1/stations/{id}/release", tag = "floor", operation_id = "releaseRack",
    params(("id" = String, Path, example = "W")), responses(
    (status = 204, description = "The visit has ended, and that is durable"),
    (status = 409, description = "No rack stands there")))]
pub async fn release(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    say(&api, &id, StationOrder::Release).await
}

/// End a pick: the job ends as done, the robot takes its rack away, and lines that are left are confirmed. A pick lasts
/// until this call or until its last line is over; a job's `pick_s` is only how long the pick is planned to take.
#[utoipa::path(post, path = "/v1/stations/{id}/done", tag = "floor", operation_id = "finishPick",
    params(("id" = String, Path, example = "W")), responses(
    (status = 204, description = "The pick has ended, and that is durable"),
    (status = 409, description = "No rack stands there")))]
pub async fn done(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    say(&api, &id, StationOrder::Done).await
}

/// End a pick because goods were missing: the job ends as failed, with that reason, and the robot takes the rack away.
/// Lines that are left are short.
#[utoipa::path(post, path = "/v1/stations/{id}/short", tag = "floor", operation_id = "reportShortPick",
    params(("id" = String, Path, example = "W")), responses(
    (status = 204, description = "The pick has ended, and that is durable"),
    (status = 409, description = "No rack stands there")))]
pub async fn short(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    say(&api, &id, StationOrder::Short).await
}

/// Pause picking at a station: no more racks are fetched for it, and racks in its queue wait.
#[utoipa::path(post, path = "/v1/stations/{id}/pause", tag = "floor", operation_id = "pauseStation",
    params(("id" = String, Path, example = "W")), responses(
    (status = 204, description = "Picking is paused, and that is durable")))]
pub async fn pause(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    say(&api, &id, StationOrder::Pause).await
}

/// Resume picking at a station.
#[utoipa::path(post, path = "/v1/stations/{id}/resume", tag = "floor", operation_id = "resumeStation",
    params(("id" = String, Path, example = "W")), responses(
    (status = 204, description = "Picking goes on, and that is durable")))]
pub async fn resume(Called(api): Called, PathPart(id): PathPart) -> Result<StatusCode, Problem> {
    say(&api, &id, StationOrder::Resume).await
}

async fn say(api: &Api, name: &str, order: StationOrder) -> Result<StatusCode, Problem> {
    let station = parse_station(api, name)?;
    done::done(api, Ask::station(station, order)).await
}
