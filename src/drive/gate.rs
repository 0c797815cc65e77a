//! What of the decisions is durable, and whether there may be more of them.
//!
//! Main types: [`JournalGate`], [`JournalReport`]. Refuses: to count what the journal did not say.

use std::collections::VecDeque;

/// So many facts may wait for the journal; then the fleet stands until they are durable.
pub const MOST_PENDING: usize = 20_000;

/// How the journal is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum JournalState {
    /// It takes facts.
    #[default]
    Writes,
    /// It has taken long over the last ones.
    Slow,
    /// It does not take them.
    Refuses,
    /// It is not where it was: nothing that it says counts.
    Gone,
}

/// What the journal says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JournalReport {
    /// How many steps with facts are durable, of those that this driver has had written.
    pub durable: u64,
    /// How it is.
    pub state: JournalState,
}

/// Between decisions and what leaves because of them.
#[derive(Debug, Default)]
pub struct JournalGate {
    /// Steps with facts so far.
    recorded: u64,
    journal: JournalReport,
    /// How many facts each step has that is not durable, the oldest first.
    waiting: VecDeque<usize>,
    /// The sum of these.
    pending: usize,
}

impl JournalGate {
    /// Takes in what the journal says.
    ///
    /// # Panics
    /// If it has more than it was given.
    pub fn note(&mut self, journal: JournalReport) {
        assert!(journal.durable <= self.recorded, "{journal:?} after {} steps", self.recorded);
        let JournalReport { durable, state } = journal;
        // Reports may be older than the last one.
        self.journal = JournalReport { durable: durable.max(self.journal.durable), state };
        while self.waiting.len() as u64 > self.recorded - self.journal.durable {
            self.pending -= self.waiting.pop_front().expect("it is not empty");
        }
    }

    /// A step has so many facts. What depends on them may leave when so many steps are durable as this says.
    pub fn record(&mut self, facts: usize) -> u64 {
        if facts > 0 {
            self.recorded += 1;
            self.waiting.push_back(facts);
            self.pending += facts;
        }
        self.recorded
    }

    /// How many steps are durable, if anything may leave at all.
    pub fn releases(&self) -> Option<u64> {
        (self.journal.state != JournalState::Gone).then_some(self.journal.durable)
    }

    /// Whether there may be no more facts.
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
