//! Work cells in recordings: all of them with a key frame, else only the changed ones.
//!
//! Main function: [`line()`]. Refuses: to keep where hands were.

use crate::dto::cell::shown::ShownCell;
use crate::live::Frame;
use serde_json::{Map, json};

/// The line of a frame with the cells that changed since the `last` frame; nothing if none did.
pub fn line(last: Option<&Frame>, frame: &Frame) -> Option<String> {
    let before = last.map_or(&[][..], |last| &last.beside.cells);
    let cells = frame.beside.cells.iter().enumerate();
    let changed = cells.filter(|(i, cell)| before.get(*i) != Some(*cell)).map(|(_, cell)| cell);
    let rows: Map<_, _> = changed.map(|cell: &ShownCell| (cell.station.clone(), json!(cell))).collect();
    (!rows.is_empty()).then(|| format!("{{\"at\":{},\"cells\":{}}}\n", frame.time_s, json!(rows)))
}
