//! `/v1/stations/{id}/live` over WebSocket: the feed for a display above the opening of a station.
//!
//! Main function: [`live_station`]. Refuses: to keep anything for a reader; each message is the whole state.

use crate::dto::names::Names;
use crate::http::feeds::floor::{ReadOnly, reader_upgrade};
use crate::http::shared::named::parse_station;
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::Problem;
use crate::wire::extract::PathPart;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::response::Response;
use giveway_floor::id::StationId;
use std::time::Duration;
use tokio::time::Instant;

/// The longest interval between messages, so that a reader knows that the connection works.
const AT_LEAST: Duration = Duration::from_secs(1);

/// Open the feed of one station: JSON texts, each the whole state like `GET /v1/stations/{id}`, once a second and as
/// soon as anything but the time has changed. Offer the protocol `giveway`, and `bearer.TOKEN` if a token is needed.
#[utoipa::path(get, path = "/v1/stations/{id}/live", tag = "floor", operation_id = "openStationFeed",
    params(("id" = String, Path, example = "W")), responses(
    (status = 101, description = "The feed begins"),
    (status = 426, description = "Not a WebSocket"),
    (status = 429, description = "Too many readers")))]
pub async fn live_station(
    Called(api): Called,
    PathPart(id): PathPart,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, Problem> {
    let station = parse_station(&api, &id)?;
    let upgrade = reader_upgrade(&api, upgrade)?;
    Ok(upgrade.on_upgrade(move |socket| async move {
        api.metrics.live_clients.inc();
        serve(&api, socket, station).await;
        api.metrics.live_clients.dec();
    }))
}

async fn serve(api: &Api, socket: WebSocket, station: StationId) {
    let mut newest = api.live.subscribe();
    let mut connection = ReadOnly::new(api, socket);
    let mut sent: Option<(String, Instant)> = None;
    loop {
        let moment = api.moment();
        let mut detail = Names { map: &api.map, view: &moment.view }.station_detail(station);
        let now = std::mem::take(&mut detail.now);
        let text = serde_json::to_string(&detail).expect("plain values are JSON");
        let is_old = |(before, at): &(String, Instant)| *before != text || at.elapsed() >= AT_LEAST;
        if sent.as_ref().is_none_or(is_old) {
            sent = Some((text, Instant::now()));
            detail.now = now;
            let text = serde_json::to_string(&detail).expect("plain values are JSON");
            if !connection.send(Message::Text(text.into())).await {
                return;
            }
        }
        if !connection.wait(&mut newest).await {
            return;
        }
    }
}
