//! The web page, built into the program, and the answer to every path that has no route.
//!
//! Main function: [`page`]. Files with a hash in their name never change; browsers ask for the pages themselves again
//! each time. Refuses: scripts from elsewhere, by Content-Security-Policy.

use crate::access::peer::SharedBody;
use crate::page::assets::{encoded, file};
use crate::wire::error::Problem;
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use bytes::Bytes;
use giveway_floor::text::sentence::requests;
use rust_embed::EmbeddedFile;
use std::borrow::Cow;

/// What the page may load: its own files only, images also from data and blob addresses, and workers from blobs.
const POLICY: &str = "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; \
    worker-src 'self' blob:; object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// The file of the page at this path, or a problem if there is none.
pub async fn page(method: Method, uri: Uri, headers: HeaderMap) -> Response {
    let path = uri.path().trim_start_matches('/');
    let unknown = || {
        let detail = format!("there is nothing at /{path}: /openapi.json lists the paths of the API");
        let detail = requests::malformed(detail);
        Problem::unknown("page", detail).into_response()
    };
    if path == "v1" || path.starts_with("v1/") || !matches!(method, Method::GET | Method::HEAD) {
        return unknown();
    }
    let name = match path {
        "" => "index.html",
        "headset" | "headset/marks" => "headset.html",
        "station" => "station.html",
        one if one.starts_with("station/") => "station.html",
        "docs" => "docs.html",
        "sign-in" => "signin.html",
        "editor" => "editor.html",
        other => other,
    };
    match file(name) {
        Some(file) => serve(name, &file, &headers),
        None => unknown(),
    }
}

fn serve(name: &str, file: &EmbeddedFile, headers: &HeaderMap) -> Response {
    let digest: String = file.metadata.sha256_hash()[..12].iter().map(|b| format!("{b:02x}")).collect();
    let etag = format!("\"{digest}\"");
    let known = headers.get(header::IF_NONE_MATCH).and_then(|v| v.to_str().ok());
    let smaller = encoded(name, |encoding| accepts(headers, encoding));
    let mut response = if known.is_some_and(|known| known.contains(&etag)) {
        StatusCode::NOT_MODIFIED.into_response()
    } else {
        in_place(smaller.as_ref().map_or(file, |(_, smaller)| smaller))
    };
    let hashed = name.starts_with("assets/");
    let caching = if hashed { "public, max-age=31536000, immutable" } else { "no-cache" };
    let out = response.headers_mut();
    if let Some((encoding, _)) = smaller {
        out.insert(header::CONTENT_ENCODING, HeaderValue::from_static(encoding));
    }
    out.insert(header::VARY, HeaderValue::from_static("accept-encoding"));
    out.insert(header::CONTENT_TYPE, HeaderValue::from_static(media_type(name)));
    out.insert(header::CACHE_CONTROL, HeaderValue::from_static(caching));
    // Both headers concern documents; on scripts and styles they would mean nothing, and a first visit fetches many.
    if !matches!(media_type(name), "text/javascript; charset=utf-8" | "text/css; charset=utf-8") {
        out.insert(header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(POLICY));
        out.insert(header::REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    }
    out.insert(header::ETAG, HeaderValue::from_str(&etag).expect("hexadecimal digits in quotes"));
    response
}

/// A response with the file, not copied if it is part of the program.
fn in_place(file: &EmbeddedFile) -> Response {
    let bytes = match &file.data {
        Cow::Borrowed(bytes) => Bytes::from_static(bytes),
        Cow::Owned(bytes) => Bytes::copy_from_slice(bytes),
    };
    let mut response = bytes.into_response();
    if matches!(file.data, Cow::Borrowed(_)) {
        response.extensions_mut().insert(SharedBody);
    }
    response
}

/// Whether the client accepts this encoding.
pub fn accepts(headers: &HeaderMap, encoding: &str) -> bool {
    let values = headers.get_all(header::ACCEPT_ENCODING).into_iter().filter_map(|v| v.to_str().ok());
    values.flat_map(|v| v.split(',')).any(|item| {
        let (name, weight) = item.split_once(';').unwrap_or((item, ""));
        let refused = weight.trim().strip_prefix("q=").is_some_and(|q| q.parse() == Ok(0.0));
        name.trim().eq_ignore_ascii_case(encoding) && !refused
    })
}

fn media_type(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js" | "mjs") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("json" | "map" | "webmanifest") => "application/json",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("ico") => "image/x-icon",
        Some("woff2") => "font/woff2",
        Some("wasm") => "application/wasm",
        Some("txt") => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}
