//! The same holds in a building for other kinds of robots.
//!
//! Main function: [`Timeline::refit`]. Refuses: to change what is held, and to know kinds by their names.

use super::{Line, Timeline};
use crate::id::{BodyId, IdVec};
use crate::warehouse::Warehouse;
use std::sync::Arc;

impl Timeline {
    /// Switches to the same building for other kinds of robots: all chains stay, and the lines are written anew, since
    /// there is one for each resource and footprint. `bodies` are the kinds of robots, by their numbers.
    ///
    /// # Panics
    /// If `warehouse` is another building.
    pub fn refit(&mut self, warehouse: Arc<Warehouse>, bodies: Vec<BodyId>) {
        let (before, now) = (self.warehouse.resource_count(), warehouse.resource_count());
        assert_eq!(before, now, "the building stays the same for other kinds of robots");
        self.bodies = bodies;
        let mut lines = IdVec::filled(Line::default(), warehouse.line_count());
        for (holder, chain) in self.chains.iter().filter(|(_, chain)| !chain.absent) {
            let context = self.context(&warehouse, holder);
            for (serial, visit) in (chain.first..).zip(&chain.visits) {
                Self::write(&mut lines, context, holder, serial, visit);
            }
        }
        (self.lines, self.warehouse) = (lines, warehouse);
    }
}
