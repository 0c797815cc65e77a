//! A digest of facts that is the same on every run, unlike the standard hasher's.
//!
//! Main type: [`Digest`] (FNV-1a, 64 bits). Refuses: to protect against attackers; it finds differences, not forgeries.

use crate::fleet::Fact;
use std::hash::{Hash, Hasher};

/// The digest of all facts of a run.
#[derive(Clone, Debug, Default)]
pub struct Digest(Fnv);

impl Digest {
    /// Takes the facts of one step in.
    pub fn add(&mut self, facts: &[Fact]) {
        facts.iter().for_each(|f| f.hash(&mut self.0));
    }

    /// The digest so far.
    pub fn value(&self) -> u64 {
        self.0.finish()
    }
}

#[derive(Clone, Debug)]
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Fnv {
        Fnv(0xcbf2_9ce4_8422_2325)
    }
}

impl Hasher for Fnv {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for b in bytes {
            self.0 = (self.0 ^ u64::from(*b)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}
