//! What is different between two maps, by names: what was added, removed, moved or otherwise changed, and where.
//!
//! Main function: [`differences`]; main type [`Difference`]. Things with the same name are the same thing. Refuses: to
//! judge whether a difference does any harm.

use super::{Lane, NodeKind, Warehouse};
use crate::geometry::Point;
use std::collections::BTreeMap;

/// Distance from its old place beyond which a thing has moved, metres.
const MOVED_M: f64 = 0.0005;

/// How something is different.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum HowDifferent {
    /// Only the new map has it.
    Added,
    /// Only the old map has it.
    Removed,
    /// The thing is elsewhere.
    Moved,
    /// Something else about the thing is different.
    Changed,
}

impl HowDifferent {
    /// `added`, `removed`, `moved` or `changed`.
    pub fn word(self) -> &'static str {
        match self {
            HowDifferent::Added => "added",
            HowDifferent::Removed => "removed",
            HowDifferent::Moved => "moved",
            HowDifferent::Changed => "changed",
        }
    }
}

/// Things of one sort that differ in the same way.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The sort of things, in the plural.
    pub what: &'static str,
    /// How the things differ.
    pub how: HowDifferent,
    /// Names of the things, and where each is: on the new map, or, if it was removed, on the old one.
    pub things: Vec<(String, Point)>,
}

/// Something with a name.
struct Thing {
    at: Point,
    /// All other properties, as a text that is equal if nothing differs.
    rest: String,
}

type Things = BTreeMap<String, Thing>;

/// All differences, by sort and kind of difference; none if the maps are equal.
pub fn differences(old: &Warehouse, new: &Warehouse) -> Vec<Difference> {
    let of_kind = |kind: NodeKind| move |w: &Warehouse| nodes(w, Some(kind));
    let mut found = Vec::new();
    let mut add = |what, things: &dyn Fn(&Warehouse) -> Things| {
        found.extend(compared(what, &things(old), &things(new)));
    };
    add("stations", &stations);
    add("racks", &racks);
    add("storage places", &of_kind(NodeKind::Storage));
    add("chargers", &of_kind(NodeKind::Charger));
    add("parking places", &of_kind(NodeKind::Parking));
    add("doors", &of_kind(NodeKind::Exit));
    add("nodes", &|w| nodes(w, None));
    add("lanes", &lanes);
    add("obstacles", &|w| outlines(&w.obstacles));
    add("floors for people", &|w| outlines(&w.walkable));
    add("marks", &|w| w.marks.iter().map(|m| named(&m.name, m.at, String::new())).collect());
    add("settings of the map", &settings);
    found
}

fn named(name: &str, at: Point, rest: String) -> (String, Thing) {
    (name.to_owned(), Thing { at, rest })
}

/// All nodes, or only those with one purpose.
fn nodes(w: &Warehouse, kind: Option<NodeKind>) -> Things {
    let meant = w.nodes.iter().filter(|n| kind.is_none_or(|kind| n.kind == kind));
    meant.map(|n| named(&n.name, n.at, String::new())).collect()
}

fn stations(w: &Warehouse) -> Things {
    let rest = |s: &super::Station| {
        let queue: Vec<&str> = s.queue.iter().map(|n| w.nodes[*n].name.as_str()).collect();
        format!("{} {queue:?} {:?} {:?}", w.nodes[s.node].name, s.pick, s.cell)
    };
    w.stations.iter().map(|s| named(&s.name, w.nodes[s.node].at, rest(s))).collect()
}

fn racks(w: &Warehouse) -> Things {
    let rest = |r: &super::Rack| {
        let rack_type = r.rack_type.map(|t| &w.rack_types[t]);
        format!("{} {:?} {} {rack_type:?}", w.nodes[r.home].name, r.load, r.weight_kg)
    };
    w.racks.iter().map(|r| named(&r.name, w.nodes[r.home].at, rest(r))).collect()
}

/// Lanes by their ends. A lane between nodes that moved has not changed.
fn lanes(w: &Warehouse) -> Things {
    let thing = |l: &Lane| {
        let (a, b) = (&w.nodes[l.a], &w.nodes[l.b]);
        let name = match l.both {
            true => format!("{}–{}", (&a.name).min(&b.name), (&a.name).max(&b.name)),
            false => format!("{}→{}", a.name, b.name),
        };
        let detour_mm = ((l.length_m - (b.at - a.at).norm()) * 1000.0).round() as i64;
        let rest =
            format!("{:?} {:?} {:?} {:?} {detour_mm}", l.speed_limit_mps, l.users, l.kinds, l.corridor);
        named(&name, a.at + (b.at - a.at) / 2.0, rest)
    };
    w.lanes.iter().map(thing).collect()
}

/// Outlines have no names: a changed outline counts as another one.
fn outlines(all: &[Vec<Point>]) -> Things {
    let name = |ring: &Vec<Point>| {
        ring.iter().map(|p| format!("({:.2}, {:.2})", p.x, p.y)).collect::<Vec<_>>().join(" ")
    };
    all.iter().filter_map(|ring| Some(named(&name(ring), *ring.first()?, String::new()))).collect()
}

fn settings(w: &Warehouse) -> Things {
    let middle = {
        let (low, high) = w.bounds();
        low + (high - low) / 2.0
    };
    let all = [("name", w.name.clone()), ("footprint of robots", format!("{} m", w.footprint_m))];
    all.into_iter().map(|(name, value)| named(name, middle, value)).collect()
}

fn compared(what: &'static str, old: &Things, new: &Things) -> Vec<Difference> {
    let only = |a: &Things, b: &Things| {
        a.iter().filter(|(name, _)| !b.contains_key(*name)).map(|(name, t)| (name.clone(), t.at)).collect()
    };
    let (mut moved, mut changed) = (Vec::new(), Vec::new());
    for (name, now) in new {
        let Some(before) = old.get(name) else { continue };
        let far = (now.at - before.at).norm() > MOVED_M;
        if before.rest != now.rest {
            changed.push((name.clone(), now.at));
        } else if far && !["lanes", "settings of the map"].contains(&what) {
            moved.push((name.clone(), now.at));
        }
    }
    let ways = [
        (HowDifferent::Added, only(new, old)),
        (HowDifferent::Removed, only(old, new)),
        (HowDifferent::Moved, moved),
        (HowDifferent::Changed, changed),
    ];
    let some = ways.into_iter().filter(|(_, things): &(_, Vec<_>)| !things.is_empty());
    some.map(|(how, things)| Difference { what, how, things }).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{DraftNode, Users, lab};
    use super::*;
    use crate::warehouse::formats::json;

    fn text(found: &[Difference]) -> Vec<String> {
        let line = |d: &Difference| {
            let names: Vec<&str> = d.things.iter().map(|(name, _)| name.as_str()).collect();
            format!("{} {}: {}", d.what, d.how.word(), names.join(", "))
        };
        found.iter().map(line).collect()
    }

    #[test]
    fn what_was_added_removed_moved_or_changed_is_named_with_its_place() {
        let old = lab();
        let mut draft = json::parse_draft(&json::write(&old)).unwrap();
        let end = draft.nodes.iter().find(|n| n.name == "R32").unwrap().at;
        let at = end + crate::geometry::Vector::new(1.2, 0.0);
        draft.nodes.push(DraftNode { name: "new".into(), at });
        draft.lanes.push(super::super::DraftLane::both_ways("R32", "new", Users::ALL));
        draft.parking.push("new".into());
        draft.racks.retain(|r| r.name != "K12");
        draft.nodes.iter_mut().find(|n| n.name == "R118").unwrap().at.y += 0.15;
        draft.stations[0].pick = draft.stations[0].pick * 2;
        let found = differences(&old, &draft.build().unwrap());
        let expected = [
            "stations changed: P",
            "racks removed: K12",
            "chargers moved: R118",
            "parking places added: new",
            "nodes added: new",
            "nodes moved: R118",
            "lanes added: R32–new",
        ];
        assert_eq!(text(&found), expected);
        let place = |what, how| found.iter().find(|d| d.what == what && d.how == how).unwrap().things[0].1;
        assert_eq!(place("parking places", HowDifferent::Added), at);
    }

    #[test]
    fn a_map_is_not_different_from_itself() {
        assert_eq!(differences(&lab(), &lab()), []);
    }
}
