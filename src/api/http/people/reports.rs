//! `/v1/massrobotics`: reports of the MassRobotics standard, over HTTP and over a WebSocket, which devices that follow
//! the standard use.
//!
//! Main functions: [`post`], [`stream`]. Refuses: to answer valid reports, since the standard has no answers.

use super::positions::{checked_time, report};
use crate::feed::massrobotics::{InteropReport, Unfit};
use crate::feed::warn::Warnings;
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::JsonBody;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::http::StatusCode;
use axum::response::Response;
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::{feed, requests};
use std::pin::pin;
use std::time::Duration;
use tokio::time::timeout;

/// The longest report, in bytes.
const MESSAGE: usize = 64 * 1024;

/// A device that is silent for this long is gone.
const SILENT: Duration = Duration::from_secs(120);

/// How long sending an answer may take.
const SEND: Duration = Duration::from_secs(2);

/// Send an identityReport or a statusReport. Only uuids of workers are accepted: register the worker with the uuid as
/// its name, or list the uuid in the settings.
#[utoipa::path(post, path = "/v1/massrobotics", tag = "people",
    operation_id = "postInteropReport", request_body = InteropReport, responses(
    (status = 202, description = "Accepted; the fleet evaluates it in its next step"),
    (status = 404, description = "No worker is known under this uuid")))]
pub async fn post(
    Called(api): Called,
    JsonBody(said): JsonBody<InteropReport>,
) -> Result<StatusCode, Problem> {
    take(&api, &said)?;
    Ok(StatusCode::ACCEPTED)
}

/// Send these reports as texts of a WebSocket, one after the other. A refused report is answered with the problem, each
/// kind at most every two seconds.
#[utoipa::path(get, path = "/v1/massrobotics", tag = "people", operation_id = "streamInteropReports", responses(
    (status = 101, description = "Reports may be sent"),
    (status = 426, description = "Not a WebSocket")))]
pub async fn stream(
    Called(api): Called,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, Problem> {
    let upgrade = upgrade.map_err(|e| {
        let detail = format!("this is a WebSocket: connect, or POST a report ({})", e.body_text());
        let detail = requests::malformed(detail);
        Problem::new(StatusCode::UPGRADE_REQUIRED, "websocket", "A WebSocket is needed", detail)
    })?;
    let upgrade = upgrade.protocols(["giveway"]).max_message_size(MESSAGE);
    Ok(upgrade.on_upgrade(move |socket| async move { serve(&api, socket).await }))
}

async fn serve(api: &Api, mut socket: WebSocket) {
    let mut closing = api.closing.clone();
    let mut warnings = Warnings::default();
    let mut ended = pin!(api.gate.ended(&api.caller, &api.now));
    loop {
        let message = tokio::select! {
            message = timeout(SILENT, socket.recv()) => message,
            () = &mut ended => return,
            () = async { _ = closing.wait_for(|closing| *closing).await.is_ok() } => return,
        };
        let text = match message {
            Ok(Some(Ok(Message::Text(text)))) => text,
            Ok(Some(Ok(Message::Ping(_) | Message::Pong(_) | Message::Binary(_)))) => continue,
            _ => return,
        };
        let report = serde_json::from_str::<InteropReport>(&text);
        let report = report.map_err(|e| Problem::malformed(format!("not a report: {e}")));
        let Err(problem) = report.and_then(|report| take(api, &report)) else { continue };
        let told = warnings.note(kind_of(problem.status), 1, (api.now)()).is_some();
        let text = serde_json::to_string(&problem.at("/v1/massrobotics")).expect("problems are plain");
        if told && !matches!(timeout(SEND, socket.send(Message::Text(text.into()))).await, Ok(Ok(()))) {
            return;
        }
    }
}

fn kind_of(status: u16) -> &'static str {
    match status {
        400 => "malformed",
        404 => "unknown",
        422 => "invalid",
        _ => "unavailable",
    }
}

fn take(api: &Api, said: &InteropReport) -> Result<(), Problem> {
    let name = api.interop.worker(&said.uuid).unwrap_or(&said.uuid);
    let named = |name: &str| {
        let pseudonym = api.pseudonyms.pseudonym_of(name);
        api.feeds.named(pseudonym.as_deref().unwrap_or(name))
    };
    let worker = named(name).or_else(|| named(&name.to_lowercase()));
    let worker = worker.ok_or_else(|| {
        api.metrics.refused("unknown-uuid");
        Problem::unknown("worker", unfit(&Unfit::UnknownUuid(said.uuid.clone())))
    })?;
    let wrong = |e: Unfit| Problem::invalid(vec![FieldError::new("report", unfit(&e))]);
    let Some(sighting) = api.interop.sighting(worker, said).map_err(wrong)? else { return Ok(()) };
    let now = (api.now)();
    let wrong = |detail| Problem::invalid(vec![FieldError::new("timestamp", detail)]);
    checked_time(sighting.seen, now).map_err(wrong)?;
    report(api, sighting, now)
}

/// Why a report is refused. All reasons except an unknown device are for developers.
fn unfit(why: &Unfit) -> Sentence {
    match why {
        Unfit::UnknownUuid(uuid) => feed::no_worker_for_uuid(uuid),
        Unfit::UnknownDatum(_) | Unfit::Time(_) | Unfit::Neither | Unfit::Absurd => {
            requests::malformed(why.to_string())
        }
    }
}
