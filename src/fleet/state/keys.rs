//! Customers' keys: the same key never makes a second job or assignment, for as long as the key is known.
//!
//! Main type: [`Keys`]. A key lives as long as its job is open, and at least [`KEY_LIFE`] after the job was accepted.
//! Refuses: to forget anything by itself; a step records which keys are forgotten ([`super::fact::Fact::KeysExpired`]).

use crate::time::{Span, Time};
use std::collections::BTreeMap;

/// A key is known for at least so long after its job or assignment was accepted: 7 days.
pub const KEY_LIFE: Span = Span::from_secs(7 * 24 * 3600);

/// So many keys of each kind are forgotten in one step at most, so that no step is long because of them.
const AT_ONCE: usize = 64;

/// The keys of jobs, or of assignments.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Keys<I> {
    known: BTreeMap<String, I>,
    /// Those of what is over, with the time of acceptance. Ids are given in the order of acceptance, so the first one
    /// is the oldest.
    over: BTreeMap<I, (Time, String)>,
}

impl<I> Default for Keys<I> {
    fn default() -> Keys<I> {
        Keys { known: BTreeMap::new(), over: BTreeMap::new() }
    }
}

impl<I: Copy + Ord> Keys<I> {
    /// These keys: of what is open, and of what is over with the time of acceptance.
    pub fn of(
        open: impl IntoIterator<Item = (String, I)>,
        over: impl IntoIterator<Item = (I, Time, String)>,
    ) -> Keys<I> {
        let mut keys = Keys { known: open.into_iter().collect(), over: BTreeMap::new() };
        for (id, accepted, key) in over {
            keys.known.insert(key.clone(), id);
            keys.over.insert(id, (accepted, key));
        }
        keys
    }

    /// Keys of what is open.
    pub fn open(&self) -> impl Iterator<Item = (&str, I)> {
        let open = self.known.iter().filter(|(_, id)| !self.over.contains_key(id));
        open.map(|(key, id)| (key.as_str(), *id))
    }

    /// What this key was given for.
    pub fn get(&self, key: &str) -> Option<&I> {
        self.known.get(key)
    }

    /// How many keys are known.
    pub fn len(&self) -> usize {
        self.known.len()
    }

    /// Whether no key is known.
    pub fn is_empty(&self) -> bool {
        self.known.is_empty()
    }

    /// Keys of what is over, oldest first, with the time of acceptance.
    pub fn over(&self) -> impl Iterator<Item = (I, Time, &str)> {
        self.over.iter().map(|(id, (accepted, key))| (*id, *accepted, key.as_str()))
    }

    /// A key is known from now on.
    pub fn insert(&mut self, key: String, id: I) {
        self.known.insert(key, id);
    }

    /// What had this key is over; it was accepted then.
    pub fn end(&mut self, id: I, key: String, accepted: Time) {
        self.over.insert(id, (accepted, key));
    }

    /// Forgets the key of something that is over.
    pub(in crate::fleet) fn forget(&mut self, id: I) {
        let (_, key) = self.over.remove(&id).expect("only keys of what is over are forgotten");
        self.known.remove(&key);
    }

    /// The oldest keys that may be forgotten now.
    pub fn expired(&self, now: Time) -> Vec<I> {
        let old = self.over.iter().take_while(|(_, (accepted, _))| *accepted + KEY_LIFE <= now);
        old.take(AT_ONCE).map(|(id, _)| *id).collect()
    }
}
