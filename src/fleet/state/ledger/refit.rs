//! How kinds of robots that come and go change the ledger: its building is always for all kinds, in their order.
//!
//! Facts about a kind whose name the site's file has by now change nothing: the file may be changed between two
//! starts, and what it says goes first. Refuses: to ask whether the floor was drawn for a kind; that was found out
//! before.

use super::Ledger;
use crate::state::kind::RobotKind;
use std::sync::Arc;

impl Ledger {
    /// Robots of a kind may join.
    ///
    /// # Panics
    /// If robots are of another one of its name.
    pub(super) fn put_kind(&mut self, kind: &RobotKind) {
        if self.kinds.is_of_site(&kind.name) || self.kinds.named(&kind.name) == Some(kind) {
            return;
        }
        assert_eq!(self.robots_of(&kind.name), 0, "robots are of the kind {:?} that is put", kind.name);
        self.kinds.put(kind.clone());
        self.refit();
    }

    /// No robots of a kind join any more.
    ///
    /// # Panics
    /// If robots are of it, or it was not added.
    pub(super) fn remove_kind(&mut self, name: &str) {
        if self.kinds.is_of_site(name) {
            return;
        }
        assert_eq!(self.robots_of(name), 0, "robots are of the kind {name:?} that is removed");
        self.kinds.remove(name);
        self.refit();
    }

    /// The building for all kinds, with the same holds in it.
    fn refit(&mut self) {
        let bodies = self.kinds.iter().map(RobotKind::body).collect();
        let warehouse = Arc::new(self.warehouse().with_bodies(bodies));
        let of_robots = self.promises.robots.iter().map(|r| warehouse.body_of(&r.kind)).collect();
        self.timeline.refit(warehouse, of_robots);
    }
}
