//! Maps as text: the project's own JSON, and benchmark grids to import.
//!
//! Main types: [`MapError`], [`Options`], [`ImportNotes`]; [`import`] detects the format of a text. Refuses: reading
//! files, and maps that are not well-formed.

mod cell_record;
mod foreign;
mod grid;
pub mod json;
pub mod kiva;
pub mod octile;

use super::{Draft, Findings, Warehouse};
use std::fmt;

/// Why a text is not a map.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MapError {
    /// The text does not follow its format.
    #[error("line {line}, column {column}: {message}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column, from 1; 0 if the whole line is meant.
        column: usize,
        /// What is wrong there.
        message: String,
    },
    /// The text is readable, but the building is not fit to plan on.
    #[error("{0}")]
    Findings(#[from] Findings),
}

impl MapError {
    fn syntax(line: usize, column: usize, message: impl Into<String>) -> MapError {
        MapError::Syntax { line, column, message: message.into() }
    }
}

/// Values that an import adds to a format that lacks them.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Name of the map, for formats without one.
    pub name: String,
    /// Side of a grid cell, metres.
    pub pitch_m: f64,
    /// Picking stations to add beside a warehouse grid.
    pub stations: usize,
    /// Number of waiting places before each station.
    pub queue: usize,
    /// Usual length of a pick, seconds.
    pub pick_s: f64,
    /// Largest share of the free cells of an octile grid that become parking places.
    pub parking_share: f64,
    /// Share of the robots' homes in a warehouse grid that become chargers.
    pub charger_share: f64,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            name: "imported".into(),
            pitch_m: 1.0,
            stations: 8,
            queue: 4,
            pick_s: 8.0,
            parking_share: 0.15,
            charger_share: 0.1,
        }
    }
}

/// What an import left out, changed or added, for people to read.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct ImportNotes(pub Vec<String>);

impl fmt::Display for ImportNotes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.join("\n"))
    }
}

/// Reads a map in any known format: own JSON, Moving AI octile grid, or warehouse grid with endpoints.
///
/// # Errors
/// [`MapError::Syntax`] if the text follows no known format, [`MapError::Findings`] if the building is not fit to plan
/// on.
pub fn import(text: &str, options: &Options) -> Result<(Warehouse, ImportNotes), MapError> {
    let (draft, notes) = import_draft(text, options)?;
    Ok((draft.build()?, notes))
}

/// Reads a map in any known format without validating it.
///
/// # Errors
/// [`MapError::Syntax`] if the text follows no known format.
pub fn import_draft(text: &str, options: &Options) -> Result<(Draft, ImportNotes), MapError> {
    let text = text.trim_start_matches('\u{feff}');
    read_any(text, options).map_err(|why| match of_others(text) {
        Some(message) => MapError::syntax(1, 1, message),
        None => why,
    })
}

/// The message about a layout of another system; nothing if the text is not such a layout.
pub fn of_others(text: &str) -> Option<String> {
    let format = foreign::foreign_layout(text)?;
    Some(format!("this is {format}, which cannot be read yet: draw the floor in the editor, or {KNOWN}"))
}

/// The formats that can be read.
const KNOWN: &str =
    "give a JSON map (\"{\"), an octile grid (\"type octile\") or a warehouse grid (\"rows,columns\")";

fn read_any(text: &str, options: &Options) -> Result<(Draft, ImportNotes), MapError> {
    // Old spreadsheets and editors end lines with CR.
    let with_lf = text.replace("\r\n", "\n").replace('\r', "\n");
    let text = with_lf.as_str();
    let first = text.lines().next().unwrap_or_default().trim();
    if text.trim_start().starts_with('{') {
        Ok((json::parse_draft(text)?, ImportNotes::default()))
    } else if first.starts_with("type") {
        octile::parse(text, options)
    } else if first.split(',').count() == 2 && first.split(',').all(|n| n.trim().parse::<usize>().is_ok()) {
        kiva::parse(text, options)
    } else {
        Err(MapError::syntax(1, 1, format!("not a known map format: {KNOWN}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const JSON: &str = r#"{"giveway_map":1,"name":"two","footprint_m":0.9,"nodes":[{"id":"a","x":0,"y":0},
        {"id":"p","x":1,"y":0}],"lanes":[{"from":"a","to":"p","both":true}],"parking":["p"]}"#;
    const OCTILE: &str = "type octile\nheight 2\nwidth 3\nmap\n...\n.@.\n";
    const KIVA: &str = "2,3\n0\n2\n100\n...\nr.r\n";

    proptest! {
        #[test]
        fn no_text_makes_the_import_panic(
            text in prop::sample::select(vec![JSON, OCTILE, KIVA]),
            cut in 0usize..200,
            at in 0usize..200,
            byte in 32u8..127,
        ) {
            let mut bytes = text.as_bytes().to_vec();
            let at = at % bytes.len();
            bytes[at] = byte;
            bytes.truncate(bytes.len().saturating_sub(cut.saturating_sub(100)));
            let _ = import(&String::from_utf8_lossy(&bytes), &Options::default());
        }
    }

    #[test]
    fn every_format_is_known_by_its_first_line() {
        for text in [JSON, OCTILE, KIVA] {
            let (w, _) = import(text, &Options::default()).expect(text);
            assert!(!w.nodes.is_empty());
        }
    }

    #[test]
    fn lines_of_grids_end_in_any_way_and_blank_ones_may_follow() {
        for text in [OCTILE, KIVA] {
            let (wanted, _) = import(text, &Options::default()).expect(text);
            let mixed = text.replacen('\n', "\r\n", 2);
            for other in [
                text.replace('\n', "\r\n"),
                text.replace('\n', "\r"),
                mixed,
                format!("\u{feff}{text}\n \n\r\n"),
            ] {
                let (read, _) =
                    import(&other, &Options::default()).unwrap_or_else(|e| panic!("{other:?}: {e}"));
                assert_eq!(json::write(&read), json::write(&wanted), "{other:?}");
            }
        }
    }

    #[test]
    fn a_header_that_says_less_or_more_than_the_rows_is_refused_in_every_grid() {
        let octile =
            |height, width| format!("type octile\nheight {height}\nwidth {width}\nmap\n...\n.@.\n...\n");
        let kiva = |height, width| format!("{height},{width}\n0\n2\n100\n...\nr.r\n...\n");
        let rows = "3 rows, the header says 2";
        for (height, width, says) in [
            (2, 3, rows),
            (4, 3, "3 rows, the header says 4"),
            (3, 2, "3 cells in a row, the header says 2"),
            (3, 4, "3 cells in a row, the header says 4"),
        ] {
            for text in [octile(height, width), kiva(height, width)] {
                let error = import(&text, &Options::default()).expect_err(&text).to_string();
                assert!(error.contains(says), "{text}: {error}");
            }
        }
        // A row that is too long is one row too many, whatever it contains.
        let error = import(&format!("{}x\n", octile(3, 3)), &Options::default()).expect_err("a fourth row");
        assert!(error.to_string().contains("4 rows, the header says 3"), "{error}");
    }

    #[test]
    fn a_text_in_no_known_format_is_refused_with_what_is_known() {
        let error = import("<xml/>", &Options::default()).expect_err("no XML");
        assert!(error.to_string().contains("type octile"), "{error}");
    }
}
