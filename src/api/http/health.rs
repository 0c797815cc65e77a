//! `/v1/health` and `/metrics`: whether the server does its work.
//!
//! Main types: [`Health`], [`Alive`]. Refuses: to say ok while an alarm stands.

use crate::api::Api;
use crate::api::error::{FieldError, Problem};
use crate::fleet::RobotState;
use axum::Json;
use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use utoipa::ToSchema;

/// The server's health.
#[derive(Serialize, ToSchema)]
pub struct Health {
    /// Always "ok": anything else is a problem with status 503.
    #[schema(example = "ok")]
    status: &'static str,
    /// Version of the program.
    version: &'static str,
    /// Name of the map.
    map: String,
    /// How many robots.
    robots: usize,
    /// Seconds since the server started.
    time_s: f64,
}

/// Whether the server works as it should: 200, or 503 with every active alarm. Needs no token.
#[utoipa::path(get, path = "/v1/health", tag = "server", responses(
    (status = 200, description = "All is well", body = Health),
    (status = 503, description = "An alarm is active, or the server is starting", body = Problem,
     content_type = "application/problem+json")))]
pub async fn health(State(api): State<Api>) -> Result<Json<Health>, Problem> {
    let alarms = api.alarms.list();
    if !alarms.is_empty() {
        let errors: Vec<_> = alarms.into_iter().map(|a| FieldError::new(a.id, a.text)).collect();
        let text: Vec<_> = errors.iter().map(|e| e.detail.as_str()).collect();
        return Err(Problem { errors: errors.clone(), ..Problem::unavailable(text.join("; "), 2) });
    }
    let moment = api.moment();
    Ok(Json(Health {
        status: "ok",
        version: env!("CARGO_PKG_VERSION"),
        map: api.map.name.clone(),
        robots: moment.view.robots.iter().filter(|r| r.state != RobotState::Gone).count(),
        time_s: moment.time_s,
    }))
}

/// The process is alive.
#[derive(Serialize, ToSchema)]
pub struct Alive {
    /// Always "alive".
    #[schema(example = "alive")]
    status: &'static str,
    /// Version of the program.
    version: &'static str,
}

/// Whether the process is alive: 200 from the moment it listens, even while it starts and while an alarm is active. A
/// watchdog may restart a process that does not answer this; 503 from `/v1/health` is no reason to. Needs no token.
#[utoipa::path(get, path = "/v1/health/live", tag = "server", responses(
    (status = 200, description = "The process is alive", body = Alive)))]
pub async fn alive() -> Json<Alive> {
    Json(Alive { status: "alive", version: env!("CARGO_PKG_VERSION") })
}

/// Metrics for Prometheus, as OpenMetrics text.
#[utoipa::path(get, path = "/metrics", tag = "server", responses(
    (status = 200, description = "Metrics", body = String,
     content_type = "application/openmetrics-text; version=1.0.0; charset=utf-8")))]
pub async fn metrics(State(api): State<Api>) -> Response {
    let media = "application/openmetrics-text; version=1.0.0; charset=utf-8";
    ([(header::CONTENT_TYPE, media)], api.metrics.text(&api.moment())).into_response()
}
