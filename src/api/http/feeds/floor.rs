//! `/v1/live` over WebSocket: sends each reader what it lacks, pings it, and closes connections that do not answer.
//!
//! Main function: [`live`]. Refuses: to buffer for a reader, and to read more than necessary.

use crate::access::auth::TOKEN_ENDED;
use crate::dto::people::SensesDto;
use crate::feed::hub::CarriedSenses;
use crate::live::{FeedReader, LAGGING, PatchFormat, SnapshotFormat};
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::Problem;
use crate::wire::extract::Params;
use crate::wire::text::worker_name;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{CloseFrame, Message, Utf8Bytes, WebSocket, WebSocketUpgrade, close_code};
use axum::http::StatusCode;
use axum::response::Response;
use giveway_floor::id::{Dense, WorkerId};
use giveway_floor::text::sentence::requests;
use serde::Deserialize;
use serde_json::json;
use std::pin::Pin;
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::{Interval, MissedTickBehavior, interval, timeout};
use utoipa::IntoParams;

/// The most readers at once.
const MOST_READERS: i64 = 1000;

/// Interval between pings to a reader.
const PING: Duration = Duration::from_secs(15);

/// After this many pings without an answer, a reader is gone.
const SILENT_PINGS: u32 = 3;

/// How long sending one message may take.
const SEND: Duration = Duration::from_secs(10);

/// The reader's version, and options of the live feed.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct LiveParams {
    /// The version that the reader has: patches continue from it if they are still kept; else a snapshot comes first.
    since: Option<u64>,
    /// Whether to send the gaze, hands and headset charge of workers, too: a message `senses` after each patch.
    senses: Option<bool>,
    /// Whether to send thin patches: numbers by row instead of rows by name, about a tenth of the bytes.
    thin: Option<bool>,
    /// Whether to send snapshots as binary messages, each compressed with gzip.
    packed: Option<bool>,
}

/// Open the live feed: JSON texts, first `{"type": "snapshot", "version", …}`, then `{"type": "patch", "base",
/// "version", …}` ten times a second. A patch contains only items and keys that changed; if its base is not the
/// reader's version, connect again. With `thin=true`, patches carry numbers by row (docs/api.md, "Live feed"); with
/// `packed=true`, snapshots are binary messages: their text, compressed with gzip. With `senses=true`, there are also
/// messages `{"type": "senses", "workers": [{"id", "gaze", "hands", "battery"}]}`. Offer the protocol `giveway`, and
/// `bearer.TOKEN` if a token is needed.
#[utoipa::path(get, path = "/v1/live", tag = "floor", operation_id = "openLiveFeed", params(LiveParams), responses(
    (status = 101, description = "The feed begins"),
    (status = 426, description = "Not a WebSocket"),
    (status = 429, description = "Too many readers")))]
pub async fn live(
    Called(api): Called,
    Params(p): Params<LiveParams>,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<Response, Problem> {
    let upgrade = reader_upgrade(&api, upgrade)?;
    Ok(upgrade.on_upgrade(move |socket| async move {
        api.metrics.live_clients.inc();
        serve(&api, socket, &p).await;
        api.metrics.live_clients.dec();
    }))
}

/// Accepts a WebSocket for one more reader, if there is room.
pub(super) fn reader_upgrade(
    api: &Api,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Result<WebSocketUpgrade, Problem> {
    let upgrade = upgrade.map_err(|e| {
        let detail = format!("this is a WebSocket: connect with ws:// or wss:// ({})", e.body_text());
        let detail = requests::malformed(detail);
        Problem::new(StatusCode::UPGRADE_REQUIRED, "websocket", "A WebSocket is needed", detail)
    })?;
    if api.metrics.live_clients.get() >= MOST_READERS {
        return Err(Problem::too_many(requests::too_many_feeds(MOST_READERS), 10));
    }
    Ok(upgrade.protocols(["giveway"]).max_message_size(4096).max_write_buffer_size(64 << 20))
}

/// A connection that only sends: it is pinged, and closed when the server shuts down or the reader's token ends.
pub(super) struct ReadOnly<'a> {
    socket: WebSocket,
    closing: watch::Receiver<bool>,
    ended: Pin<Box<dyn Future<Output = ()> + Send + 'a>>,
    ping: Interval,
    silent: u32,
}

impl<'a> ReadOnly<'a> {
    pub fn new(api: &'a Api, socket: WebSocket) -> ReadOnly<'a> {
        let (closing, ended) = (api.closing.clone(), Box::pin(api.gate.ended(&api.caller, &api.now)));
        let mut ping = interval(PING);
        ping.set_missed_tick_behavior(MissedTickBehavior::Delay);
        ReadOnly { socket, closing, ended, ping, silent: 0 }
    }

    /// Waits for news. Returns false if the connection is over.
    pub async fn wait<T>(&mut self, news: &mut watch::Receiver<T>) -> bool {
        loop {
            tokio::select! {
                changed = news.changed() => {
                    news.mark_unchanged();
                    return changed.is_ok();
                }
                message = self.socket.recv() => match message {
                    Some(Ok(Message::Close(_)) | Err(_)) | None => return false,
                    Some(Ok(_)) => self.silent = 0,
                },
                _ = self.ping.tick() => {
                    self.silent += 1;
                    if self.silent > SILENT_PINGS || !self.send(Message::Ping(Default::default())).await {
                        return false;
                    }
                }
                () = &mut self.ended => {
                    let frame = CloseFrame { code: close_code::POLICY, reason: TOKEN_ENDED.into() };
                    self.send(Message::Close(Some(frame))).await;
                    return false;
                }
                () = async { _ = self.closing.wait_for(|closing| *closing).await.is_ok() } => {
                    let frame = CloseFrame { code: close_code::AWAY, reason: "server shutting down".into() };
                    self.send(Message::Close(Some(frame))).await;
                    return false;
                }
            }
        }
    }

    /// Sends a message; false if it did not leave in time.
    pub async fn send(&mut self, message: Message) -> bool {
        matches!(timeout(SEND, self.socket.send(message)).await, Ok(Ok(())))
    }
}

/// Serves one reader until it leaves, stalls, or the server shuts down.
async fn serve(api: &Api, socket: WebSocket, p: &LiveParams) {
    let mut newest = api.live.subscribe();
    let reader = FeedReader {
        patches: if p.thin == Some(true) { PatchFormat::Thin } else { PatchFormat::Plain },
        snapshots: if p.packed == Some(true) { SnapshotFormat::Gzip } else { SnapshotFormat::Text },
    };
    let (mut messages, mut version) = api.live.after(reader, p.since, api.live.kept());
    let mut connection = ReadOnly::new(api, socket);
    loop {
        let news = !messages.is_empty();
        let senses = (news && p.senses == Some(true)).then(|| Message::Text(senses(api)));
        for message in messages.drain(..).chain(senses) {
            if !connection.send(message).await {
                return;
            }
        }
        if !connection.wait(&mut newest).await {
            return;
        }
        (messages, version) = api.live.after(reader, Some(version), LAGGING);
    }
}

/// A message with what headsets report besides poses.
fn senses(api: &Api) -> Utf8Bytes {
    let carried = api.feeds.all_carried();
    let worker = |(i, c): (usize, &CarriedSenses)| {
        let mut item = json!(SensesDto::from(c));
        item["id"] = worker_name(WorkerId::at(i)).into();
        item
    };
    let workers: Vec<_> = carried.iter().enumerate().map(worker).collect();
    json!({"type": "senses", "workers": workers}).to_string().into()
}
