//! `/v1/map`: the building.
//!
//! Main function: [`map`]. Refuses: to send it again to a page that has it.

use crate::api::building::{MapDto, map_text};
use crate::api::called::Called;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use sha2::{Digest, Sha256};

/// The building.
#[utoipa::path(get, path = "/v1/map", tag = "floor", operation_id = "getMap", responses(
    (status = 200, description = "The building", body = MapDto),
    (status = 304, description = "Unchanged: its ETag is the one in If-None-Match")))]
pub async fn map(Called(api): Called, headers: HeaderMap) -> Response {
    let text = map_text(&api.map);
    let digest = Sha256::digest(&text);
    let etag = format!("\"{}\"", digest[..12].iter().map(|b| format!("{b:02x}")).collect::<String>());
    let known = headers.get(header::IF_NONE_MATCH).and_then(|v| v.to_str().ok());
    if known.is_some_and(|known| known.contains(&etag)) {
        return (StatusCode::NOT_MODIFIED, [(header::ETAG, etag)]).into_response();
    }
    let headers = [
        (header::ETAG, etag.as_str()),
        (header::CONTENT_TYPE, "application/json"),
        (header::CACHE_CONTROL, "no-cache"),
    ];
    (headers, text).into_response()
}
