//! Customers' keys: the same key never makes a second job or assignment, for as long as the key is known.
//!
//! Main types: [`Keys`], [`ClientKey`]. A key belongs to the customer who gave it: two customers who choose the same
//! text have two keys. A key lives as long as its job is open, and at least [`KEY_LIFE`] after the job was accepted.
//! Refuses: to forget anything by itself; a step records which keys are forgotten
//! ([`super::fact::FloorFact::KeysExpired`]).

use giveway_floor::id::CustomerId;
use giveway_floor::time::{Span, Time};
use std::collections::BTreeMap;
use std::hash::{Hash, Hasher};

/// How long at least a key is known after its job or assignment was accepted: 7 days.
pub const KEY_LIFE: Span = Span::from_secs(7 * 24 * 3600);

/// How many keys of each kind are forgotten in one step at most, so that no step is long because of them.
const AT_ONCE: usize = 64;

/// A customer's own key for a job or an assignment.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ClientKey {
    /// The customer whose key it is; nothing if that is not known.
    pub owner: Option<CustomerId>,
    /// The text that the customer chose.
    pub text: String,
}

impl<T: Into<String>> From<T> for ClientKey {
    /// A key whose owner is not known.
    fn from(text: T) -> ClientKey {
        ClientKey { owner: None, text: text.into() }
    }
}

impl Hash for ClientKey {
    fn hash<H: Hasher>(&self, to: &mut H) {
        self.text.hash(to);
        // Digests of recordings in which no customer is known stay what they were.
        if let Some(owner) = self.owner {
            owner.hash(to);
        }
    }
}

/// The keys of jobs, or of assignments.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Keys<I> {
    known: BTreeMap<ClientKey, I>,
    /// Keys of jobs or assignments that are over, with the time of acceptance. Ids are given in the order of
    /// acceptance, so the first one is the oldest.
    over: BTreeMap<I, (Time, ClientKey)>,
}

impl<I> Default for Keys<I> {
    fn default() -> Keys<I> {
        Keys { known: BTreeMap::new(), over: BTreeMap::new() }
    }
}

impl<I: Copy + Ord> Keys<I> {
    /// Takes keys of open jobs or assignments, and keys of those that are over, with the time of acceptance.
    pub fn of(
        open: impl IntoIterator<Item = (ClientKey, I)>,
        over: impl IntoIterator<Item = (I, Time, ClientKey)>,
    ) -> Keys<I> {
        let mut keys = Keys { known: open.into_iter().collect(), over: BTreeMap::new() };
        for (id, accepted, key) in over {
            keys.known.insert(key.clone(), id);
            keys.over.insert(id, (accepted, key));
        }
        keys
    }

    /// Keys of open jobs or assignments.
    pub fn open(&self) -> impl Iterator<Item = (&ClientKey, I)> {
        let open = self.known.iter().filter(|(_, id)| !self.over.contains_key(id));
        open.map(|(key, id)| (key, *id))
    }

    /// The job or assignment for which this key was given. A key of an earlier build, which did not note the owner, is
    /// found under its text by every customer, so that no retry over an update makes a second job.
    pub fn get(&self, key: &ClientKey) -> Option<&I> {
        self.known.get(key).or_else(|| self.known.get(&ClientKey::from(key.text.as_str())))
    }

    /// How many keys are known.
    pub fn len(&self) -> usize {
        self.known.len()
    }

    /// Whether no key is known.
    pub fn is_empty(&self) -> bool {
        self.known.is_empty()
    }

    /// Keys of jobs or assignments that are over, oldest first, with the time of acceptance.
    pub fn over(&self) -> impl Iterator<Item = (I, Time, &ClientKey)> {
        self.over.iter().map(|(id, (accepted, key))| (*id, *accepted, key))
    }

    /// Makes a key known from now on.
    pub fn insert(&mut self, key: ClientKey, id: I) {
        let before = self.known.insert(key, id);
        assert!(before.is_none(), "a key that is known makes nothing new");
    }

    /// Notes that the job or assignment with this key is over, and when it was accepted.
    pub fn end(&mut self, id: I, key: ClientKey, accepted: Time) {
        assert!(self.known.contains_key(&key), "what ends had its key");
        let before = self.over.insert(id, (accepted, key));
        assert!(before.is_none(), "what is over does not end again");
    }

    /// Forgets the key of a job or assignment that is over.
    pub(crate) fn forget(&mut self, id: I) {
        let (_, key) = self.over.remove(&id).expect("only keys of what is over are forgotten");
        self.known.remove(&key);
    }

    /// The oldest keys that may be forgotten now.
    pub fn expired(&self, now: Time) -> Vec<I> {
        let old = self.over.iter().take_while(|(_, (accepted, _))| *accepted + KEY_LIFE <= now);
        old.take(AT_ONCE).map(|(id, _)| *id).collect()
    }
}
