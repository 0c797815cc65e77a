//! Drawing drafts on a grid of one metre.
//!
//! Main type: [`Pen`]. Refuses: to check anything; the draft is checked when it is built.

use crate::geometry::Point;
use crate::warehouse::{Draft, DraftLane, DraftNode, DraftRack, Users};
use std::collections::BTreeMap;

/// A grid position, metres.
pub(super) type Cell = (i64, i64);

/// A draft that is being drawn, with the name of the node at each cell.
pub(super) struct Pen {
    pub draft: Draft,
    names: BTreeMap<Cell, String>,
}

impl Pen {
    /// An empty floor for robots 0.9 m wide.
    pub fn new(name: &str) -> Pen {
        let draft = Draft { name: name.into(), footprint_m: 0.9, ..Draft::default() };
        Pen { draft, names: BTreeMap::new() }
    }

    pub fn node(&mut self, cell: Cell, name: impl Into<String>) -> String {
        let name = name.into();
        self.draft.nodes.push(DraftNode { name: name.clone(), at: point(cell) });
        self.names.insert(cell, name.clone());
        name
    }

    /// Adds a node for a rack.
    pub fn storage(&mut self, cell: Cell, name: impl Into<String>) {
        let name = self.node(cell, name);
        self.draft.storage.push(name);
    }

    /// Adds a place to stay beside the floor node at `floor`.
    pub fn place(&mut self, cell: Cell, floor: Cell, name: impl Into<String>, charger: bool) {
        let name = self.node(cell, name);
        if charger { &mut self.draft.chargers } else { &mut self.draft.parking }.push(name);
        self.both_ways(floor, cell, Users::ROBOTS);
    }

    pub fn has(&self, cell: Cell) -> bool {
        self.names.contains_key(&cell)
    }

    /// The name of the node at `cell`, which must be there.
    pub fn name(&self, cell: Cell) -> &str {
        &self.names[&cell]
    }

    pub fn one_way(&mut self, from: Cell, to: Cell, users: Users) {
        let lane = DraftLane::one_way(self.name(from), self.name(to), users);
        self.draft.lanes.push(lane);
    }

    pub fn both_ways(&mut self, from: Cell, to: Cell, users: Users) {
        let lane = DraftLane::both_ways(self.name(from), self.name(to), users);
        self.draft.lanes.push(lane);
    }

    /// Puts racks on this share of the storage nodes, scattered: free nodes are near everywhere.
    pub fn racks(&mut self, fill: f64) {
        const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;
        let storage = &self.draft.storage;
        let count = (storage.len() as f64 * fill.clamp(0.0, 1.0)).round() as usize;
        // Multiples of the golden ratio modulo one are spread evenly, whatever the length of the rows.
        let mut order: Vec<usize> = (0..storage.len()).collect();
        order.sort_by_key(|&i| (i as u64).wrapping_mul(GOLDEN));
        order.truncate(count);
        order.sort_unstable();
        self.draft.racks =
            order.iter().zip(1..).map(|(&i, k)| DraftRack::plain(format!("K{k}"), &storage[i])).collect();
    }
}

/// The middle of a cell.
pub(super) fn point((x, y): Cell) -> Point {
    Point::new(x as f64, y as f64)
}

/// The outline of all cells from `low` to `high`.
pub(super) fn outline(low: Cell, high: Cell) -> Vec<Point> {
    let (l, h) = (point(low), point(high));
    let (left, right, below, above) = (l.x - 0.5, h.x + 0.5, l.y - 0.5, h.y + 0.5);
    vec![Point::new(left, below), Point::new(right, below), Point::new(right, above), Point::new(left, above)]
}
