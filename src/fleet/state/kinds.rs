//! All robot kinds on a floor: those of its site, and those that were added during operation.
//!
//! Main type: [`RobotKinds`]. Part of the ledger, whose building is for these kinds, in this order. Refuses: to know
//! whether the floor was drawn for a kind, and whether robots are of it.

use super::kind::{RobotKind, most_dangerous};
use giveway_floor::time::Span;
use std::ops::Deref;
use std::sync::Arc;

/// All robot kinds on a floor, each with a unique name: the site's kinds first, then the added ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotKinds {
    all: Arc<[RobotKind]>,
    /// How many of the kinds are the site's.
    of_site: usize,
}

impl Deref for RobotKinds {
    type Target = [RobotKind];

    fn deref(&self) -> &[RobotKind] {
        &self.all
    }
}

impl RobotKinds {
    /// The kinds of a site, without added ones.
    ///
    /// # Panics
    /// If the site has none.
    pub fn of_site(kinds: &[RobotKind]) -> RobotKinds {
        assert!(!kinds.is_empty(), "a site has a kind of robots");
        RobotKinds { all: kinds.into(), of_site: kinds.len() }
    }

    /// These kinds and the added ones. An added kind whose name the site has by now is left out: the site's file may
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

    /// The added kinds, in the order in which they were added.
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
    /// If there is none. For robots in a ledger, [`super::ledger::Ledger::unknown_kinds`] says so beforehand; robots of
    /// such a kind cannot join.
    pub fn of(&self, name: &str) -> &RobotKind {
        self.named(name).unwrap_or_else(|| panic!("there is no kind of robots named {name:?}"))
    }

    /// How long a hold outlasts the moment in which its robot stands on the next node. The same for all kinds, since
    /// robots hand places to one another.
    pub fn clearance(&self) -> Span {
        most_dangerous(self.site()).clearance
    }

    /// Adds a kind, or replaces the added kind of the same name.
    ///
    /// # Panics
    /// If the kind is the site's, or needs a longer clearance than the holds on the floor have.
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
    /// If no kind of this name was added.
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
