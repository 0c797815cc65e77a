//! Warnings to a client: each kind at most every two seconds, with a count.
//!
//! Main type: [`Warnings`]. Pure. Refuses: to answer a flood with a flood.

use giveway_floor::time::{Span, Time};
use std::collections::BTreeMap;

/// The shortest interval between two warnings of one kind.
const OFTEN: Span = Span::from_secs(2);

/// Faults of which the client was warned, and faults that are still to be reported.
#[derive(Clone, Debug, Default)]
pub struct Warnings {
    kinds: BTreeMap<&'static str, (Option<Time>, u64)>,
}

impl Warnings {
    /// Notes a fault. Returns how many of its kind occurred since the last warning, if a warning is due now.
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
