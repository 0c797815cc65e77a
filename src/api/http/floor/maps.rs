//! `/v1/maps:check` and `/v1/maps:try`: check and try out maps while they are being drawn, before anything is built;
//! `/v1/map:file`: the server's own map as a file, to start from.
//!
//! Main types: [`MapFile`], [`MapReviewDto`], [`TrialDto`]. Refuses: to change the map of the server.

use super::map::MapAnswer;
use crate::port::trial::{NoTrial, TrialFigures, TrialOrder};
use crate::state::api::Api;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{JsonBody, json_text, not_as_wanted};
use crate::wire::text::round3;
use axum::extract::{FromRequest, Request, State};
use axum::http::{HeaderValue, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use giveway_floor::geometry::Point;
use giveway_floor::text::SentenceArg;
use giveway_floor::text::sentence::requests;
use giveway_floor::time::Span;
use giveway_floor::warehouse::{Draft, Remark, Review, Severity, Warehouse, formats, review, room_for};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::time::Duration;
use utoipa::ToSchema;

/// The largest map file, in bytes: ten times the size of the largest hall that ships.
pub(super) const LIMIT: usize = 8 * 1024 * 1024;
/// The most findings in an answer, and the most points in a finding.
pub(super) const MOST: usize = 500;
/// The most robots of a trial.
const MOST_ROBOTS: usize = 200;
/// The longest trial, minutes of simulated time.
const MOST_MINUTES: f64 = 120.0;
/// How long a trial may take in real time.
const PATIENCE: Duration = Duration::from_secs(25);

/// A map as in map files: an object with `giveway_map`, `name`, `footprint_m`, `nodes`, `lanes` and more.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(transparent)]
#[schema(value_type = Object, example = json!({"giveway_map": 1, "name": "small", "footprint_m": 0.9,
    "nodes": [{"id": "a", "x": 0, "y": 0}, {"id": "p", "x": 1, "y": 0}],
    "lanes": [{"from": "a", "to": "p", "both": true}], "parking": ["p"]}))]
pub struct MapFile(pub(super) Draft);

/// A request body that is a map. A file in another system's layout gets an error that names that system.
pub struct MapBody(pub(super) Draft);

impl<S: Send + Sync> FromRequest<S> for MapBody {
    type Rejection = Problem;

    async fn from_request(request: Request, _: &S) -> Result<Self, Problem> {
        let text = json_text(request, LIMIT).await?;
        serde_json::from_slice(&text).map(|MapFile(draft)| MapBody(draft)).map_err(|e| {
            let others = std::str::from_utf8(&text).ok().and_then(formats::of_others);
            let named =
                others.map(|why| Problem::invalid(vec![FieldError::new("body", requests::malformed(why))]));
            named.unwrap_or_else(|| not_as_wanted(&e))
        })
    }
}

/// The severity of a finding.
#[derive(Clone, Copy, Debug, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum MapSeverity {
    /// The map is refused.
    Error,
    /// The map can be used, but should be looked at again.
    Warning,
}

/// A finding about a map.
#[derive(Debug, Serialize, ToSchema)]
struct MapRemarkDto {
    severity: MapSeverity,
    /// The place in the map, in words.
    #[schema(example = "station W")]
    place: String,
    /// What is wrong, or looks like a mistake.
    text: String,
    /// How to correct it.
    remedy: String,
    /// Names of the nodes concerned; some may not exist.
    nodes: Vec<String>,
    /// Places on the floor, `[x, y]` each, metres; empty if the finding concerns no place.
    at: Vec<[f64; 2]>,
}

/// The findings of a map check.
#[derive(Debug, Serialize, ToSchema)]
pub struct MapReviewDto {
    /// Whether the map can be used, that is, has no errors.
    good: bool,
    /// How many errors there are.
    errors: usize,
    /// How many warnings there are.
    warnings: usize,
    /// The findings, errors first; 500 at most.
    findings: Vec<MapRemarkDto>,
}

impl From<&Remark> for MapRemarkDto {
    fn from(remark: &Remark) -> MapRemarkDto {
        let finding = remark.finding.clone();
        let mut nodes = finding.nodes;
        nodes.truncate(MOST);
        MapRemarkDto {
            severity: match remark.severity {
                Severity::Error => MapSeverity::Error,
                Severity::Warning => MapSeverity::Warning,
            },
            place: finding.place,
            text: finding.problem,
            remedy: finding.remedy,
            nodes,
            at: remark.at.iter().take(MOST).map(|p: &Point| [round3(p.x), round3(p.y)]).collect(),
        }
    }
}

impl From<&Review> for MapReviewDto {
    fn from(review: &Review) -> MapReviewDto {
        let all = || review.remarks.iter().chain(&review.dead_ends);
        let errors = review.of(Severity::Error).count();
        MapReviewDto {
            good: review.is_good(),
            errors,
            warnings: all().count() - errors,
            findings: all().take(MOST).map(MapRemarkDto::from).collect(),
        }
    }
}

/// Get the server's map as a map file, with everything that a map file can contain. The `ETag` is the map's version, as
/// in `GET /v1/map`.
#[utoipa::path(get, path = "/v1/map:file", tag = "floor", operation_id = "getMapFile", responses(
    (status = 200, description = "The map file", body = MapFile)))]
pub async fn file(State(api): State<Api>, Extension(answer): Extension<Arc<MapAnswer>>) -> Response {
    let media = (header::CONTENT_TYPE, HeaderValue::from_static("application/json"));
    ([media, (header::ETAG, answer.etag.clone())], formats::json::write(&api.map)).into_response()
}

/// Check a map: everything that is wrong with it or looks like a mistake, each with its place and remedy. The server's
/// map stays as it is. A text that is no map file is refused with line and column.
#[utoipa::path(post, path = "/v1/maps:check", tag = "floor", operation_id = "checkMap", request_body = MapFile,
    responses(
    (status = 200, description = "What there is to say about it", body = MapReviewDto),
    (status = 413, description = "The map is longer than 8 MiB")))]
pub async fn check(MapBody(draft): MapBody) -> Result<Json<MapReviewDto>, Problem> {
    let review = tokio::task::spawn_blocking(move || MapReviewDto::from(&review(&draft)));
    review.await.map(Json).map_err(|_| Problem::internal())
}

/// The parameters of a trial.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewTrial {
    /// The map to try.
    map: MapFile,
    /// How many robots drive in the trial.
    #[schema(minimum = 1, maximum = 200, example = 4)]
    robots: usize,
    /// How many jobs per hour arrive, at random times; if absent, as many as the robots can do.
    #[schema(minimum = 1, maximum = 100_000)]
    jobs_per_hour: Option<f64>,
    /// How long the trial lasts, minutes of simulated time; 30 if absent.
    #[schema(minimum = 1, maximum = 120, example = 30)]
    minutes: Option<f64>,
    /// Seed of the simulation; the same seed gives the same run; 1 if absent.
    seed: Option<u32>,
}

/// A place where robots waited.
#[derive(Debug, Serialize, ToSchema)]
struct TrialWaitDto {
    /// The node.
    node: String,
    /// The node's x, metres.
    x: f64,
    /// The node's y, metres.
    y: f64,
    /// Seconds that robots waited there, summed over all robots.
    seconds: f64,
}

/// The result of a trial.
#[derive(Debug, Serialize, ToSchema)]
pub struct TrialDto {
    /// How many robots drove.
    robots: usize,
    /// The simulated time, seconds.
    simulated_s: f64,
    /// Whether the whole requested time was simulated; a trial ends after 25 real seconds, with the result so far.
    complete: bool,
    /// How long the trial took in real time, seconds.
    took_s: f64,
    /// Racks that robots brought to stations.
    deliveries: u64,
    /// Racks that robots brought to stations, per simulated hour.
    deliveries_per_hour: f64,
    /// Mean seconds from when a robot got a job until the job was done; null if no job was done.
    mean_job_s: Option<f64>,
    /// Places where robots waited for each other, for queues and for routes; the longest first, 500 at most.
    waited: Vec<TrialWaitDto>,
    /// Seconds that robots waited, summed over all robots.
    waited_s: f64,
    /// How often a law of the floor was broken: two robots at one place, or a robot that never makes progress.
    law_violations: u64,
    /// The first violations, in words.
    broken: Vec<String>,
}

/// Try out a map: simulate half an hour (or `minutes`) with a number of robots, in seconds of real time. The server's
/// own floor is not touched. One trial runs at a time.
#[utoipa::path(post, path = "/v1/maps:try", tag = "floor", operation_id = "tryMap", request_body = NewTrial,
    responses(
    (status = 200, description = "What came out", body = TrialDto),
    (status = 413, description = "The map is longer than 8 MiB"),
    (status = 429, description = "Another trial runs")))]
pub async fn trial(
    State(api): State<Api>,
    JsonBody(new): JsonBody<NewTrial, LIMIT>,
) -> Result<Json<TrialDto>, Problem> {
    let order = tokio::task::spawn_blocking(move || read(new)).await.map_err(|_| Problem::internal())??;
    let figures = api.trials.run(order.clone()).await.map_err(refused)?;
    Ok(Json(told(&order, &figures)))
}

/// An error whose text the map editor shows unchanged: findings of checks, and limits of trials.
fn wrong(field: &str, detail: impl Into<SentenceArg>) -> FieldError {
    FieldError::new(field, requests::malformed(detail))
}

fn read(new: NewTrial) -> Result<TrialOrder, Problem> {
    let mut errors = Vec::new();
    if !(1..=MOST_ROBOTS).contains(&new.robots) {
        errors.push(wrong("robots", format!("from 1 to {MOST_ROBOTS}")));
    }
    if new.jobs_per_hour.is_some_and(|n| !(1.0..=100_000.0).contains(&n)) {
        errors.push(wrong("jobs_per_hour", "from 1 to 100000, or left out"));
    }
    let minutes = new.minutes.unwrap_or(30.0);
    if !(1.0..=MOST_MINUTES).contains(&minutes) {
        errors.push(wrong("minutes", format!("from 1 to {MOST_MINUTES}")));
    }
    let map = match new.map.0.build() {
        Ok(map) => Some(map),
        Err(findings) => {
            errors.extend(findings.0.iter().take(20).map(|f| wrong("map", f.to_string())));
            None
        }
    };
    errors.extend(map.as_ref().and_then(|map| nothing_to_try(map, new.robots)));
    let Some(map) = map.filter(|_| errors.is_empty()) else { return Err(Problem::invalid(errors)) };
    Ok(TrialOrder {
        map: Arc::new(map),
        robots: new.robots,
        jobs_per_hour: new.jobs_per_hour,
        span: Span::from_secs_f64(minutes * 60.0),
        seed: new.seed.unwrap_or(1).into(),
        patience: PATIENCE,
    })
}

fn nothing_to_try(map: &Warehouse, robots: usize) -> Option<FieldError> {
    if map.stations.is_empty() || map.racks.is_empty() {
        return Some(wrong("map", "nothing can be delivered: there must be a station and a rack"));
    }
    room_for(map, robots).err().map(|findings| wrong("robots", findings.to_string()))
}

fn refused(why: NoTrial) -> Problem {
    match why {
        NoTrial::Busy => Problem::too_many(requests::trial_busy(), 5),
        NoTrial::Nowhere => Problem::unavailable(requests::no_trials(), 60),
        NoTrial::Unfit(why) => Problem::invalid(vec![wrong("map", why)]),
        NoTrial::Broken => Problem::internal(),
    }
}

fn told(order: &TrialOrder, figures: &TrialFigures) -> TrialDto {
    let simulated_s = figures.simulated.as_secs_f64();
    let mut places = figures.waited.clone();
    places.sort_by_key(|(node, span)| (std::cmp::Reverse(*span), *node));
    let place = |(node, span): &(_, Span)| {
        let node = &order.map.nodes[*node];
        let (x, y) = (round3(node.at.x), round3(node.at.y));
        TrialWaitDto { node: node.name.clone(), x, y, seconds: round3(span.as_secs_f64()) }
    };
    TrialDto {
        robots: order.robots,
        simulated_s: round3(simulated_s),
        complete: figures.simulated >= order.span,
        took_s: round3(figures.took.as_secs_f64()),
        deliveries: figures.deliveries,
        deliveries_per_hour: round3(figures.deliveries as f64 * 3600.0 / simulated_s.max(1.0)),
        mean_job_s: figures.mean_job.map(|s| round3(s.as_secs_f64())),
        waited: places.iter().take(MOST).map(place).collect(),
        waited_s: round3(places.iter().map(|(_, span)| span.as_secs_f64()).sum()),
        law_violations: figures.law_violations,
        broken: figures.broken.clone(),
    }
}
