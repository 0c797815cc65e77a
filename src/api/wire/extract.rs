//! Reading requests: bodies, queries and paths, with every rejection a problem that says what to do.
//!
//! Main types: [`JsonBody`], [`Params`], [`PathPart`], [`IdempotencyKey`]. Refuses: unknown fields, bodies over 64 KiB
//! (a batch of jobs may be longer), other media types.

use super::error::{FieldError, Problem};
use super::text::{LATEST, is_never, parse_time};
use axum::body::Bytes;
use axum::extract::rejection::{PathRejection, QueryRejection};
use axum::extract::{FromRequest, FromRequestParts, Path, Query, Request};
use axum::http::{StatusCode, header, request::Parts};
use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::requests;
use giveway_floor::time::Time;
use serde::de::DeserializeOwned;
use std::time::Duration;

/// The longest body, in bytes.
pub const BODY_LIMIT: usize = 64 * 1024;

/// How long a body may take to arrive.
const BODY_TIME: Duration = Duration::from_secs(20);

/// The longest name of a person who signs, in characters.
const LONGEST_SIGNATURE: usize = 80;

/// The trimmed name of the person who reports something, or the error in it.
pub fn signed(by: &str) -> Result<String, FieldError> {
    let by = by.trim();
    if by.is_empty() || by.chars().count() > LONGEST_SIGNATURE || by.chars().any(char::is_control) {
        return Err(FieldError::new("by", requests::say_who_you_are(LONGEST_SIGNATURE)));
    }
    Ok(by.to_owned())
}

/// The time in a field, if given; adds an error if it is no time.
pub fn read_time(field: &str, text: Option<&str>, errors: &mut Vec<FieldError>) -> Option<Time> {
    let text = text?;
    let time = parse_time(text);
    if time.is_none() {
        errors.push(FieldError::new(field, no_time(text)));
    }
    time
}

/// The end time in a field; a time later than all others means that there is no end ([`is_never`]).
pub fn read_end(field: &str, text: Option<&str>, errors: &mut Vec<FieldError>) -> Option<Time> {
    read_time(field, text.filter(|text| !is_never(text)), errors)
}

/// The error for a text that is no time.
pub fn no_time(text: &str) -> Sentence {
    match is_never(text) {
        true => requests::time_too_late(text, LATEST),
        false => requests::not_a_time(text),
    }
}

/// A JSON body of at most `LIMIT` bytes.
pub struct JsonBody<T, const LIMIT: usize = BODY_LIMIT>(pub T);

impl<T: DeserializeOwned, S: Send + Sync, const LIMIT: usize> FromRequest<S> for JsonBody<T, LIMIT> {
    type Rejection = Problem;

    async fn from_request(request: Request, _: &S) -> Result<Self, Problem> {
        let text = json_text(request, LIMIT).await?;
        serde_json::from_slice(&text).map(JsonBody).map_err(|e| not_as_wanted(&e))
    }
}

/// The text of a JSON body of at most `limit` bytes.
///
/// # Errors
/// If the body has another media type, is too long or arrives too slowly.
pub(crate) async fn json_text(request: Request, limit: usize) -> Result<Bytes, Problem> {
    let media = request.headers().get(header::CONTENT_TYPE).and_then(|v| v.to_str().ok()).unwrap_or("");
    let media = media.split(';').next().unwrap_or("").trim();
    if !media.eq_ignore_ascii_case("application/json") {
        let status = StatusCode::UNSUPPORTED_MEDIA_TYPE;
        let detail = format!("the body is \"{media}\": send JSON with `Content-Type: application/json`");
        let detail = requests::malformed(detail);
        return Err(Problem::new(status, "media-type", "The body is not JSON", detail));
    }
    let read = axum::body::to_bytes(request.into_body(), limit);
    let read = tokio::time::timeout(BODY_TIME, read).await.map_err(|_| {
        let detail = format!("the body did not come within {} s: send it at once", BODY_TIME.as_secs());
        let detail = requests::malformed(detail);
        Problem::new(StatusCode::REQUEST_TIMEOUT, "slow-body", "The body is too slow", detail)
    })?;
    let bytes = read.map_err(|_| {
        let detail = requests::malformed(format!("the body is cut off or longer than {limit} bytes"));
        Problem::new(StatusCode::PAYLOAD_TOO_LARGE, "too-large", "The body is too large", detail)
    })?;
    // Some programs begin every text with a byte order mark, which has no meaning in UTF-8.
    let mark = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
    Ok(bytes.slice(mark..))
}

/// The problem with a body that is no JSON, or not the expected JSON.
pub(crate) fn not_as_wanted(e: &serde_json::Error) -> Problem {
    match e.classify() {
        serde_json::error::Category::Data => {
            let status = StatusCode::UNPROCESSABLE_ENTITY;
            let detail = requests::malformed(e.to_string());
            Problem::new(status, "invalid", "Some fields are wrong", detail)
        }
        _ => Problem::malformed(format!("the body is not JSON: {e}")),
    }
}

/// The query of an address.
pub struct Params<T>(pub T);

impl<T: DeserializeOwned, S: Send + Sync> FromRequestParts<S> for Params<T> {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let query = Query::<T>::from_request_parts(parts, state).await;
        let detail = |e: QueryRejection| Problem::malformed(e.body_text());
        query.map(|Query(params)| Params(params)).map_err(detail)
    }
}

/// The variable part of a path.
pub struct PathPart(pub String);

impl<S: Send + Sync> FromRequestParts<S> for PathPart {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let path = Path::<String>::from_request_parts(parts, state).await;
        path.map(|Path(text)| PathPart(text)).map_err(|e: PathRejection| Problem::malformed(e.body_text()))
    }
}

/// Both variable parts of a path with two.
pub struct PathPair(pub String, pub String);

impl<S: Send + Sync> FromRequestParts<S> for PathPair {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Problem> {
        let path = Path::<(String, String)>::from_request_parts(parts, state).await;
        path.map(|Path((a, b))| PathPair(a, b)).map_err(|e: PathRejection| Problem::malformed(e.body_text()))
    }
}

/// The `Idempotency-Key` header.
pub struct IdempotencyKey(pub Option<String>);

impl<S: Send + Sync> FromRequestParts<S> for IdempotencyKey {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Problem> {
        let Some(value) = parts.headers.get("idempotency-key") else { return Ok(IdempotencyKey(None)) };
        let text = value.to_str().unwrap_or("").trim();
        if text.is_empty() || text.len() > 255 {
            let detail =
                "Idempotency-Key must be 1 to 255 printable ASCII characters, one key per job or assignment";
            return Err(Problem::malformed(detail));
        }
        Ok(IdempotencyKey(Some(text.into())))
    }
}
