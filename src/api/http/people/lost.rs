//! `/v1/workers/{id}/clear` and `/narrow`: a supervisor who has looked reports on a lost worker.
//!
//! Main types: [`VouchBody`], [`NarrowBody`]. Refuses: reports without a name.

use crate::http::shared::done::done;
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{JsonBody, PathPart, signed};
use axum::http::StatusCode;
use giveway_fleet::Ask;
use giveway_floor::geometry::{Spot, to_mm};
use giveway_floor::text::SentenceArg;
use giveway_floor::text::sentence::requests;
use serde::Deserialize;
use utoipa::ToSchema;

/// The person who vouches for the report.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct VouchBody {
    /// Your name, 1 to 80 characters. It is kept with your report.
    #[schema(example = "Ben")]
    by: String,
}

/// The place of a lost worker.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NarrowBody {
    /// Your name, 1 to 80 characters. It is kept with your report.
    #[schema(example = "Ben")]
    by: String,
    /// A place near the worker, `[x, y]` in metres in the map's frame; alternatively give `node`.
    #[schema(example = json!([4.0, 7.5]))]
    at: Option<[f64; 2]>,
    /// The name of a node near the worker; alternatively give `at`.
    node: Option<String>,
    /// The worker's greatest distance from that place, metres on foot, 0.5 to 8.
    #[schema(example = 3.0)]
    within_m: f64,
}

/// Confirm that a worker has left the floor, or that nobody is where the worker was lost. Robots drive there again.
/// Poses that were under way do not bring the worker back; later poses do.
#[utoipa::path(post, path = "/v1/workers/{id}/clear", tag = "people", operation_id = "clearWorker",
    params(("id" = String, Path, example = "w1")), request_body = VouchBody, responses(
    (status = 204, description = "Cleared, and that is durable"),
    (status = 422, description = "There is no name")))]
pub async fn clear(
    Called(api): Called,
    PathPart(id): PathPart,
    JsonBody(body): JsonBody<VouchBody>,
) -> Result<StatusCode, Problem> {
    let id = api.feeds.worker(&id)?;
    let by = signed(&body.by).map_err(|e| Problem::invalid(vec![e]))?;
    done(&api, Ask::clear_worker(id, by)).await
}

/// Report roughly where a lost worker is: robots keep out of only that place until the worker is seen again or cleared.
#[utoipa::path(post, path = "/v1/workers/{id}/narrow", tag = "people", operation_id = "narrowWorker",
    params(("id" = String, Path, example = "w1")), request_body = NarrowBody, responses(
    (status = 204, description = "Narrowed, and that is durable"),
    (status = 409, description = "The worker is not lost, or a recording is shown"),
    (status = 422, description = "There is no name, or nobody can stand there")))]
pub async fn narrow(
    Called(api): Called,
    PathPart(id): PathPart,
    JsonBody(body): JsonBody<NarrowBody>,
) -> Result<StatusCode, Problem> {
    let id = api.feeds.worker(&id)?;
    let mut errors = Vec::new();
    let by = signed(&body.by).map_err(|e| errors.push(e)).unwrap_or_default();
    let spot = spot(&api, &body).map_err(|e| errors.push(e)).ok();
    if !(0.5..=8.0).contains(&body.within_m) {
        errors.push(FieldError::new(
            "within_m",
            requests::metres_out_of_range(SentenceArg::rounded(0.5, 1), 8),
        ));
    }
    match spot {
        Some(spot) if errors.is_empty() => {
            done(&api, Ask::narrow_worker(id, (spot, to_mm(body.within_m)), by)).await
        }
        _ => Err(Problem::invalid(errors)),
    }
}

/// The place that a body gives as coordinates or as a node.
fn spot(api: &Api, body: &NarrowBody) -> Result<Spot, FieldError> {
    match (body.at, &body.node) {
        (Some([x, y]), None) if x.is_finite() && y.is_finite() && x.abs() < 1e6 && y.abs() < 1e6 => {
            Ok(Spot { x_mm: to_mm(x), y_mm: to_mm(y) })
        }
        (None, Some(name)) => {
            let node = api.map.node_named(name);
            let at = node.map(|n| api.map.nodes[n].at.into());
            at.ok_or_else(|| FieldError::new("node", requests::node_not_on_map(name)))
        }
        _ => Err(FieldError::new("at", requests::at_or_node())),
    }
}
