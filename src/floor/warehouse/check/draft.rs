//! Names and numbers of a draft: unknown, duplicate, absurd.
//!
//! Main functions: [`names_and_numbers`], [`without_bad_parts`]. Refuses: to look at routes through the building, which
//! need ids.

use super::place::FindingPlace;
use super::{Doubts, Findings, cell, corridor};
use crate::geometry::{FARTHEST_M, OutlineFault, Point, outline_area_m2};
use crate::text::{NameFault, name_fault};
use crate::warehouse::build::{Draft, DraftLane, DraftRack};
use std::collections::{BTreeMap, BTreeSet};

/// Largest number of nodes: more than any building has; keeps a broken file from taking all memory.
const NODES_MAX: usize = 200_000;
/// Greatest length of a lane, metres.
const LANE_MAX_M: f64 = 1_000.0;
/// Least share of the straight distance that a stated length may have.
const SHORTCUT: f64 = 0.99;
/// Greatest width of a robot with its rack, metres.
const FOOTPRINT_MAX_M: f64 = 10.0;
/// Greatest speed on a lane, metres per second.
const SPEED_MAX_MPS: f64 = 50.0;
/// Largest number of arrival headings of a node: they are counted in a byte.
const ARRIVALS_MAX: usize = 255;
/// Longest name, characters: names are for people.
const NAME_MAX: usize = 80;
/// Greatest weight of a rack, kilograms: heavier ones are a mistake in the unit.
const WEIGHT_MAX_KG: f64 = 100_000.0;

/// Checks all that can be checked of a draft before its names are turned into ids.
pub(in crate::warehouse) fn names_and_numbers(draft: &Draft) -> Result<(), Findings> {
    let mut found = Findings::default();
    if draft.nodes.is_empty() {
        found.add("nodes", "there are none", "add at least one place where robots can stand");
    }
    if draft.nodes.len() > NODES_MAX {
        found.add("nodes", format!("{} of them", draft.nodes.len()), format!("keep below {NODES_MAX}"));
        return found.into_result();
    }
    let f = draft.footprint_m;
    if !is_footprint(f) {
        let remedy = format!("give the side of a robot with its rack, above 0 and up to {FOOTPRINT_MAX_M} m");
        found.add("footprint_m", format!("{f} m"), remedy);
    }
    let at = nodes(draft, &mut found);
    lanes(draft, &at, &mut found);
    stations(draft, &mut found);
    cell::cells(draft, &at, &mut found);
    cell::rack_types(draft, &mut found);
    racks(draft, &mut found);
    roles(draft, &at, &mut found);
    outlines(draft, &mut found);
    marks(draft, &at, &mut found);
    found.into_result()
}

/// Checks names and positions of the nodes; returns the position of each name.
fn nodes<'a>(draft: &'a Draft, found: &mut Findings) -> BTreeMap<&'a str, Point> {
    let mut at = BTreeMap::new();
    for node in &draft.nodes {
        let place = FindingPlace::of(format!("node {}", node.name), [&node.name]);
        good_name(&node.name, &place, found);
        if at.insert(node.name.as_str(), node.at).is_some() {
            found.add(&place, "the name is used twice", "rename one of the two");
        }
        if is_far(node.at) {
            let problem = format!("it stands at ({}, {})", node.at.x, node.at.y);
            found.add(&place, problem, format!("give metres within ±{FARTHEST_M} of the map's zero"));
        }
    }
    at
}

fn is_footprint(f: f64) -> bool {
    f.is_finite() && f > 0.0 && f <= FOOTPRINT_MAX_M
}

pub(super) fn is_far(p: Point) -> bool {
    [p.x, p.y].iter().any(|v| !v.is_finite() || v.abs() > FARTHEST_M)
}

pub(super) fn good_name(name: &str, place: &FindingPlace, found: &mut Findings) {
    if let Some(fault) = name_fault(name, NAME_MAX) {
        let problem = match fault {
            NameFault::Length(_) => "its name is empty or too long".to_owned(),
            _ => format!("its name \"{}\" can be taken for another one", name.escape_debug()),
        };
        found.add(place, problem, fault.to_string());
    }
}

/// Whether corners are a valid outline.
pub(super) fn good_outline(corners: &[Point], place: &FindingPlace, found: &mut Findings) -> bool {
    let fault = outline_area_m2(corners).err();
    if let Some(fault) = fault {
        let problem = match fault {
            OutlineFault::Corners(_) => "it is no outline",
            OutlineFault::Far(_) => "a corner is nowhere",
            OutlineFault::Flat(_) => "it has no width",
            OutlineFault::Crosses(..) => "the area that it encloses is not the one that its corners go round",
        };
        found.add(place, problem, fault.to_string());
    }
    fault.is_none()
}

fn lanes(draft: &Draft, at: &BTreeMap<&str, Point>, found: &mut Findings) {
    let mut ways: BTreeSet<(&str, &str)> = BTreeSet::new();
    let mut arrivals: BTreeMap<&str, usize> = BTreeMap::new();
    for lane in &draft.lanes {
        one_lane(lane, at, &mut ways, found);
        *arrivals.entry(lane.to.as_str()).or_default() += 1;
        if lane.both {
            *arrivals.entry(lane.from.as_str()).or_default() += 1;
        }
    }
    for (name, count) in arrivals.into_iter().filter(|(_, count)| *count > ARRIVALS_MAX) {
        let problem = format!("{count} lanes end here");
        let place = FindingPlace::of(format!("node {name}"), [name]);
        found.add(place, problem, format!("keep to at most {ARRIVALS_MAX}"));
    }
}

/// Checks a lane by itself and against the `ways` of those before it.
fn one_lane<'a>(
    lane: &'a DraftLane,
    at: &BTreeMap<&str, Point>,
    ways: &mut BTreeSet<(&'a str, &'a str)>,
    found: &mut Findings,
) {
    let place = FindingPlace::of(format!("lane {}–{}", lane.from, lane.to), [&lane.from, &lane.to]);
    lane_numbers(lane, &place, found);
    match (at.get(lane.from.as_str()), at.get(lane.to.as_str())) {
        // Absurd positions are reported with their nodes.
        (Some(&a), Some(&b)) if is_far(a) || is_far(b) => {}
        (Some(&a), Some(&b)) if lane.from != lane.to => lane_length(lane, &place, (b - a).norm(), found),
        (Some(_), Some(_)) => found.add(&place, "it ends where it starts", "remove it"),
        (a, b) => {
            let unknown = [(a, &lane.from), (b, &lane.to)];
            for (_, name) in unknown.iter().filter(|(node, _)| node.is_none()) {
                found.add(&place, format!("there is no node {name}"), "add the node or correct the name");
            }
        }
    }
    let (from, to) = (lane.from.as_str(), lane.to.as_str());
    let directions = [(from, to), (to, from)];
    for way in &directions[..if lane.both { 2 } else { 1 }] {
        if !ways.insert(*way) && from != to {
            let problem = format!("a second lane from {} to {}", way.0, way.1);
            found.add(&place, problem, "keep one of them");
        }
    }
}

fn lane_numbers(lane: &DraftLane, place: &FindingPlace, found: &mut Findings) {
    let u = lane.users;
    if !(u.loaded || u.unloaded || u.people) {
        found.add(place, "nothing may use it", "name loaded, unloaded or people, or remove it");
    }
    for kind in lane.kinds.iter().flatten() {
        good_name(kind, place, found);
    }
    if lane.kinds.as_ref().is_some_and(Vec::is_empty) {
        found.add(place, "no robot kind may use it", "name kinds, or leave `kinds` out");
    }
    if let Some(widths) = lane.corridor {
        corridor::widths(widths, place, found);
    }
    if let Some(v) = lane.speed_limit_mps
        && !(v > 0.0 && v <= SPEED_MAX_MPS)
    {
        let remedy = format!("give metres per second, above 0 and up to {SPEED_MAX_MPS}");
        found.add(place, format!("its speed limit is {v} m/s"), remedy);
    }
}

fn lane_length(lane: &DraftLane, place: &FindingPlace, straight: f64, found: &mut Findings) {
    let length = lane.length_m.unwrap_or(straight);
    if length.is_nan() || length <= 0.0 {
        found.add(place, format!("its length is {length} m"), "move its ends apart or merge them");
    } else if length > LANE_MAX_M || straight > LANE_MAX_M {
        let problem = format!("it is {:.0} m long", length.max(straight));
        found.add(place, problem, format!("put nodes in between; a lane is at most {LANE_MAX_M} m long"));
    } else if length < straight * SHORTCUT {
        let problem = format!("{length} m is shorter than the straight distance of {straight:.3} m");
        found.add(place, problem, "give the driven length or leave it out");
    }
}

fn stations(draft: &Draft, found: &mut Findings) {
    let mut names = BTreeSet::new();
    for station in &draft.stations {
        let line = std::iter::once(&station.node).chain(&station.queue);
        let place = FindingPlace::of(format!("station {}", station.name), line);
        good_name(&station.name, &place, found);
        if !names.insert(station.name.as_str()) {
            found.add(&place, "the name is used twice", "rename one of the two");
        }
        if station.pick.0 < 0 || station.pick.as_secs_f64() > 86_400.0 {
            let problem = format!("a pick of {} s", station.pick.as_secs_f64());
            found.add(&place, problem, "give seconds between 0 and a day");
        }
    }
}

fn racks(draft: &Draft, found: &mut Findings) {
    let storage: BTreeSet<&str> = draft.storage.iter().map(String::as_str).collect();
    let (mut names, mut taken) = (BTreeSet::new(), BTreeMap::new());
    for DraftRack { name, node, weight_kg, load, .. } in &draft.racks {
        let place = FindingPlace::of(format!("rack {name}"), [node]);
        good_name(name, &place, found);
        if let Some(load) = load {
            good_name(load, &place, found);
        }
        if !(0.0..=WEIGHT_MAX_KG).contains(weight_kg) {
            let remedy = format!("give kilograms from 0 to {WEIGHT_MAX_KG}");
            found.add(&place, format!("it weighs {weight_kg} kg"), remedy);
        }
        if !names.insert(name.as_str()) {
            found.add(&place, "the name is used twice", "rename one of the two");
        }
        if !storage.contains(node.as_str()) {
            found.add(&place, format!("{node} is not a storage node"), "add it to storage or move the rack");
        }
        if let Some(other) = taken.insert(node.as_str(), name) {
            found.add(&place, format!("rack {other} stands on {node} too"), "move one of them");
        }
    }
}

/// Checks that every node has one role at most, and that every role has an existing node.
fn roles(draft: &Draft, at: &BTreeMap<&str, Point>, found: &mut Findings) {
    let lists = [
        ("storage", &draft.storage),
        ("chargers", &draft.chargers),
        ("parking", &draft.parking),
        ("exits", &draft.exits),
    ];
    let plain = lists.iter().flat_map(|(role, names)| names.iter().map(|n| (role.to_string(), n)));
    let stands = draft.stations.iter().map(|s| (format!("station {}", s.name), &s.node));
    let queues = (draft.stations.iter())
        .flat_map(|s| s.queue.iter().map(move |n| (format!("the queue of station {}", s.name), n)));
    let mut known: BTreeMap<&str, String> = BTreeMap::new();
    for (role, name) in plain.chain(stands).chain(queues) {
        if !at.contains_key(name.as_str()) {
            found.add(role, format!("there is no node {name}"), "add the node or correct the name");
        } else if let Some(other) = known.get(name.as_str()) {
            let problem = if *other == role {
                format!("listed twice in {role}")
            } else {
                format!("listed in {other} and in {role}")
            };
            let place = FindingPlace::of(format!("node {name}"), [name]);
            found.add(place, problem, "a node has one role: keep one entry");
        } else {
            known.insert(name, role);
        }
    }
}

fn outlines(draft: &Draft, found: &mut Findings) {
    for (kind, outlines) in [("walkable", &draft.walkable), ("obstacles", &draft.obstacles)] {
        for (i, outline) in outlines.iter().enumerate() {
            let place = FindingPlace::outline(format!("outline {} of {kind}", i + 1), outline);
            good_outline(outline, &place, found);
        }
    }
}

fn marks(draft: &Draft, at: &BTreeMap<&str, Point>, found: &mut Findings) {
    let mut names = BTreeSet::new();
    for mark in &draft.marks {
        let place = FindingPlace::from(format!("mark {}", mark.name));
        good_name(&mark.name, &place, found);
        if !names.insert(mark.name.as_str()) {
            found.add(&place, "the name is used twice", "rename one of the two");
        }
        if is_far(mark.at) {
            let problem = format!("it is at ({}, {})", mark.at.x, mark.at.y);
            found.add(&place, problem, format!("give metres within ±{FARTHEST_M} of the map's zero"));
        }
        if at.get(mark.name.as_str()).is_some_and(|node| *node != mark.at) {
            found.add(&place, "a node elsewhere has this name", "rename the mark, or put it at the node");
        }
    }
}

/// A bad draft without its bad parts, and the places that this leaves in doubt: enough to look for problems of the
/// floor too. Nothing if there are no nodes, or far too many.
pub(in crate::warehouse) fn without_bad_parts(draft: &Draft) -> Option<(Draft, Doubts)> {
    if draft.nodes.is_empty() || draft.nodes.len() > NODES_MAX {
        return None;
    }
    let (mut rest, mut doubts) = (draft.clone(), Doubts::default());
    if !is_footprint(rest.footprint_m) {
        // With no footprint, nothing overlaps: conflicts of robots need a valid one.
        rest.footprint_m = 0.0;
    }
    let mut at: BTreeMap<&str, Point> = BTreeMap::new();
    rest.nodes.clear();
    for node in &draft.nodes {
        if !is_far(node.at) && !at.contains_key(node.name.as_str()) {
            at.insert(&node.name, node.at);
            rest.nodes.push(node.clone());
        } else {
            doubts.places.insert(node.name.clone());
        }
    }
    let mut ways = BTreeSet::new();
    rest.lanes.clear();
    for lane in &draft.lanes {
        let mut wrong = Findings::default();
        one_lane(lane, &at, &mut ways, &mut wrong);
        if wrong.0.is_empty() {
            rest.lanes.push(lane.clone());
        } else {
            doubts.places.extend([lane.from.clone(), lane.to.clone()]);
        }
    }
    keep_good_roles(&mut rest, &at, &mut doubts);
    // The floor is the same with and without racks.
    rest.racks.clear();
    Some((rest, doubts))
}

/// Drops roles of unknown nodes, and all but the first role of each node; a station is dropped as a whole.
fn keep_good_roles(rest: &mut Draft, at: &BTreeMap<&str, Point>, doubts: &mut Doubts) {
    let mut taken: BTreeSet<String> = BTreeSet::new();
    let mut is_good = |name: &String| at.contains_key(name.as_str()) && taken.insert(name.clone());
    let Doubts { places, stays } = doubts;
    for (list, lasting) in [
        (&mut rest.storage, true),
        (&mut rest.chargers, true),
        (&mut rest.parking, true),
        (&mut rest.exits, false),
    ] {
        let (good, bad) = std::mem::take(list).into_iter().partition(|name| is_good(name));
        *list = good;
        *stays |= lasting && !Vec::is_empty(&bad);
        places.extend(bad);
    }
    rest.stations.retain(|s| {
        let line = || std::iter::once(&s.node).chain(&s.queue);
        let mut good = true;
        for name in line() {
            good &= is_good(name);
        }
        if !good {
            places.extend(line().cloned());
        }
        good
    });
}
