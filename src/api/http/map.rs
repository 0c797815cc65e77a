//! `/v1/map`: the building.
//!
//! Main function: [`map`]; main type [`MapAnswer`], made once. Refuses: to send it again to a page that has it.

use super::page::accepts;
use crate::api::building::{MapDto, map_text, map_version};
use crate::warehouse::Warehouse;
use axum::Extension;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use brotli::CompressorWriter;
use bytes::Bytes;
use std::io::Write;
use std::sync::{Arc, OnceLock};
use std::thread;

/// The best quality and the usual window. It takes two seconds for a hall with 800 robots, once, and the answer is half
/// as long as with what is quick enough for each request.
const QUALITY: u32 = 11;
const WINDOW: u32 = 22;

/// Shorter maps are compressed with every answer.
const SMALL: usize = 16 * 1024;

/// The building as it is sent.
pub struct MapAnswer {
    text: Bytes,
    /// Names what is in it.
    pub version: String,
    /// The same in quotes.
    pub etag: HeaderValue,
    /// The text compressed with brotli, as soon as that is done.
    packed: OnceLock<Bytes>,
}

impl MapAnswer {
    /// Writes the building down, and compresses that on a thread of its own.
    pub fn of(map: &Warehouse) -> Arc<MapAnswer> {
        let text = Bytes::from(map_text(map));
        let version = map_version(map);
        let etag = HeaderValue::from_str(&format!("\"{version}\"")).expect("hexadecimal digits in quotes");
        let answer = Arc::new(MapAnswer { text, version, etag, packed: OnceLock::new() });
        if answer.text.len() > SMALL {
            let theirs = answer.clone();
            thread::spawn(move || _ = theirs.packed.set(brotli(&theirs.text)));
        }
        answer
    }
}

/// The building.
#[utoipa::path(get, path = "/v1/map", tag = "floor", operation_id = "getMap", responses(
    (status = 200, description = "The building", body = MapDto),
    (status = 304, description = "Unchanged: its ETag is the one in If-None-Match")))]
pub async fn map(Extension(answer): Extension<Arc<MapAnswer>>, headers: HeaderMap) -> Response {
    let known = headers.get(header::IF_NONE_MATCH).and_then(|v| v.to_str().ok());
    let etag = answer.etag.clone();
    if known.zip(etag.to_str().ok()).is_some_and(|(known, etag)| known.contains(etag)) {
        return (StatusCode::NOT_MODIFIED, [(header::ETAG, etag)]).into_response();
    }
    let packed = answer.packed.get().filter(|_| accepts(&headers, "br"));
    let mut response = packed.unwrap_or(&answer.text).clone().into_response();
    let out = response.headers_mut();
    out.insert(header::ETAG, etag);
    out.insert(header::CONTENT_TYPE, HeaderValue::from_static("application/json"));
    out.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-cache"));
    out.insert(header::VARY, HeaderValue::from_static("accept-encoding"));
    if packed.is_some() {
        out.insert(header::CONTENT_ENCODING, HeaderValue::from_static("br"));
    }
    response
}

fn brotli(text: &[u8]) -> Bytes {
    let mut packed = CompressorWriter::new(Vec::new(), 4096, QUALITY, WINDOW);
    packed.write_all(text).expect("memory takes what is written");
    packed.into_inner().into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;

    #[test]
    fn what_is_compressed_is_the_text() {
        let text = include_str!("../../../maps/lab.json").repeat(3);
        let packed = brotli(text.as_bytes());
        let mut read = String::new();
        ::brotli::Decompressor::new(&packed[..], 4096).read_to_string(&mut read).unwrap();
        assert!(read == text && packed.len() * 4 < text.len());
    }
}
