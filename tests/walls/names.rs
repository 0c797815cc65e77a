//! A type's name says what it is wherever it is read: no two types of the crate share one.

use crate::all_sources;
use crate::tokens::{Token, tokens};
use std::collections::BTreeMap;

/// Words before the name of a type. Types of traits (`type Output = ...`) have names that the trait gives.
const DECLARES: [&str; 4] = ["struct", "enum", "union", "trait"];

/// Before a name that a macro gives.
const MACRO: &str = "$";

/// The types that a file declares.
fn declared<'a>(tokens: &[Token<'a>]) -> Vec<&'a str> {
    let pairs = tokens.windows(2);
    let named = |pair: &&[Token<'a>]| DECLARES.contains(&pair[0].text) && pair[1].text != MACRO;
    pairs.filter(named).map(|pair| pair[1].text).collect()
}

/// Names of types that are declared more than once, with the files.
fn shared(files: &[(String, String)]) -> Vec<String> {
    let mut all: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (path, text) in files {
        for name in declared(&tokens(text)) {
            all.entry(name).or_default().push(path);
        }
    }
    all.retain(|_, paths| paths.len() > 1);
    all.into_iter().map(|(name, paths)| format!("{name}: {}", paths.join(", "))).collect()
}

/// The words of a standard are its own: `Node`, `Edge`, `Action`.
const STANDARD: &str = "src/vda5050/model/";

#[test]
fn no_two_types_have_one_name() {
    let ours = all_sources().into_iter().filter(|(path, _)| !path.starts_with(STANDARD));
    assert_eq!(shared(&ours.collect::<Vec<_>>()), [""; 0]);
}

#[test]
fn types_of_one_name_are_found() {
    let file = |path: &str, text: &str| (path.to_owned(), text.to_owned());
    let files = [
        file("src/a.rs", "pub struct Place;\n// struct Line;\nconst WORDS: &str = \"enum Line\";\n"),
        file("src/b.rs", "mod tests {\n    enum Place { A }\n    trait Line {}\n}\n"),
    ];
    assert_eq!(shared(&files), ["Place: src/a.rs, src/b.rs"]);
}
