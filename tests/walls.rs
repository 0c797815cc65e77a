//! The walls between modules: layers, purity, headers, sizes. `src/lib.rs` says why they stand.
//!
//! [`check`] looks at one file, [`check_overview`] at `src/lib.rs`. Both take text, so that violations can be planted
//! here, one of each kind, and must be found with file and line.

use petgraph::algo::tarjan_scc;
use petgraph::graph::{DiGraph, NodeIndex};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::path::Path;

/// The core in its order: each may name those before it. `human` and `route` meet only in `aware`.
const CORE: [&str; 10] =
    ["time", "id", "geometry", "warehouse", "timeline", "route", "human", "aware", "fleet", "history"];
/// Pure too, and driving the core.
const AROUND: [&str; 2] = ["sim", "experiment"];
/// The outside world: behind the cargo feature `edge`.
const EDGE: [&str; 5] = ["store", "api", "vda5050", "server", "cli"];

/// Files of `src/api/feed` that are numbers in, numbers out, though they stand at the edge.
const PURE_FEED: [&str; 6] = ["align", "clock", "intake", "pose", "thin", "warn"];

/// Rooms of `fleet` that build on its state.
const ROOMS: [&str; 7] = ["requests", "people", "yielding", "dispatch", "traffic", "read", "carry"];
/// Modules inside which imports go one way. In the others a folder's file and those inside it still share types.
const ONE_WAY: [&str; 4] = ["aware", "history", "sim", "api"];

const FILE_LINES: usize = 600;
const FUNCTION_LINES: usize = 70;
const WIDTH: usize = 120;
const HEADER_LINES: usize = 3;

/// Crates of the outside world, and of chance.
const CRATES: [&str; 15] = [
    "tokio",
    "axum",
    "sqlx",
    "reqwest",
    "hyper",
    "tower",
    "tower_http",
    "rumqttc",
    "clap",
    "anyhow",
    "jiff",
    "rand",
    "rand_core",
    "rand_chacha",
    "rand_pcg",
];
/// Modules of `std` that reach outside.
const STD: [&str; 6] = ["fs", "net", "env", "thread", "process", "os"];
/// Clocks, hash order, locks.
const TYPES: [&str; 8] =
    ["Instant", "SystemTime", "HashMap", "HashSet", "RandomState", "Mutex", "RwLock", "Condvar"];
const MACROS: [&str; 5] = ["println", "eprintln", "print", "eprint", "dbg"];
/// The one place for random numbers.
const CHANCE: &str = "src/sim/random.rs";

#[derive(Debug, PartialEq, Eq)]
struct Violation {
    path: String,
    line: usize,
    what: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.path, self.line, self.what)
    }
}

/// Modules that a top module may name, besides itself.
fn may_name(top: &str) -> Vec<&'static str> {
    let core = |n: usize| CORE[..n].to_vec();
    match top {
        "human" => core(5),
        "experiment" => [core(CORE.len()), vec!["sim"]].concat(),
        "sim" | "store" | "api" | "vda5050" => core(CORE.len()),
        "server" => [core(CORE.len()), AROUND.to_vec(), EDGE[..3].to_vec()].concat(),
        "cli" => [core(CORE.len()), AROUND.to_vec(), EDGE[..4].to_vec()].concat(),
        "main" => vec!["cli"],
        _ => core(CORE.iter().position(|m| *m == top).unwrap_or(0)),
    }
}

fn is_pure(top: &str) -> bool {
    CORE.contains(&top) || AROUND.contains(&top)
}

/// Everything that is wrong with one file; `path` begins with `src/`.
fn check(path: &str, text: &str) -> Vec<Violation> {
    let inner = path.strip_prefix("src/").expect("a file below src/").trim_end_matches(".rs");
    let parts: Vec<&str> = inner.split('/').collect();
    let top = parts[0];
    let mut found = Vec::new();
    let mut add = |line: usize, what: String| found.push(Violation { path: path.into(), line, what });
    check_shape(&parts, text, &mut add);
    let tokens = tokens(text);
    for (line, name, lines) in functions(&tokens) {
        if lines > FUNCTION_LINES {
            add(line, format!("function {name} has {lines} lines, more than {FUNCTION_LINES}"));
        }
    }
    let is_test = parts.contains(&"tests");
    if top == "lib" || is_test {
        return found;
    }
    let code = without_tests(&tokens);
    check_layers(&parts, &code, &mut add);
    check_rooms(&parts, &code, &mut add);
    if is_pure(top) || matches!(parts[..], ["api", "feed", file] if PURE_FEED.contains(&file)) {
        check_purity(path, &code, &mut add);
    }
    found.sort_by_key(|v| v.line);
    found
}

/// Header, length, width.
fn check_shape(parts: &[&str], text: &str, add: &mut impl FnMut(usize, String)) {
    let header: Vec<&str> = text.lines().take_while(|l| l.starts_with("//!")).collect();
    if header.is_empty() {
        add(1, "the file does not open with `//!`".into());
    }
    let is_module =
        parts.last() == Some(&"mod") || (parts.len() == 1 && !["lib", "main"].contains(&parts[0]));
    if is_module && header.len() < HEADER_LINES {
        add(1, format!("the module's header has {} lines, fewer than {HEADER_LINES}", header.len()));
    }
    if is_module && !header.iter().any(|l| l.contains("Refuses")) {
        add(1, "the module's header does not say what it refuses (`Refuses: …`)".into());
    }
    let lines = text.lines().count();
    if lines > FILE_LINES {
        add(lines, format!("the file has {lines} lines, more than {FILE_LINES}"));
    }
    for (i, line) in text.lines().enumerate() {
        let width = line.chars().count();
        if width > WIDTH {
            add(i + 1, format!("the line is {width} characters wide, more than {WIDTH}"));
        }
    }
}

/// Who names whom.
fn check_layers(parts: &[&str], code: &[Token<'_>], add: &mut impl FnMut(usize, String)) {
    let top = parts[0];
    if !is_pure(top) && !EDGE.contains(&top) && top != "main" {
        add(1, format!("module {top} has no place in the layers of tests/walls.rs"));
    }
    let depth = if parts.last() == Some(&"mod") { parts.len() - 1 } else { parts.len() };
    let allowed = may_name(top);
    for (line, path) in paths(code) {
        let supers = path.iter().take_while(|s| **s == "super").count();
        let root = ["crate", "giveway"].contains(&path[0]);
        let named = match (root, supers > 0 && supers >= depth) {
            (true, _) => path.get(1),
            (_, true) => path.get(supers),
            _ => None,
        };
        let Some(named) = named else { continue };
        if *named != top && !allowed.contains(named) {
            add(line, format!("{top} names {named}, which it may not know"));
        }
    }
}

/// Inside `fleet`, what was promised and what is seen know no other room.
fn check_rooms(parts: &[&str], code: &[Token<'_>], add: &mut impl FnMut(usize, String)) {
    let ["fleet", "state", ..] = parts else { return };
    for (line, path) in paths(code) {
        let room = match path[..] {
            ["crate" | "giveway", "fleet", room, ..] => room,
            ["super", "super", room, ..] if parts.len() == 3 => room,
            _ => continue,
        };
        if ROOMS.contains(&room) {
            add(line, format!("fleet/state names fleet/{room}, another room"));
        }
    }
}

/// No clock, no outside world, no hash order, no lock, no chance.
fn check_purity(file: &str, code: &[Token<'_>], add: &mut impl FnMut(usize, String)) {
    for (line, path) in paths(code) {
        let chance_is_allowed = file == CHANCE && path[0] == "rand_pcg";
        if CRATES.contains(&path[0]) && !chance_is_allowed {
            add(line, format!("pure code uses {}", path.join("::")));
        }
        if path[0] == "std" && path.get(1).is_some_and(|m| STD.contains(m)) {
            add(line, format!("pure code uses {}", path.join("::")));
        }
        if let Some(name) = path.iter().find(|s| TYPES.contains(s)) {
            add(line, format!("pure code uses {name}"));
        }
    }
    for pair in code.windows(2) {
        if pair[0].text == "async" || pair[0].text == "await" {
            add(pair[0].line, format!("pure code uses {}", pair[0].text));
        }
        if MACROS.contains(&pair[0].text) && pair[1].text == "!" {
            add(pair[0].line, format!("pure code uses {}!", pair[0].text));
        }
    }
}

/// The module of a file, by its path below `src`.
fn module_of(path: &str) -> Vec<&str> {
    let inner = path.strip_prefix("src/").expect("a file below src/").trim_end_matches(".rs");
    inner.split('/').filter(|part| *part != "mod").collect()
}

/// Leaves out what a folder shows of its inside.
fn without_exports<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    let mut kept: Vec<Token<'a>> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let after = if tokens.get(i + 1).is_some_and(|t| t.text == "(") { i + 5 } else { i + 1 };
        let shown = (after.saturating_sub(1)..=after)
            .any(|j| tokens[i].text == "pub" && tokens.get(j).is_some_and(|t| t.text == "use"));
        if shown {
            i = (i..tokens.len()).find(|j| tokens[*j].text == ";").map_or(tokens.len(), |j| j + 1);
        } else {
            kept.push(tokens[i]);
            i += 1;
        }
    }
    kept
}

/// The circles of imports among files of one top module: those of each circle, sorted.
fn circles(top: &str, files: &[(String, String)]) -> Vec<Vec<String>> {
    let files: Vec<&(String, String)> = files.iter().filter(|(p, _)| module_of(p)[0] == top).collect();
    let modules: BTreeMap<Vec<&str>, usize> =
        files.iter().enumerate().map(|(i, (path, _))| (module_of(path), i)).collect();
    let mut graph = DiGraph::<usize, ()>::new();
    (0..files.len()).for_each(|i| _ = graph.add_node(i));
    for (i, (path, text)) in files.iter().enumerate() {
        let tokens = tokens(text);
        let code = without_exports(&without_tests(&tokens));
        // `pub(in crate::api)` names a module and takes nothing from it.
        let takes = |segments: &[&str]| segments.len() > 1 && *segments != ["crate", top];
        for (_, segments) in paths(&code).into_iter().filter(|(_, segments)| takes(segments)) {
            let ups = segments.iter().take_while(|s| **s == "super").count();
            let mut at = module_of(path);
            let rest = match segments[0] {
                "crate" | "giveway" => {
                    at.clear();
                    &segments[1..]
                }
                "self" => &segments[1..],
                _ => {
                    at.truncate(at.len().saturating_sub(ups));
                    &segments[ups..]
                }
            };
            // The deepest module that has a file; the rest of the path is what is taken from it.
            let ends = (0..=rest.len()).rev().map(|n| [&at, &rest[..n]].concat());
            let named = ends.filter(|m| m.len() > at.len() || ups > 0).find_map(|m| modules.get(&m));
            let edge = |other: &usize| graph.update_edge(NodeIndex::new(i), NodeIndex::new(*other), ());
            named.filter(|other| **other != i).map(edge);
        }
    }
    let name = |i: &NodeIndex| files[i.index()].0.clone();
    let mut found: Vec<Vec<String>> =
        tarjan_scc(&graph).iter().filter(|c| c.len() > 1).map(|c| c.iter().map(name).collect()).collect();
    found.iter_mut().for_each(|circle| circle.sort());
    found.sort();
    found
}

/// `src/lib.rs` names every top module in its text and keeps the edge behind its feature.
fn check_overview(text: &str) -> Vec<Violation> {
    let header: String = text.lines().take_while(|l| l.starts_with("//!")).collect();
    let mut found = Vec::new();
    let mut before = "";
    for (i, line) in text.lines().enumerate() {
        if let Some(name) = line.strip_prefix("pub mod ").and_then(|l| l.strip_suffix(';')) {
            let mut add =
                |what: String| found.push(Violation { path: "src/lib.rs".into(), line: i + 1, what });
            if !header.contains(&format!("`{name}`")) && !header.contains(&format!("{name}/")) {
                add(format!("the text above does not name module {name}"));
            }
            if EDGE.contains(&name) != before.contains("feature = \"edge\"") {
                add(format!("module {name} is on the wrong side of the feature `edge`"));
            }
        }
        before = line;
    }
    found
}

#[derive(Clone, Copy, Debug)]
struct Token<'a> {
    line: usize,
    text: &'a str,
}

/// Words, `::` and signs; without comments, texts, numbers and lifetimes.
fn tokens(text: &str) -> Vec<Token<'_>> {
    let bytes = text.as_bytes();
    let (mut i, mut line, mut found) = (0, 1, Vec::new());
    while i < bytes.len() {
        let rest = &text[i..];
        let step = match bytes[i] {
            b'/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            b'/' if rest.starts_with("/*") => block_comment(rest),
            b'"' => plain_text(rest, 1),
            b'b' if rest.starts_with("b\"") => plain_text(rest, 2),
            b'r' | b'b' if raw_text(rest).is_some() => raw_text(rest).expect("just seen"),
            b'\'' => letter_or_lifetime(rest),
            b':' if rest.starts_with("::") => 2,
            b if b.is_ascii_alphanumeric() || b == b'_' => {
                rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())
            }
            _ => rest.chars().next().map_or(1, char::len_utf8),
        };
        let token = &text[i..i + step];
        let first = bytes[i];
        let is_word = first.is_ascii_alphabetic() || first == b'_';
        let is_text = is_word && token.contains('"');
        let is_sign = first.is_ascii_punctuation() && !"\"'".contains(first as char) && token.len() <= 2;
        if (is_word && !is_text) || (is_sign && !token.starts_with("//")) {
            found.push(Token { line, text: token });
        }
        line += token.matches('\n').count();
        i += step;
    }
    found
}

fn block_comment(rest: &str) -> usize {
    let (mut depth, mut i) = (0, 0);
    while i < rest.len() {
        match &rest.as_bytes()[i..] {
            [b'/', b'*', ..] => (depth, i) = (depth + 1, i + 2),
            [b'*', b'/', ..] if depth == 1 => return i + 2,
            [b'*', b'/', ..] => (depth, i) = (depth - 1, i + 2),
            _ => i += 1,
        }
    }
    rest.len()
}

/// The length of a text whose first quote ends at `from`.
fn plain_text(rest: &str, from: usize) -> usize {
    let mut escaped = false;
    for (i, b) in rest.bytes().enumerate().skip(from) {
        match b {
            _ if escaped => escaped = false,
            b'\\' => escaped = true,
            b'"' => return i + 1,
            _ => {}
        }
    }
    rest.len()
}

fn raw_text(rest: &str) -> Option<usize> {
    let after = rest.strip_prefix("br").or(rest.strip_prefix('r'))?;
    let hashes = after.len() - after.trim_start_matches('#').len();
    let body = after[hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    let start = rest.len() - body.len();
    Some(body.find(&end).map_or(rest.len(), |i| start + i + end.len()))
}

/// `'a'`, `'\n'` are letters; `'a` is a lifetime.
fn letter_or_lifetime(rest: &str) -> usize {
    let mut chars = rest.char_indices().skip(1);
    match (chars.next(), chars.next()) {
        (Some((_, '\\')), Some(_)) => rest[3..].find('\'').map_or(rest.len(), |i| i + 4),
        (Some(_), Some((i, '\''))) => i + 1,
        _ => rest[1..].find(|c: char| !c.is_alphanumeric() && c != '_').map_or(rest.len(), |i| i + 1),
    }
}

/// The index behind the bracket that closes the one at `open`.
fn behind_block(tokens: &[Token<'_>], open: usize) -> usize {
    let mut depth = 0;
    for (i, t) in tokens.iter().enumerate().skip(open) {
        match t.text {
            "{" => depth += 1,
            "}" if depth == 1 => return i + 1,
            "}" => depth -= 1,
            _ => {}
        }
    }
    tokens.len()
}

/// Leaves out every item under `#[cfg(test)]`.
fn without_tests<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    let marker = ["#", "[", "cfg", "(", "test", ")", "]"];
    let (mut i, mut kept) = (0, Vec::new());
    while i < tokens.len() {
        let marked = tokens[i..].iter().map(|t| t.text).take(marker.len()).eq(marker);
        if !marked {
            kept.push(tokens[i]);
            i += 1;
            continue;
        }
        let end = (i..tokens.len()).find(|j| ["{", ";"].contains(&tokens[*j].text));
        i = match end {
            Some(j) if tokens[j].text == "{" => behind_block(tokens, j),
            Some(j) => j + 1,
            None => tokens.len(),
        };
    }
    kept
}

/// Every path as its segments, groups in braces taken apart.
fn paths<'a>(tokens: &[Token<'a>]) -> Vec<(usize, Vec<&'a str>)> {
    let mut found = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let goes_on = i > 0 && ["::", "."].contains(&tokens[i - 1].text);
        i = if is_word(tokens[i]) && !goes_on { path(tokens, i, &[], &mut found) } else { i + 1 };
    }
    found
}

fn is_word(t: Token<'_>) -> bool {
    t.text.starts_with(|c: char| c.is_alphabetic() || c == '_') || t.text == "*"
}

/// One path from the word at `i` on; gives the index behind it.
fn path<'a>(
    tokens: &[Token<'a>],
    mut i: usize,
    prefix: &[&'a str],
    found: &mut Vec<(usize, Vec<&'a str>)>,
) -> usize {
    let (line, mut segments) = (tokens[i].line, prefix.to_vec());
    segments.push(tokens[i].text);
    i += 1;
    while tokens.get(i).is_some_and(|t| t.text == "::") {
        match tokens.get(i + 1) {
            Some(t) if is_word(*t) => {
                segments.push(t.text);
                i += 2;
            }
            Some(t) if t.text == "{" => {
                let end = behind_block(tokens, i + 1);
                i += 2;
                while i + 1 < end {
                    i = if is_word(tokens[i]) { path(tokens, i, &segments, found) } else { i + 1 };
                }
                return end;
            }
            _ => break,
        }
    }
    found.push((line, segments));
    i
}

/// Every function with a body: line, name, lines.
fn functions<'a>(tokens: &[Token<'a>]) -> Vec<(usize, &'a str, usize)> {
    let mut found = Vec::new();
    for (i, pair) in tokens.windows(2).enumerate() {
        if pair[0].text != "fn" || !is_word(pair[1]) {
            continue;
        }
        let mut depth = 0;
        let body = (i..tokens.len()).find(|j| {
            match tokens[*j].text {
                "(" | "[" => depth += 1,
                ")" | "]" => depth -= 1,
                _ => {}
            }
            depth == 0 && ["{", ";"].contains(&tokens[*j].text)
        });
        if let Some(open) = body.filter(|j| tokens[*j].text == "{") {
            let last = tokens[behind_block(tokens, open) - 1].line;
            found.push((pair[0].line, pair[1].text, last + 1 - pair[0].line));
        }
    }
    found
}

fn sources(folder: &Path, found: &mut Vec<(String, String)>) {
    let mut entries: Vec<_> =
        std::fs::read_dir(folder).expect("the sources are here").flatten().map(|e| e.path()).collect();
    entries.sort();
    for entry in entries {
        if entry.is_dir() {
            sources(&entry, found);
        } else if entry.extension().is_some_and(|e| e == "rs") {
            let inner = entry.strip_prefix(env!("CARGO_MANIFEST_DIR")).expect("below the manifest");
            let text = std::fs::read_to_string(&entry).expect("sources are text");
            found.push((inner.to_string_lossy().replace('\\', "/"), text));
        }
    }
}

fn all_sources() -> Vec<(String, String)> {
    let mut found = Vec::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut found);
    assert!(found.len() > 40, "only {} files seen", found.len());
    found
}

fn assert_none(found: &[Violation]) {
    let text: Vec<String> = found.iter().map(Violation::to_string).collect();
    assert!(found.is_empty(), "{} violations:\n{}", found.len(), text.join("\n"));
}

#[test]
fn the_sources_keep_their_walls() {
    let found: Vec<Violation> = all_sources().iter().flat_map(|(path, text)| check(path, text)).collect();
    assert_none(&found);
}

#[test]
fn the_overview_names_every_module_and_keeps_the_edge_behind_its_feature() {
    let files = all_sources();
    let lib = &files.iter().find(|(path, _)| path == "src/lib.rs").expect("the library").1;
    assert_none(&check_overview(lib));
    let tops: BTreeSet<&str> = (files.iter())
        .map(|(path, _)| path["src/".len()..].split('/').next().expect("a name").trim_end_matches(".rs"))
        .filter(|top| !["lib", "main"].contains(top))
        .collect();
    let forgotten: Vec<_> = tops.iter().filter(|top| !lib.contains(&format!("pub mod {top};"))).collect();
    assert!(forgotten.is_empty(), "src/lib.rs does not declare {forgotten:?}");
}

#[test]
fn no_files_of_a_module_import_one_another_in_a_circle() {
    let files = all_sources();
    let found: Vec<Vec<String>> = ONE_WAY.iter().flat_map(|top| circles(top, &files)).collect();
    assert!(found.is_empty(), "{} circles:\n{found:#?}", found.len());
}

#[test]
fn a_circle_of_imports_is_found_wherever_it_is_closed() {
    let file = |path: &str, body: &str| (format!("src/api/{path}.rs"), body.to_owned());
    let circle = [
        file("mod", "pub use a::A;\npub(crate) use c::C;\nmod a;\n"),
        file("a", "use super::b::{self, B};\n"),
        file("b/mod", "mod inner;\nfn f() { crate::api::c::C.g() }\n"),
        file("b/inner", "use super::super::c::C;\n"),
        file("c", "use crate::{api::a::A, id::NodeId};\n"),
    ];
    assert_eq!(circles("api", &circle), [["src/api/a.rs", "src/api/b/mod.rs", "src/api/c.rs"]]);
    let open =
        [&circle[..4], &[file("c", "#[cfg(test)]\nmod tests {\n    use super::super::a::A;\n}\n")]].concat();
    assert_eq!(circles("api", &open), [[""; 0]; 0]);
    let through_the_top = [file("mod", "use a::A;\npub struct Api(A);\n"), file("a", "use super::Api;\n")];
    assert_eq!(circles("api", &through_the_top), [["src/api/a.rs", "src/api/mod.rs"]]);
}

/// The text with a good header in front; planted lines begin at line 5.
fn with_header(body: &str) -> String {
    format!("//! A planted file.\n//!\n//! Refuses: nothing that the tests do not know.\n\n{body}")
}

fn planted(path: &str, body: &str) -> Vec<String> {
    check(path, &with_header(body)).iter().map(Violation::to_string).collect()
}

#[test]
fn a_module_that_names_one_below_it_is_found() {
    let body = "use crate::time::Time;\nuse crate::fleet::Fleet;\n";
    assert_eq!(
        planted("src/route/x.rs", body),
        ["src/route/x.rs:6: route names fleet, which it may not know"]
    );
    assert_eq!(planted("src/fleet/x.rs", body), [""; 0]);
}

#[test]
fn a_path_in_a_group_in_an_expression_or_through_super_is_found_too() {
    let body = "use crate::{\n    id::NodeId,\n    sim::{World, laws::Laws},\n};\n";
    let found = planted("src/fleet/x.rs", body);
    assert_eq!(found.len(), 2, "{found:?}");
    assert_eq!(found[0], "src/fleet/x.rs:7: fleet names sim, which it may not know");
    let found = planted("src/time.rs", "fn f() -> u8 {\n    crate::id::number()\n}\n");
    assert_eq!(found, ["src/time.rs:6: time names id, which it may not know"]);
    let found = planted("src/fleet/x.rs", "use super::super::sim::World;\nuse super::ledger::Ledger;\n");
    assert_eq!(found, ["src/fleet/x.rs:5: fleet names sim, which it may not know"]);
    let found = planted("src/fleet/mod.rs", "use super::*;\n");
    assert_eq!(found, ["src/fleet/mod.rs:5: fleet names *, which it may not know"]);
}

#[test]
fn the_state_of_the_fleet_that_names_another_room_is_found() {
    let found = planted("src/fleet/state/x.rs", "use crate::fleet::{state::fact::Fact, read::view::View};\n");
    assert_eq!(found, ["src/fleet/state/x.rs:5: fleet/state names fleet/read, another room"]);
    let found = planted("src/fleet/state/x.rs", "use super::super::people::state::Crowd;\n");
    assert_eq!(found, ["src/fleet/state/x.rs:5: fleet/state names fleet/people, another room"]);
    assert_eq!(planted("src/fleet/read/x.rs", "use crate::fleet::state::fact::Fact;\n"), [""; 0]);
}

#[test]
fn parts_of_the_edge_that_name_each_other_are_found() {
    for (path, other) in
        [("store", "api"), ("api", "store"), ("api", "sim"), ("vda5050", "api"), ("sim", "server")]
    {
        let found = planted(&format!("src/{path}/x.rs"), &format!("use crate::{other}::Thing;\n"));
        assert_eq!(found, [format!("src/{path}/x.rs:5: {path} names {other}, which it may not know")]);
    }
    assert_eq!(planted("src/server/x.rs", "use crate::{store, api, sim};\n"), [""; 0]);
}

#[test]
fn people_and_routes_meet_nowhere_but_in_aware() {
    let found = planted("src/human/x.rs", "use crate::route::Route;\n");
    assert_eq!(found, ["src/human/x.rs:5: human names route, which it may not know"]);
    assert_eq!(planted("src/route/x.rs", "use crate::human::Belief;\n").len(), 1);
    assert_eq!(planted("src/aware/x.rs", "use crate::{human::Belief, route::Route};\n"), [""; 0]);
}

#[test]
fn a_module_without_a_place_in_the_layers_is_found() {
    let found = planted("src/utils/mod.rs", "fn f() {}\n");
    assert_eq!(found, ["src/utils/mod.rs:1: module utils has no place in the layers of tests/walls.rs"]);
}

#[test]
fn every_kind_of_impurity_is_found_at_its_line() {
    for (line, name) in [
        ("use tokio::sync::mpsc;", "tokio::sync::mpsc"),
        ("use axum::Router;", "axum::Router"),
        ("fn f(p: sqlx::SqlitePool) {}", "sqlx::SqlitePool"),
        ("use reqwest::Client;", "reqwest::Client"),
        ("use std::{collections::BTreeMap, fs};", "std::fs"),
        ("use std::net::TcpStream;", "std::net::TcpStream"),
        ("fn f() -> bool { std::env::var(\"X\").is_ok() }", "std::env::var"),
        ("fn f() { std::thread::yield_now() }", "std::thread::yield_now"),
        ("use std::process::exit;", "std::process::exit"),
        ("use std::time::Instant;", "Instant"),
        ("fn f() { SystemTime::now(); }", "SystemTime"),
        ("fn f(m: &HashMap<u8, u8>) {}", "HashMap"),
        ("use std::collections::HashSet;", "HashSet"),
        ("use std::sync::Mutex;", "Mutex"),
        ("use rand::random;", "rand::random"),
        ("use rand_pcg::Pcg64Mcg;", "rand_pcg::Pcg64Mcg"),
        ("async fn f() {}", "async"),
        ("fn f() { println!(\"x\") }", "println!"),
        ("fn f() { eprintln!(\"x\") }", "eprintln!"),
    ] {
        for path in ["src/fleet/x.rs", "src/sim/x.rs", "src/experiment/x.rs"] {
            let found = planted(path, &format!("const A: u8 = 1;\n{line}\n"));
            assert_eq!(found, [format!("{path}:6: pure code uses {name}")], "{line}");
        }
        assert_eq!(planted("src/server/x.rs", line), [""; 0], "{line}");
    }
    assert_eq!(planted(CHANCE, "use rand_pcg::Pcg64Mcg;\n"), [""; 0]);
}

#[test]
fn comments_texts_and_test_modules_are_no_violations() {
    let body = r##"
// use tokio::x; HashMap, async
/* println!("x") /* Instant */ std::fs::read */
/// Like [`crate::server`], but `std::net`.
const A: &str = "crate::sim::World \" println!(";
const B: &str = r#"std::fs "HashMap" "#;
fn f<'a>(x: &'a str) -> (&'a str, char, char, u8) { (x, '"', '\'', b'"') }
#[cfg(test)]
mod tests {
    use std::collections::HashMap;
    use crate::sim::World;
    fn g() { println!("{{") }
}
"##;
    assert_eq!(planted("src/fleet/x.rs", body), [""; 0]);
    let after = format!("{body}use std::fs;\n");
    assert_eq!(planted("src/fleet/x.rs", &after), ["src/fleet/x.rs:18: pure code uses std::fs"]);
    assert_eq!(planted("src/fleet/tests.rs", "use crate::sim::World;\nuse std::fs;\n"), [""; 0]);
}

#[test]
fn a_file_without_a_header_and_a_module_with_a_poor_one_are_found() {
    let texts = |path, text| check(path, text).iter().map(Violation::to_string).collect::<Vec<_>>();
    assert_eq!(
        texts("src/fleet/x.rs", "use std::fmt;\n"),
        ["src/fleet/x.rs:1: the file does not open with `//!`"]
    );
    let found = texts("src/fleet/mod.rs", "//! The core.\n//! Main types: none.\n");
    assert_eq!(found.len(), 2, "{found:?}");
    assert_eq!(found[0], "src/fleet/mod.rs:1: the module's header has 2 lines, fewer than 3");
    assert!(found[1].contains("does not say what it refuses"), "{found:?}");
    assert_eq!(texts("src/fleet/x.rs", "//! Short is enough inside.\n"), [""; 0]);
}

#[test]
fn long_files_long_functions_and_wide_lines_are_found() {
    let found = planted("src/fleet/x.rs", &"const A: u8 = 1;\n".repeat(FILE_LINES));
    assert_eq!(found, ["src/fleet/x.rs:604: the file has 604 lines, more than 600"]);
    let body = format!("fn short() {{}}\nfn long(x: [u8; 2]) {{\n{}}}\n", "    f();\n".repeat(69));
    let found = planted("src/fleet/x.rs", &body);
    assert_eq!(found, ["src/fleet/x.rs:6: function long has 71 lines, more than 70"]);
    let found = planted("src/cli/x.rs", &format!("fn f() {{}}\n// {}\n", "ö".repeat(118)));
    assert_eq!(found, ["src/cli/x.rs:6: the line is 121 characters wide, more than 120"]);
}

#[test]
fn a_module_that_the_overview_forgets_or_leaves_in_front_of_the_feature_is_found() {
    let text = "//! The parts: [`time`], [`store`].\n\npub mod time;\npub mod id;\npub mod store;\n";
    let found: Vec<String> = check_overview(text).iter().map(Violation::to_string).collect();
    assert_eq!(
        found,
        [
            "src/lib.rs:4: the text above does not name module id",
            "src/lib.rs:5: module store is on the wrong side of the feature `edge`",
        ]
    );
    let good = text
        .replace("pub mod id;\n", "")
        .replace("pub mod store", "#[cfg(feature = \"edge\")]\npub mod store");
    assert_none(&check_overview(&good));
}
