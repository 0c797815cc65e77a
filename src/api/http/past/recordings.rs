//! `/v1/past`: the recordings that are kept, their figures, and their frames.
//!
//! Main types: [`PastDto`], [`FiguresDto`], [`SpanParams`]. Refuses: frames of more than an hour in one answer.

use crate::recording::{Cut, Folder, Mark, Sum, thinned};
use crate::state::api::Api;
use crate::state::called::Called;
use crate::wire::error::{FieldError, Problem};
use crate::wire::extract::{Params, no_time};
use crate::wire::text::{parse_time, round3, time_text};
use axum::Json;
use axum::body::{Body, Bytes};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use flate2::Compression;
use flate2::write::GzEncoder;
use giveway_floor::text::sentence::requests;
use giveway_floor::time::{Span, Time};
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::sync::Arc;
use tokio::sync::mpsc;
use utoipa::{IntoParams, ToSchema};

/// The longest span in one answer, seconds.
const LONGEST_S: f64 = 3600.0;

/// Length of a span if its end is not given, seconds.
const USUAL_S: f64 = 300.0;

/// How many compressed bytes are collected before they are sent.
const CHUNK: usize = 128 * 1024;

/// The most bookmarks, or sums, in one answer: the newest ones.
const MOST: usize = 2000;

/// Start and end of a span: RFC 3339, or seconds from the server's start like `time_s` of the live feed, negative for
/// earlier runs.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct SpanParams {
    /// Start of the span; if absent, the start of everything kept.
    #[param(example = "2027-01-31T14:05:00Z")]
    from: Option<String>,
    /// End of the span; if absent, five minutes after the start for a recording, else the end of everything kept.
    #[param(example = "2027-01-31T14:10:00Z")]
    to: Option<String>,
    /// `false` leaves the map out of a recording.
    map: Option<bool>,
}

/// The recordings that are kept.
#[derive(Serialize, ToSchema)]
pub struct PastDto {
    /// The time of day at which the seconds are zero, RFC 3339; null in a recorded simulation.
    start: Option<String>,
    /// The current time, in these seconds.
    now_s: f64,
    /// Whether this server shows a recording and runs no fleet.
    recording: bool,
    /// Spans of time with frames, in order.
    spans: Vec<SpanDto>,
    /// Bookmarks in order: the last 2000.
    bookmarks: Vec<Mark>,
}

/// A span of time without a gap.
#[derive(Serialize, ToSchema)]
struct SpanDto {
    /// Start, in seconds from the server's start.
    from_s: f64,
    /// End, in seconds from the server's start.
    to_s: f64,
    /// Start, RFC 3339; null in a recorded simulation.
    from: Option<String>,
    /// End, RFC 3339; null in a recorded simulation.
    to: Option<String>,
}

/// Get the recordings that are kept: spans, and the bookmarks from `from` to `to`.
#[utoipa::path(get, path = "/v1/past", tag = "past", operation_id = "getPast", params(SpanParams), responses(
    (status = 200, description = "Spans and bookmarks", body = PastDto),
    (status = 404, description = "This server keeps no past")))]
pub async fn past(Called(api): Called, Params(p): Params<SpanParams>) -> Result<Json<PastDto>, Problem> {
    let folder = folder(&api)?;
    let (from, to) = span(folder, &p.from, &p.to)?;
    let past = folder.past(from.unwrap_or(f64::NEG_INFINITY), to.unwrap_or(f64::INFINITY));
    let text = |s: f64| folder.start.map(|start| time_text(start + Span::from_secs_f64(s)));
    let span = |(from_s, to_s)| SpanDto { from_s, to_s, from: text(from_s), to: text(to_s) };
    let surplus = past.marks.len().saturating_sub(MOST);
    Ok(Json(PastDto {
        start: folder.start.map(time_text),
        now_s: round3(api.moment().time_s),
        recording: api.queue.is_none(),
        spans: past.spans.into_iter().map(span).collect(),
        bookmarks: past.marks.into_iter().skip(surplus).collect(),
    }))
}

/// Start, end and step of the figures; times as for spans.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct FigureParams {
    /// Start of the figures; if absent, the start of everything kept.
    #[param(example = "2027-01-31T14:05:00Z")]
    from: Option<String>,
    /// End of the figures; if absent, the end of everything kept.
    #[param(example = "2027-01-31T14:10:00Z")]
    to: Option<String>,
    /// Length of a step, 1 to 86400 seconds: one sum is returned per step; if absent, all sums.
    #[param(example = 60)]
    step: Option<f64>,
}

/// Figures of the past.
#[derive(Serialize, ToSchema)]
pub struct FiguresDto {
    /// The time of day at which the seconds are zero, RFC 3339; null in a recorded simulation.
    start: Option<String>,
    /// Running sums, in order, including the last sum before the span and the first one after it: at most the last
    /// 2000.
    sums: Vec<Sum>,
}

/// Get the figures from `from` to `to`: running sums, one every ten seconds, whose differences make charts. Where
/// `covered_s` falls, or grows by less than the clock, there is a gap. Recordings of earlier versions have no sums.
#[utoipa::path(get, path = "/v1/past/figures", tag = "past",
    operation_id = "getPastFigures", params(FigureParams), responses(
    (status = 200, description = "Running sums", body = FiguresDto),
    (status = 404, description = "This server keeps no past")))]
pub async fn figures(
    Called(api): Called,
    Params(p): Params<FigureParams>,
) -> Result<Json<FiguresDto>, Problem> {
    let folder = folder(&api)?;
    let (from, to) = span(folder, &p.from, &p.to)?;
    let step = p.step.unwrap_or(1.0);
    if !(1.0..=86_400.0).contains(&step) {
        return Err(Problem::invalid(vec![FieldError::new(
            "step",
            requests::not_between(step.round() as i64, 1, 86_400),
        )]));
    }
    let sums = folder.sums(from.unwrap_or(f64::NEG_INFINITY), to.unwrap_or(f64::INFINITY));
    let sums = thinned(&sums, step);
    let surplus = sums.len().saturating_sub(MOST);
    let start = folder.start.map(time_text);
    Ok(Json(FiguresDto { start, sums: sums.into_iter().skip(surplus).collect() }))
}

/// Get the frames of a span as a recording: JSON lines, compressed with gzip. The recording begins with the last key
/// frame before `from`.
#[utoipa::path(get, path = "/v1/past/reel", tag = "past", operation_id = "getPastReel", params(SpanParams), responses(
    (status = 200, description = "The reel", body = Vec<u8>, content_type = "application/gzip"),
    (status = 404, description = "Nothing is kept of that time")))]
pub async fn recording(Called(api): Called, Params(p): Params<SpanParams>) -> Result<Response, Problem> {
    let folder = folder(&api)?;
    let (from, to) = span(folder, &p.from, &p.to)?;
    let from = from.or_else(|| Some(folder.past(0.0, 0.0).spans.first()?.0)).unwrap_or(0.0);
    let to = to.unwrap_or(from + USUAL_S);
    if to < from || to - from > LONGEST_S {
        let detail = requests::malformed(format!("a reel covers 0 to {LONGEST_S} seconds: ask for several"));
        return Err(Problem::invalid(vec![FieldError::new("to", detail)]));
    }
    let cut = folder
        .cut(from, to, p.map != Some(false))
        .ok_or_else(|| Problem::unknown("past", requests::nothing_kept()))?;
    let name = format!("attachment; filename=\"giveway-{}.reel\"", file_name(folder, from));
    let headers =
        [(header::CONTENT_TYPE, "application/gzip".to_owned()), (header::CONTENT_DISPOSITION, name)];
    Ok((headers, packed(cut)).into_response())
}

fn folder(api: &Api) -> Result<&Arc<Folder>, Problem> {
    api.past.as_ref().ok_or_else(|| Problem::unknown("past", requests::no_past()))
}

fn file_name(folder: &Folder, from_s: f64) -> String {
    let at = folder.start.map(|start| time_text(start + Span::from_secs_f64(from_s.round())));
    at.unwrap_or_else(|| format!("{from_s:.0}")).replace(':', "-")
}

/// Both ends of the span, in seconds from the start; nothing for an end that is not given.
fn span(
    folder: &Folder,
    from: &Option<String>,
    to: &Option<String>,
) -> Result<(Option<f64>, Option<f64>), Problem> {
    let mut errors = Vec::new();
    let mut read = |field: &str, text: &Option<String>| {
        let text = text.as_deref()?;
        let seconds = text.parse::<f64>().ok().filter(|s| s.is_finite());
        let zero = folder.start.unwrap_or(Time::ZERO);
        let found = seconds.or_else(|| Some((parse_time(text)? - zero).as_secs_f64()));
        if found.is_none() {
            let detail = requests::malformed(format!("{}, nor seconds", no_time(text)));
            errors.push(FieldError::new(field, detail));
        }
        found
    };
    let ends = (read("from", from), read("to", to));
    if errors.is_empty() { Ok(ends) } else { Err(Problem::invalid(errors)) }
}

/// Compresses and sends while it reads: neither the span nor the answer is ever in memory as a whole.
fn packed(cut: Cut) -> Body {
    let (send, receive) = mpsc::channel::<Result<Bytes, std::io::Error>>(4);
    tokio::task::spawn_blocking(move || {
        let mut out = GzEncoder::new(Vec::new(), Compression::fast());
        cut.each(|lines| {
            // Writing to memory cannot fail.
            let _ = out.write_all(lines.as_bytes());
            out.get_ref().len() < CHUNK
                || send.blocking_send(Ok(std::mem::take(out.get_mut()).into())).is_ok()
        });
        if let Ok(last) = out.finish() {
            let _ = send.blocking_send(Ok(last.into()));
        }
    });
    Body::from_stream(futures_util::stream::unfold(receive, |mut receive| async move {
        let chunk = receive.recv().await?;
        Some((chunk, receive))
    }))
}
