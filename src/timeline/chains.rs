//! The chain of each holder: robots by number, since they are asked for many times in every step.
//!
//! Main type: [`Chains`]. Refuses: to know what a chain holds.

use super::{Chain, Holder};
use crate::id::Dense;
use std::collections::BTreeMap;
use std::ops::Index;

/// The chains of all holders.
#[derive(Clone, Debug, Default)]
pub(super) struct Chains {
    robots: Vec<Option<Chain>>,
    others: BTreeMap<Holder, Chain>,
}

impl Chains {
    /// The chain of a holder.
    pub fn get(&self, holder: &Holder) -> Option<&Chain> {
        match holder {
            Holder::Robot(robot) => self.robots.get(robot.ix())?.as_ref(),
            Holder::Worker(_) => self.others.get(holder),
        }
    }

    /// The chain of a holder, to change it.
    pub fn get_mut(&mut self, holder: &Holder) -> Option<&mut Chain> {
        match holder {
            Holder::Robot(robot) => self.robots.get_mut(robot.ix())?.as_mut(),
            Holder::Worker(_) => self.others.get_mut(holder),
        }
    }

    /// Whether a holder has one.
    pub fn contains_key(&self, holder: &Holder) -> bool {
        self.get(holder).is_some()
    }

    /// Gives a holder a chain in place of the one that it had.
    pub fn insert(&mut self, holder: Holder, chain: Chain) {
        match holder {
            Holder::Robot(robot) => {
                if self.robots.len() <= robot.ix() {
                    self.robots.resize_with(robot.ix() + 1, || None);
                }
                self.robots[robot.ix()] = Some(chain);
            }
            Holder::Worker(_) => _ = self.others.insert(holder, chain),
        }
    }

    /// Takes the chain of a holder away.
    pub fn remove(&mut self, holder: &Holder) -> Option<Chain> {
        match holder {
            Holder::Robot(robot) => self.robots.get_mut(robot.ix())?.take(),
            Holder::Worker(_) => self.others.remove(holder),
        }
    }

    /// All of them, in the order of holders.
    pub fn iter(&self) -> impl Iterator<Item = (Holder, &Chain)> {
        let robots = self.robots.iter().enumerate();
        let robots = robots.filter_map(|(i, chain)| Some((Holder::Robot(Dense::at(i)), chain.as_ref()?)));
        robots.chain(self.others.iter().map(|(holder, chain)| (*holder, chain)))
    }
}

impl Index<&Holder> for Chains {
    type Output = Chain;

    fn index(&self, holder: &Holder) -> &Chain {
        self.get(holder).unwrap_or_else(|| panic!("{holder:?} holds nothing"))
    }
}

impl PartialEq for Chains {
    fn eq(&self, other: &Chains) -> bool {
        self.iter().eq(other.iter())
    }
}
