//! The walls that Cargo does not keep: the order of modules inside members of the workspace, purity, headers, sizes.
//! `src/giveway/lib.rs` says why they stand.
//!
//! [`check`] looks at one file, [`forgotten`] at `src/giveway/lib.rs`. Both take text, so that violations can be planted
//! here, one of each kind, and must be found with file and line.

mod circles;
mod members;
mod names;
mod numbers;
mod rooms;
mod tokens;

use members::{absolute, is_folder, place};
use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;
use tokens::{Token, functions, paths, tokens, without_tests};

/// The core in its order: each may name those before it. `human` and `route` meet only in `aware`.
const CORE: [&str; 17] = [
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
    "vda5050",
    "site",
];
/// Pure too, and driving the core.
const AROUND: [&str; 4] = ["drive", "sim", "lab", "links"];
/// The outside world.
const EDGE: [&str; 5] = ["store", "api", "mqtt", "server", "cli"];
/// The laboratory's commands, which are no more pure than the product's.
const LAB_COMMANDS: &str = "src/lab/commands/";

/// What of `src/api/feed` is numbers in, numbers out, though it stands at the edge.
const PURE_FEED: [&str; 3] = ["intake", "thin", "warn"];

/// The architecture text.
const OVERVIEW: &str = "src/giveway/lib.rs";
/// The module of the fleet that shows its parts to tests, and its functions.
const INTERNALS: [&str; 2] = ["internals", "internals_mut"];

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
        "sim" => [core(CORE.len()), vec!["drive"]].concat(),
        "lab" => [core(CORE.len()), vec!["drive", "sim", "cli"]].concat(),
        // The messages of a standard know nothing of this house.
        "vda5050" => Vec::new(),
        "drive" | "links" | "store" | "api" | "mqtt" => core(CORE.len()),
        "server" => [core(CORE.len()), AROUND.to_vec(), EDGE[..3].to_vec()].concat(),
        "cli" => [core(CORE.len()), AROUND.to_vec(), EDGE[..4].to_vec()].concat(),
        "main" => vec!["cli", "lab"],
        _ => core(CORE.iter().position(|m| *m == top).unwrap_or(0)),
    }
}

fn is_pure(path: &str) -> bool {
    let place = place(path);
    let feed = matches!(place[..], ["api", "feed", inner, ..] if PURE_FEED.contains(&inner));
    let layer = CORE.contains(&place[0]) || AROUND.contains(&place[0]);
    feed || layer && !path.starts_with(LAB_COMMANDS) && !path.ends_with("/main.rs")
}

/// Everything that is wrong with one file; `path` begins with `src/`.
fn check(path: &str, text: &str) -> Vec<Violation> {
    let place = place(path);
    let top = *place.first().unwrap_or(&"lib");
    let mut found = Vec::new();
    let mut add = |line: usize, what: String| found.push(Violation { path: path.into(), line, what });
    check_shape(path, text, &mut add);
    let tokens = tokens(text);
    for (line, name, lines) in functions(&tokens) {
        if lines > FUNCTION_LINES {
            add(line, format!("function {name} has {lines} lines, more than {FUNCTION_LINES}"));
        }
    }
    let is_test = path.contains("/tests/") || path.ends_with("/tests.rs");
    if place.is_empty() || is_test || path.ends_with("/build.rs") {
        return found;
    }
    let code = without_tests(&tokens);
    check_layers(path, &code, &mut add);
    if !["cli", "main"].contains(&top) && !path.starts_with(LAB_COMMANDS) {
        check_prints(&code, &mut add);
    }
    if is_pure(path) {
        check_purity(path, &code, &mut add);
    }
    found.sort_by_key(|v| v.line);
    found
}

/// Header, length, width.
fn check_shape(path: &str, text: &str, add: &mut impl FnMut(usize, String)) {
    let header: Vec<&str> = text.lines().take_while(|l| l.starts_with("//!")).collect();
    if header.is_empty() {
        add(1, "the file does not open with `//!`".into());
    }
    let place = place(path);
    let is_module = !place.is_empty() && (is_folder(path) || place.len() == 1 && !path.ends_with("/main.rs"));
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
fn check_layers(path: &str, code: &[Token<'_>], add: &mut impl FnMut(usize, String)) {
    let top = place(path)[0];
    if !CORE.contains(&top) && !AROUND.contains(&top) && !EDGE.contains(&top) && top != "main" {
        add(1, format!("module {top} has no place in the layers of tests/walls/main.rs"));
    }
    let shows = ["src/fleet/lib.rs", "src/fleet/internals.rs"].contains(&path);
    for token in code.iter().filter(|t| INTERNALS.contains(&t.text) && !shows) {
        add(token.line, format!("{top} names {} of the fleet, which is for tests alone", token.text));
    }
    let allowed = may_name(top);
    for (line, segments) in paths(code) {
        let Some(to) = absolute(path, &segments) else { continue };
        // What the root of a member declares may be named by all of that member: Cargo keeps the order of members.
        let Some(named) = to.first().filter(|_| segments.len() > 1) else { continue };
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

/// Nothing prints but commands, whose `println!` and `eprintln!` (`src/giveway/cli/out.rs`) outlive a closed pipe.
fn check_prints(code: &[Token<'_>], add: &mut impl FnMut(usize, String)) {
    for pair in code.windows(2).filter(|pair| MACROS.contains(&pair[0].text) && pair[1].text == "!") {
        add(pair[0].line, format!("code outside of commands uses {}!", pair[0].text));
    }
}

/// The text before the code of the overview.
fn overview(text: &str) -> String {
    text.lines().take_while(|l| l.starts_with("//!")).map(|l| format!("{l}\n")).collect()
}

/// Modules of the tree that the overview does not name.
fn forgotten<'a>(overview: &str, paths: impl Iterator<Item = &'a str>) -> BTreeSet<&'a str> {
    let tops = paths.filter_map(|path| place(path).first().copied()).filter(|top| *top != "main");
    tops.filter(|top| !overview.contains(&format!("`{top}`")) && !overview.contains(&format!("{top}/")))
        .collect()
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
fn the_overview_names_every_module() {
    let files = all_sources();
    let text = &files.iter().find(|(path, _)| path == OVERVIEW).expect("the overview").1;
    let paths = || files.iter().map(|(path, _)| path.as_str());
    assert_eq!(forgotten(&overview(text), paths()), BTreeSet::new());
    let planted = ["src/floor/attic/mod.rs", "src/floor/time.rs"].into_iter();
    assert_eq!(forgotten("//! [`time`]", planted), BTreeSet::from(["attic"]));
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
    let text = std::fs::read_to_string(root.join(OVERVIEW)).expect("the library");
    let known = |path: &str| {
        let folders = ["src", "src/fleet", "src/floor", "src/people", "src/giveway", "."];
        path.starts_with("vda5050") || folders.iter().any(|f| root.join(f).join(path).exists())
    };
    assert_eq!(not_there(&text, known), [""; 0]);
    let planted = "//! | a | `api/http/`, `gone.rs`; `sim/random.rs`, `away.rs` |";
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
    let body = "use giveway_floor::time::Time;\nuse giveway_fleet::Fleet;\n";
    assert_eq!(
        planted("src/floor/route/x.rs", body),
        ["src/floor/route/x.rs:6: route names fleet, which it may not know"]
    );
    assert_eq!(planted("src/fleet/x.rs", body), [""; 0]);
}

#[test]
fn a_path_in_a_group_in_an_expression_or_through_super_is_found_too() {
    let body = "use giveway_floor::{\n    id::NodeId,\n    route::{Route, search::Search},\n};\n";
    let found = planted("src/people/human/x.rs", body);
    assert_eq!(found.len(), 2, "{found:?}");
    assert_eq!(found[0], "src/people/human/x.rs:7: human names route, which it may not know");
    let found = planted("src/floor/time.rs", "fn f() -> u8 {\n    crate::id::number()\n}\n");
    assert_eq!(found, ["src/floor/time.rs:6: time names id, which it may not know"]);
    let found =
        planted("src/people/human/x.rs", "use super::super::aware::Effects;\nuse super::track::Track;\n");
    assert_eq!(found, ["src/people/human/x.rs:5: human names aware, which it may not know"]);
}

#[test]
fn parts_of_the_edge_that_name_each_other_are_found() {
    for (path, other) in
        [("store", "api"), ("api", "store"), ("api", "sim"), ("vda5050", "api"), ("sim", "store")]
    {
        let found = planted(&format!("src/{path}/x.rs"), &format!("use giveway_{other}::Thing;\n"));
        assert_eq!(found, [format!("src/{path}/x.rs:5: {path} names {other}, which it may not know")]);
    }
    assert_eq!(
        planted("src/giveway/server/x.rs", "use giveway_api::Api;\nuse giveway_sim::World;\n"),
        [""; 0]
    );
}

#[test]
fn people_and_routes_meet_nowhere_but_in_aware() {
    let found = planted("src/people/human/x.rs", "use giveway_floor::route::Route;\n");
    assert_eq!(found, ["src/people/human/x.rs:5: human names route, which it may not know"]);
    assert_eq!(planted("src/floor/route/x.rs", "use giveway_people::human::Belief;\n").len(), 1);
    assert_eq!(
        planted("src/people/aware/x.rs", "use crate::human::Belief;\nuse giveway_floor::route::Route;\n"),
        [""; 0]
    );
}

#[test]
fn a_module_without_a_place_in_the_layers_is_found() {
    let found = planted("src/floor/utils/mod.rs", "fn f() {}\n");
    assert_eq!(
        found,
        ["src/floor/utils/mod.rs:1: module utils has no place in the layers of tests/walls/main.rs"]
    );
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
        for path in ["src/fleet/x.rs", "src/sim/x.rs", "src/lab/x.rs"] {
            let found = planted(path, &format!("const A: u8 = 1;\n{line}\n"));
            assert_eq!(found, [format!("{path}:6: pure code uses {name}")], "{line}");
        }
        assert_eq!(planted("src/giveway/server/x.rs", line), [""; 0], "{line}");
    }
    assert_eq!(planted(CHANCE, "use rand_pcg::Pcg64Mcg;\n"), [""; 0]);
}

#[test]
fn prints_that_do_not_outlive_a_closed_pipe_are_found() {
    for name in ["println!", "eprintln!", "print!", "dbg!"] {
        let line = format!("fn f() {{ {name}(\"x\") }}\n");
        for path in ["src/fleet/x.rs", "src/lab/x.rs", "src/giveway/server/x.rs", "src/api/x.rs"] {
            assert_eq!(planted(path, &line), [format!("{path}:5: code outside of commands uses {name}")]);
        }
        assert_eq!(planted("src/giveway/cli/x.rs", &line), [""; 0]);
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
    use giveway_sim::World;
    fn g() { println!("{{") }
}
"##;
    assert_eq!(planted("src/fleet/x.rs", body), [""; 0]);
    let after = format!("{body}use std::fs;\n");
    assert_eq!(planted("src/fleet/x.rs", &after), ["src/fleet/x.rs:18: pure code uses std::fs"]);
    assert_eq!(planted("src/fleet/tests/x.rs", "use giveway_sim::World;\nuse std::fs;\n"), [""; 0]);
}

#[test]
fn a_file_without_a_header_and_a_module_with_a_poor_one_are_found() {
    let texts = |path, text| check(path, text).iter().map(Violation::to_string).collect::<Vec<_>>();
    assert_eq!(
        texts("src/fleet/x.rs", "use std::fmt;\n"),
        ["src/fleet/x.rs:1: the file does not open with `//!`"]
    );
    let found = texts("src/fleet/lib.rs", "//! The core.\n//! Main types: none.\n");
    assert_eq!(found.len(), 2, "{found:?}");
    assert_eq!(found[0], "src/fleet/lib.rs:1: the module's header has 2 lines, fewer than 3");
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
    let found = planted("src/giveway/cli/x.rs", &format!("fn f() {{}}\n// {}\n", "ö".repeat(118)));
    assert_eq!(found, ["src/giveway/cli/x.rs:6: the line is 121 characters wide, more than 120"]);
}

#[test]
fn the_internals_of_the_fleet_are_shown_to_tests_alone() {
    let found = planted("src/sim/x.rs", "use giveway_fleet::internals::Internals;\n");
    assert_eq!(found, ["src/sim/x.rs:5: sim names internals of the fleet, which is for tests alone"]);
    let found = planted("src/sim/x.rs", "fn f(fleet: &Fleet) {\n    fleet.internals().floor()\n}\n");
    assert_eq!(found, ["src/sim/x.rs:6: sim names internals of the fleet, which is for tests alone"]);
    assert_eq!(planted("src/fleet/tests/x.rs", "use giveway_fleet::internals::Internals;\n"), [""; 0]);
}
