//! The files of the page, built into the program.
//!
//! Main functions: [`file()`], [`encoded`], [`single`]. Refuses: files that are not part of the build.

use rust_embed::{EmbeddedFile, RustEmbed};

#[derive(RustEmbed)]
#[folder = "$OUT_DIR/web"]
struct Web;

/// Encodings of the page's files, the smallest first: the build writes each encoded file beside the plain one.
const ENCODINGS: [(&str, &str); 2] = [("br", "br"), ("gzip", "gz")];

/// The file of the page at this path.
pub fn file(path: &str) -> Option<EmbeddedFile> {
    Web::get(path)
}

/// A file in an encoding that the client accepts, with the name of the encoding; nothing if the build has none.
pub fn encoded(path: &str, accepts: impl Fn(&str) -> bool) -> Option<(&'static str, EmbeddedFile)> {
    let accepted = ENCODINGS.into_iter().filter(|(name, _)| accepts(name));
    accepted.filter_map(|(name, ending)| Some((name, file(&format!("{path}.{ending}"))?))).next()
}

/// The page's script and style, one piece each, for a file that needs no server; nothing if the page was not built.
pub fn single() -> Option<[String; 2]> {
    let text = |name| Some(String::from_utf8_lossy(&file(name)?.data).into_owned());
    Some([text("single/page.js")?, text("single/page.css")?])
}
