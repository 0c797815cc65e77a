//! Long answers that are the same for all clients: kept in memory once, and compressed once.
//!
//! Main type: [`SharedText`]. It takes no more memory when many clients receive it. Refuses: texts that change; a
//! changed text is a new [`SharedText`].

use crate::access::peer::SharedBody;
use crate::page::served::accepts;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use brotli::CompressorWriter;
use bytes::Bytes;
use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread;

/// Brotli's best quality and usual window. Compression takes two seconds for a hall with 800 robots, once, and the
/// answer is half as long as with a quality that is fast enough for each request.
const QUALITY: u32 = 11;
const WINDOW: u32 = 22;

/// Texts up to this many bytes are sent uncompressed.
const SMALL: usize = 1024;

/// A JSON text, ready to send.
pub struct SharedText {
    text: Bytes,
    /// The text compressed with brotli, as soon as that is done.
    brotli: OnceLock<Bytes>,
    gzip: OnceLock<Bytes>,
    /// Whether compression has started or is done.
    is_begun: AtomicBool,
}

impl SharedText {
    /// Keeps a text. It is compressed when the first client that accepts compression asks for it.
    pub fn of(text: String) -> Arc<SharedText> {
        let (brotli, gzip) = (OnceLock::new(), OnceLock::new());
        Arc::new(SharedText { text: text.into(), brotli, gzip, is_begun: AtomicBool::new(false) })
    }

    /// Compresses the text on a thread of its own, once.
    pub fn compress(self: &Arc<Self>) {
        if self.text.len() <= SMALL || self.is_begun.swap(true, Ordering::Relaxed) {
            return;
        }
        let theirs = self.clone();
        thread::spawn(move || {
            _ = theirs.gzip.set(zipped(&theirs.text));
            _ = theirs.brotli.set(packed(&theirs.text));
        });
    }

    /// The answer to a client that sent these headers.
    pub fn answer(self: &Arc<Self>, asked: &HeaderMap) -> Response {
        if accepts(asked, "br") || accepts(asked, "gzip") {
            self.compress();
        }
        let known = [("br", &self.brotli), ("gzip", &self.gzip)];
        let mut known = known.into_iter().filter_map(|(name, bytes)| Some((name, bytes.get()?)));
        let smaller = known.find(|(name, _)| accepts(asked, name));
        let mut response = smaller.map_or(&self.text, |(_, bytes)| bytes).clone().into_response();
        response.extensions_mut().insert(SharedBody);
        let out = response.headers_mut();
        out.insert(header::CONTENT_TYPE, HeaderValue::from_static("application/json"));
        out.insert(header::VARY, HeaderValue::from_static("accept-encoding"));
        if let Some((name, _)) = smaller {
            out.insert(header::CONTENT_ENCODING, HeaderValue::from_static(name));
        }
        response
    }
}

fn packed(text: &[u8]) -> Bytes {
    let mut packed = CompressorWriter::new(Vec::new(), 4096, QUALITY, WINDOW);
    packed.write_all(text).expect("memory takes what is written");
    packed.into_inner().into()
}

fn zipped(text: &[u8]) -> Bytes {
    let mut zipped = GzEncoder::new(Vec::new(), Compression::best());
    zipped.write_all(text).expect("memory takes what is written");
    zipped.finish().expect("memory takes what is written").into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;

    #[test]
    fn what_is_compressed_is_the_text() {
        let text = include_str!("../../../../maps/lab.json").repeat(3);
        let (packed, zipped) = (packed(text.as_bytes()), zipped(text.as_bytes()));
        let (mut read, mut other) = (String::new(), String::new());
        brotli::Decompressor::new(&packed[..], 4096).read_to_string(&mut read).unwrap();
        flate2::read::GzDecoder::new(&zipped[..]).read_to_string(&mut other).unwrap();
        assert!(read == text && other == text);
        assert!(packed.len() * 4 < text.len() && zipped.len() * 3 < text.len());
    }

    #[test]
    fn all_answers_are_the_same_memory_whatever_a_client_accepts() {
        let shared = SharedText::of("{\"a\":1}".repeat(1000));
        shared.compress();
        while shared.brotli.get().is_none() {
            thread::yield_now();
        }
        for (accepted, encoding) in [("", None), ("gzip", Some("gzip")), ("br, gzip", Some("br"))] {
            let mut headers = HeaderMap::new();
            headers.insert(header::ACCEPT_ENCODING, HeaderValue::from_static(accepted));
            let answer = shared.answer(&headers);
            let said = answer.headers().get(header::CONTENT_ENCODING).map(|v| v.to_str().unwrap());
            assert_eq!(said, encoding);
            assert!(answer.extensions().get::<SharedBody>().is_some());
        }
    }
}
