//! The files of the page, built into the program.
//!
//! Main functions: [`file()`], [`single`]. Refuses: files that are not part of the build.

use rust_embed::{EmbeddedFile, RustEmbed};

#[derive(RustEmbed)]
#[folder = "$OUT_DIR/web"]
struct Web;

/// A file of the page by its path.
pub fn file(path: &str) -> Option<EmbeddedFile> {
    Web::get(path)
}

/// Script and style of the page in one piece each, for a file that needs no server; nothing where the page was not
/// built.
pub fn single() -> Option<[String; 2]> {
    let text = |name| Some(String::from_utf8_lossy(&file(name)?.data).into_owned());
    Some([text("single/page.js")?, text("single/page.css")?])
}
