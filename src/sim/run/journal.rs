//! A journal in memory that may be late, refuse, and lose what it has not confirmed.
//!
//! Main type: [`SimJournal`]. Refuses: to lose what it has confirmed; nothing could recover from such a journal.

use giveway_drive::{JournalReport, JournalState, WrittenStep};
use giveway_fleet::{Fact, Ledger};
use giveway_floor::id::RobotId;
use giveway_floor::time::{Span, Time};
use std::collections::{BTreeMap, VecDeque};

/// A write that takes at least this long counts as slow.
const SLOW: Span = Span::from_secs(1);
/// How much longer a write takes in a slow period.
const SLOWER: Span = Span::from_millis(1_500);

/// The simulated journal.
pub struct SimJournal {
    /// The fold of the durable facts.
    ledger: Ledger,
    /// How many steps of this process are durable.
    durable: u64,
    /// The highest durable grant of each robot ever: the serial number of the first visit not granted.
    granted: BTreeMap<RobotId, u64>,
    /// Steps not yet durable, and when they will be.
    queue: VecDeque<(Time, WrittenStep)>,
    /// Duration of a write.
    pub delay: Span,
    /// Until when writes take much longer.
    pub slow_until: Time,
    /// Until when nothing is written.
    pub refuses_until: Time,
}

impl SimJournal {
    /// A journal that contains this ledger.
    pub fn new(ledger: Ledger, delay: Span) -> SimJournal {
        let (slow_until, refuses_until) = (Time::ZERO, Time::ZERO);
        SimJournal {
            ledger,
            durable: 0,
            granted: BTreeMap::new(),
            queue: VecDeque::new(),
            delay,
            slow_until,
            refuses_until,
        }
    }

    /// The fold of the durable facts.
    pub fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    /// Whether any durable fact granted this visit to a robot.
    pub fn has_granted(&self, robot: RobotId, serial: u64) -> bool {
        serial < self.granted.get(&robot).copied().unwrap_or(0).max(self.ledger.chain(robot).granted())
    }

    /// Queues a step to be written.
    pub fn write(&mut self, now: Time, step: WrittenStep) {
        let slower = if now < self.slow_until { SLOWER } else { Span::ZERO };
        let after = self.queue.back().map_or(now, |(due, _)| *due).max(now);
        self.queue.push_back((after.max(now + self.delay + slower), step));
    }

    /// Writes what is due; gives the facts that became durable.
    pub fn advance(&mut self, now: Time) -> Vec<Fact> {
        let mut facts = Vec::new();
        while now >= self.refuses_until && self.queue.front().is_some_and(|(due, _)| *due <= now) {
            facts.extend(self.take_one());
            self.durable += 1;
        }
        facts
    }

    /// Makes the oldest queued step durable and gives its facts.
    fn take_one(&mut self) -> Vec<Fact> {
        let (_, step) = self.queue.pop_front().expect("the caller looked");
        for fact in &step.facts {
            self.ledger.evolve(fact);
            if let Some(robot) = fact.robot() {
                let granted = self.ledger.chain(robot).granted();
                self.granted.entry(robot).and_modify(|most| *most = granted.max(*most)).or_insert(granted);
            }
        }
        step.facts
    }

    /// The journal's state.
    pub fn report(&self, now: Time) -> JournalReport {
        let late = self.queue.front().is_some_and(|(_, step)| now - step.at >= SLOW);
        let state = match (now < self.refuses_until, late) {
            (true, _) => JournalState::Refuses,
            (false, true) => JournalState::Slow,
            (false, false) => JournalState::Writes,
        };
        JournalReport { durable: self.durable, state }
    }

    /// How many steps are not durable.
    pub fn pending(&self) -> usize {
        self.queue.len()
    }

    /// The process dies. `on_disk` unconfirmed steps are on the disk all the same; the others are lost. Gives the facts
    /// that turn out to be durable.
    pub fn die(&mut self, on_disk: usize) -> Vec<Fact> {
        let kept = (0..on_disk.min(self.queue.len())).flat_map(|_| self.take_one()).collect();
        self.queue.clear();
        self.durable = 0;
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_fleet::{Fleet, FloorFact, Settings};
    use giveway_floor::warehouse::lab;
    use std::sync::Arc;

    fn step(at: i64) -> WrittenStep {
        let at = Time::ZERO + Span::from_secs(at);
        let halted = FloorFact::Halted { robot: None, at };
        WrittenStep { at, facts: vec![halted.into()], caused: vec![] }
    }

    #[test]
    fn steps_are_durable_in_their_order_and_those_that_were_not_confirmed_are_lost_or_not() {
        let ledger = Fleet::new(Arc::new(lab()), Settings::default()).ledger().clone();
        let at = |s: i64| Time::ZERO + Span::from_secs(s);
        let mut journal = SimJournal::new(ledger, Span::from_millis(500));
        journal.write(at(1), step(1));
        assert_eq!((journal.advance(at(1)).len(), journal.pending()), (0, 1));
        assert_eq!((journal.advance(at(2)).len(), journal.report(at(2)).durable), (1, 1));
        journal.refuses_until = at(20);
        (3..6).for_each(|s| journal.write(at(s), step(s)));
        assert_eq!(journal.advance(at(10)).len(), 0);
        assert_eq!(journal.report(at(10)).state, JournalState::Refuses);
        assert_eq!(journal.report(at(20)).state, JournalState::Slow);
        assert_eq!(journal.die(2).len(), 2);
        assert_eq!((journal.pending(), journal.report(at(20))), (0, JournalReport::default()));
        assert_eq!(journal.ledger().stopped, Some(at(4)), "of the facts, those that are on the disk count");
    }
}
