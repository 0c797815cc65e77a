//! What differs between two maps, as notes for people.
//!
//! Main function: [`notes`]. Refuses: to judge the differences.

use super::matching::{Matching, added};
use giveway_floor::id::{Dense, IdVec, NodeId};
use giveway_floor::warehouse::{NodeKind, Warehouse};
use std::collections::BTreeSet;

/// How many names of a list are given.
const NAMED: usize = 5;
/// A node that is farther from its old place than this has moved, metres.
const MOVED_M: f64 = 0.0005;

/// All differences that matter to a fleet, one note for each kind.
pub(super) fn notes(old: &Warehouse, new: &Warehouse, ids: &Matching) -> Vec<String> {
    let mut notes = Vec::new();
    notes.extend(moved(old, new, ids));
    notes.extend(other_purpose(old, new, ids));
    let mut say = |what: &str, gone: Vec<String>, come: Vec<String>| {
        notes.extend(list(&format!("{what} removed"), gone));
        notes.extend(list(&format!("{what} added"), come));
    };
    let node = |n: NodeId| new.nodes[n].name.clone();
    say("nodes", gone(&ids.nodes, |n| old.nodes[n].name.clone()), names(&ids.nodes, new.nodes.len(), node));
    let (before, after) = (lanes(old), lanes(new));
    let only = |a: &BTreeSet<String>, b: &BTreeSet<String>| a.difference(b).cloned().collect();
    say("lanes", only(&before, &after), only(&after, &before));
    let station = |s| new.stations[s].name.clone();
    let gone_stations = gone(&ids.stations, |s| old.stations[s].name.clone());
    say("stations", gone_stations, names(&ids.stations, new.stations.len(), station));
    let rack = |k| new.racks[k].name.clone();
    say("racks", gone(&ids.racks, |k| old.racks[k].name.clone()), names(&ids.racks, new.racks.len(), rack));
    if (old.footprint_m - new.footprint_m).abs() > MOVED_M {
        notes.push(format!("the footprint of robots is {} m, it was {} m", new.footprint_m, old.footprint_m));
    }
    for body in new.bodies().iter() {
        let before = old.bodies().iter().find(|b| b.kind == body.kind);
        if before.is_some_and(|b| b.footprints != body.footprints) {
            notes.push(format!("robots of kind {} have other footprints", body.kind));
        }
    }
    notes
}

fn gone<I: Dense, T>(ids: &IdVec<I, Option<I>>, name: impl Fn(I) -> T) -> Vec<T> {
    ids.pairs().filter(|(_, new)| new.is_none()).map(|(old, _)| name(old)).collect()
}

fn names<I: Dense + Ord>(ids: &IdVec<I, Option<I>>, new: usize, name: impl Fn(I) -> String) -> Vec<String> {
    added(ids, new).into_iter().map(name).collect()
}

/// Nodes that have moved: how many, and the one that moved the farthest.
fn moved(old: &Warehouse, new: &Warehouse, ids: &Matching) -> Option<String> {
    let pairs = ids.nodes.pairs().filter_map(|(a, b)| Some((a, (*b)?)));
    let far = pairs.map(|(a, b)| ((new.nodes[b].at - old.nodes[a].at).norm(), a));
    let moved: Vec<(f64, NodeId)> = far.filter(|(m, _)| *m > MOVED_M).collect();
    let (far, node) = moved.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)))?;
    let name = &old.nodes[node].name;
    Some(format!("{} nodes moved, by {far:.2} m at most ({name})", moved.len()))
}

/// Nodes that have another purpose now.
fn other_purpose(old: &Warehouse, new: &Warehouse, ids: &Matching) -> Option<String> {
    let pairs = ids.nodes.pairs().filter_map(|(a, b)| Some((a, (*b)?)));
    let other = pairs.filter(|(a, b)| purpose(old, *a) != purpose(new, *b));
    list("nodes for another purpose", other.map(|(a, _)| old.nodes[a].name.clone()).collect())
}

/// What a node is for, by names.
fn purpose(w: &Warehouse, node: NodeId) -> String {
    match w.nodes[node].kind {
        NodeKind::Station(s) | NodeKind::Queue(s) => {
            format!("{:?} {}", w.stations[s].node == node, w.stations[s].name)
        }
        kind => format!("{kind:?}"),
    }
}

/// All lanes by the names of their ends, each with its direction.
fn lanes(w: &Warehouse) -> BTreeSet<String> {
    let text = |l: &giveway_floor::warehouse::Lane| {
        let (a, b) = (&w.nodes[l.a].name, &w.nodes[l.b].name);
        match l.both {
            true => format!("{}–{}", a.min(b), a.max(b)),
            false => format!("{a}→{b}"),
        }
    };
    w.lanes.iter().map(text).collect()
}

/// How many there are, and the names of some; nothing if there are none.
fn list(what: &str, names: Vec<String>) -> Option<String> {
    let more = names.len().saturating_sub(NAMED);
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    let some = names.iter().take(NAMED).map(String::as_str).collect::<Vec<_>>().join(", ");
    (!names.is_empty()).then(|| format!("{} {what}: {some}{rest}", names.len()))
}
