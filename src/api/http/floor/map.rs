//! `/v1/map`: the building.
//!
//! Main function: [`map`]; main type [`MapAnswer`], made once. Refuses: to send the map again to a page that has it.

use crate::dto::building::{MapDto, map_text, map_version};
use crate::http::shared::shared_text::SharedText;
use axum::Extension;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use giveway_floor::warehouse::Warehouse;
use std::sync::Arc;

/// The building as it is sent.
pub struct MapAnswer {
    text: Arc<SharedText>,
    /// The version of the map's content.
    pub version: String,
    /// The version in quotes, as an ETag.
    pub etag: HeaderValue,
}

impl MapAnswer {
    /// Serialises the building.
    pub fn of(map: &Warehouse) -> Arc<MapAnswer> {
        let version = map_version(map);
        let etag = HeaderValue::from_str(&format!("\"{version}\"")).expect("hexadecimal digits in quotes");
        let text = SharedText::of(map_text(map));
        // Web pages ask for the map at once.
        text.compress();
        Arc::new(MapAnswer { text, version, etag })
    }
}

/// Get the building.
#[utoipa::path(get, path = "/v1/map", tag = "floor", operation_id = "getMap", responses(
    (status = 200, description = "The building", body = MapDto),
    (status = 304, description = "Unchanged: its ETag is the one in If-None-Match")))]
pub async fn map(Extension(answer): Extension<Arc<MapAnswer>>, headers: HeaderMap) -> Response {
    let known = headers.get(header::IF_NONE_MATCH).and_then(|v| v.to_str().ok());
    let etag = answer.etag.clone();
    if known.zip(etag.to_str().ok()).is_some_and(|(known, etag)| known.contains(etag)) {
        return (StatusCode::NOT_MODIFIED, [(header::ETAG, etag)]).into_response();
    }
    let mut response = answer.text.answer(&headers);
    let out = response.headers_mut();
    out.insert(header::ETAG, etag);
    out.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-cache"));
    response
}
