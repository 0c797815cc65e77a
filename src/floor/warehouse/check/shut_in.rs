//! Where a broken robot shuts others in: a warning, since people can push a broken robot aside.
//!
//! A robot is shut in if every way from its node to a place where it may stay leads over the node of the broken robot.
//! Ways are those that the search knows: lanes have users and kinds, a loaded robot needs a storage node, and the
//! places of a station are for robots bound for it or on their way out. For one broken robot these are the nodes that
//! its node dominates in the graph of reversed lanes, with one sink behind all places to stay: O(nodes and lanes) for
//! all nodes together. A node or a lane in conflict with that node is blocked, too: such nodes are searched one by one,
//! exactly, with the footprint of the map, which contains that of every kind. Each place where robots can be shut in is
//! reported once, with the node that shuts in the most. Places to stay are not reported: a robot there is in no other
//! robot's way.
//!
//! Two things are left out. A robot that breaks down while it drives keeps all nodes that it was granted. And places to
//! stay may be taken.
//!
//! Main type: [`ShutIn`]; main functions: [`shut_in`], [`shut_in_text`]. Refuses: to refuse a map.

use super::place::FindingPlace;
use super::{Findings, list};
use crate::id::{ArcId, Dense, IdVec, NodeId, StationId};
use crate::warehouse::{Arc, NodeKind, Warehouse};
use petgraph::algo::dominators::simple_fast;
use petgraph::graph::{DiGraph, NodeIndex};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Number of lines about dead ends that are shown; a program gets them all.
const SHOWN: usize = 10;

/// Where robots can be shut in, and the node on which a broken robot does it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ShutIn {
    /// The broken robot's node: of the nodes that shut these in, the one that shuts in the most.
    pub broken_on: String,
    /// Which robots are shut in: "robots", "loaded robots", "unloaded robots"; of which kinds, if not all.
    pub robots: String,
    /// Stations where the shut-in robots are, or whose queues they are in.
    pub stations: Vec<String>,
    /// Nodes from which the robots cannot leave.
    pub shut_in: Vec<String>,
    /// What to do about it.
    pub remedy: &'static str,
}

/// A group of robots: of a kind that lanes name, or of none that any lane names; without or with a rack.
type Mode<'a> = (Option<&'a str>, bool);
/// The broken robot's node, and the nodes that it shuts in.
type Group = (NodeId, BTreeSet<NodeId>);

/// All places where a broken robot would shut others in.
pub fn shut_in(w: &Warehouse) -> Vec<ShutIn> {
    let named = w.lanes.iter().flat_map(|l| l.kinds.iter().flatten()).map(String::as_str);
    let mut kinds: BTreeSet<Option<&str>> = named.map(Some).collect();
    kinds.insert(None);
    let mut found: BTreeMap<Group, Vec<Mode<'_>>> = BTreeMap::new();
    for mode in kinds.iter().flat_map(|kind| [(*kind, false), (*kind, true)]) {
        let ways = WaysOut::of(w, mode);
        for group in ways.groups() {
            found.entry(group).or_default().push(mode);
        }
    }
    let mut all: Vec<ShutIn> =
        found.into_iter().map(|((on, nodes), modes)| told(w, on, &nodes, (&modes, kinds.len()))).collect();
    all.sort_by_key(|s| std::cmp::Reverse(s.shut_in.len()));
    all
}

/// Text about these for people: one line for each dead end, and one for stations that are alike.
pub fn shut_in_text(all: &[ShutIn]) -> Vec<String> {
    let (at_stations, ends): (Vec<&ShutIn>, Vec<&ShutIn>) = all.iter().partition(|s| !s.stations.is_empty());
    // Loaded and unloaded robots may be shut in on more or fewer nodes by the same station.
    let mut by_station: BTreeMap<&[String], (BTreeSet<&str>, usize)> = BTreeMap::new();
    for s in at_stations {
        let (robots, nodes) = by_station.entry(&s.stations).or_default();
        robots.insert(&s.robots);
        *nodes = s.shut_in.len().max(*nodes);
    }
    let mut alike: BTreeMap<(&str, usize), Vec<&str>> = BTreeMap::new();
    for (stations, (robots, nodes)) in by_station {
        let one = robots.first().filter(|_| robots.len() == 1);
        let names = stations.iter().map(String::as_str);
        alike.entry((one.copied().unwrap_or("robots"), nodes)).or_default().extend(names);
    }
    let mut lines: Vec<String> =
        alike.into_iter().map(|((robots, nodes), names)| at_station(robots, nodes, &names)).collect();
    lines.extend(ends.iter().take(SHOWN).map(|s| {
        let names: Vec<&str> = s.shut_in.iter().map(String::as_str).collect();
        let (on, robots, nodes) = (&s.broken_on, &s.robots, counted(names.len()));
        format!(
            "node {on}: if a robot breaks down there, {robots} on {nodes} ({}) cannot leave: {END}",
            list(&names)
        )
    }));
    if ends.len() > SHOWN {
        lines.push(format!("and {} more dead ends: --json lists them all", ends.len() - SHOWN));
    }
    lines
}

/// The entries as findings with their places, one for each.
pub(super) fn remarks_of(all: &[ShutIn]) -> Findings {
    let mut found = Findings::default();
    for s in all {
        let words = match &s.stations[..] {
            [] => format!("node {}", s.broken_on),
            [station] => format!("station {station}"),
            many => format!("stations {}", many.join(", ")),
        };
        let (on, robots, nodes) = (&s.broken_on, &s.robots, counted(s.shut_in.len()));
        let place = FindingPlace::of(words, s.shut_in.iter().chain([on]));
        found.add(
            place,
            format!("if a robot breaks down at {on}, {robots} on {nodes} cannot leave"),
            s.remedy,
        );
    }
    found
}

fn at_station(robots: &str, nodes: usize, names: &[&str]) -> String {
    let (count, which, nodes) = (names.len(), list(names), counted(nodes));
    let what = if count == 1 { format!("station {which}") } else { format!("{count} stations ({which})") };
    format!(
        "{what}: if a robot breaks down there or on the way out, {robots} on up to {nodes} cannot leave: {QUEUE}"
    )
}

const QUEUE: &str = "add a lane from the queue to open floor, or a bay";
const END: &str = "add a bay, or a lane that leads out";

fn counted(nodes: usize) -> String {
    if nodes == 1 { "one node".into() } else { format!("{nodes} nodes") }
}

fn told(w: &Warehouse, on: NodeId, nodes: &BTreeSet<NodeId>, (modes, kinds): (&[Mode<'_>], usize)) -> ShutIn {
    let stations: BTreeSet<StationId> = nodes.iter().filter_map(|n| w.kind(*n).reserved_for()).collect();
    let name = |n: &NodeId| w.nodes[*n].name.clone();
    let load = match (modes.iter().any(|m| m.1), modes.iter().all(|m| m.1)) {
        (true, true) => "loaded robots",
        (true, false) => "robots",
        (false, _) => "unloaded robots",
    };
    let which: BTreeSet<Option<&str>> = modes.iter().map(|m| m.0).collect();
    let robots = if which.len() == kinds {
        load.to_owned()
    } else {
        let words: Vec<&str> = which.into_iter().map(|k| k.unwrap_or("that no lane names")).collect();
        format!("{load} of kind {}", words.join(", "))
    };
    ShutIn {
        broken_on: name(&on),
        robots,
        remedy: if stations.is_empty() { END } else { QUEUE },
        stations: stations.iter().map(|s| w.stations[*s].name.clone()).collect(),
        shut_in: nodes.iter().map(name).collect(),
    }
}

/// The lanes that some robots may drive, backwards.
struct WaysOut<'a> {
    w: &'a Warehouse,
    /// The arcs that end at each node.
    into: IdVec<NodeId, Vec<ArcId>>,
    from: IdVec<NodeId, Vec<ArcId>>,
    stays: IdVec<NodeId, bool>,
}

impl<'a> WaysOut<'a> {
    fn of(w: &'a Warehouse, (kind, loaded): Mode<'_>) -> WaysOut<'a> {
        let none = || IdVec::filled(Vec::new(), w.nodes.len());
        let (mut into, mut from) = (none(), none());
        let mut stays = IdVec::filled(false, w.nodes.len());
        for (id, a) in w.arcs.pairs().filter(|(_, a)| is_way(w, a, kind, loaded)) {
            into[a.to].push(id);
            from[a.from].push(id);
            let to = w.kind(a.to);
            stays[a.to] |= if loaded { to == NodeKind::Storage } else { to.is_lasting() };
        }
        WaysOut { w, into, from, stays }
    }

    /// Groups of nodes that one broken robot shuts in; every node that can be shut in is in at least one.
    fn groups(&self) -> Vec<Group> {
        let mut groups = self.dominated();
        let mut known: BTreeSet<NodeId> = groups.iter().flat_map(|g| g.1.iter().copied()).collect();
        let mut by_conflicts: Vec<Group> =
            self.w.nodes.ids().filter_map(|n| self.behind_conflicts(n)).collect();
        by_conflicts.sort_by_key(|(n, shut)| (std::cmp::Reverse(shut.len()), *n));
        for (n, shut) in by_conflicts {
            if shut.iter().any(|v| !known.contains(v)) {
                known.extend(shut.iter().copied());
                groups.push((n, shut));
            }
        }
        groups
    }

    /// The largest sets of nodes that one node alone cuts off.
    fn dominated(&self) -> Vec<Group> {
        let mut graph: DiGraph<(), ()> = DiGraph::new();
        let sink = graph.add_node(());
        let index = |n: NodeId| NodeIndex::new(n.ix() + 1);
        for _ in self.w.nodes.ids() {
            graph.add_node(());
        }
        for (n, arcs) in self.into.pairs() {
            for arc in arcs {
                graph.add_edge(index(n), index(self.w.arcs[*arc].from), ());
            }
            if self.stays[n] {
                graph.add_edge(sink, index(n), ());
            }
        }
        let dominators = simple_fast(&graph, sink);
        let mut groups: BTreeMap<NodeId, BTreeSet<NodeId>> = BTreeMap::new();
        // The outermost node that all ways from each node lead over; the node itself if there is none.
        let mut outermost: IdVec<NodeId, Option<NodeId>> = IdVec::filled(None, self.w.nodes.len());
        for n in self.w.nodes.ids() {
            let (mut at, mut walked) = (n, vec![n]);
            let end = loop {
                if let Some(known) = outermost[at] {
                    break Some(known);
                }
                match dominators.immediate_dominator(index(at)) {
                    None => break None,
                    Some(up) if up == sink => break Some(at),
                    Some(up) => at = NodeId::at(up.index() - 1),
                }
                walked.push(at);
            };
            let Some(end) = end else { continue };
            walked.into_iter().for_each(|v| outermost[v] = Some(end));
            if end != n && !self.w.kind(n).is_lasting() {
                groups.entry(end).or_default().insert(n);
            }
        }
        groups.into_iter().collect()
    }

    /// What a robot that breaks down on a node shuts in, if the node is in conflict with others.
    fn behind_conflicts(&self, on: NodeId) -> Option<Group> {
        let (mut nodes, mut lanes) = (BTreeSet::from([on]), BTreeSet::new());
        for r in self.w.conflicts(self.w.node_resource(on)) {
            match self.w.resource(*r) {
                Ok(node) => nodes.extend([node]),
                Err(lane) => lanes.extend([lane]),
            }
        }
        if nodes.len() + lanes.len() == 1 {
            return None;
        }
        let is_open =
            |a: &Arc| !nodes.contains(&a.from) && !nodes.contains(&a.to) && !lanes.contains(&a.lane);
        // Shut-in robots include some on nodes with a blocked way; mostly there are none.
        let ends = lanes.iter().flat_map(|l| [self.w.lanes[*l].a, self.w.lanes[*l].b]);
        let before = nodes.iter().flat_map(|n| self.into[*n].iter().map(|a| self.w.arcs[*a].from));
        let next_to: BTreeSet<NodeId> = ends.chain(before).filter(|n| !nodes.contains(n)).collect();
        if next_to.into_iter().all(|n| self.leads_out(n, is_open)) {
            return None;
        }
        let out = self.all_that_lead_out(|n| !nodes.contains(&n), is_open);
        let all = self.all_that_lead_out(|_| true, |_| true);
        let shut: BTreeSet<NodeId> = all
            .difference(&out)
            .copied()
            .filter(|n| !nodes.contains(n) && !self.w.kind(*n).is_lasting())
            .collect();
        (!shut.is_empty()).then_some((on, shut))
    }

    /// Whether a way over open arcs leads from a node to a place to stay.
    fn leads_out(&self, start: NodeId, is_open: impl Fn(&Arc) -> bool) -> bool {
        let (mut seen, mut next) = (BTreeSet::from([start]), vec![start]);
        while let Some(n) = next.pop() {
            if self.stays[n] {
                return true;
            }
            let on = self.from[n].iter().map(|a| &self.w.arcs[*a]).filter(|a| is_open(a)).map(|a| a.to);
            next.extend(on.filter(|to| seen.insert(*to)));
        }
        false
    }

    /// All nodes from which a way over open arcs leads to a place to stay that is open.
    fn all_that_lead_out(
        &self,
        is_free: impl Fn(NodeId) -> bool,
        is_open: impl Fn(&Arc) -> bool,
    ) -> BTreeSet<NodeId> {
        let mut next: Vec<NodeId> = self.w.nodes.ids().filter(|n| self.stays[*n] && is_free(*n)).collect();
        let mut found: BTreeSet<NodeId> = next.iter().copied().collect();
        while let Some(n) = next.pop() {
            let back = self.into[n].iter().map(|a| &self.w.arcs[*a]).filter(|a| is_open(a)).map(|a| a.from);
            next.extend(back.filter(|from| found.insert(*from)));
        }
        found
    }
}

/// Whether these robots may drive an arc on their way out.
fn is_way(w: &Warehouse, a: &Arc, kind: Option<&str>, loaded: bool) -> bool {
    let kinds = &w.lanes[a.lane].kinds;
    let is_theirs = kinds.as_ref().is_none_or(|all| kind.is_some_and(|k| all.iter().any(|name| name == k)));
    let zone = w.kind(a.to).reserved_for();
    is_theirs && a.users.allows(loaded) && (zone.is_none() || zone == w.kind(a.from).reserved_for())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warehouse::{Draft, lab, sketch};

    /// A floor with a corridor of three nodes that ends in this kind of place.
    fn corridor(end: char) -> Draft {
        sketch(&format!("RS....{end}\n...\nP"))
    }

    fn found(draft: Draft) -> Vec<ShutIn> {
        shut_in(&draft.build().expect("robots can always get on there"))
    }

    fn end(robots: &str, shut_in: &[&str]) -> ShutIn {
        ShutIn {
            broken_on: "2,2".into(),
            robots: robots.into(),
            stations: Vec::new(),
            shut_in: shut_in.iter().map(|n| (*n).to_owned()).collect(),
            remedy: END,
        }
    }

    #[test]
    fn a_dead_end_is_found_if_it_has_no_bay_for_the_robots_that_may_be_in_it() {
        let tail = ["3,2", "4,2", "5,2"];
        assert_eq!(found(corridor(' ')), [end("robots", &tail)]);
        assert_eq!(found(corridor('P')), [end("loaded robots", &tail)], "they cannot park");
        assert_eq!(found(corridor('S')), []);
        let text = shut_in_text(&[end("robots", &tail)]);
        let expected =
            "node 2,2: if a robot breaks down there, robots on 3 nodes (3,2, 4,2, 5,2) cannot leave: ";
        assert_eq!(text, [format!("{expected}add a bay, or a lane that leads out")]);
    }

    #[test]
    fn a_lane_out_that_only_some_robots_may_drive_is_none_for_the_others() {
        for (kinds, robots) in [(None, None), (Some("shuttle"), Some("robots of kind that no lane names"))] {
            let mut draft = sketch("RS....\n......\nP");
            for lane in draft.lanes.iter_mut().filter(|l| l.from.ends_with(",1") && l.to.ends_with(",1")) {
                lane.kinds = kinds.filter(|_| lane.to == "3,1").map(|k| vec![k.to_owned()]);
            }
            let found = found(draft);
            assert_eq!(found.first().map(|s| s.robots.as_str()), robots);
            assert!(
                robots.is_none() || found[0].shut_in.len() == 6 && found[0].broken_on == "2,2",
                "{found:?}"
            );
        }
    }

    /// Two lanes side by side are one dead end where a robot on the one blocks the other.
    fn narrow() -> Draft {
        let mut draft = sketch("RS....\n......\nP");
        for node in draft.nodes.iter_mut().filter(|n| n.at.x > 2.5) {
            node.at.y = 1.0 + node.at.y / 2.0;
        }
        draft
    }

    #[test]
    fn what_a_broken_robot_blocks_beside_its_node_counts() {
        assert_eq!(found(sketch("RS....\n......\nP")), [], "with room for two side by side");
        let all = ["3,1", "3,2", "4,1", "4,2", "5,1", "5,2"];
        assert_eq!(found(narrow()), [end("robots", &all)]);
    }

    #[test]
    fn robots_in_the_queue_of_a_station_are_shut_in_by_one_that_breaks_down_in_it() {
        let found = shut_in(&lab());
        assert!(found.iter().all(|s| s.stations.len() == 1), "{found:?}");
        let text = shut_in_text(&found);
        assert_eq!(text.len(), 1, "{text:?}");
        assert!(text[0].starts_with("station "), "{text:?}");
    }

    /// Nodes that some broken robot shuts in, by a walk from each node for each node.
    fn by_walks(w: &Warehouse) -> BTreeSet<NodeId> {
        let mut found = BTreeSet::new();
        for ways in [false, true].map(|loaded| WaysOut::of(w, (None, loaded))) {
            for on in w.nodes.ids() {
                let blocked: Vec<_> =
                    w.conflicts(w.node_resource(on)).iter().map(|r| w.resource(*r)).collect();
                let free = |n: NodeId| n != on && !blocked.contains(&Ok(n));
                let open = |a: &Arc| free(a.to) && !blocked.contains(&Err(a.lane));
                let passed = |n: &NodeId| free(*n) && !w.kind(*n).is_lasting();
                let shut =
                    |n: &NodeId| passed(n) && ways.leads_out(*n, |_| true) && !ways.leads_out(*n, open);
                found.extend(w.nodes.ids().filter(shut));
            }
        }
        found
    }

    #[test]
    fn every_node_on_which_robots_can_be_shut_in_is_named() {
        let drawn = |d: Draft| d.build().expect("robots can always get on there");
        for w in [lab(), drawn(corridor(' ')), drawn(corridor('P')), drawn(narrow())] {
            let names = shut_in(&w).into_iter().flat_map(|s| s.shut_in);
            let told: BTreeSet<NodeId> = names.map(|n| w.node_named(&n).expect("it is there")).collect();
            assert_eq!(told, by_walks(&w), "{}", w.name);
        }
    }
}
