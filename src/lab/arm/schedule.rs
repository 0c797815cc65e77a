//! Which targets are open to the arm while a person reaches for one (Lyu et al. 2022, table II), as printed and as
//! derived.
//!
//! Main types: [`TargetTable`]. Refuses: tables that name unknown targets.
//!
//! Derived means that a target is closed while the path to it meets the person's forecast arm with more than a
//! threshold probability.

use std::collections::BTreeMap;

/// For each of the person's targets, the targets that the arm may go to; targets count from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TargetTable {
    allowed: Vec<Vec<bool>>,
}

/// Why a table is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TargetTableError {
    /// The text is not a table.
    #[error("the table of targets cannot be read: {0}")]
    Unreadable(String),
    /// An unknown target, or a target without a line; numbered from 1 as in the text.
    #[error("the table of targets has no line for target {0}, or names it though there are fewer")]
    Target(usize),
}

impl TargetTable {
    /// Reads a table from JSON: for each of the person's targets, numbered from 1, the list of the arm's.
    ///
    /// # Errors
    /// The first fault in the table.
    pub fn parse(text: &str) -> Result<TargetTable, TargetTableError> {
        let lines: BTreeMap<usize, Vec<usize>> =
            serde_json::from_str(text).map_err(|e| TargetTableError::Unreadable(e.to_string()))?;
        let count = lines.len();
        if let Some(missing) = (1..=count).find(|k| !lines.contains_key(k)) {
            return Err(TargetTableError::Target(missing));
        }
        let mut allowed = vec![vec![false; count]; count];
        for (person, arms) in lines {
            for arm in arms {
                if arm == 0 || arm > count {
                    return Err(TargetTableError::Target(arm));
                }
                allowed[person - 1][arm - 1] = true;
            }
        }
        Ok(TargetTable { allowed })
    }

    /// Table II as printed.
    pub fn published() -> TargetTable {
        TargetTable::parse(include_str!("table_2.json")).expect("a test reads the built-in table")
    }

    /// A table derived for `count` targets: `meets(person, arm)` is the probability that the path to the arm's target
    /// meets the arm of a person reaching for the person's target.
    pub fn derived(count: usize, delta: f64, mut meets: impl FnMut(usize, usize) -> f64) -> TargetTable {
        let mut line = |person: usize| (0..count).map(|arm| meets(person, arm) <= delta).collect();
        TargetTable { allowed: (0..count).map(&mut line).collect() }
    }

    /// Whether the arm may go to its target while the person goes to theirs; unknown targets are closed.
    pub fn allows(&self, person: usize, arm: usize) -> bool {
        self.allowed.get(person).and_then(|line| line.get(arm)).copied().unwrap_or(false)
    }

    /// The probability that the arm's target is closed, given the probability of each of the person's targets.
    pub fn out(&self, person: &[f64], arm: usize) -> f64 {
        let out = person.iter().enumerate().filter(|(k, _)| !self.allows(*k, arm));
        out.map(|(_, p)| p).sum()
    }

    /// The share of pairs of targets on which both tables agree.
    pub fn agreement(&self, other: &TargetTable) -> f64 {
        let count = self.allowed.len().max(other.allowed.len());
        let pairs = (0..count).flat_map(|p| (0..count).map(move |a| (p, a)));
        let same = pairs.filter(|(p, a)| self.allows(*p, *a) == other.allows(*p, *a)).count();
        same as f64 / (count * count).max(1) as f64
    }

    /// The first target at or after `next`, cyclically, that is closed with a probability of at most `delta`.
    pub fn next(&self, person: &[f64], next: usize, delta: f64) -> Option<usize> {
        let count = self.allowed.len();
        let circle = (0..count).map(|k| (next + k) % count.max(1));
        circle.into_iter().find(|arm| self.out(person, *arm) <= delta)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_printed_table_is_read_whole() {
        let table = TargetTable::published();
        let open = |person: usize| (0..12).filter(|arm| table.allows(person - 1, *arm)).count();
        let counts: Vec<usize> = (1..=12).map(open).collect();
        assert_eq!(counts, [7, 6, 5, 6, 6, 8, 10, 9, 9, 9, 9, 10]);
        assert!((0..12).all(|k| !table.allows(k, k)), "nobody shares a target with the arm");
        assert!((table.agreement(&table) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_next_target_is_the_first_that_is_hardly_ever_out() {
        let table = TargetTable::published();
        let mut person = [0.0; 12];
        person[2] = 1.0;
        // While the person is at 3 the arm goes on from 9 to 12, skipping 10 and 11.
        assert_eq!(table.next(&person, 8, 0.05), Some(11));
        (person[2], person[11]) = (0.03, 0.97);
        assert_eq!(table.next(&person, 8, 0.05), Some(8));
        assert_eq!(table.next(&person, 8, 0.01), Some(0));
        let never = TargetTable::derived(3, 0.05, |_, _| 0.5);
        assert_eq!(never.next(&[1.0, 0.0, 0.0], 0, 0.05), None);
    }

    #[test]
    fn tables_with_targets_that_there_are_not_are_refused() {
        assert_eq!(TargetTable::parse("{\"1\": [2]}"), Err(TargetTableError::Target(2)));
        assert_eq!(TargetTable::parse("{\"2\": [1]}"), Err(TargetTableError::Target(1)));
        assert!(matches!(TargetTable::parse("[]"), Err(TargetTableError::Unreadable(_))));
    }
}
