//! Warnings to a client: each kind at most every two seconds, with how many there were.
//!
//! Main type: [`Warnings`]. Pure. Refuses: to answer a flood with a flood.

use giveway_floor::time::{Span, Time};
use std::collections::BTreeMap;

/// How often a client is told of one kind of fault.
const OFTEN: Span = Span::from_secs(2);

/// What a client was told of, and what it was not told of yet.
#[derive(Clone, Debug, Default)]
pub struct Warnings {
    kinds: BTreeMap<&'static str, (Option<Time>, u64)>,
}

impl Warnings {
    /// Notes a fault. How many of its kind there were since the client was told last, if it is to be told now.
    pub fn note(&mut self, kind: &'static str, count: u64, now: Time) -> Option<u64> {
        let (told, untold) = self.kinds.entry(kind).or_default();
        *untold += count;
        if told.is_some_and(|t| now - t < OFTEN) {
            return None;
        }
        *told = Some(now);
        Some(std::mem::take(untold))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flood_of_faults_is_told_in_drops() {
        let mut warnings = Warnings::default();
        let told: Vec<u64> = (0..6000).filter_map(|ms| warnings.note("absurd", 1, Time(ms * 1000))).collect();
        assert_eq!(told, [1, 2000, 2000]);
        assert_eq!(warnings.note("future", 3, Time(1)), Some(3), "another kind is told at once");
    }
}
