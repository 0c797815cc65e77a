//! The files of the page, built into the program.
//!
//! Main functions: [`file()`], [`encoded`], [`single`]. Refuses: files that are not part of the build.

use rust_embed::{EmbeddedFile, RustEmbed};

#[derive(RustEmbed)]
#[folder = "$OUT_DIR/web"]
struct Web;

/// How a file of the page may be encoded, the smallest first: the build wrote it so beside the file.
const ENCODINGS: [(&str, &str); 2] = [("br", "br"), ("gzip", "gz")];

/// A file of the page by its path.
pub fn file(path: &str) -> Option<EmbeddedFile> {
    Web::get(path)
}

/// A file as it was encoded by the build, with the name of the encoding, if there is one that is accepted.
pub fn encoded(path: &str, accepts: impl Fn(&str) -> bool) -> Option<(&'static str, EmbeddedFile)> {
    let accepted = ENCODINGS.into_iter().filter(|(name, _)| accepts(name));
    accepted.filter_map(|(name, ending)| Some((name, file(&format!("{path}.{ending}"))?))).next()
}

/// Script and style of the page in one piece each, for a file that needs no server; nothing where the page was not
/// built.
pub fn single() -> Option<[String; 2]> {
    let text = |name| Some(String::from_utf8_lossy(&file(name)?.data).into_owned());
    Some([text("single/page.js")?, text("single/page.css")?])
}
