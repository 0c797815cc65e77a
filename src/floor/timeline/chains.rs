//! The chain of each holder: robots by number, since they are asked for many times in every step.
//!
//! Main type: [`Chains`]. Refuses: to know what a chain holds.

use super::Chain;
use crate::id::{Dense, RobotId};
use std::ops::Index;

/// The chains of all holders.
#[derive(Clone, Debug, Default)]
pub(super) struct Chains(Vec<Option<Chain>>);

impl Chains {
    /// The chain of a holder.
    #[inline]
    pub fn get(&self, holder: &RobotId) -> Option<&Chain> {
        self.0.get(holder.ix())?.as_ref()
    }

    /// The chain of a holder, to change it.
    #[inline]
    pub fn get_mut(&mut self, holder: &RobotId) -> Option<&mut Chain> {
        self.0.get_mut(holder.ix())?.as_mut()
    }

    /// Whether a holder has a chain.
    #[inline]
    pub fn contains_key(&self, holder: &RobotId) -> bool {
        self.get(holder).is_some()
    }

    /// Sets the chain of a holder in place of the earlier one.
    #[inline]
    pub fn insert(&mut self, holder: RobotId, chain: Chain) {
        if self.0.len() <= holder.ix() {
            self.0.resize_with(holder.ix() + 1, || None);
        }
        self.0[holder.ix()] = Some(chain);
    }

    /// Removes the chain of a holder.
    #[inline]
    pub fn remove(&mut self, holder: &RobotId) -> Option<Chain> {
        self.0.get_mut(holder.ix())?.take()
    }

    /// All chains, in the order of holders.
    #[inline]
    pub fn iter(&self) -> impl Iterator<Item = (RobotId, &Chain)> {
        self.0.iter().enumerate().filter_map(|(i, chain)| Some((RobotId::at(i), chain.as_ref()?)))
    }
}

impl Index<&RobotId> for Chains {
    type Output = Chain;

    fn index(&self, holder: &RobotId) -> &Chain {
        self.get(holder).unwrap_or_else(|| panic!("{holder:?} holds nothing"))
    }
}

impl PartialEq for Chains {
    fn eq(&self, other: &Chains) -> bool {
        self.iter().eq(other.iter())
    }
}
