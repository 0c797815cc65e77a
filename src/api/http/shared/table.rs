//! Answers as tables: whether the client asks for one, and quoting of its cells (RFC 4180).
//!
//! Main functions: [`wants_table`], [`quoted`]. Refuses: formats other than JSON and CSV.

use crate::wire::error::{FieldError, Problem};
use axum::http::{HeaderMap, header};
use giveway_floor::text::sentence::requests;

/// Whether the client asks for a table instead of JSON.
pub fn wants_table(headers: &HeaderMap, format: Option<&str>) -> Result<bool, Problem> {
    match format {
        Some("csv") => Ok(true),
        Some("json") => Ok(false),
        Some(other) => {
            let detail = requests::not_one_of(other, vec!["csv", "json"]);
            Err(Problem::invalid(vec![FieldError::new("format", detail)]))
        }
        None => {
            let accepted = headers.get(header::ACCEPT).and_then(|v| v.to_str().ok()).unwrap_or("");
            Ok(accepted.split(',').any(|m| m.split(';').next().unwrap_or("").trim() == "text/csv"))
        }
    }
}

/// A cell of a table, quoted if necessary.
pub fn quoted(cell: &str) -> String {
    if cell.contains(['"', ',', '\r', '\n']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.into()
    }
}
