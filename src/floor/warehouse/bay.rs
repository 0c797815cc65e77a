//! A station bay: queue places in one row outwards from the floor, the station at their end, and the way back in the
//! row beside them.
//!
//! Main type: [`Bay`]. Refuses: to look for room; the caller knows that there is some.

use super::{Draft, DraftLane, DraftNode, DraftStation, Users};
use crate::geometry::{Point, Vector};
use crate::time::Span;

/// A bay to add to a draft.
pub(super) struct Bay {
    /// Name of the station.
    pub name: String,
    /// Name and position of the floor node where robots turn in.
    pub entry: (String, Point),
    /// Name and position of the floor node where robots come out.
    pub exit: (String, Point),
    /// One step away from the floor, metres.
    pub outward: Vector,
    /// Number of waiting places.
    pub queue: usize,
    /// Usual length of a pick.
    pub pick: Span,
}

impl Bay {
    /// Adds nodes, lanes and the station: places `NAME.q1` (next to the station) and so on, the way out
    /// `NAME.o1` (next to the station) and so on. All lanes are one way, for robots.
    pub fn add_to(self, draft: &mut Draft) {
        let steps = self.queue + 1;
        let at = |from: Point, step: usize| from + self.outward * step as f64;
        let queue: Vec<String> = (1..=self.queue).map(|i| format!("{}.q{i}", self.name)).collect();
        let mut way = vec![self.entry.0.clone()];
        for (i, name) in queue.iter().enumerate().rev() {
            draft.nodes.push(DraftNode { name: name.clone(), at: at(self.entry.1, steps - 1 - i) });
            way.push(name.clone());
        }
        draft.nodes.push(DraftNode { name: self.name.clone(), at: at(self.entry.1, steps) });
        way.push(self.name.clone());
        for i in 1..=steps {
            let name = format!("{}.o{i}", self.name);
            draft.nodes.push(DraftNode { name: name.clone(), at: at(self.exit.1, steps + 1 - i) });
            way.push(name);
        }
        way.push(self.exit.0);
        for pair in way.windows(2) {
            draft.lanes.push(DraftLane::one_way(&pair[0], &pair[1], Users::ROBOTS));
        }
        let (name, node) = (self.name.clone(), self.name);
        draft.stations.push(DraftStation { name, node, queue, pick: self.pick, cell: None });
    }
}
