//! Numbers that are kept for ever: each kind of fact has one of its own, and none is left out.
//!
//! The compiler sees that the kinds of one subject differ; a digest also needs those of all subjects to differ.

use crate::all_sources;
use std::collections::BTreeMap;

const FACTS: &str = "src/fleet/state/fact/";

/// The numbers that variants are given in a text, `Name = 7,` or `} = 7,`, with their lines.
fn numbers(text: &str) -> impl Iterator<Item = (u64, usize)> {
    text.lines().enumerate().filter_map(|(at, line)| {
        let number = line.strip_suffix(',')?.rsplit_once(" = ")?.1.parse().ok()?;
        Some((number, at + 1))
    })
}

#[test]
fn every_kind_of_fact_has_a_number_of_its_own_and_none_is_left_out() {
    let mut found: BTreeMap<u64, Vec<String>> = BTreeMap::new();
    for (path, text) in all_sources() {
        if path.starts_with(FACTS) || path == "src/fleet/state/note.rs" {
            for (number, line) in numbers(&text) {
                found.entry(number).or_default().push(format!("{path}:{line}"));
            }
        }
    }
    let twice: Vec<_> = found.iter().filter(|(_, places)| places.len() > 1).collect();
    assert!(twice.is_empty(), "the next free number is {}: {twice:?}", found.len());
    assert!(found.len() >= 50, "facts were not found: {found:?}");
    assert!(found.keys().copied().eq(0..found.len() as u64), "a number is left out: {found:?}");
}

#[test]
fn numbers_are_read_from_variants_with_and_without_fields() {
    let text = "    Paused = 7,\n    Closed {\n        area: Area,\n    } = 23,\n    x: f64,\n";
    assert_eq!(numbers(text).collect::<Vec<_>>(), [(7, 1), (23, 4)]);
}
