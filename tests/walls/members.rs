//! The modules of all members of the workspace as one tree: `src/floor/route/search.rs` is `route::search`, and
//! `src/fleet/lib.rs` is `fleet`.
//!
//! Main functions: [`place`], [`absolute`].

/// Members whose modules stand at the top of the tree. The others are one module each.
const FLAT: [&str; 3] = ["floor", "people", "giveway"];
/// Modules of the fleet that stand beside it.
const BESIDE_FLEET: [&str; 2] = ["alarm", "history"];

/// What `member::rest` is in the tree.
fn of_member<'a>(member: &'a str, rest: &[&'a str]) -> Vec<&'a str> {
    let is_beside = member == "fleet" && rest.first().is_some_and(|m| BESIDE_FLEET.contains(m));
    if FLAT.contains(&member) || is_beside { rest.to_vec() } else { [&[member], rest].concat() }
}

/// The member of a file, and its path inside it.
fn split(path: &str) -> (&str, &str) {
    let inner = path.strip_prefix("src/").expect("a file below src/").trim_end_matches(".rs");
    inner.split_once('/').unwrap_or((inner, ""))
}

/// The place of a file in the tree.
pub fn place(path: &str) -> Vec<&str> {
    let (member, inner) = split(path);
    let parts: Vec<&str> = inner.split('/').filter(|part| !["mod", "lib", ""].contains(part)).collect();
    of_member(member, &parts)
}

/// Whether a file shows what is in its folder: `mod.rs`, `lib.rs`.
pub fn is_folder(path: &str) -> bool {
    path.ends_with("/mod.rs") || path.ends_with("/lib.rs")
}

/// The place that a path in a file leads to, if it does not begin where it stands or in a foreign crate.
pub fn absolute<'a>(path: &'a str, segments: &[&'a str]) -> Option<Vec<&'a str>> {
    let ups = segments.iter().take_while(|s| **s == "super").count();
    if ups > 0 {
        let mut at = place(path);
        at.truncate(at.len().saturating_sub(ups));
        return Some([&at, &segments[ups..]].concat());
    }
    match segments[0] {
        "crate" => Some(of_member(split(path).0, &segments[1..])),
        "giveway" => Some(segments[1..].to_vec()),
        other => Some(of_member(other.strip_prefix("giveway_")?, &segments[1..])),
    }
}

#[test]
fn files_and_paths_have_their_places_in_the_tree() {
    assert_eq!(place("src/floor/route/search.rs"), ["route", "search"]);
    assert_eq!(place("src/floor/time.rs"), ["time"]);
    assert_eq!(place("src/fleet/lib.rs"), ["fleet"]);
    assert_eq!(place("src/fleet/alarm/mod.rs"), ["alarm"]);
    assert_eq!(place("src/giveway/server/drive.rs"), ["server", "drive"]);
    let file = "src/fleet/traffic/plan.rs";
    assert_eq!(absolute(file, &["crate", "state", "x"]).unwrap(), ["fleet", "state", "x"]);
    assert_eq!(absolute(file, &["super", "super", "read"]).unwrap(), ["fleet", "read"]);
    assert_eq!(absolute(file, &["giveway_floor", "time", "Time"]).unwrap(), ["time", "Time"]);
    assert_eq!(absolute(file, &["giveway_fleet", "history"]).unwrap(), ["history"]);
    assert_eq!(absolute("tests/x.rs", &["giveway", "fleet", "Fleet"]).unwrap(), ["fleet", "Fleet"]);
    assert_eq!(absolute(file, &["std", "fmt"]), None);
}
