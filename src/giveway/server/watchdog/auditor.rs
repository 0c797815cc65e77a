//! Checks the whole ledger, on the journal's task, which folds durable facts anyway: this costs the control loop
//! nothing.
//!
//! Main type: [`Auditor`]. Refuses: to repair contradictions.

use giveway_api::Alarms;
use giveway_drive::panic_text;
use giveway_fleet::Ledger;
use giveway_fleet::alarm::AlarmKind;
use giveway_floor::text::sentence::alarms as sentence;
use giveway_floor::time::Time;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// How many facts are folded between two checks.
const AUDIT_AFTER: usize = 20_000;

/// Checks the whole ledger, each time after `AUDIT_AFTER` facts.
#[derive(Debug, Default)]
pub struct Auditor {
    facts: usize,
}

impl Auditor {
    /// Notes that this many facts were folded; checks if it is time.
    pub fn note(&mut self, facts: usize, ledger: &Ledger, now: Time, alarms: &Alarms) {
        self.facts += facts;
        if self.facts < AUDIT_AFTER {
            return;
        }
        self.facts = 0;
        match catch_unwind(AssertUnwindSafe(|| ledger.assert_sound())) {
            Ok(()) => _ = alarms.clear(AlarmKind::LedgerUnsound, now),
            Err(panic) => {
                let said = panic_text(&*panic);
                let text = sentence::ledger_contradicts_itself(said);
                alarms.raise(AlarmKind::LedgerUnsound, text, now);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_fleet::{
        Fact, Fleet, JobFact, JobKind, JobRequest, JobState, Purpose, RobotFact, Settings, Task,
    };
    use giveway_floor::id::{JobId, NodeId, RobotId};
    use giveway_floor::warehouse::lab;
    use std::sync::Arc;

    #[test]
    fn promises_that_contradict_each_other_are_an_alarm() {
        let map = Arc::new(lab());
        let node = map.node_named("R118").expect("a charger of the laboratory");
        let (name, kind) = ("robot-1".into(), "robot".into());
        let joins = Fact::Robot(RobotFact::Registered { robot: RobotId(0), name, kind, node, at: Time(1) });
        let park = JobKind::Park { robot: RobotId(0) };
        let request = JobRequest::new(park);
        let (goal, stay, job) = (NodeId(0), NodeId(0), JobId(1));
        let task = Task::Move { job: Some(job), goal, stay, purpose: Purpose::Park };
        let state = JobState::Assigned { robot: RobotId(0) };
        let begins =
            Fact::Job(JobFact::Progressed { job, state, tasked: Some((RobotId(0), task)), at: Time(1) });
        let facts = [joins, Fact::Job(JobFact::Accepted { job, request, at: Time(1) }), begins];
        let fleet = Fleet::restore(map, Settings::default(), facts);
        let (alarms, mut auditor) = (Alarms::default(), Auditor::default());
        auditor.note(AUDIT_AFTER, fleet.ledger(), Time(1), &alarms);
        assert!(alarms.list().is_empty());
        let mut parts = fleet.ledger().to_parts();
        parts.promises.robots[RobotId(0)].task = Task::Idle;
        let (warehouse, kinds) = (fleet.warehouse().clone(), &fleet.settings().site_kinds);
        let broken = Ledger::from_parts(warehouse, kinds, parts).expect("it says nothing of jobs");
        auditor.note(1, &broken, Time(1), &alarms);
        assert!(alarms.list().is_empty(), "not every time");
        auditor.note(AUDIT_AFTER, &broken, Time(1), &alarms);
        assert_eq!(alarms.list()[0].kind, AlarmKind::LedgerUnsound);
    }
}
