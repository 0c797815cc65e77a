//! Errors of a map in red: a numbered ring at each place, and below the floor the meaning of each number.
//!
//! Main function: [`draw`]. Refuses: to draw more rings than a reader can tell apart.

use super::canvas::{Canvas, MARGIN, escape};
use crate::warehouse::check::Remark;
use std::fmt::Write as _;

/// Number of errors explained below the floor; `map check` lists all.
const TOLD: usize = 40;
/// Number of rings drawn for one error.
const RINGS: usize = 200;
/// Height of a line of text, pixels.
const LINE: f64 = 19.0;
/// Average width of a letter, pixels.
const LETTER: f64 = 6.6;

/// Style of the marks; left out of drawings without marks.
const STYLE: &str = "<style>.mark{fill:#d92d20;fill-opacity:.12;stroke:#d92d20;stroke-width:2.5}
.number{fill:#b42318;font-weight:700;text-anchor:middle}.wrong{fill:#b42318;font-size:13px}</style>
";

/// Room that the words take below the legend, pixels.
pub(super) fn height(c: &Canvas, errors: &[&Remark]) -> f64 {
    let lines: usize = told(c, errors).iter().map(Vec::len).sum();
    if lines == 0 { 0.0 } else { (lines + 1) as f64 * LINE }
}

/// Draws the rings, and writes the words from `top` on (pixels).
pub(super) fn draw(out: &mut String, c: &Canvas, errors: &[&Remark], top: f64) {
    if errors.is_empty() {
        return;
    }
    out.push_str(STYLE);
    let radius = (c.scale * 0.55).clamp(7.0, 30.0);
    for (i, error) in errors.iter().enumerate() {
        for p in error.at.iter().take(RINGS) {
            let (x, y) = c.px(*p);
            let number = (x + radius * 0.9, y - radius * 0.8);
            out.push_str(&format!(
                "<circle class=\"mark\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\"/>\n"
            ));
            let size = (radius * 0.8).clamp(10.0, 15.0);
            let (nx, ny) = number;
            writeln!(
                out,
                "<text class=\"number\" font-size=\"{size:.1}\" x=\"{nx:.1}\" y=\"{ny:.1}\">{}</text>",
                i + 1
            )
            .expect("a string takes all text");
        }
    }
    let mut y = top + LINE;
    for line in told(c, errors).into_iter().flatten() {
        y += LINE;
        let text = escape(&line);
        writeln!(out, "<text class=\"wrong\" x=\"{MARGIN}\" y=\"{y:.1}\">{text}</text>")
            .expect("a string takes all text");
    }
}

/// The explanations, each error broken into lines.
fn told(c: &Canvas, errors: &[&Remark]) -> Vec<Vec<String>> {
    let width = ((c.width - 2.0 * MARGIN) / LETTER) as usize;
    let told = errors.iter().enumerate().take(TOLD).map(|(i, e)| wrapped(&format!("{}  {e}", i + 1), width));
    let more = errors.len().saturating_sub(TOLD);
    told.chain((more > 0).then(|| vec![format!("and {more} more: `giveway map check` tells all")])).collect()
}

fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last_mut().expect("there is always one");
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > width {
            lines.push(format!("    {word}"));
        } else {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines
}
