//! Looks at everything that was promised, where the journal's task folds what is durable, so that the control loop pays
//! nothing.
//!
//! Main type: [`Auditor`]. Refuses: to mend what contradicts itself.

use super::super::start::panic_text;
use crate::api::port::Alarms;
use crate::fleet::Ledger;
use crate::time::Time;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The alarm when what was promised contradicts itself.
const UNSOUND: &str = "ledger";
/// So many facts are taken in between two looks at everything that was promised.
const AUDIT_AFTER: usize = 20_000;

/// Looks at everything that was promised, after so many facts.
#[derive(Debug, Default)]
pub struct Auditor {
    facts: usize,
}

impl Auditor {
    /// So many facts were taken in.
    pub fn note(&mut self, facts: usize, ledger: &Ledger, now: Time, alarms: &Alarms) {
        self.facts += facts;
        if self.facts < AUDIT_AFTER {
            return;
        }
        self.facts = 0;
        match catch_unwind(AssertUnwindSafe(|| ledger.assert_sound())) {
            Ok(()) => _ = alarms.clear(UNSOUND),
            Err(panic) => {
                let said = panic_text(&*panic);
                let text = format!(
                    "the ledger contradicts itself: {said}. Keep a copy of the database and restart Giveway."
                );
                if alarms.raise(UNSOUND, text.clone(), now) {
                    tracing::error!("{text}");
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::fleet;
    use super::*;
    use crate::fleet::Task;
    use crate::id::RobotId;

    #[test]
    fn promises_that_contradict_each_other_are_an_alarm() {
        let (fleet, alarms, mut auditor) = (fleet(), Alarms::default(), Auditor::default());
        auditor.note(AUDIT_AFTER, fleet.ledger(), Time(1), &alarms);
        assert!(alarms.list().is_empty());
        let mut parts = fleet.ledger().to_parts();
        parts.promises.robots[RobotId(0)].task = Task::Idle;
        let (warehouse, clearance) = (fleet.warehouse().clone(), fleet.settings().clearance());
        let broken = Ledger::from_parts(warehouse, clearance, parts).expect("it says nothing of jobs");
        auditor.note(1, &broken, Time(1), &alarms);
        assert!(alarms.list().is_empty(), "not every time");
        auditor.note(AUDIT_AFTER, &broken, Time(1), &alarms);
        assert_eq!(alarms.list()[0].id, UNSOUND);
    }
}
