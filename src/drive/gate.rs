//! How many of the decisions are durable, and whether more may be made.
//!
//! Main types: [`JournalGate`], [`JournalReport`]. Refuses: to count steps that the journal did not report.

use std::collections::VecDeque;

/// Number of facts that may wait for the journal; beyond it, the fleet stands until they are durable.
pub const MOST_PENDING: usize = 20_000;

/// The state of the journal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum JournalState {
    /// The journal takes facts.
    #[default]
    Writes,
    /// The journal has taken long over the last facts.
    Slow,
    /// The journal does not take facts.
    Refuses,
    /// The journal's file is not where it was: none of its reports count.
    Gone,
}

/// A report of the journal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JournalReport {
    /// Number of durable steps with facts, of those that this driver has had written.
    pub durable: u64,
    /// State of the journal.
    pub state: JournalState,
}

/// The gate between decisions and the messages that they cause.
#[derive(Debug, Default)]
pub struct JournalGate {
    /// Number of steps with facts so far.
    recorded: u64,
    journal: JournalReport,
    /// Number of facts of each step that is not durable yet, the oldest first.
    waiting: VecDeque<usize>,
    /// The sum of `waiting`.
    pending: usize,
}

impl JournalGate {
    /// Takes a report of the journal.
    ///
    /// # Panics
    /// If the journal reports more steps than it was given.
    pub fn note(&mut self, journal: JournalReport) {
        assert!(journal.durable <= self.recorded, "{journal:?} after {} steps", self.recorded);
        let JournalReport { durable, state } = journal;
        // Reports may be older than the last one.
        self.journal = JournalReport { durable: durable.max(self.journal.durable), state };
        while self.waiting.len() as u64 > self.recorded - self.journal.durable {
            self.pending -= self.waiting.pop_front().expect("it is not empty");
        }
    }

    /// Records the number of facts of a step. Gives the number of steps that must be durable before messages that
    /// depend on them may leave.
    pub fn record(&mut self, facts: usize) -> u64 {
        if facts > 0 {
            self.recorded += 1;
            self.waiting.push_back(facts);
            self.pending += facts;
        }
        self.recorded
    }

    /// Number of durable steps, if any messages may leave at all.
    pub fn releases(&self) -> Option<u64> {
        (self.journal.state != JournalState::Gone).then_some(self.journal.durable)
    }

    /// Whether no more facts may be added.
    pub fn is_full(&self) -> bool {
        self.pending >= MOST_PENDING
    }

    /// Whether new requests are refused.
    pub fn refuses(&self) -> bool {
        self.journal.state != JournalState::Writes || self.is_full()
    }

    /// Whether everything is durable.
    pub fn is_settled(&self) -> bool {
        self.recorded == self.journal.durable
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(durable: u64, state: JournalState) -> JournalReport {
        JournalReport { durable, state }
    }

    #[test]
    fn facts_are_counted_until_they_are_durable_and_a_step_without_any_waits_for_those_before() {
        let mut gate = JournalGate::default();
        assert_eq!((gate.record(0), gate.record(MOST_PENDING - 1), gate.record(0)), (0, 1, 1));
        assert!(!gate.is_full() && !gate.is_settled());
        assert_eq!(gate.record(1), 2);
        assert!(gate.is_full() && gate.refuses());
        gate.note(report(1, JournalState::Writes));
        assert!(!gate.is_full() && !gate.refuses() && !gate.is_settled());
        gate.note(report(2, JournalState::Writes));
        gate.note(report(1, JournalState::Writes));
        assert!(gate.is_settled(), "an old report takes nothing back");
    }

    #[test]
    fn nothing_leaves_by_the_word_of_a_journal_that_is_gone() {
        let mut gate = JournalGate::default();
        gate.record(1);
        gate.note(report(1, JournalState::Gone));
        assert_eq!((gate.releases(), gate.refuses()), (None, true));
        gate.note(report(1, JournalState::Slow));
        assert_eq!((gate.releases(), gate.refuses()), (Some(1), true));
    }
}
