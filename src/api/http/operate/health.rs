//! `/v1/health` and `/metrics`: whether the server works.
//!
//! Main types: [`Health`], [`Alive`], [`Ready`]. Refuses: to report ok while a critical alarm is active, and to fail
//! because of what an operator ordered.

use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use axum::Json;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use giveway_fleet::RobotState;
use giveway_fleet::alarm::{Alarm, AlarmKind, AlarmScope, AlarmSeverity};
use giveway_floor::text::sentence::requests;
use giveway_floor::time::Span;
use serde::Serialize;
use utoipa::ToSchema;

/// A loop that is stuck for this long does not recover by itself.
const STUCK: Span = Span::from_secs(30);

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
    /// How many robots there are.
    robots: usize,
    /// Seconds since the server started.
    time_s: f64,
}

/// Get whether the server and the floor are healthy: 200, or 503 with every critical alarm that no operator caused.
/// Needs no token.
#[utoipa::path(get, path = "/v1/health", tag = "server", operation_id = "getHealth", responses(
    (status = 200, description = "No critical alarm is active, but for what an operator asked for", body = Health),
    (status = 503, description = "A critical alarm is active, or the server is starting")))]
pub async fn health(Called(api): Called) -> Result<Json<Health>, Problem> {
    let is_bad = |a: &Alarm| a.severity == AlarmSeverity::Critical && a.kind.scope() != AlarmScope::Operator;
    fails_for(&api, is_bad)?;
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

/// The answer while the server starts, when nothing can be stuck yet.
pub async fn alive() -> Json<Alive> {
    Json(Alive { status: "alive", version: env!("CARGO_PKG_VERSION") })
}

/// Get whether the process works: 200 from the moment it listens, even while it starts and whatever alarms are active;
/// 503 only if the control loop has been stuck for 30 s, which a restart ends. Use this for a watchdog that restarts
/// processes. Needs no token.
#[utoipa::path(get, path = "/v1/health/live", tag = "server", operation_id = "getLiveness", responses(
    (status = 200, description = "The process works", body = Alive),
    (status = 503, description = "The control loop is stuck: restart the process")))]
pub async fn live(Called(api): Called) -> Result<Json<Alive>, Problem> {
    let now = (api.now)();
    fails_for(&api, |a| a.kind == AlarmKind::LoopStuck && now - a.since > STUCK)?;
    Ok(alive().await)
}

/// The server accepts requests.
#[derive(Serialize, ToSchema)]
pub struct Ready {
    /// Always "ready".
    #[schema(example = "ready")]
    status: &'static str,
}

/// Get whether the server can promise anything: 200, or 503 while it starts and until each robot has reported or is
/// known to be silent (after three seconds), while the journal accepts no facts, while the database is not in its
/// place, and while the control loop is stuck or the fleet cannot be trusted. An operator's orders (a stop, a pause, an
/// evacuation) and problems with robots or people never make it fail. Use this for a load balancer. Needs no token.
#[utoipa::path(get, path = "/v1/health/ready", tag = "server", operation_id = "getReadiness", responses(
    (status = 200, description = "The server takes requests", body = Ready),
    (status = 503, description = "Nothing can be promised now; the text says why")))]
pub async fn ready(Called(api): Called) -> Result<Json<Ready>, Problem> {
    fails_for(&api, |a| a.kind.ends_readiness())?;
    match api.moment().unheard {
        Some(0) => {}
        Some(n) => {
            return Err(Problem::unavailable(requests::robots_unheard(n), 1));
        }
        None => return Err(Problem::unavailable(requests::no_step_yet(), 1)),
    }
    Ok(Json(Ready { status: "ready" }))
}

/// A problem that lists the active alarms for which `is_so` holds, if there are any.
fn fails_for(api: &Api, is_so: impl Fn(&Alarm) -> bool) -> Result<(), Problem> {
    let alarms = api.alarms.list().into_iter().filter(is_so);
    let errors: Vec<_> = alarms.map(|a| FieldError::new(a.kind.word(), a.text)).collect();
    if errors.is_empty() {
        return Ok(());
    }
    let said: Vec<_> = errors.iter().map(FieldError::sentence).collect();
    Err(Problem { errors: errors.into(), ..Problem::unavailable(requests::alarms_say(said), 2) })
}

/// Get metrics for Prometheus, as OpenMetrics text.
#[utoipa::path(get, path = "/metrics", tag = "server", operation_id = "getMetrics", responses(
    (status = 200, description = "Metrics", body = String,
     content_type = "application/openmetrics-text; version=1.0.0; charset=utf-8")))]
pub async fn metrics(Called(api): Called) -> Response {
    let media = "application/openmetrics-text; version=1.0.0; charset=utf-8";
    api.metrics.note_alarms(&api.alarms.list());
    ([(header::CONTENT_TYPE, media)], api.metrics.text(&api.moment())).into_response()
}
