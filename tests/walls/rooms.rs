//! Rooms of the fleet: none of those that decide names or calls another one. What a room may know of another one is an
//! argument.
//!
//! One room stands between two: how robots give way depends on what is believed of people, and is done by routes. It
//! knows these two by a list of names, so a call that is not on it is found there, too.
//!
//! A call counts as one from room to room where the name of the function is declared in one room of the fleet and
//! nowhere else in the sources: others may be of any type.

use crate::members::absolute;
use crate::tokens::{Token, paths, tokens, without_tests};
use crate::{Violation, all_sources, assert_none};
use std::collections::{BTreeMap, BTreeSet};

/// Each room with those that it may name and call. `state` knows none, those that decide know `state` alone, `waits`
/// and `read` see the others, and none of these calls them.
const BENEATH: [(&str, &[&str]); 9] = [
    ("state", &[]),
    ("carry", &["state"]),
    ("requests", &["state"]),
    ("people", &["state"]),
    ("dispatch", &["state"]),
    ("traffic", &["state"]),
    ("yielding", &["state"]),
    ("waits", &["state", "people", "traffic", "yielding"]),
    ("read", &["state", "people", "dispatch", "traffic", "yielding", "requests"]),
];

/// What yielding may name and call of two others: beliefs about people, and the routes and revocations that it asks
/// for.
const DOORS: [(&str, &str, &[&str]); 2] = [
    (
        "yielding",
        "people",
        &[
            "ForeseenPerson",
            "HumanState",
            "Led",
            "STROLL_MPS",
            "WalkMode",
            "among_robots",
            "drives_up",
            "done_at",
            "foreseen",
            "forecast",
            "goal_of",
            "rest_of_path",
        ],
    ),
    (
        "yielding",
        "traffic",
        &[
            "Direction",
            "Traffic",
            "better_direction",
            "commit_all",
            "detour",
            "direct",
            "direction",
            "directions_for",
            "is_obstructed_ahead",
            "drives_back_to",
            "drives_into",
            "forget_revoked",
            "grant_waits_for",
            "granted_way",
            "halfway",
            "in_turn",
            "insert",
            "is_revoked",
            "is_spent",
            "kept_by_a_worker",
            "last_reached",
            "plan_again",
            "reroute",
            "revoke_grant",
            "step_out",
            "way_aside",
        ],
    ),
];

/// Rooms that may name what the fleet shows to the outside: they are asked from there.
const OUTER: [&str; 2] = ["carry", "read"];

/// Methods that types of the standard library have.
const STD: [&str; 8] = ["clear", "insert", "remove", "extend", "push", "get", "at", "take"];

/// The room of a file, if it is in one.
fn room_of(path: &str) -> Option<&str> {
    let rest = path.strip_prefix("src/fleet/")?;
    let room = rest.split_once('/')?.0;
    (!["tests", "alarm", "history"].contains(&room)).then_some(room)
}

fn declared<'a>(code: &[Token<'a>]) -> impl Iterator<Item = &'a str> {
    let pairs: Vec<&'a str> = code.windows(2).filter(|p| p[0].text == "fn").map(|p| p[1].text).collect();
    pairs.into_iter()
}

/// Names of functions that one file alone declares, of those in the fleet.
pub fn declared_once(files: &[(String, String)]) -> BTreeMap<&str, &str> {
    let mut by: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (path, text) in files {
        let tokens = tokens(text);
        for name in declared(&without_tests(&tokens)) {
            by.entry(name).or_default().insert(path);
        }
    }
    let once = by.into_iter().filter(|(name, paths)| paths.len() == 1 && !STD.contains(name));
    let of_fleet = |path: &&str| path.starts_with("src/fleet/");
    once.filter_map(|(name, paths)| Some((name, paths.into_iter().find(of_fleet)?))).collect()
}

/// Calls of methods in a file: line and name.
pub fn calls<'a>(code: &[Token<'a>]) -> Vec<(usize, &'a str)> {
    let called = |w: &&[Token<'a>]| w[0].text == "." && w[2].text == "(";
    code.windows(3).filter(called).map(|w| (w[1].line, w[1].text)).collect()
}

/// Whether a room may name or call this of another one.
fn is_door(room: &str, other: &str, name: &str) -> bool {
    DOORS.iter().any(|(from, to, names)| *from == room && *to == other && names.contains(&name))
}

/// Rooms that name or call others which they may not know.
fn check_rooms(files: &[(String, String)]) -> Vec<Violation> {
    let once = declared_once(files);
    let mut found = Vec::new();
    for (path, text) in files {
        let Some(room) = room_of(path) else { continue };
        let Some((_, beneath)) = BENEATH.iter().find(|(name, _)| *name == room) else {
            let what = format!("room {room} has no place in tests/walls/rooms.rs");
            found.push(Violation { path: path.clone(), line: 1, what });
            continue;
        };
        let knows = |other: &str| other == room || beneath.contains(&other);
        let tokens = tokens(text);
        let code = without_tests(&tokens);
        let mut add = |line, what| found.push(Violation { path: path.clone(), line, what });
        for (line, segments) in paths(&code) {
            let to = absolute(path, &segments);
            let Some(["fleet", inner, ..]) = to.as_deref() else { continue };
            let is_room = BENEATH.iter().any(|(name, _)| name == inner);
            let name = segments.last().expect("a path has segments");
            if is_room && !knows(inner) && !is_door(room, inner, name) {
                add(line, format!("fleet/{room} names fleet/{inner}, which it may not know"));
            } else if !is_room && !OUTER.contains(&room) {
                add(line, format!("fleet/{room} names {inner}, which the whole fleet shows"));
            }
        }
        for (line, name) in calls(&code) {
            let Some(other) = once.get(name).and_then(|path| room_of(path)) else { continue };
            if !knows(other) && !is_door(room, other, name) {
                add(line, format!("fleet/{room} calls {name} of fleet/{other}, which it may not know"));
            }
        }
    }
    found
}

#[test]
fn rooms_of_the_fleet_know_those_beneath_them_alone() {
    assert_none(&check_rooms(&all_sources()));
}

fn planted(files: &[(&str, &str)]) -> Vec<String> {
    let files: Vec<_> = files.iter().map(|(p, t)| (p.to_string(), t.to_string())).collect();
    check_rooms(&files).iter().map(Violation::to_string).collect()
}

const SEARCH: (&str, &str) =
    ("src/fleet/traffic/plan.rs", "impl Traffic {\n    fn search_well(&self) {}\n}\n");

#[test]
fn a_call_from_a_room_into_one_that_it_may_not_know_is_found() {
    let call = "fn f(t: &T) {\n    t.search_well()\n}\n";
    let found = planted(&[SEARCH, ("src/fleet/people/x.rs", call)]);
    let what = "fleet/people calls search_well of fleet/traffic, which it may not know";
    assert_eq!(found, [format!("src/fleet/people/x.rs:2: {what}")]);
    for room in ["requests", "dispatch", "yielding", "state"] {
        let path = format!("src/fleet/{room}/x.rs");
        assert_eq!(planted(&[SEARCH, (&path, call)]).len(), 1, "{room}");
    }
    let detour = ("src/fleet/traffic/plan.rs", "impl Traffic {\n    fn detour(&self) {}\n}\n");
    let asks = "fn f(t: &T) {\n    t.detour()\n}\n";
    assert_eq!(planted(&[detour, ("src/fleet/yielding/x.rs", asks)]), [""; 0], "it asks for routes");
    assert_eq!(planted(&[detour, ("src/fleet/dispatch/x.rs", asks)]).len(), 1, "dispatch does not");
    let elsewhere = ("src/floor/geometry.rs", "fn search_well() {}\n");
    assert_eq!(planted(&[SEARCH, elsewhere, ("src/fleet/people/x.rs", call)]), [""; 0], "of which type?");
    let by_a_test = format!("#[cfg(test)]\nmod tests {{\n{call}}}\n");
    assert_eq!(planted(&[SEARCH, ("src/fleet/people/x.rs", &by_a_test)]), [""; 0]);
}

#[test]
fn a_room_that_names_another_or_the_whole_fleet_is_found() {
    let found = planted(&[("src/fleet/state/x.rs", "use crate::{state::fact::Fact, read::view::View};\n")]);
    let what = "fleet/state names fleet/read, which it may not know";
    assert_eq!(found, [format!("src/fleet/state/x.rs:1: {what}")]);
    let found = planted(&[("src/fleet/people/x.rs", "use super::super::traffic::state::Traffic;\n")]);
    assert_eq!(found.len(), 1, "{found:?}");
    let whole = "use crate::Fleet;\n";
    let found = planted(&[("src/fleet/traffic/x.rs", whole)]);
    assert_eq!(found, ["src/fleet/traffic/x.rs:1: fleet/traffic names Fleet, which the whole fleet shows"]);
    assert_eq!(planted(&[("src/fleet/read/x.rs", whole)]), [""; 0]);
    let found = planted(&[("src/fleet/attic/x.rs", "")]);
    assert_eq!(found, ["src/fleet/attic/x.rs:1: room attic has no place in tests/walls/rooms.rs"]);
}

#[test]
fn every_name_that_one_room_may_use_of_another_is_used_there() {
    let sources = all_sources();
    for (from, _, names) in DOORS {
        let of_room: Vec<_> = sources.iter().filter(|(path, _)| room_of(path) == Some(from)).collect();
        let uses = |name: &&str| {
            of_room.iter().any(|(_, text)| {
                let tokens = tokens(text);
                let code = without_tests(&tokens);
                let named = paths(&code).iter().any(|(_, p)| p.last() == Some(name));
                named || calls(&code).iter().any(|(_, n)| n == name)
            })
        };
        let unused: Vec<&&str> = names.iter().filter(|name| !uses(name)).collect();
        assert!(unused.is_empty(), "{from} uses none of {unused:?}: take them off the list");
    }
}
