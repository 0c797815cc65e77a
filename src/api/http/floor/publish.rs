//! `/v1/map:check` and `PUT /v1/map`: publish a map to the server while it runs.
//!
//! Main types: [`MapCheckDto`], [`PublishedMapDto`]. The publisher names the version of the map on which the changes
//! are based, so that two editors do not overwrite one another. Refuses: to publish what would lose something on the
//! floor, unless the publisher accepts that.

use super::map::MapAnswer;
use super::maps::{LIMIT, MOST, MapBody, MapFile, MapReviewDto};
use crate::state::called::Called;
use crate::state::publish::{MapOrder, MapOrigin, MapOutlook, MapRefusal, MapRequest};
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{JsonBody, Params};
use crate::wire::text::{round3, time_text};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use giveway_fleet::carry::{Report, ReportEntry};
use giveway_floor::geometry::Point;
use giveway_floor::text::sentence::requests;
use giveway_floor::warehouse::{Difference, Severity};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use utoipa::{IntoParams, ToSchema};

/// The most names listed for a change.
const NAMED: usize = 20;

/// The publication from which the map in operation comes.
#[derive(Debug, Serialize, ToSchema)]
struct MapOriginDto {
    /// The number of the published map, counted from 1.
    number: u32,
    /// When the map was published, RFC 3339.
    #[schema(format = DateTime)]
    at: String,
    /// The publisher.
    by: String,
}

/// Things of one sort that differ in the same way.
#[derive(Debug, Serialize, ToSchema)]
struct MapChangeDto {
    /// The sort of thing.
    #[schema(example = "stations")]
    what: &'static str,
    /// The difference: added, removed, moved or changed.
    #[schema(example = "added")]
    how: &'static str,
    /// How many things differ.
    count: usize,
    /// The names of the first 20.
    names: Vec<String>,
    /// Places of these things, `[x, y]` each, metres: on the new map, or on the old one if they were removed; 500 at
    /// most.
    at: Vec<[f64; 2]>,
}

/// Something on the floor that cannot be carried over to the new map, or only with a loss.
#[derive(Debug, Serialize, ToSchema)]
struct CarryFindingDto {
    /// The thing and its place.
    #[schema(example = "robot-1 stands on R32, which the new map does not have")]
    text: String,
    /// How to solve the problem.
    remedy: String,
    /// The place on the map in operation, metres; empty if the problem has no place.
    at: Vec<[f64; 2]>,
}

/// What publishing a map would mean at present.
#[derive(Debug, Serialize, ToSchema)]
pub struct MapCheckDto {
    /// The version of the map in operation, for `If-Match`.
    version: String,
    /// The publication of the map in operation; null if the server was started with it as a file.
    published: Option<MapOriginDto>,
    /// Whether the server would switch to the map: there are no errors and no obstacles.
    good: bool,
    /// The findings about the map itself.
    review: MapReviewDto,
    /// The differences from the map in operation.
    changes: Vec<MapChangeDto>,
    /// Obstacles: the map cannot be published until they are removed from the floor or the map.
    obstacles: Vec<CarryFindingDto>,
    /// Losses: with these, the map can be published only with `accept_losses=true`.
    losses: Vec<CarryFindingDto>,
    /// Other effects on the floor.
    notes: Vec<String>,
}

/// The map to which the server has switched.
#[derive(Debug, Serialize, ToSchema)]
pub struct PublishedMapDto {
    /// The map's version; also its ETag.
    version: String,
    /// The publication of this map; null if it equals the map that was in operation and nothing was done.
    published: Option<MapOriginDto>,
    /// What was lost, as accepted.
    losses: Vec<CarryFindingDto>,
    /// Other effects on the floor.
    notes: Vec<String>,
}

/// Parameters of publishing.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct PublishParams {
    /// Whether to accept the loss of jobs, assignments and closures for which the new map has no place.
    accept_losses: Option<bool>,
}

impl From<&MapOrigin> for MapOriginDto {
    fn from(origin: &MapOrigin) -> MapOriginDto {
        MapOriginDto { number: origin.number, at: time_text(origin.at), by: origin.by.clone() }
    }
}

impl From<&Difference> for MapChangeDto {
    fn from(found: &Difference) -> MapChangeDto {
        MapChangeDto {
            what: found.what,
            how: found.how.word(),
            count: found.things.len(),
            names: found.things.iter().take(NAMED).map(|(name, _)| name.clone()).collect(),
            at: found.things.iter().take(MOST).map(|(_, at)| pair(*at)).collect(),
        }
    }
}

impl From<&ReportEntry> for CarryFindingDto {
    fn from(entry: &ReportEntry) -> CarryFindingDto {
        let at = entry.at.map(|spot| pair(spot.into()));
        CarryFindingDto {
            text: entry.what.clone(),
            remedy: entry.remedy.clone(),
            at: at.into_iter().collect(),
        }
    }
}

fn pair(at: Point) -> [f64; 2] {
    [round3(at.x), round3(at.y)]
}

fn entries(list: &[ReportEntry]) -> Vec<CarryFindingDto> {
    list.iter().take(MOST).map(CarryFindingDto::from).collect()
}

/// Check what publishing a map would change: the differences from the map in operation, what on the floor and in the
/// database cannot be carried over, and what is wrong with the map itself. Nothing is changed.
#[utoipa::path(post, path = "/v1/map:check", tag = "floor", operation_id = "checkMapChange", request_body = MapFile,
    responses(
    (status = 200, description = "What it would mean now", body = MapCheckDto),
    (status = 413, description = "The map is longer than 8 MiB")))]
pub async fn check(
    Called(api): Called,
    Extension(answer): Extension<Arc<MapAnswer>>,
    MapBody(draft): MapBody,
) -> Result<Json<MapCheckDto>, Problem> {
    let outlook = api.maps.ask(|reply| MapRequest::Check(Box::new(draft), reply)).await?;
    let MapOutlook { review, differences, report } = outlook.map_err(|why| refused(&why))?;
    Ok(Json(MapCheckDto {
        version: answer.version.clone(),
        published: api.maps.origin.as_ref().map(MapOriginDto::from),
        good: review.is_good() && report.obstacles.is_empty(),
        review: MapReviewDto::from(&review),
        changes: differences.iter().map(MapChangeDto::from).collect(),
        obstacles: entries(&report.obstacles),
        losses: entries(&report.losses),
        notes: report.notes,
    }))
}

/// Publish a map: the server switches to it while it runs. Robots drive to the end of their grants and stop, the
/// database is backed up and carried over in one transaction, and the floor goes on with the new map; feeds end and
/// clients must reconnect. That takes some seconds. `If-Match` names the version on which the map is based, as the
/// `ETag` of `GET /v1/map` does, so that two editors do not overwrite one another. The next start of the server uses
/// the published map, too.
#[utoipa::path(put, path = "/v1/map", tag = "floor", operation_id = "publishMap", request_body = MapFile,
    params(PublishParams, ("If-Match" = Option<String>, Header,
        description = "The version on which the map is based, in quotes; `*` for any. Without it the answer is 428")),
    responses(
    (status = 200, description = "The server has gone over to it, and that is durable", body = PublishedMapDto),
    (status = 409, description = "The map has errors, or not everything can be carried over: `errors` lists what"),
    (status = 412, description = "The map in operation is another one than that in If-Match"),
    (status = 413, description = "The map is longer than 8 MiB"),
    (status = 428, description = "If-Match is missing")))]
pub async fn publish(
    Called(api): Called,
    Extension(answer): Extension<Arc<MapAnswer>>,
    Params(p): Params<PublishParams>,
    headers: HeaderMap,
    JsonBody(MapFile(map)): JsonBody<MapFile, LIMIT>,
) -> Result<Response, Problem> {
    is_based_on(&headers, &answer.version)?;
    let by = api.entry.clone().ok_or_else(Problem::internal)?;
    let order = MapOrder { map, accept_losses: p.accept_losses == Some(true), by };
    let done = api.maps.ask(|reply| MapRequest::Publish(Box::new(order), reply)).await?;
    let done = done.map_err(|why| refused(&why))?;
    let etag = format!("\"{}\"", done.version);
    let body = PublishedMapDto {
        version: done.version,
        published: done.origin.as_ref().map(MapOriginDto::from),
        losses: entries(&done.report.losses),
        notes: done.report.notes,
    };
    Ok(([(header::ETAG, etag)], Json(body)).into_response())
}

/// Checks that the request is based on this version.
fn is_based_on(headers: &HeaderMap, version: &str) -> Result<(), Problem> {
    let Some(named) = headers.get(header::IF_MATCH) else {
        let detail = format!(
            "say with If-Match on which version the map is based, as the ETag of GET /v1/map names it: now \
             \"{version}\""
        );
        let (status, detail) = (StatusCode::PRECONDITION_REQUIRED, requests::malformed(detail));
        return Err(Problem::new(status, "if-match", "If-Match is missing", detail));
    };
    let named = named.to_str().unwrap_or("");
    let known = |tag: &str| tag == "*" || tag.trim_start_matches("W/").trim_matches('"') == version;
    if named.split(',').map(str::trim).any(known) {
        return Ok(());
    }
    let detail = requests::map_of_other_version(named, version);
    let status = StatusCode::PRECONDITION_FAILED;
    Err(Problem::new(status, "other-version", "The map was changed meanwhile", detail))
}

fn refused(why: &MapRefusal) -> Problem {
    match why {
        MapRefusal::Failed(why) => Problem::unavailable(requests::unavailable(why), 10),
        MapRefusal::Outlook(outlook) => {
            let errors = reasons(outlook);
            let reasons: Vec<_> = errors.iter().map(FieldError::sentence).collect();
            let detail = requests::map_not_published(reasons);
            let problem = Problem::conflict("map-refused", "The map is not published", detail);
            Problem { errors: errors.into(), ..problem }
        }
    }
}

/// Why a map is refused: its own errors, obstacles, and losses on the floor.
fn reasons(outlook: &MapOutlook) -> Vec<FieldError> {
    let errors = outlook
        .review
        .of(Severity::Error)
        .map(|r| FieldError::new("error", requests::malformed(r.to_string())));
    let Report { obstacles, losses, .. } = &outlook.report;
    let of = |field: &'static str| {
        move |e: &ReportEntry| FieldError::new(field, requests::malformed(e.to_string()))
    };
    errors
        .chain(obstacles.iter().map(of("obstacle")))
        .chain(losses.iter().map(of("loss")))
        .take(MOST)
        .collect()
}
