//! `/v1/events`: events in order, for systems that follow the floor.
//!
//! Main types: [`EventPage`], [`EventParams`]. The same events are available as a page of JSON or as a stream
//! (server-sent events). Refuses: to leave out events silently: a reader that is too far behind gets 410.

use crate::dto::events::{EventDto, event};
use crate::dto::names::Names;
use crate::http::shared::paging::checked_limit;
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::Params;
use axum::Json;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream::{Stream, unfold};
use giveway_fleet::{EventKind, EventQuery, EventRow};
use giveway_floor::id::Dense;
use giveway_floor::text::sentence::requests;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::convert::Infallible;
use std::time::Duration;
use tokio::sync::watch;
use utoipa::{IntoParams, ToSchema};

/// Media type of a stream.
const STREAM: &str = "text/event-stream";

/// How many events are read from the database at once.
const AT_ONCE: u32 = 500;

/// The most streams at once.
const MOST_STREAMS: i64 = 100;

/// Interval of the keep-alive comments in a stream without events.
const KEEP_ALIVE: Duration = Duration::from_secs(10);

/// How long a stream waits after the database failed to answer.
const AGAIN: Duration = Duration::from_secs(2);

/// A page of events, in order.
#[derive(Debug, Serialize, ToSchema)]
pub struct EventPage {
    /// The events.
    pub items: Vec<EventDto>,
    /// The value for `after` that gives the events that follow.
    pub next: i64,
    /// The number of the latest event.
    pub last: i64,
}

/// Filters for the list of events.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct EventParams {
    /// Only events after this number. If absent, a page begins with the oldest event that is kept, and a stream with
    /// the next event to happen. The header `Last-Event-ID`, which browsers send on their own when a stream broke,
    /// takes precedence.
    #[param(minimum = 0)]
    after: Option<i64>,
    /// Only these kinds, with commas between them: job, robot, fleet, station, worker, assignment, closure, alarm,
    /// encounter, robot_replanned, worker_deviated, worker_goal.
    #[param(example = "job,alarm")]
    kind: Option<String>,
    /// How many events a page has at most, 1 to 500; 100 if absent. Streams have no limit.
    limit: Option<u32>,
}

/// List events, in order, of the last seven days: changes of state of jobs, robots, stations, workers, assignments,
/// closures and alarms, encounters, robots that were replanned because of a worker, a closure or a broken robot
/// (`robot_replanned`, with both routes), workers who left the path (`worker_deviated`), and where workers are most
/// probably going (`worker_goal`). With `Accept: text/event-stream` the events come as a stream of server-sent events,
/// each with its number as `id`, its kind as `event` and the event as JSON in `data`. An event is stored in one
/// transaction with the change that it reports: a reader that continues after the last number that it has seen misses
/// nothing, even if the server was killed.
#[utoipa::path(get, path = "/v1/events", tag = "events", operation_id = "listEvents", params(EventParams,
    ("Last-Event-ID" = Option<i64>, Header, minimum = 0, description = "As `after`")), responses(
    (status = 200, description = "Events in order", content(
        (EventPage = "application/json"), (String = "text/event-stream"))),
    (status = 410),
    (status = 429, description = "There are too many streams")))]
pub async fn list(
    Called(api): Called,
    headers: HeaderMap,
    Params(p): Params<EventParams>,
) -> Result<Response, Problem> {
    let limit = checked_limit(p.limit, 100)?;
    let kinds = read_kinds(p.kind.as_deref())?;
    let after = read_after(&headers, p.after)?;
    let as_stream =
        headers.get(header::ACCEPT).and_then(|v| v.to_str().ok()).is_some_and(|v| v.contains(STREAM));
    // Subscribe before the first read, so that no event between the two is missed.
    let changed = api.records.events_changed();
    let span = api.records.event_span().await.map_err(Problem::of_records)?;
    let begin = after.unwrap_or(if as_stream { span.last } else { span.before });
    if !span.follows(begin) {
        let detail = format!(
            "events are kept from {} to {}, so those after {begin} cannot be told: \
             read the lists again and go on after {}",
            span.before + 1,
            span.last,
            span.last
        );
        let detail = requests::malformed(detail);
        return Err(Problem::new(StatusCode::GONE, "events-gone", "These events are not kept", detail));
    }
    let query = EventQuery { kinds, after: begin, limit };
    if as_stream {
        return stream(api, query, changed);
    }
    let rows = api.records.events(query).await.map_err(Problem::of_records)?;
    let full = rows.len() == limit as usize;
    // After a page that is not full, no events of these kinds follow up to the last number that was read.
    let next = rows.last().filter(|_| full).map_or(span.last.max(begin), |row| row.seq);
    let next = rows.last().map_or(next, |row| next.max(row.seq));
    know_robots(&api, &rows).await;
    let moment = api.moment();
    let names = Names { map: &api.map, view: &moment.view };
    let items = rows.into_iter().map(|row| event(names, api.caller.role, row)).collect();
    Ok(Json(EventPage { items, next, last: span.last.max(next) }).into_response())
}

fn read_kinds(text: Option<&str>) -> Result<Vec<EventKind>, Problem> {
    let words = text.into_iter().flat_map(|text| text.split(','));
    let read = |word: &str| {
        EventKind::of_word(word.trim()).ok_or_else(|| {
            let known = EventKind::ALL.map(EventKind::word).to_vec();
            Problem::invalid(vec![FieldError::new("kind", requests::not_one_of(word, known))])
        })
    };
    words.map(read).collect()
}

fn read_after(headers: &HeaderMap, after: Option<i64>) -> Result<Option<i64>, Problem> {
    let detail = "it is not the number of an event";
    let wrong = |field: &str| Problem::invalid(vec![FieldError::new(field, requests::malformed(detail))]);
    let last = match headers.get("last-event-id").map(|v| v.to_str().unwrap_or("?").trim()) {
        Some("") | None => None,
        Some(text) => Some(text.parse::<i64>().map_err(|_| wrong("Last-Event-ID"))?),
    };
    match last.or(after) {
        Some(n) if n < 0 => Err(wrong("after")),
        after => Ok(after),
    }
}

/// How long to wait for the names of robots that have just joined.
const NAMES: Duration = Duration::from_secs(2);

/// Waits until the view contains the robots of these events: the view is published after their facts.
async fn know_robots(api: &Api, rows: &[EventRow]) {
    let Some(last) = rows.iter().filter_map(|row| row.robot).max() else { return };
    let mut moments = api.moments.clone();
    let known = moments.wait_for(|moment| moment.view.robots.len() > last.ix());
    let _ = tokio::time::timeout(NAMES, known).await;
}

/// A stream and the events that it still has to send.
struct EventStream {
    api: Api,
    query: EventQuery,
    changed: watch::Receiver<()>,
    closing: watch::Receiver<bool>,
    read: VecDeque<EventRow>,
}

impl Drop for EventStream {
    fn drop(&mut self) {
        self.api.metrics.event_streams.dec();
    }
}

fn stream(api: Api, query: EventQuery, changed: watch::Receiver<()>) -> Result<Response, Problem> {
    if api.metrics.event_streams.get() >= MOST_STREAMS {
        let detail = format!("{MOST_STREAMS} streams of events are open, which is the limit");
        return Err(Problem::too_many(requests::malformed(detail), 10));
    }
    api.metrics.event_streams.inc();
    let closing = api.closing.clone();
    let query = EventQuery { limit: AT_ONCE, ..query };
    let stream = EventStream { api, query, changed, closing, read: VecDeque::new() };
    let sse = Sse::new(texts(stream)).keep_alive(KeepAlive::new().interval(KEEP_ALIVE));
    Ok(([(header::CACHE_CONTROL, "no-store")], sse).into_response())
}

fn texts(stream: EventStream) -> impl Stream<Item = Result<Event, Infallible>> {
    unfold(stream, |mut stream| async move {
        let row = stream.next().await?;
        let text = Event::default().id(row.seq.to_string()).event(row.kind.word());
        let moment = stream.api.moment();
        let names = Names { map: &stream.api.map, view: &moment.view };
        let event = event(names, stream.api.caller.role, row);
        let text = text.json_data(&event).expect("an event is JSON");
        Some((Ok(text), stream))
    })
}

impl EventStream {
    /// The next event, as soon as there is one; nothing when the server shuts down.
    async fn next(&mut self) -> Option<EventRow> {
        loop {
            if *self.closing.borrow() {
                return None;
            }
            if let Some(row) = self.read.pop_front() {
                return Some(row);
            }
            self.changed.mark_unchanged();
            match self.api.records.events(self.query.clone()).await {
                Ok(rows) => {
                    if let Some(last) = rows.last() {
                        know_robots(&self.api, &rows).await;
                        self.query.after = last.seq;
                        self.read = rows.into();
                        continue;
                    }
                }
                // The failure has been logged.
                Err(_) => tokio::time::sleep(AGAIN).await,
            }
            tokio::select! {
                changed = self.changed.changed() => changed.ok()?,
                _ = self.closing.wait_for(|closing| *closing) => return None,
                () = self.api.gate.ended(&self.api.caller, &self.api.now) => return None,
            }
        }
    }
}
