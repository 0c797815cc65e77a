//! How robot kinds that come and go change the ledger: its building is always for all kinds, in their order.
//!
//! Facts about a kind whose name is by now in the site's file change nothing: the file may be changed between two
//! starts, and it takes precedence. Refuses: to check whether the floor was drawn for a kind; that was done before.

use super::Ledger;
use crate::state::kind::RobotKind;
use std::sync::Arc;

impl Ledger {
    /// Lets robots of a kind join.
    ///
    /// # Panics
    /// If robots are of another kind of the same name.
    pub(super) fn put_kind(&mut self, kind: &RobotKind) {
        if self.kinds.is_of_site(&kind.name) || self.kinds.named(&kind.name) == Some(kind) {
            return;
        }
        assert_eq!(self.robots_of(&kind.name), 0, "robots are of the kind {:?} that is put", kind.name);
        self.kinds.put(kind.clone());
        self.refit();
    }

    /// Lets robots of a kind no longer join.
    ///
    /// # Panics
    /// If robots are of the kind, or it was not added.
    pub(super) fn remove_kind(&mut self, name: &str) {
        if self.kinds.is_of_site(name) {
            return;
        }
        assert_eq!(self.robots_of(name), 0, "robots are of the kind {name:?} that is removed");
        self.kinds.remove(name);
        self.refit();
    }

    /// Makes the building for all kinds, with the same holds in it.
    fn refit(&mut self) {
        let bodies = self.kinds.iter().map(RobotKind::body).collect();
        let warehouse = Arc::new(self.warehouse().with_bodies(bodies));
        let of_robots = self.promises.robots.iter().map(|r| warehouse.body_of(&r.kind)).collect();
        self.timeline.refit(warehouse, of_robots);
    }
}
