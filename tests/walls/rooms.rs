//! Rooms of a member: folders whose imports go one way. What a room may know of another one is in the tables here, and
//! nothing else.
//!
//! In the fleet, none of the rooms that decide names or calls another one: what a room may know of another one is an
//! argument. One room stands between two: how robots give way depends on what is believed of people, and is done by
//! routes. It knows these two by a list of names, so a call that is not on it is found there, too.
//!
//! A call counts as one from room to room where the name of the function is declared in one room and nowhere else in
//! the sources: others may be of any type.

use crate::members::absolute;
use crate::tokens::{Token, paths, tokens, without_tests};
use crate::{Violation, all_sources, assert_none};
use std::collections::{BTreeMap, BTreeSet};

/// Each room with those that it may name and call.
type Layers = &'static [(&'static str, &'static [&'static str])];

/// A folder that is divided into rooms.
struct House {
    /// Its place in the tree of modules.
    place: &'static [&'static str],
    /// The path that its files begin with.
    folder: &'static str,
    rooms: Layers,
    /// Rooms that may name what the folder's own file shows, and the files beside it.
    outer: &'static [&'static str],
}

/// `state` knows none, those that decide know `state` alone, `waits` and `read` see the others, and none of these calls
/// them.
const FLEET: Layers = &[
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

/// From what the API needs of the program that runs it, over values and callers, what travels, and feeds, to the state
/// that handlers share. Handlers know all of these, and nothing knows handlers.
const API: Layers = &[
    ("port", &[]),
    ("wire", &[]),
    ("access", &["port", "wire"]),
    ("dto", &["port", "wire", "access"]),
    ("outgoing", &["access", "dto"]),
    ("oidc", &["access", "outgoing"]),
    ("live", &["port", "wire", "dto"]),
    ("recording", &["wire", "dto", "live"]),
    ("feed", &["wire", "dto"]),
    ("page", &["wire", "access"]),
    ("state", &["port", "wire", "access", "dto", "outgoing", "oidc", "live", "recording", "feed"]),
    (
        "http",
        &["port", "wire", "access", "dto", "outgoing", "oidc", "live", "recording", "feed", "page", "state"],
    ),
];

/// Rooms of handlers: each knows what all of them share, and none knows another one.
const HTTP: Layers = &[
    ("shared", &[]),
    ("access", &["shared"]),
    ("describe", &[]),
    ("feeds", &["shared"]),
    ("fleet", &["shared"]),
    ("floor", &["shared"]),
    ("operate", &["shared"]),
    ("orders", &["shared"]),
    ("past", &["shared"]),
    ("people", &["shared"]),
];

/// From chance and the scenario over people, robots and what is measured to the world, its laws, and the loop around it.
/// Randomness, numbers of askers and radio are rooms of one file.
const SIM: Layers = &[
    ("random", &[]),
    ("askers", &[]),
    ("scenario", &[]),
    ("link", &["random", "scenario"]),
    ("walker", &["random", "scenario"]),
    ("picker", &["random", "askers", "scenario"]),
    ("robot", &["walker"]),
    ("arm", &["random", "scenario", "picker"]),
    ("crew", &["random", "askers", "scenario", "link", "walker"]),
    ("customers", &["random", "askers", "scenario"]),
    ("incidents", &["random", "askers", "scenario"]),
    ("measure", &["walker"]),
    (
        "world",
        &[
            "random",
            "askers",
            "scenario",
            "link",
            "walker",
            "picker",
            "robot",
            "arm",
            "crew",
            "customers",
            "incidents",
            "measure",
        ],
    ),
    ("laws", &["arm", "world"]),
    ("recording", &["scenario", "measure"]),
    ("run", &["random", "askers", "scenario", "walker", "customers", "measure", "world", "laws"]),
    ("swarm", &["random", "scenario", "walker", "measure", "laws", "run"]),
];

/// All folders that are divided into rooms. In the fleet, `carry` and `read` may name what it shows to the outside: they
/// are asked from there.
const HOUSES: [House; 4] = [
    House { place: &["fleet"], folder: "src/fleet/", rooms: FLEET, outer: &["carry", "read"] },
    House { place: &["api"], folder: "src/api/", rooms: API, outer: &[] },
    House { place: &["sim"], folder: "src/sim/", rooms: SIM, outer: &[] },
    House { place: &["api", "http"], folder: "src/api/http/", rooms: HTTP, outer: &[] },
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

/// Methods that types of the standard library and of tokio have.
const STD: [&str; 9] = ["clear", "insert", "remove", "extend", "push", "get", "at", "take", "subscribe"];

/// Folders that are no rooms: tests, and modules that stand beside the fleet.
const NO_ROOMS: [&str; 4] = ["src/fleet/tests/", "src/fleet/alarm/", "src/fleet/history/", "src/sim/tests/"];

impl House {
    /// The room of a file, if it is in one. A room may be one file.
    fn room_of<'a>(&self, path: &'a str) -> Option<&'a str> {
        let rest = path.strip_prefix(self.folder)?;
        let Some((room, file)) = rest.split_once('/') else {
            let name = rest.strip_suffix(".rs")?;
            return self.rooms.iter().any(|(room, _)| *room == name).then_some(name);
        };
        let is_test = file.ends_with("tests.rs") || file.contains("tests/") || file.contains("tests_");
        (!is_test && !NO_ROOMS.iter().any(|folder| path.starts_with(folder))).then_some(room)
    }

    /// The folder's name in reports: `fleet`, `api/http`.
    fn name(&self) -> String {
        self.place.join("/")
    }
}

/// Functions that a file declares, and whether each is a method.
fn declared<'a>(code: &[Token<'a>]) -> Vec<(&'a str, bool)> {
    let is_method = |i: usize| {
        let open = (i..code.len()).find(|j| code[*j].text == "(");
        let first = open.and_then(|open| code[open + 1..].iter().find(|t| !["&", "mut"].contains(&t.text)));
        first.is_some_and(|t| t.text == "self")
    };
    let named = (0..code.len().saturating_sub(1)).filter(|i| code[*i].text == "fn");
    named.map(|i| (code[i + 1].text, is_method(i))).collect()
}

/// Names of methods that one file alone declares, of those in a folder.
pub fn declared_once<'a>(files: &'a [(String, String)], folder: &str) -> BTreeMap<&'a str, &'a str> {
    let mut by: BTreeMap<&str, (BTreeSet<&str>, bool)> = BTreeMap::new();
    for (path, text) in files {
        let tokens = tokens(text);
        for (name, is_method) in declared(&without_tests(&tokens)) {
            let (paths, are_methods) = by.entry(name).or_insert((BTreeSet::new(), true));
            paths.insert(path);
            *are_methods &= is_method;
        }
    }
    let once = by
        .into_iter()
        .filter(|(name, (paths, are_methods))| *are_methods && paths.len() == 1 && !STD.contains(name));
    let inside = |path: &&str| path.starts_with(folder);
    once.filter_map(|(name, (paths, _))| Some((name, paths.into_iter().find(inside)?))).collect()
}

/// Calls of methods in a file: line and name.
pub fn calls<'a>(code: &[Token<'a>]) -> Vec<(usize, &'a str)> {
    let called = |w: &&[Token<'a>]| w[0].text == "." && w[2].text == "(";
    code.windows(3).filter(called).map(|w| (w[1].line, w[1].text)).collect()
}

/// Whether a room may name or call this of another one.
fn is_door(house: &House, room: &str, other: &str, name: &str) -> bool {
    let is_one =
        |(from, to, names): &(&str, &str, &[&str])| *from == room && *to == other && names.contains(&name);
    house.place == ["fleet"] && DOORS.iter().any(is_one)
}

/// Rooms that name or call others which they may not know.
fn check_rooms(house: &House, files: &[(String, String)]) -> Vec<Violation> {
    let once = declared_once(files, house.folder);
    let mut found = Vec::new();
    for (path, text) in files {
        let Some(room) = house.room_of(path) else { continue };
        let Some((_, beneath)) = house.rooms.iter().find(|(name, _)| *name == room) else {
            let what = format!("room {room} has no place in tests/walls/rooms.rs");
            found.push(Violation { path: path.clone(), line: 1, what });
            continue;
        };
        let all = house.name();
        let knows = |other: &str| other == room || beneath.contains(&other);
        let tokens = tokens(text);
        let code = without_tests(&tokens);
        let mut add = |line, what| found.push(Violation { path: path.clone(), line, what });
        for (line, segments) in paths(&code) {
            let to = absolute(path, &segments);
            let Some([inner, ..]) = to.as_deref().and_then(|to| to.strip_prefix(house.place)) else {
                continue;
            };
            let is_room = house.rooms.iter().any(|(name, _)| name == inner);
            let name = segments.last().expect("a path has segments");
            if is_room && !knows(inner) && !is_door(house, room, inner, name) {
                add(line, format!("{all}/{room} names {all}/{inner}, which it may not know"));
            } else if !is_room && !house.outer.contains(&room) {
                add(line, format!("{all}/{room} names {inner}, which the whole {all} shows"));
            }
        }
        for (line, name) in calls(&code) {
            let Some(other) = once.get(name).and_then(|path| house.room_of(path)) else { continue };
            if !knows(other) && !is_door(house, room, other, name) {
                add(line, format!("{all}/{room} calls {name} of {all}/{other}, which it may not know"));
            }
        }
    }
    found
}

#[test]
fn rooms_know_those_beneath_them_alone() {
    let files = all_sources();
    let found: Vec<Violation> = HOUSES.iter().flat_map(|house| check_rooms(house, &files)).collect();
    assert_none(&found);
}

#[test]
fn the_tables_have_an_order_in_which_each_room_knows_earlier_ones_alone() {
    for house in &HOUSES {
        let mut earlier = BTreeSet::new();
        for (room, beneath) in house.rooms {
            let later: Vec<_> = beneath.iter().filter(|other| !earlier.contains(*other)).collect();
            assert!(later.is_empty(), "{}/{room} knows {later:?}, which come after it", house.name());
            earlier.insert(room);
        }
    }
}

fn planted(files: &[(&str, &str)]) -> Vec<String> {
    let files: Vec<_> = files.iter().map(|(p, t)| (p.to_string(), t.to_string())).collect();
    let found = HOUSES.iter().flat_map(|house| check_rooms(house, &files));
    found.map(|violation| violation.to_string()).collect()
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
fn an_import_that_goes_up_is_found_in_every_house() {
    let found = planted(&[("src/api/wire/x.rs", "use crate::access::caller::Role;\n")]);
    assert_eq!(found, ["src/api/wire/x.rs:1: api/wire names api/access, which it may not know"]);
    let found = planted(&[("src/api/dto/cell/x.rs", "fn f(_: &crate::state::api::Api) {}\n")]);
    assert_eq!(found, ["src/api/dto/cell/x.rs:1: api/dto names api/state, which it may not know"]);
    let found = planted(&[("src/api/state/x.rs", "use super::super::http::shared::done::done;\n")]);
    assert_eq!(found, ["src/api/state/x.rs:1: api/state names api/http, which it may not know"]);
    let found = planted(&[("src/api/http/floor/x.rs", "use crate::http::{orders::jobs, shared::table};\n")]);
    assert_eq!(
        found,
        ["src/api/http/floor/x.rs:1: api/http/floor names api/http/orders, which it may not know"]
    );
    let found = planted(&[("src/api/http/floor/x.rs", "use crate::Api;\n")]);
    assert_eq!(found, ["src/api/http/floor/x.rs:1: api/http names Api, which the whole api shows"]);
    assert_eq!(planted(&[("src/api/http/x.rs", "use crate::http::orders::jobs;\n")]), [""; 0], "a layer");
    let found = planted(&[("src/sim/walker/x.rs", "use crate::world::World;\n")]);
    assert_eq!(found, ["src/sim/walker/x.rs:1: sim/walker names sim/world, which it may not know"]);
    let found = planted(&[("src/sim/link.rs", "use crate::world::World;\n")]);
    assert_eq!(found, ["src/sim/link.rs:1: sim/link names sim/world, which it may not know"], "one file");
    let found = planted(&[("src/api/attic/x.rs", "")]);
    assert_eq!(found, ["src/api/attic/x.rs:1: room attic has no place in tests/walls/rooms.rs"]);
}

#[test]
fn every_name_that_one_room_may_use_of_another_is_used_there() {
    let sources = all_sources();
    for (from, _, names) in DOORS {
        let of_room: Vec<_> =
            sources.iter().filter(|(path, _)| HOUSES[0].room_of(path) == Some(from)).collect();
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
