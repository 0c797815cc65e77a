//! `/v1/workers/{id}/position` and `/v1/positions`: positions of workers, as tags report them.
//!
//! Main types: [`NewPosition`], [`NewPositions`]. A position is an observation: it is accepted or refused, and not
//! stored. Refuses: impossible times.

use crate::feed::hub::Untaken;
use crate::feed::massrobotics::USUAL_ACCURACY_M;
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{JsonBody, PathPart, no_time};
use crate::wire::text::{parse_time, worker_name};
use axum::Json;
use axum::http::StatusCode;
use giveway_floor::geometry::{FARTHEST_M, Point};
use giveway_floor::id::WorkerId;
use giveway_floor::text::sentence::requests;
use giveway_floor::text::{Sentence, SentenceArg};
use giveway_floor::time::{Span, Time};
use giveway_people::human::{Quality, Sighting, SourceId};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The most positions in one request.
const MOST: usize = 500;

/// How far ahead the clock of a tag may be; the fleet accepts no more.
const AHEAD: Span = Span::from_millis(150);

/// Positions older than this are useless.
const OLDEST: Span = Span::from_secs(10);

/// The position of a worker, in the map's frame.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewPosition {
    /// Position x, metres.
    x: f64,
    /// Position y, metres.
    y: f64,
    /// When the worker was seen there, RFC 3339; now if absent.
    at: Option<String>,
    /// One standard deviation of the position, metres; 0.3 if absent.
    #[schema(minimum = 0, maximum = 100)]
    accuracy_m: Option<f64>,
    /// Where the worker faces, radians, counter-clockwise from the x axis; absent if the tag does not know.
    heading: Option<f64>,
}

/// The positions of many workers.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewPositions {
    /// The positions, at most 500.
    positions: Vec<WorkerPosition>,
}

/// The position of one of many workers.
#[derive(Clone, Debug, Deserialize, ToSchema)]
pub struct WorkerPosition {
    /// The worker.
    #[schema(example = "w1")]
    worker: String,
    /// The worker's position.
    #[serde(flatten)]
    position: NewPosition,
}

/// The result of reporting many positions.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct TakenDto {
    /// How many positions were accepted.
    taken: usize,
    /// The positions that were refused, and why.
    refused: Vec<FieldError>,
}

/// Report a worker's position.
#[utoipa::path(post, path = "/v1/workers/{id}/position", tag = "people",
    operation_id = "reportPosition", request_body = NewPosition,
    params(("id" = String, Path, example = "w1")), responses(
    (status = 202, description = "Accepted; the fleet evaluates it in its next step")))]
pub async fn one(
    Called(api): Called,
    PathPart(id): PathPart,
    JsonBody(new): JsonBody<NewPosition>,
) -> Result<StatusCode, Problem> {
    let worker = api.feeds.worker(&id)?;
    let now = (api.now)();
    let sighting = new.read(worker, now).map_err(|e| Problem::invalid(vec![e]))?;
    report(&api, sighting, now)?;
    Ok(StatusCode::ACCEPTED)
}

/// Report the positions of many workers. If one position is wrong, the others are still accepted.
#[utoipa::path(post, path = "/v1/positions", tag = "people",
    operation_id = "reportPositions", request_body = NewPositions, responses(
    (status = 200, description = "How many were accepted, and why others were not", body = TakenDto)))]
pub async fn many(
    Called(api): Called,
    JsonBody(new): JsonBody<NewPositions>,
) -> Result<Json<TakenDto>, Problem> {
    if new.positions.len() > MOST {
        let detail = requests::at_most_allowed(MOST);
        return Err(Problem::invalid(vec![FieldError::new("positions", detail)]));
    }
    let now = (api.now)();
    let take = |p: &WorkerPosition| -> Result<(), Sentence> {
        let worker = api.feeds.worker(&p.worker).map_err(|problem| problem.sentence())?;
        let wrong = |e: FieldError| requests::field_is_wrong(&e.field, e.sentence());
        let sighting = p.position.read(worker, now).map_err(wrong)?;
        report(&api, sighting, now).map_err(|problem| problem.sentence())
    };
    let results = new.positions.iter().map(take).enumerate();
    let refused: Vec<_> = results
        .filter_map(|(i, result)| Some(FieldError::new(format!("positions[{i}]"), result.err()?)))
        .collect();
    Ok(Json(TakenDto { taken: new.positions.len() - refused.len(), refused }))
}

/// Passes a report on to the fleet.
pub fn report(api: &Api, sighting: Sighting, now: Time) -> Result<(), Problem> {
    api.queue()?;
    let worker = worker_name(sighting.worker);
    api.feeds.report(sighting, now).map_err(|why| match why {
        Untaken::Unknown => Problem::unknown("worker", requests::does_not_exist(worker)),
        Untaken::Full => {
            api.metrics.refused("full");
            Problem::unavailable(requests::too_many_positions(), 1)
        }
    })
}

/// A time by a clock other than the server's; refused if it is impossible.
pub fn checked_time(seen: Time, now: Time) -> Result<Time, Sentence> {
    if seen > now + AHEAD {
        let ahead = SentenceArg::rounded((seen - now).as_secs_f64(), 1);
        return Err(requests::time_in_future(ahead));
    }
    if now - seen > OLDEST {
        let behind = SentenceArg::rounded((now - seen).as_secs_f64(), 0);
        return Err(requests::time_too_old(behind));
    }
    Ok(seen)
}

impl NewPosition {
    fn read(&self, worker: WorkerId, now: Time) -> Result<Sighting, FieldError> {
        let wrong = |field: &str, detail: Sentence| Err(FieldError::new(field, detail));
        if !(self.x.abs() <= FARTHEST_M && self.y.abs() <= FARTHEST_M) {
            return wrong("x", requests::metres_on_the_map(FARTHEST_M as i64));
        }
        let accuracy_m = self.accuracy_m.unwrap_or(USUAL_ACCURACY_M);
        if !(0.0..=100.0).contains(&accuracy_m) {
            return wrong("accuracy_m", requests::metres_out_of_range(0, 100));
        }
        if self.heading.is_some_and(|h| h.abs() > 100.0) {
            return wrong("heading", requests::malformed("must be in radians"));
        }
        let seen = match self.at.as_deref() {
            None => now,
            Some(text) => match parse_time(text).map(|t| checked_time(t, now)) {
                None => return wrong("at", no_time(text)),
                Some(Err(detail)) => return wrong("at", detail),
                Some(Ok(seen)) => seen,
            },
        };
        let (at, heading, quality) = (Point::new(self.x, self.y), self.heading, Quality::Tracked);
        let (source, epoch, at_marks, seq) = (SourceId::Tag, 0, false, 0);
        Ok(Sighting {
            worker,
            source,
            seen,
            epoch,
            at_marks,
            seq,
            at,
            mirror: None,
            heading,
            accuracy_m,
            quality,
        })
    }
}
