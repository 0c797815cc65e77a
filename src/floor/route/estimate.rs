//! Lower bounds on the time to a goal: the time on an empty floor.
//!
//! Main types: [`Estimates`] (a bounded cache of tables), [`Table`] (one goal). A table is a reverse Dijkstra over
//! (node, arrival heading, motion) with circular buckets of a millisecond. Spans are rounded down, so the bounds stay
//! admissible, and a closed lane never needs a table rebuilt: closures only lengthen routes. Refuses: to know about
//! time windows.

use super::motion::{MotionState, Pace};
use crate::id::{ArcId, BodyId, Dense, NodeId};
use crate::time::Span;
use crate::warehouse::{NodeKind, Warehouse, Way};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Tables keep multiples of this many milliseconds, in sixteen bits.
const UNIT_MS: u32 = 8;
const UNREACHABLE: u16 = u16::MAX;
/// Memory for tables, bytes; beyond it, the least recently used ones are dropped.
const CACHE_BYTES: usize = 96 << 20;

/// Lower bounds to one goal.
#[derive(Debug)]
pub struct Table {
    bounds: Vec<u16>,
}

/// The cache of tables for one warehouse and pace.
#[derive(Clone, Debug)]
pub struct Estimates {
    warehouse: Arc<Warehouse>,
    body: BodyId,
    pace: Arc<Pace>,
    offsets: Vec<u32>,
    nodes: Vec<NodeId>,
    /// The edges into each state, without and with a rack.
    into: [Into; 2],
    tables: BTreeMap<(NodeId, bool), (Arc<Table>, u64)>,
    clock: u64,
    buckets: Vec<Vec<u32>>,
    built: u64,
}

/// Edges into states, by the state they lead to: first those from within the same station's places, then all others.
#[derive(Clone, Debug, Default)]
struct Into {
    start: Vec<u32>,
    inner_end: Vec<u32>,
    /// The state before, and the duration in milliseconds.
    edges: Vec<(u32, u32)>,
}

/// Whether a robot bound for `goal` may drive the arc: lanes have users, a loaded robot never passes beneath
/// racks, and the places of a station are for robots bound for it, or on their way out of it.
pub(super) fn may_drive(
    (warehouse, body): (&Warehouse, BodyId),
    from: NodeId,
    way: &Way,
    loaded: bool,
    goal: NodeId,
) -> bool {
    let kind = warehouse.kind(way.to);
    if !way.is_for(body)
        || !way.users.allows(loaded)
        || (loaded && kind == NodeKind::Storage && way.to != goal)
    {
        return false;
    }
    let zone = kind.reserved_for();
    zone.is_none()
        || zone == warehouse.kind(goal).reserved_for()
        || zone == warehouse.kind(from).reserved_for()
}

impl Estimates {
    /// An empty cache.
    pub fn new(warehouse: Arc<Warehouse>, body: BodyId, pace: Arc<Pace>) -> Estimates {
        let mut offsets = vec![0u32];
        let mut nodes = Vec::new();
        for n in warehouse.nodes.ids() {
            offsets.push(offsets[n.ix()] + 2 * warehouse.headings(n).len() as u32);
            nodes.resize(offsets[n.ix() + 1] as usize, n);
        }
        let into = [false, true].map(|loaded| Into::new((&warehouse, body), &pace, &offsets, &nodes, loaded));
        let longest = into.iter().flat_map(|i| &i.edges).map(|(_, ms)| *ms).max().unwrap_or(0);
        let buckets = vec![Vec::new(); (longest as usize + 2).next_power_of_two()];
        let tables = BTreeMap::new();
        Estimates { warehouse, body, pace, offsets, nodes, into, tables, clock: 0, buckets, built: 0 }
    }

    /// Number of tables computed so far.
    pub fn built(&self) -> u64 {
        self.built
    }

    /// Memory of the tables kept, bytes.
    pub fn bytes(&self) -> usize {
        self.tables.len() * self.states() * 2
    }

    fn states(&self) -> usize {
        *self.offsets.last().expect("offsets start with zero") as usize
    }

    /// The table for a goal, from the cache or computed.
    pub fn table(&mut self, goal: NodeId, loaded: bool) -> Arc<Table> {
        self.clock += 1;
        if let Some((table, used)) = self.tables.get_mut(&(goal, loaded)) {
            *used = self.clock;
            return table.clone();
        }
        let table = Arc::new(self.compute(goal, loaded));
        if self.bytes() > CACHE_BYTES {
            self.drop_oldest_half();
        }
        self.tables.insert((goal, loaded), (table.clone(), self.clock));
        table
    }

    fn drop_oldest_half(&mut self) {
        let mut uses: Vec<u64> = self.tables.values().map(|(_, used)| *used).collect();
        uses.sort_unstable();
        let median = uses[uses.len() / 2];
        self.tables.retain(|_, (_, used)| *used > median);
    }

    /// The bound from a node with an arrival heading; nothing if no route exists.
    pub fn bound(&self, table: &Table, node: NodeId, slot: u8, motion: MotionState) -> Option<Span> {
        let state = self.offsets[node.ix()] as usize
            + 2 * usize::from(slot)
            + usize::from(motion == MotionState::Rolling);
        match table.bounds[state] {
            UNREACHABLE => None,
            b => Some(Span::from_millis(i64::from(b) * i64::from(UNIT_MS))),
        }
    }

    /// The bound from a node for a robot that stands there with its best heading.
    pub fn bound_from(&self, table: &Table, node: NodeId) -> Option<Span> {
        let slots = 0..self.warehouse.headings(node).len() as u8;
        slots.filter_map(|s| self.bound(table, node, s, MotionState::Standing)).min()
    }

    /// Reverse Dijkstra from standing at the goal, with any heading. Nodes that may not be driven through (storage with
    /// a rack, the places of other stations) get a value as a start, but nothing leads on from them.
    fn compute(&mut self, goal: NodeId, loaded: bool) -> Table {
        self.built += 1;
        let mut best = vec![u32::MAX; self.states()];
        let mask = self.buckets.len() - 1;
        let goal_zone = self.warehouse.nodes[goal].kind.reserved_for();
        let mut waiting = 0;
        for state in (self.offsets[goal.ix()]..self.offsets[goal.ix() + 1]).step_by(2) {
            best[state as usize] = 0;
            self.buckets[0].push(state);
            waiting += 1;
        }
        let into = &self.into[usize::from(loaded)];
        let mut now = 0u32;
        while waiting > 0 {
            while let Some(state) = self.buckets[now as usize & mask].pop() {
                waiting -= 1;
                let s = state as usize;
                if best[s] != now {
                    continue;
                }
                let node = self.nodes[s];
                let kind = self.warehouse.nodes[node].kind;
                let zone = kind.reserved_for();
                if loaded && kind == NodeKind::Storage && node != goal {
                    continue;
                }
                let open = zone.is_none() || zone == goal_zone;
                let end = if open { into.start[s + 1] } else { into.inner_end[s] };
                for &(before, ms) in &into.edges[into.start[s] as usize..end as usize] {
                    let cost = now + ms;
                    if cost < best[before as usize] {
                        best[before as usize] = cost;
                        self.buckets[cost as usize & mask].push(before);
                        waiting += 1;
                    }
                }
            }
            now += 1;
        }
        let floor = |b: u32| if b == u32::MAX { UNREACHABLE } else { (b / UNIT_MS).min(0xfffe) as u16 };
        Table { bounds: best.into_iter().map(floor).collect() }
    }
}

impl Into {
    fn new(
        (warehouse, body): (&Warehouse, BodyId),
        pace: &Pace,
        offsets: &[u32],
        nodes: &[NodeId],
        loaded: bool,
    ) -> Into {
        let mut lists: Vec<Vec<(bool, u32, u32)>> = vec![Vec::new(); nodes.len()];
        let open = warehouse.arcs.pairs().filter(|(_, a)| a.users.allows(loaded));
        for (id, arc) in open.filter(|(id, _)| warehouse.may_drive(body, *id)) {
            let zone = |n: NodeId| warehouse.nodes[n].kind.reserved_for();
            let outer = zone(arc.from).is_none() || zone(arc.from) != zone(arc.to);
            for slot in 0..warehouse.headings(arc.from).len() as u8 {
                for (from, to) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let (g, h) = (motion(from), motion(to));
                    let Some(span) = step(pace, id, slot, loaded, g, h) else { continue };
                    let before = offsets[arc.from.ix()] + 2 * u32::from(slot) + from;
                    let state = offsets[arc.to.ix()] + 2 * u32::from(arc.slot) + to;
                    lists[state as usize].push((outer, before, (span.0 / 1000) as u32));
                }
            }
        }
        let mut into = Into { start: vec![0], ..Into::default() };
        for mut list in lists {
            list.sort_unstable();
            let inner = list.iter().filter(|(outer, _, _)| !outer).count() as u32;
            into.inner_end.push(into.edges.len() as u32 + inner);
            into.edges.extend(list.into_iter().map(|(_, before, ms)| (before, ms)));
            into.start.push(into.edges.len() as u32);
        }
        into
    }
}

fn motion(rolling: u32) -> MotionState {
    if rolling == 1 { MotionState::Rolling } else { MotionState::Standing }
}

/// Duration of turning and driving one arc, if that is possible with these gaits.
fn step(pace: &Pace, arc: ArcId, slot: u8, loaded: bool, from: MotionState, to: MotionState) -> Option<Span> {
    let rolls = from == MotionState::Rolling || to == MotionState::Rolling;
    if rolls && !pace.can_roll() || from == MotionState::Rolling && !pace.is_straight(arc, slot) {
        return None;
    }
    let turn = if from == MotionState::Rolling { Span::ZERO } else { pace.turn(arc, slot) };
    Some(turn + pace.drive(arc, loaded, from, to))
}

impl Estimates {
    /// The pace.
    pub fn pace(&self) -> &Arc<Pace> {
        &self.pace
    }

    /// The kind of robots.
    pub fn body(&self) -> BodyId {
        self.body
    }

    /// The building.
    pub fn warehouse(&self) -> &Arc<Warehouse> {
        &self.warehouse
    }
}
