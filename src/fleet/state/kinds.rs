//! All kinds of robots on a floor: those of its site, and those that were added while it worked.
//!
//! Main type: [`RobotKinds`]. Part of the ledger, whose building is for these kinds, in this order. Refuses: to know
//! whether the floor was drawn for a kind, and whether robots are of it.

use super::kind::{RobotKind, most_dangerous};
use giveway_floor::time::Span;
use std::ops::Deref;
use std::sync::Arc;

/// All kinds of robots on a floor, each with a name of its own: the site's first, then those that were added.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotKinds {
    all: Arc<[RobotKind]>,
    /// How many of them are the site's.
    of_site: usize,
}

impl Deref for RobotKinds {
    type Target = [RobotKind];

    fn deref(&self) -> &[RobotKind] {
        &self.all
    }
}

impl RobotKinds {
    /// The kinds of a site, and none that were added.
    ///
    /// # Panics
    /// If the site has none.
    pub fn of_site(kinds: &[RobotKind]) -> RobotKinds {
        assert!(!kinds.is_empty(), "a site has a kind of robots");
        RobotKinds { all: kinds.into(), of_site: kinds.len() }
    }

    /// The same with kinds that were added. Kinds whose name the site has by now are left out: the site's file may
    /// have been changed since.
    pub fn with_added(mut self, added: impl IntoIterator<Item = RobotKind>) -> RobotKinds {
        for kind in added {
            if self.is_of_site(&kind.name) {
                tracing::warn!(
                    "the added kind {:?} is left out: the site's file has one of this name",
                    kind.name
                );
            } else {
                self.put(kind);
            }
        }
        self
    }

    /// The kinds of the site.
    pub fn site(&self) -> &[RobotKind] {
        &self.all[..self.of_site]
    }

    /// The kinds that were added, in the order in which they were.
    pub fn added(&self) -> &[RobotKind] {
        &self.all[self.of_site..]
    }

    /// Whether the site has a kind of this name.
    pub fn is_of_site(&self, name: &str) -> bool {
        self.site().iter().any(|k| k.name == name)
    }

    /// The kind of this name, if there is one.
    pub fn named(&self, name: &str) -> Option<&RobotKind> {
        self.all.iter().find(|k| k.name == name)
    }

    /// The kind of this name.
    ///
    /// # Panics
    /// If there is none. Of robots in a ledger, [`super::ledger::Ledger::unknown_kinds`] says so beforehand; others
    /// cannot join.
    pub fn of(&self, name: &str) -> &RobotKind {
        self.named(name).unwrap_or_else(|| panic!("there is no kind of robots named {name:?}"))
    }

    /// By how much a hold outlasts the moment in which a robot stands on the next node: for all kinds the same, since
    /// they hand places to one another.
    pub fn clearance(&self) -> Span {
        most_dangerous(self.site()).clearance
    }

    /// Adds a kind, or replaces the added one of its name.
    ///
    /// # Panics
    /// If it is one of the site, or needs a longer clearance than the holds on the floor have.
    pub(super) fn put(&mut self, kind: RobotKind) {
        assert!(!self.is_of_site(&kind.name), "the site has the kind {:?}", kind.name);
        assert!(kind.kinematics.clearance <= self.clearance(), "{:?} needs longer holds", kind.name);
        let mut all = self.all.to_vec();
        match all.iter_mut().find(|k| k.name == kind.name) {
            Some(known) => *known = kind,
            None => all.push(kind),
        }
        self.all = all.into();
    }

    /// Removes an added kind.
    ///
    /// # Panics
    /// If none of this name was added.
    pub(super) fn remove(&mut self, name: &str) {
        assert!(self.added().iter().any(|k| k.name == name), "only an added kind is removed: {name:?}");
        self.all = self.all.iter().filter(|k| k.name != name).cloned().collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(name: &str) -> RobotKind {
        RobotKind { name: name.into(), ..RobotKind::default() }
    }

    fn names(kinds: &[RobotKind]) -> Vec<&str> {
        kinds.iter().map(|k| k.name.as_str()).collect()
    }

    #[test]
    fn a_replaced_kind_keeps_its_place_and_the_site_keeps_its_names() {
        let mut kinds = RobotKinds::of_site(&[kind("a")]).with_added([kind("b"), kind("c"), kind("a")]);
        assert_eq!((names(&kinds), names(kinds.added())), (vec!["a", "b", "c"], vec!["b", "c"]));
        kinds.put(RobotKind { payload_kg: 5.0, ..kind("b") });
        assert_eq!((names(&kinds), kinds.of("b").payload_kg), (vec!["a", "b", "c"], 5.0));
        kinds.remove("b");
        assert_eq!((names(&kinds), names(kinds.site()), kinds.named("b")), (vec!["a", "c"], vec!["a"], None));
    }
}
