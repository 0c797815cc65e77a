//! The walls between modules: layers, purity, headers, sizes. `src/lib.rs` says why they stand.
//!
//! [`check`] looks at one file, [`check_overview`] at `src/lib.rs`. Both take text, so that violations can be planted
//! here, one of each kind, and must be found with file and line.

mod circles;
mod names;
mod rooms;
mod tokens;

use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;
use tokens::{Token, functions, paths, tokens, without_tests};

/// The core in its order: each may name those before it. `human` and `route` meet only in `aware`.
const CORE: [&str; 15] = [
    "time",
    "id",
    "text",
    "geometry",
    "warehouse",
    "timeline",
    "route",
    "human",
    "aware",
    "reach",
    "cell",
    "local",
    "fleet",
    "history",
    "alarm",
];
/// Pure too, and driving the core.
const AROUND: [&str; 2] = ["sim", "experiment"];
/// The outside world: behind the cargo feature `edge`.
const EDGE: [&str; 5] = ["store", "api", "vda5050", "server", "cli"];

/// Files of `src/api/feed` that are numbers in, numbers out, though they stand at the edge.
const PURE_FEED: [&str; 8] = ["align", "clock", "intake", "joints", "pose", "swap", "thin", "warn"];

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
        "human" => core(6),
        // What people may name, and people.
        "reach" => [core(6), vec!["human"]].concat(),
        // Neither routes nor timelines, nor people beyond arm's length.
        "cell" => [core(5), vec!["reach"]].concat(),
        // People and the floor, neither routes nor timelines.
        "local" => [core(5), vec!["human", "aware"]].concat(),
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
    if !["cli", "main"].contains(&top) {
        check_prints(&code, &mut add);
    }
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

/// Which module names which.
fn check_layers(parts: &[&str], code: &[Token<'_>], add: &mut impl FnMut(usize, String)) {
    let top = parts[0];
    if !is_pure(top) && !EDGE.contains(&top) && top != "main" {
        add(1, format!("module {top} has no place in the layers of tests/walls/main.rs"));
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
    for token in code.iter().filter(|t| t.text == "async" || t.text == "await") {
        add(token.line, format!("pure code uses {}", token.text));
    }
}

/// Nothing prints but commands, whose `println!` and `eprintln!` (`src/cli/out.rs`) outlive a closed pipe.
fn check_prints(code: &[Token<'_>], add: &mut impl FnMut(usize, String)) {
    for pair in code.windows(2).filter(|pair| MACROS.contains(&pair[0].text) && pair[1].text == "!") {
        add(pair[0].line, format!("code outside of src/cli uses {}!", pair[0].text));
    }
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

/// Files and folders that the overview names and that are not there: in each line, a name without a folder is in the
/// folder before it.
fn not_there(text: &str, is_there: impl Fn(&str) -> bool) -> Vec<String> {
    let mut missing = Vec::new();
    for line in text.lines().filter(|l| l.starts_with("//! ") && !l.contains("```")) {
        let mut folder = "";
        for name in line.split('`').skip(1).step_by(2).filter(|n| n.ends_with(".rs") || n.ends_with('/')) {
            let beside = name.rfind('/').is_none().then(|| format!("{folder}{name}"));
            let path = beside.as_deref().unwrap_or(name);
            if !is_there(path) {
                missing.push(path.to_owned());
            }
            folder = name.rfind('/').map_or(folder, |i| &name[..=i]);
        }
    }
    missing
}

#[test]
fn the_overview_names_files_that_are_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("src/lib.rs")).expect("the library");
    let known = |path: &str| {
        let folders = ["src", "src/fleet", "."];
        path.starts_with("vda5050") || folders.iter().any(|f| root.join(f).join(path).exists())
    };
    assert_eq!(not_there(&text, known), [""; 0]);
    let planted = "//! | a | `api/http/`, `gone.rs`; `sim/run.rs`, `away.rs` |";
    assert_eq!(not_there(planted, known), ["api/http/gone.rs", "sim/away.rs"]);
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
    assert_eq!(found, ["src/utils/mod.rs:1: module utils has no place in the layers of tests/walls/main.rs"]);
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
fn prints_that_do_not_outlive_a_closed_pipe_are_found() {
    for name in ["println!", "eprintln!", "print!", "dbg!"] {
        let line = format!("fn f() {{ {name}(\"x\") }}\n");
        for path in ["src/fleet/x.rs", "src/experiment/x.rs", "src/server/x.rs", "src/api/x.rs"] {
            assert_eq!(planted(path, &line), [format!("{path}:5: code outside of src/cli uses {name}")]);
        }
        assert_eq!(planted("src/cli/x.rs", &line), [""; 0]);
    }
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
