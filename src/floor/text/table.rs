//! Delimited text (CSV) as spreadsheets and other programs write it: one reader for the program, and the same rules in
//! the page (`web/src/jobs/table.ts`). `web/fixtures/tables.json` has the cases on which both agree.
//!
//! Main type: [`TextTable`]. The first line that has any cell names the columns. Refuses: empty tables, two columns of
//! one name, a quote without its end, and text that is not UTF-8; never a line because of its cells' content.

use std::fmt;

/// A table with named columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextTable {
    /// Names of the columns; an unnamed column has an empty name.
    pub columns: Vec<String>,
    /// The lines below the names, without lines in which every cell is empty.
    pub rows: Vec<TextTableRow>,
}

/// A line of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextTableRow {
    /// Number of the line in the text where the row begins, from 1.
    pub line: usize,
    /// A cell for each column.
    pub cells: Vec<String>,
    /// Number of cells if the row has more cells than columns; else 0. Empty cells at the end do not count.
    pub surplus: usize,
}

/// Why a text is not a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TableFault {
    /// No line has a cell.
    Empty,
    /// There is a header and nothing below it.
    NoRows,
    /// Two columns have this name.
    Twice(String),
    /// A quoted cell begins in this line and does not end.
    Unclosed(usize),
    /// The text is not valid UTF-8.
    NotText,
}

impl fmt::Display for TableFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TableFault::Empty => f.write_str("the file is empty"),
            TableFault::NoRows => f.write_str("there is no line below the header"),
            TableFault::Twice(name) => write!(f, "the header names two columns `{name}`: keep one"),
            TableFault::Unclosed(line) => {
                write!(f, "line {line}: a quoted cell begins here and does not end")
            }
            TableFault::NotText => f.write_str("it is not text in UTF-8: save it as \"CSV UTF-8\""),
        }
    }
}

/// Characters that do not count at either end of a cell.
const PADDING: [char; 4] = [' ', '\t', '\u{a0}', '\u{feff}'];

/// Possible separators of cells; of two that are equally frequent in the header, the first.
const SEPARATORS: [char; 3] = [',', ';', '\t'];

impl TextTable {
    /// Reads a table. Lines end with LF, CR LF or CR; a byte order mark is skipped; the separator is the most frequent
    /// of comma, semicolon and tab in the header. A cell in quotes may have separators, line ends and, doubled, quotes
    /// (RFC 4180). White space around a cell does not count.
    ///
    /// # Errors
    /// Why the text is not a table.
    pub fn read(text: &str) -> Result<TextTable, TableFault> {
        if text.contains(['\0', '\u{fffd}']) {
            return Err(TableFault::NotText);
        }
        let text = text.trim_start_matches('\u{feff}').replace("\r\n", "\n").replace('\r', "\n");
        if text.chars().all(|c| c == '\n' || PADDING.contains(&c) || SEPARATORS.contains(&c)) {
            return Err(TableFault::Empty);
        }
        let mut lines = split(&text, separator(&text))?.into_iter();
        let (_, mut columns) = lines.next().ok_or(TableFault::Empty)?;
        drop_empty_end(&mut columns, 0);
        for (i, name) in columns.iter().enumerate().filter(|(_, name)| !name.is_empty()) {
            if columns[..i].iter().any(|before| before.eq_ignore_ascii_case(name)) {
                return Err(TableFault::Twice(name.clone()));
            }
        }
        let width = columns.len();
        let row = |(line, mut cells): (usize, Vec<String>)| {
            drop_empty_end(&mut cells, width);
            let surplus = if cells.len() > width { cells.len() } else { 0 };
            cells.resize(width, String::new());
            TextTableRow { line, cells, surplus }
        };
        let rows: Vec<TextTableRow> = lines.map(row).collect();
        if rows.is_empty() { Err(TableFault::NoRows) } else { Ok(TextTable { columns, rows }) }
    }

    /// The column with this name, ignoring the case of ASCII letters.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|c| c.eq_ignore_ascii_case(name))
    }
}

/// Drops empty cells from the end, down to `least` cells.
fn drop_empty_end(cells: &mut Vec<String>, least: usize) {
    while cells.len() > least && cells.last().is_some_and(String::is_empty) {
        cells.pop();
    }
}

/// The most frequent separator in the first line with text, outside quotes.
fn separator(text: &str) -> char {
    let mut counts = [0; SEPARATORS.len()];
    let (mut quoted, mut has_text) = (false, false);
    for c in text.chars() {
        match (c, SEPARATORS.iter().position(|s| *s == c)) {
            ('\n', _) if !quoted && has_text => break,
            ('\n', _) if !quoted => counts = Default::default(),
            (_, Some(i)) if !quoted => counts[i] += 1,
            _ => {
                quoted ^= c == '"';
                has_text |= !PADDING.contains(&c);
            }
        }
    }
    let most = counts.iter().max().copied().unwrap_or_default();
    SEPARATORS[counts.iter().position(|n| *n == most).unwrap_or_default()]
}

/// The lines that have a cell with text, each with its number, from 1.
fn split(text: &str, separator: char) -> Result<Vec<(usize, Vec<String>)>, TableFault> {
    let mut lines: Vec<(usize, Vec<String>)> = Vec::new();
    let (mut row, mut cell): (Vec<String>, String) = Default::default();
    let (mut line, mut began, mut quoted) = (1, 1, None);
    let trimmed = |cell: &mut String| std::mem::take(cell).trim_matches(PADDING).to_owned();
    let mut letters = text.chars().chain(['\n']).peekable();
    while let Some(c) = letters.next() {
        let is_last = letters.peek().is_none();
        match c {
            '"' if quoted.is_some() => match letters.next_if_eq(&'"') {
                Some(quote) => cell.push(quote),
                None => quoted = None,
            },
            '\n' if quoted.is_some() && is_last => {}
            '\n' if quoted.is_some() => {
                line += 1;
                cell.push(c);
            }
            _ if quoted.is_some() => cell.push(c),
            '"' if cell.trim_matches(PADDING).is_empty() => {
                quoted = Some(line);
                cell.clear();
            }
            '\n' => {
                row.push(trimmed(&mut cell));
                let cells = std::mem::take(&mut row);
                if cells.iter().any(|c| !c.is_empty()) {
                    lines.push((began, cells));
                }
                line += 1;
                began = line;
            }
            _ if c == separator => row.push(trimmed(&mut cell)),
            _ => cell.push(c),
        }
    }
    match quoted {
        Some(line) => Err(TableFault::Unclosed(line)),
        None => Ok(lines),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    /// The cases that the page's reader is also tested with.
    const CASES: &str = include_str!("../../../web/fixtures/tables.json");

    fn as_json(read: Result<TextTable, TableFault>) -> Value {
        let row = |r: TextTableRow| match r.surplus {
            0 => json!({"line": r.line, "cells": r.cells}),
            n => json!({"line": r.line, "cells": r.cells, "surplus": n}),
        };
        match read {
            Ok(table) => {
                json!({"columns": table.columns, "rows": table.rows.into_iter().map(row).collect::<Vec<_>>()})
            }
            Err(TableFault::Empty) => json!({"fault": "empty"}),
            Err(TableFault::NoRows) => json!({"fault": "no rows"}),
            Err(TableFault::Twice(name)) => json!({"fault": "twice", "name": name}),
            Err(TableFault::Unclosed(line)) => json!({"fault": "unclosed", "line": line}),
            Err(TableFault::NotText) => json!({"fault": "not text"}),
        }
    }

    #[test]
    fn tables_are_read_as_the_page_reads_them() {
        let cases: Vec<Value> = serde_json::from_str(CASES).unwrap();
        assert!(cases.len() >= 25, "{} cases", cases.len());
        for case in cases {
            let read = as_json(TextTable::read(case["text"].as_str().unwrap()));
            assert_eq!(read, case["read"], "{}", case["about"]);
        }
    }
}
