//! A page with a recording in it: one file that opens in a browser, without a server and without a network.
//!
//! Main function: [`page`]. Its Content-Security-Policy allows only its own script, and no requests. Refuses: to leave
//! anything outside of the file.

use crate::page::assets::single;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

/// A page with this recording, as it is stored; nothing if the page was not built into the program.
pub fn page(title: &str, recording: &[u8]) -> Option<String> {
    let [script, style] = single()?;
    // Inside a script, nothing may look like the script's end.
    let script = script.replace("</script", "<\\/script").replace("<!--", "\\x3c!--");
    let style = style.replace("</style", "<\\/style");
    let seal = STANDARD.encode(Sha256::digest(&script));
    let title = title.replace('&', "&amp;").replace('<', "&lt;");
    let recording = STANDARD.encode(recording);
    Some(format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'sha256-{seal}'; \
         style-src 'unsafe-inline'; img-src data: blob:\">\n\
         <link rel=\"icon\" href=\"data:,\">\n<title>{title} – Giveway</title>\n<style>{style}</style>\n</head>\n\
         <body>\n<div id=\"app\"></div>\n\
         <script type=\"application/gzip\" id=\"reel\">{recording}</script>\n\
         <script type=\"module\">{script}</script>\n</body>\n</html>\n"
    ))
}
