//! What closed areas and robots that cannot drive cut off: stations that no rack gets to, and storage whose racks do
//! not get out.
//!
//! Main types: [`CutOff`], [`Barrier`]. It is computed anew only when a robot breaks down, is repaired or stands
//! elsewhere, and when an area is closed or opened: a few walks over the floor, which leave out what is held. Robot
//! kinds are not told apart, and lanes that are in conflict with a hold count as open. Refuses: to plan: that a place
//! is not cut off is no promise of a route.

use crate::state::job_kind::JobKind;
use crate::state::ledger::Ledger;
use crate::state::scene::Scene;
use giveway_floor::id::{ArcId, ClosureId, IdVec, NodeId, RobotId, StationId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{Arc, NodeKind, Warehouse};
use std::collections::{BTreeMap, VecDeque};
use std::sync::OnceLock;

/// A station that has been blocked for this long is blocked for long: racks for it wait in storage, not on robots.
const LONG: Span = Span::from_secs(60);

/// Something that no robot gets past.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Barrier {
    /// This robot, which cannot drive.
    Robot(RobotId),
    /// This area, which is closed or will be soon.
    Closure(ClosureId),
    /// Something on this node, as a robot reported; robots try the node again, so it cuts no job off.
    Obstruction(NodeId),
}

/// What blocks a station, and since when.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Blocker {
    cut: Barrier,
    since: Time,
}

impl Blocker {
    /// Whether the station is blocked for long. A robot may drive on in a moment; how long an area stays closed is
    /// known, and that is long.
    fn is_for_long(&self, now: Time) -> bool {
        match self.cut {
            Barrier::Robot(_) => now - self.since > LONG,
            Barrier::Closure(_) => true,
            Barrier::Obstruction(_) => false,
        }
    }
}

/// What robots that cannot drive, and closed areas, cut off.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CutOff {
    /// Nodes that are closed, and nodes on which a robot that cannot drive may stand or which it blocks.
    held: BTreeMap<NodeId, Barrier>,
    /// Stations that no rack gets to, or that none gets away from.
    blocked: BTreeMap<StationId, Blocker>,
    /// What the other stations are connected to.
    open: BTreeMap<StationId, Region>,
    storage: BTreeMap<NodeId, Barrier>,
    reach: ReachedNodes,
}

/// Nodes to which a robot gets from each node, without and with a rack, past nothing that is held. The walk for a node
/// is done when it is first asked for, so what was asked for makes no difference between two of these.
#[derive(Clone, Debug, Default)]
struct ReachedNodes(IdVec<NodeId, [OnceLock<IdVec<NodeId, bool>>; 2]>);

impl PartialEq for ReachedNodes {
    fn eq(&self, _: &ReachedNodes) -> bool {
        true
    }
}

/// What a station is connected to: nodes from which robots get there, without and with a rack, and nodes to which
/// robots get from there without a rack.
#[derive(Clone, Debug, PartialEq)]
struct Region {
    from: [IdVec<NodeId, bool>; 2],
    to: IdVec<NodeId, bool>,
}

impl CutOff {
    /// Looks again; nothing if nothing has changed. `closed` are the nodes of closed areas.
    pub(crate) fn anew(
        &self,
        ledger: &Ledger,
        scene: &Scene,
        closed: &BTreeMap<NodeId, ClosureId>,
        now: Time,
    ) -> Option<CutOff> {
        let mut held = held_by_failed(ledger, scene);
        // A closure ends at a known time, a broken robot may stay for longer.
        closed.iter().for_each(|(n, c)| {
            held.entry(*n).or_insert(Barrier::Closure(*c));
        });
        if held == self.held { None } else { Some(self.with(ledger.warehouse(), held, now)) }
    }

    /// What would be cut off if these nodes were closed as well.
    pub(crate) fn with_closed(
        &self,
        w: &Warehouse,
        nodes: &[NodeId],
        closure: ClosureId,
        now: Time,
    ) -> CutOff {
        let mut held = self.held.clone();
        held.extend(nodes.iter().map(|n| (*n, Barrier::Closure(closure))));
        self.with(w, held, now)
    }

    fn with(&self, w: &Warehouse, held: BTreeMap<NodeId, Barrier>, now: Time) -> CutOff {
        let mut found = CutOff { held, ..CutOff::default() };
        if found.held.is_empty() {
            return found;
        }
        found.reach = ReachedNodes(w.nodes.ids().map(|_| Default::default()).collect());
        let walks = FloorWalks { into: incoming(w), ..FloorWalks::new(w, &found.held) };
        for station in w.stations.ids() {
            match walks.blocks(station) {
                Some(cut) => {
                    let since = self.blocked.get(&station).map_or(now, |b| b.since);
                    found.blocked.insert(station, Blocker { cut, since });
                }
                None => found.open.extend([(station, walks.region(station))]),
            }
        }
        found.storage = walks.storage(&found.open);
        found
    }

    /// Stations that no rack gets to, or that none gets away from.
    pub fn blocked(&self) -> impl Iterator<Item = StationId> + '_ {
        self.blocked.keys().copied()
    }

    /// What blocks a station, if it has been blocked for long.
    pub fn blocks_for_long(&self, station: StationId, now: Time) -> Option<Barrier> {
        self.blocked.get(&station).filter(|b| b.is_for_long(now)).map(|b| b.cut)
    }

    /// Whether a robot on a node gets to no storage node without passing something that is held: if it carries a rack,
    /// it can set it down nowhere else.
    pub fn traps(&self, w: &Warehouse, here: NodeId) -> bool {
        if self.held.is_empty() || w.kind(here) == NodeKind::Storage {
            return false;
        }
        !w.nodes.ids().any(|n| w.kind(n) == NodeKind::Storage && self.reaches(w, (here, n), true))
    }

    /// Stations that have been blocked for long.
    pub fn blocked_for_long(&self, now: Time) -> impl Iterator<Item = StationId> + '_ {
        self.blocked.keys().copied().filter(move |s| self.blocks_for_long(*s, now).is_some())
    }

    /// Storage nodes that are cut off from all stations, with what cuts each off.
    pub fn storage(&self) -> &BTreeMap<NodeId, Barrier> {
        &self.storage
    }

    /// Whether nothing is closed, and no robot holds anything that it cannot leave.
    pub fn is_empty(&self) -> bool {
        self.held.is_empty()
    }

    /// Whether a robot is cut off from all stations.
    pub fn is_shut_in(&self, here: NodeId, loaded: bool) -> bool {
        !self.open.is_empty() && !self.open.values().any(|r| r.from[usize::from(loaded)][here])
    }

    /// Whether lanes lead a robot from where it stands to a node that is no place of a station, past nothing that is
    /// held. It may leave a closed area in which it stands.
    pub fn reaches(&self, w: &Warehouse, (here, node): (NodeId, NodeId), loaded: bool) -> bool {
        if self.held.is_empty() || here == node {
            return true;
        }
        let walks = || FloorWalks { leaves: Some(here), ..FloorWalks::new(w, &self.held) };
        let walked = || walks().walk([here], LaneSense::Forward(None), loaded, |_| false).seen;
        self.reach.0[here][usize::from(loaded)].get_or_init(walked)[node]
    }

    /// Whether something that is held keeps a robot with a rack from a node.
    pub fn keeps_rack_from(&self, w: &Warehouse, here: NodeId, goal: NodeId) -> bool {
        let Some(station) = w.kind(goal).reserved_for().filter(|_| !self.held.is_empty()) else {
            return !self.reaches(w, (here, goal), true);
        };
        let joined = |n: NodeId| self.open.get(&station).is_some_and(|r| r.from[1][n]);
        let leaves = |a: &Arc| is_way(w, a, Some(station), true) && joined(a.to);
        let comes_out = || self.held.contains_key(&here) && w.out(here).any(|(_, a)| leaves(a));
        !joined(here) && !comes_out()
    }

    /// Whether a robot without a rack gets to a rack, as far as is known.
    pub fn may_fetch(&self, here: NodeId, node: NodeId) -> bool {
        self.open.is_empty() || self.open.values().any(|r| r.from[0][here] && r.to[node])
    }

    /// What is between a rack and where a job is to bring it. Blocked stations do not count here.
    pub fn blocks_job(&self, w: &Warehouse, kind: &JobKind, rack_at: NodeId) -> Option<Barrier> {
        if let Some(cut) = self.storage.get(&rack_at) {
            return Some(*cut);
        }
        let goes_on = match *kind {
            JobKind::Deliver { station, .. } => self.open.get(&station).is_none_or(|r| r.from[1][rack_at]),
            JobKind::Relocate { node, .. } => self.reaches(w, (rack_at, node), true),
            _ => true,
        };
        if goes_on { None } else { self.first_met(w, rack_at) }
    }

    /// The first barrier on the ways of a rack from a node; if there is none, any barrier.
    pub fn first_met(&self, w: &Warehouse, node: NodeId) -> Option<Barrier> {
        let walk = FloorWalks::new(w, &self.held).walk([node], LaneSense::Forward(None), true, |_| false);
        walk.met.or(self.held.values().next().copied())
    }

    /// The first barrier on a robot's ways from where it is to a node, if none of them leads there past all barriers
    /// and past the `obstructed` nodes.
    pub fn between(
        &self,
        w: &Warehouse,
        (here, goal): (NodeId, NodeId),
        loaded: bool,
        obstructed: impl Iterator<Item = NodeId>,
    ) -> Option<Barrier> {
        let mut held: BTreeMap<NodeId, Barrier> = obstructed.map(|n| (n, Barrier::Obstruction(n))).collect();
        held.extend(self.held.iter().map(|(n, cut)| (*n, *cut)));
        if held.is_empty() {
            return None;
        }
        let walks = FloorWalks { leaves: Some(here), ..FloorWalks::new(w, &held) };
        let along = LaneSense::Forward(w.kind(goal).reserved_for());
        let walk = walks.walk([here], along, loaded, |n| n == goal);
        if walk.ended { None } else { walk.met }
    }
}

/// Nodes on which robots that cannot drive may stand, or which they block.
fn held_by_failed(ledger: &Ledger, scene: &Scene) -> BTreeMap<NodeId, Barrier> {
    let w = ledger.warehouse();
    let mut held = BTreeMap::new();
    for robot in ledger.present().filter(|r| ledger.robots[*r].failed) {
        let chain = ledger.chain(robot);
        let granted = (chain.granted() - chain.first()) as usize;
        let own = chain.visits().take(granted).map(|v| v.node);
        let off = scene.displaced(robot).map_or(&[][..], |d| &d.nodes);
        for node in own.chain(off.iter().copied()) {
            let beside = w.conflicts(w.node_resource(node)).iter().filter_map(|r| w.resource(*r).ok());
            held.extend(beside.chain([node]).map(|n| (n, Barrier::Robot(robot))));
        }
    }
    held
}

/// Walks over the floor that leave out what is held.
struct FloorWalks<'a> {
    w: &'a Warehouse,
    held: &'a BTreeMap<NodeId, Barrier>,
    /// Where a robot stands that may leave, though this node is held.
    leaves: Option<NodeId>,
    /// The arcs that end at each node; needed by walks back along the lanes alone.
    into: IdVec<NodeId, Vec<ArcId>>,
}

/// Which way along the lanes, and for which station robots are bound meanwhile.
#[derive(Clone, Copy, PartialEq, Eq)]
enum LaneSense {
    Forward(Option<StationId>),
    Back(Option<StationId>),
}

impl<'a> FloorWalks<'a> {
    /// Walks that lead along the lanes.
    fn new(w: &'a Warehouse, held: &'a BTreeMap<NodeId, Barrier>) -> FloorWalks<'a> {
        FloorWalks { w, held, leaves: None, into: IdVec::new() }
    }

    /// What no rack passes on its way from storage to a station, or from there to storage.
    fn blocks(&self, station: StationId) -> Option<Barrier> {
        let node = self.w.stations[station].node;
        let is_end = |n: NodeId| self.w.kind(n) == NodeKind::Storage;
        [LaneSense::Forward(None), LaneSense::Back(Some(station))].into_iter().find_map(|along| {
            let walk = self.walk([node], along, true, is_end);
            if walk.ended { None } else { walk.met }
        })
    }

    /// What a station is connected to.
    fn region(&self, station: StationId) -> Region {
        let seen = |along, loaded| self.walk([self.w.stations[station].node], along, loaded, |_| false).seen;
        let from = [false, true].map(|loaded| seen(LaneSense::Back(Some(station)), loaded));
        Region { from, to: seen(LaneSense::Forward(None), false) }
    }

    /// Storage nodes from which no rack gets to an open station, or which no robot reaches from there; with what is in
    /// the way. If no station is open, only the storage nodes that are held.
    fn storage(&self, open: &BTreeMap<StationId, Region>) -> BTreeMap<NodeId, Barrier> {
        let is_storage = |n: &NodeId| self.w.kind(*n) == NodeKind::Storage;
        let held = self.held.iter().filter(|(n, _)| is_storage(n));
        let mut cut_off: BTreeMap<NodeId, Barrier> = held.map(|(n, r)| (*n, *r)).collect();
        let is_joined = |n: NodeId| open.is_empty() || open.values().any(|r| r.from[1][n] && r.to[n]);
        for n in self.w.nodes.ids().filter(|n| is_storage(n) && !is_joined(*n)) {
            let out = self.walk([n], LaneSense::Forward(None), true, |_| false);
            let met = out.met.or_else(|| self.walk([n], LaneSense::Back(None), false, |_| false).met);
            // If nothing was met, no way leads there on an open floor either.
            cut_off.extend(met.map(|cut| (n, cut)));
        }
        cut_off
    }

    /// Walks along lanes from some nodes on, or back along the lanes that lead to them.
    fn walk(
        &self,
        starts: impl IntoIterator<Item = NodeId>,
        along: LaneSense,
        loaded: bool,
        is_end: impl Fn(NodeId) -> bool,
    ) -> FloorWalk {
        let w = self.w;
        let mut walk = FloorWalk { seen: IdVec::filled(false, w.nodes.len()), met: None, ended: false };
        let starts: Vec<NodeId> = starts.into_iter().collect();
        let mut next: VecDeque<NodeId> = starts.iter().copied().collect();
        while let Some(n) = next.pop_front() {
            if walk.seen[n] {
                continue;
            }
            if let Some(cut) = self.held.get(&n).filter(|_| self.leaves != Some(n)) {
                walk.met = walk.met.or(Some(*cut));
                continue;
            }
            walk.seen[n] = true;
            if is_end(n) {
                walk.ended = true;
                return walk;
            }
            // A loaded robot begins and ends at storage, and does not pass it.
            if loaded && w.kind(n) == NodeKind::Storage && !starts.contains(&n) {
                continue;
            }
            match along {
                LaneSense::Forward(bound) => {
                    let ways = w.out(n).map(|(_, a)| a).filter(|a| is_way(w, a, bound, loaded));
                    next.extend(ways.map(|a| a.to));
                }
                LaneSense::Back(bound) => {
                    let ways =
                        self.into[n].iter().map(|a| &w.arcs[*a]).filter(|a| is_way(w, a, bound, loaded));
                    next.extend(ways.map(|a| a.from));
                }
            }
        }
        walk
    }
}

/// What a walk found.
struct FloorWalk {
    seen: IdVec<NodeId, bool>,
    /// The first barrier that the walk met.
    met: Option<Barrier>,
    /// Whether the walk came to where it was to end.
    ended: bool,
}

/// Whether a robot that is bound for a station, or for none, drives along a lane: places of a station are for robots
/// that are bound for it, and for those that stand in one of them already.
fn is_way(w: &Warehouse, a: &Arc, bound: Option<StationId>, loaded: bool) -> bool {
    let (from, to) = (w.kind(a.from).reserved_for(), w.kind(a.to).reserved_for());
    a.users.allows(loaded) && (to.is_none() || to == bound || to == from)
}

fn incoming(w: &Warehouse) -> IdVec<NodeId, Vec<ArcId>> {
    let mut into = IdVec::filled(Vec::new(), w.nodes.len());
    for (id, arc) in w.arcs.pairs() {
        into[arc.to].push(id);
    }
    into
}
