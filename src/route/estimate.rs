//! Lower bounds for the way to a goal: what it takes with nobody else on the floor.
//!
//! Main types: [`Estimates`] (a bounded cache of tables), [`Table`] (one goal). A table is a reverse Dijkstra over
//! (node, arrival heading, gait) with circular buckets of a millisecond. Spans are rounded down, so the bounds
//! stay admissible, and a closed lane never needs a table rebuilt: closures only lengthen ways. Refuses: to know
//! about time windows.

use super::motion::{Gait, Pace};
use crate::id::{ArcId, Dense, NodeId};
use crate::time::Span;
use crate::warehouse::{NodeKind, Warehouse};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Tables keep multiples of this, in sixteen bits.
const UNIT_MS: u32 = 8;
const UNREACHABLE: u16 = u16::MAX;
/// Memory for tables, bytes; the least recently used ones are dropped beyond it.
const CACHE_BYTES: usize = 96 << 20;

/// Lower bounds to one goal.
#[derive(Debug)]
pub struct Table {
    bounds: Vec<u16>,
}

/// The cache of tables for one warehouse and pace.
#[derive(Debug)]
pub struct Estimates {
    warehouse: Arc<Warehouse>,
    pace: Arc<Pace>,
    offsets: Vec<u32>,
    into_start: Vec<u32>,
    into: Vec<ArcId>,
    tables: BTreeMap<(NodeId, bool), (Arc<Table>, u64)>,
    clock: u64,
    buckets: Vec<Vec<u32>>,
    built: u64,
}

/// Whether a robot bound for `goal` may drive the arc: lanes have users, a loaded robot never passes beneath
/// racks, and the places of a station are for robots bound for it, or on their way out of it.
pub(super) fn may_drive(warehouse: &Warehouse, arc: ArcId, loaded: bool, goal: NodeId) -> bool {
    let arc = &warehouse.arcs[arc];
    let kind = warehouse.nodes[arc.to].kind;
    if !arc.users.allows(loaded) || (loaded && kind == NodeKind::Storage && arc.to != goal) {
        return false;
    }
    let zone = kind.reserved_for();
    zone.is_none()
        || zone == warehouse.nodes[goal].kind.reserved_for()
        || zone == warehouse.nodes[arc.from].kind.reserved_for()
}

impl Estimates {
    /// No tables yet.
    pub fn new(warehouse: Arc<Warehouse>, pace: Arc<Pace>) -> Estimates {
        let mut offsets = vec![0u32];
        for n in warehouse.nodes.ids() {
            offsets.push(offsets[n.ix()] + 2 * warehouse.headings(n).len() as u32);
        }
        let mut into: Vec<ArcId> = warehouse.arcs.ids().collect();
        into.sort_by_key(|a| (warehouse.arcs[*a].to, *a));
        let mut into_start = vec![0u32; warehouse.nodes.len() + 1];
        for a in warehouse.arcs.iter() {
            into_start[a.to.ix() + 1] += 1;
        }
        for i in 0..warehouse.nodes.len() {
            into_start[i + 1] += into_start[i];
        }
        let buckets = vec![Vec::new(); (longest_ms(&warehouse, &pace) + 1).next_power_of_two()];
        let tables = BTreeMap::new();
        Estimates { warehouse, pace, offsets, into_start, into, tables, clock: 0, buckets, built: 0 }
    }

    /// How many tables were computed so far.
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

    /// The bound from a node with an arrival heading; nothing where there is no way.
    pub fn bound(&self, table: &Table, node: NodeId, slot: u8, gait: Gait) -> Option<Span> {
        let state =
            self.offsets[node.ix()] as usize + 2 * usize::from(slot) + usize::from(gait == Gait::Rolling);
        match table.bounds[state] {
            UNREACHABLE => None,
            b => Some(Span::from_millis(i64::from(b) * i64::from(UNIT_MS))),
        }
    }

    /// The bound from a node for a robot that stands there with its best heading.
    pub fn bound_from(&self, table: &Table, node: NodeId) -> Option<Span> {
        let slots = 0..self.warehouse.headings(node).len() as u8;
        slots.filter_map(|s| self.bound(table, node, s, Gait::Standing)).min()
    }

    /// Reverse Dijkstra from standing at the goal, whatever the heading.
    fn compute(&mut self, goal: NodeId, loaded: bool) -> Table {
        self.built += 1;
        let mut best = vec![u32::MAX; self.states()];
        let mask = self.buckets.len() - 1;
        let mut waiting = 0;
        for slot in 0..self.warehouse.headings(goal).len() as u32 {
            let state = self.offsets[goal.ix()] + 2 * slot;
            best[state as usize] = 0;
            self.buckets[0].push(state);
            waiting += 1;
        }
        let node_of = self.node_of_state();
        let mut now = 0u32;
        while waiting > 0 {
            while let Some(state) = self.buckets[now as usize & mask].pop() {
                waiting -= 1;
                if best[state as usize] == now {
                    waiting += self.relax(&mut best, state, node_of[state as usize], now, loaded, goal);
                }
            }
            now += 1;
        }
        let floor = |b: u32| if b == u32::MAX { UNREACHABLE } else { (b / UNIT_MS).min(0xfffe) as u16 };
        Table { bounds: best.into_iter().map(floor).collect() }
    }

    fn node_of_state(&self) -> Vec<NodeId> {
        let mut nodes = Vec::with_capacity(self.states());
        for n in self.warehouse.nodes.ids() {
            nodes.resize(self.offsets[n.ix() + 1] as usize, n);
        }
        nodes
    }

    /// Relaxes everything that can lead into `state` of `node`; gives how many entries were queued.
    fn relax(
        &mut self,
        best: &mut [u32],
        state: u32,
        node: NodeId,
        now: u32,
        loaded: bool,
        goal: NodeId,
    ) -> usize {
        let local = state - self.offsets[node.ix()];
        let (slot, to) = ((local / 2) as u8, if local % 2 == 1 { Gait::Rolling } else { Gait::Standing });
        let mask = self.buckets.len() - 1;
        let mut queued = 0;
        for i in self.into_start[node.ix()]..self.into_start[node.ix() + 1] {
            let id = self.into[i as usize];
            let arc = &self.warehouse.arcs[id];
            if arc.slot != slot || !may_drive(&self.warehouse, id, loaded, goal) {
                continue;
            }
            for from_slot in 0..self.warehouse.headings(arc.from).len() as u8 {
                for from in [Gait::Standing, Gait::Rolling] {
                    let Some(span) = self.step(id, from_slot, loaded, from, to) else { continue };
                    let cost = now + (span.0 / 1000) as u32;
                    let rolling = u32::from(from == Gait::Rolling);
                    let before = self.offsets[arc.from.ix()] + 2 * u32::from(from_slot) + rolling;
                    if cost < best[before as usize] {
                        best[before as usize] = cost;
                        self.buckets[cost as usize & mask].push(before);
                        queued += 1;
                    }
                }
            }
        }
        queued
    }

    /// Turning and driving one arc, if that can be done with these gaits.
    fn step(&self, arc: ArcId, slot: u8, loaded: bool, from: Gait, to: Gait) -> Option<Span> {
        let pace = &self.pace;
        let rolls = from == Gait::Rolling || to == Gait::Rolling;
        if rolls && !pace.can_roll() || from == Gait::Rolling && !pace.is_straight(arc, slot) {
            return None;
        }
        let turn = if from == Gait::Rolling { Span::ZERO } else { pace.turn(arc, slot) };
        Some(turn + pace.drive(arc, loaded, from, to))
    }
}

/// The longest turn and drive of all arcs, milliseconds.
fn longest_ms(warehouse: &Warehouse, pace: &Pace) -> usize {
    let mut longest = Span::ZERO;
    for (id, arc) in warehouse.arcs.pairs() {
        for slot in 0..warehouse.headings(arc.from).len() as u8 {
            for loaded in [false, true] {
                let drive = pace.drive(id, loaded, Gait::Standing, Gait::Standing);
                longest = longest.max(pace.turn(id, slot) + drive);
                longest =
                    longest.max(pace.turn(id, slot) + pace.drive(id, loaded, Gait::Standing, Gait::Rolling));
            }
        }
    }
    (longest.0 / 1000) as usize + 1
}

/// Durations per node of everything that starts there: for the search.
impl Estimates {
    /// The pace.
    pub fn pace(&self) -> &Arc<Pace> {
        &self.pace
    }

    /// The building.
    pub fn warehouse(&self) -> &Arc<Warehouse> {
        &self.warehouse
    }
}
