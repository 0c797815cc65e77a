//! Routes through the finished graph: can robots always move on, and stay somewhere without cutting the floor?
//!
//! *Open floor* is every node that is neither lasting nor part of a station. Loaded and unloaded robots each have their
//! own graph of open floor; its largest strongly connected part is their *main floor*. The rules:
//!
//! - every open node leads back to the main floor, and is reached from there or from a station's exit;
//! - every lasting place is reached from and left to the main floor over open floor alone: storage with and
//!   without a rack, chargers and parking places without;
//! - every station is reached through its queue in order, and left without its queue;
//! - a robot that stands at a lasting place, a station or in a queue blocks no node, and the lanes that it blocks
//!   are removed before all other rules are checked.
//!
//! Where bad parts of a draft were left out, the places in doubt count as joined to the main floor.
//!
//! Main function: [`well_formed`]. Refuses: to count on luck, i.e. on a robot moving out of the way.

use super::place::FindingPlace;
use super::{Doubts, Findings, list};
use crate::id::{Dense, IdVec, LaneId, NodeId};
use crate::warehouse::{Arc, NodeKind, Station, Warehouse};
use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::{Dfs, Reversed};
use smallvec::SmallVec;

/// A set of nodes.
type Set = IdVec<NodeId, bool>;
/// The arcs that end at each node.
type Incoming = IdVec<NodeId, SmallVec<[Arc; 4]>>;
/// For each lane, the node at which a standing robot blocks it, if there is one.
type Blocked = IdVec<LaneId, Option<NodeId>>;

/// Checks everything that keeps robots from ever being stuck for want of a route or of a place to stay.
pub(in crate::warehouse) fn well_formed(w: &Warehouse, doubts: &Doubts) -> Result<(), Findings> {
    let mut found = Findings::default();
    if !w.nodes.iter().any(|n| n.kind.is_lasting()) && !doubts.stays {
        let problem = "no storage, charging or parking place where a robot could stay indefinitely";
        found.add(format!("map {}", w.name), problem, "add parking places beside the lanes");
    }
    let doubtful: Set = w.nodes.iter().map(|n| doubts.places.contains(&n.name)).collect();
    let blocked = standing(w, &doubtful, &mut found);
    without_lanes(w, &doubtful, &mut found);
    let incoming = incoming(w);
    let [loaded, unloaded] =
        [true, false].map(|loaded| OpenFloor::of(w, loaded, &doubtful, &blocked, &incoming));
    loaded.cut_off(&mut found);
    unloaded.cut_off(&mut found);
    for (n, node) in w.nodes.pairs().filter(|(n, _)| !doubtful[*n]) {
        match node.kind {
            NodeKind::Storage => {
                loaded.lasting(n, &mut found);
                unloaded.lasting(n, &mut found);
            }
            NodeKind::Charger | NodeKind::Parking => unloaded.lasting(n, &mut found),
            _ => {}
        }
    }
    let is_sure = |s: &&Station| !std::iter::once(&s.node).chain(&s.queue).any(|n| doubtful[*n]);
    for station in w.stations.iter().filter(is_sure) {
        loaded.station(station, &mut found);
    }
    found.into_result()
}

fn is_open(kind: NodeKind) -> bool {
    matches!(kind, NodeKind::Aisle | NodeKind::Exit)
}

/// Reports nodes that a robot standing elsewhere blocks; returns, for each lane, the place from which it is blocked.
fn standing(w: &Warehouse, doubtful: &Set, found: &mut Findings) -> Blocked {
    let mut blocked = Blocked::filled(None, w.lanes.len());
    for n in w.nodes_where(|kind| !is_open(kind)).into_iter().filter(|n| !doubtful[*n]) {
        for &other in w.conflicts(w.node_resource(n)) {
            let o = match w.resource(other) {
                Ok(o) if doubtful[o] => continue,
                Ok(o) => o,
                Err(lane) => {
                    blocked[lane] = Some(n);
                    continue;
                }
            };
            let (name, other) = (&w.nodes[n].name, &w.nodes[o].name);
            let place = FindingPlace::of(format!("nodes {name} and {other}"), [name, other]);
            let remedy = format!("move them apart by the footprint of {} m or more", w.footprint_m);
            if is_open(w.nodes[o].kind) {
                found.add(place, format!("a robot at {name} blocks {other}"), remedy);
            } else if n < o {
                found.add(place, "robots standing at both would overlap", remedy);
            }
        }
    }
    blocked
}

fn without_lanes(w: &Warehouse, doubtful: &Set, found: &mut Findings) {
    let mut touched = doubtful.clone();
    for lane in w.lanes.iter() {
        touched[lane.a] = true;
        touched[lane.b] = true;
    }
    let lone: Vec<&str> =
        w.nodes.pairs().filter(|(n, _)| !touched[*n]).map(|(_, n)| n.name.as_str()).collect();
    if !lone.is_empty() {
        let place = FindingPlace::of(format!("nodes {}", list(&lone)), &lone);
        found.add(place, "no lane touches them", "add lanes or remove them");
    }
}

/// The arcs that end at each node.
fn incoming(w: &Warehouse) -> Incoming {
    let mut incoming = Incoming::filled(SmallVec::new(), w.nodes.len());
    for a in w.arcs.iter() {
        incoming[a.to].push(*a);
    }
    incoming
}

/// The open floor for robots with or without a rack.
struct OpenFloor<'a> {
    w: &'a Warehouse,
    loaded: bool,
    blocked: &'a Blocked,
    incoming: &'a Incoming,
    /// Open nodes reached from the main floor over open floor.
    reached: Set,
    /// Open nodes that lead to the main floor over open floor.
    leads_back: Set,
    /// Open nodes reached from a station over open floor.
    after_station: Set,
}

impl<'a> OpenFloor<'a> {
    fn of(
        w: &'a Warehouse,
        loaded: bool,
        doubtful: &Set,
        blocked: &'a Blocked,
        incoming: &'a Incoming,
    ) -> Self {
        let usable = |a: &&Arc| a.users.allows(loaded) && blocked[a.lane].is_none();
        let open = |n: NodeId| is_open(w.nodes[n].kind) || doubtful[n];
        let mut graph: DiGraph<(), ()> = DiGraph::new();
        for _ in w.nodes.ids() {
            graph.add_node(());
        }
        for a in w.arcs.iter().filter(usable).filter(|a| open(a.from) && open(a.to)) {
            graph.add_edge(index(a.from), index(a.to), ());
        }
        let main = (kosaraju_scc(&graph).into_iter())
            .filter(|part| open(NodeId::at(part[0].index())))
            .max_by_key(|part| (part.len(), std::cmp::Reverse(part.iter().min().copied())))
            .unwrap_or_default();
        let is_station = |n: NodeId| matches!(w.nodes[n].kind, NodeKind::Station(_));
        let exits =
            (w.arcs.iter().filter(usable)).filter(|a| is_station(a.from) && open(a.to)).map(|a| index(a.to));
        let unknown = doubtful.pairs().filter(|(_, d)| **d).map(|(n, _)| index(n));
        let main: Vec<NodeIndex> = main.into_iter().chain(unknown).collect();
        let reached = spread(main.iter().copied(), Dfs::empty(&graph), |dfs| dfs.next(&graph));
        let back = spread(main.iter().copied(), Dfs::empty(&graph), |dfs| dfs.next(Reversed(&graph)));
        let after = spread(exits, Dfs::empty(&graph), |dfs| dfs.next(&graph));
        let set = |nodes: Vec<NodeIndex>| {
            let mut set: Set = IdVec::filled(false, w.nodes.len());
            nodes.into_iter().for_each(|n| set[NodeId::at(n.index())] = true);
            set
        };
        OpenFloor {
            w,
            loaded,
            blocked,
            incoming,
            reached: set(reached),
            leads_back: set(back),
            after_station: set(after),
        }
    }

    fn usable(&self, a: &Arc) -> bool {
        a.users.allows(self.loaded) && self.blocked[a.lane].is_none()
    }

    fn robots(&self) -> &'static str {
        if self.loaded { "loaded robots" } else { "unloaded robots" }
    }

    /// Reports open nodes that these robots may use but not leave, or not reach.
    fn cut_off(&self, found: &mut Findings) {
        let mut theirs: Set = IdVec::filled(false, self.w.nodes.len());
        for a in self.w.arcs.iter().filter(|a| a.users.allows(self.loaded)) {
            theirs[a.from] = true;
            theirs[a.to] = true;
        }
        let open = || self.w.nodes.ids().filter(|&n| is_open(self.w.nodes[n].kind) && theirs[n]);
        let trapped: Vec<NodeId> = open().filter(|&n| !self.leads_back[n]).collect();
        let unreached: Vec<NodeId> =
            open().filter(|&n| self.leads_back[n] && !self.reached[n] && !self.after_station[n]).collect();
        let robots = self.robots();
        let remedy = "add lanes that join them to the main floor both ways";
        let problem = format!("{robots} cannot get from there to the main floor without crossing a place");
        self.report(&trapped, problem, remedy, found);
        self.report(&unreached, format!("{robots} cannot get there from the main floor"), remedy, found);
    }

    fn report(&self, nodes: &[NodeId], problem: String, remedy: &str, found: &mut Findings) {
        if !nodes.is_empty() {
            let names: Vec<&str> = nodes.iter().map(|&n| self.w.nodes[n].name.as_str()).collect();
            let problem = problem + &self.why_blocked(nodes);
            found.add(FindingPlace::of(format!("nodes {}", list(&names)), &names), problem, remedy);
        }
    }

    /// Names the lane at these nodes that a robot standing elsewhere blocks, if there is one.
    fn why_blocked(&self, nodes: &[NodeId]) -> String {
        let blocked = self.w.lanes.pairs().filter_map(|(id, l)| Some((id, l, self.blocked[id]?)));
        let mut reasons = blocked.filter(|(_, l, _)| nodes.contains(&l.a) || nodes.contains(&l.b));
        match reasons.next() {
            None => String::new(),
            Some((l, _, by)) => {
                let lane = self.w.resource_name(self.w.lane_resource(l));
                format!(" (a robot at {} blocks lane {lane})", self.w.nodes[by].name)
            }
        }
    }

    /// Reports a lasting place that these robots cannot reach or leave over open floor alone.
    fn lasting(&self, n: NodeId, found: &mut Findings) {
        let reached = self.entered_from(n).any(|from| self.reached[from]);
        let left = self.left_to(n).any(|to| self.leads_back[to]);
        let what = match (reached, left) {
            (true, true) => return,
            (false, true) => "reach it from",
            (true, false) => "leave it to",
            (false, false) => "reach it from, nor leave it to,",
        };
        let robots = self.robots();
        let problem = format!("{robots} cannot {what} the main floor without crossing another place");
        let problem = problem + &self.why_blocked(&[n]);
        let remedy = format!("join it to open floor both ways by a lane for {robots}");
        let name = &self.w.nodes[n].name;
        found.add(FindingPlace::of(format!("node {name}"), [name]), problem, remedy);
    }

    /// Reports a station that cannot be reached through its queue, or cannot be left without it.
    fn station(&self, station: &Station, found: &mut Findings) {
        let w = self.w;
        let robots = self.robots();
        let mut line = vec![station.node];
        line.extend(&station.queue);
        let names = line.iter().map(|&n| &w.nodes[n].name);
        let place = FindingPlace::of(format!("station {}", station.name), names);
        let last = line[line.len() - 1];
        if !self.entered_from(last).any(|from| self.reached[from]) {
            let problem = format!("{robots} cannot reach {} from the main floor", w.nodes[last].name);
            let problem = problem + &self.why_blocked(&[last]);
            found.add(&place, problem, "add a lane from open floor to it");
        }
        for pair in line.windows(2) {
            if !self.entered_from(pair[0]).any(|from| from == pair[1]) {
                let (from, to) = (&w.nodes[pair[1]].name, &w.nodes[pair[0]].name);
                let problem = format!("{robots} cannot move up from {from} to {to}");
                let remedy = "add the lane, or list the queue from the station outwards";
                found.add(&place, problem + &self.why_blocked(&[pair[0]]), remedy);
            }
        }
        if !self.left_to(station.node).any(|to| self.leads_back[to]) {
            let problem = format!("{robots} cannot leave it to the main floor without its queue");
            let problem = problem + &self.why_blocked(&[station.node]);
            found.add(&place, problem, "add a way out that is not part of the queue");
        }
    }

    fn entered_from(&self, n: NodeId) -> impl Iterator<Item = NodeId> {
        self.incoming[n].iter().filter(|a| self.usable(a)).map(|a| a.from)
    }

    fn left_to(&self, n: NodeId) -> impl Iterator<Item = NodeId> {
        self.w.out(n).filter(|(_, a)| self.usable(a)).map(|(_, a)| a.to)
    }
}

fn index(n: NodeId) -> NodeIndex {
    NodeIndex::new(n.ix())
}

/// All nodes that a walk from the seeds reaches.
fn spread<M>(
    seeds: impl Iterator<Item = NodeIndex>,
    mut dfs: Dfs<NodeIndex, M>,
    mut next: impl FnMut(&mut Dfs<NodeIndex, M>) -> Option<NodeIndex>,
) -> Vec<NodeIndex> {
    dfs.stack.extend(seeds);
    std::iter::from_fn(|| next(&mut dfs)).collect()
}
