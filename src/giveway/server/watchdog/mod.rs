//! Checks the fleet, the loop and the clock about once a second, and passes faults to the alarms; among the checks are
//! those laws of the simulation that make sense in operation, cheap and sampled.
//!
//! Main types: [`Watchdog`] (robots, people, jobs, steps), [`Auditor`] (reservations, and jobs against the robots that
//! serve them). Refuses: to repair anything, and to check everything in one turn of the loop.

mod auditor;

pub use auditor::Auditor;

use giveway_api::Alarms;
use giveway_fleet::alarm::{AlarmCondition, AlarmKind, AlarmSubject, FloorWatch, LoopHealth};
use giveway_fleet::{Fleet, View, untrue};
use giveway_floor::text::sentence::alarms;
use giveway_floor::time::{Span, Time};

/// Interval between checks of the fleet.
const LOOKS: Span = Span::from_secs(1);

/// Checks the fleet at intervals.
#[derive(Debug, Default)]
pub struct Watchdog {
    looked: Option<Time>,
    floor: FloorWatch,
    health: LoopHealth,
}

impl Watchdog {
    /// Notes the duration of a step.
    pub fn note_step(&mut self, now: Time, length: Span, period: Span) {
        self.health.period = period;
        self.health.steps.note(now, length > period);
    }

    /// Raises and ends alarms, once a second, however often it is called. `clock_ahead` is how far the system's clock
    /// is ahead.
    pub fn look(&mut self, fleet: &Fleet, view: &View, clock_ahead: Span, alarms: &Alarms) {
        let now = view.now;
        if self.looked.is_some_and(|at| now - at < LOOKS) {
            return;
        }
        self.looked = Some(now);
        self.health.clock_ahead = clock_ahead;
        let mut found = self.floor.look(fleet, view, &self.health);
        found.extend(waits_in_vain(fleet, now));
        alarms.observe(found, now);
    }
}

/// Robots that wait for something that does not hold them up. Waiting that ends in this very step does not count.
fn waits_in_vain(fleet: &Fleet, now: Time) -> Option<AlarmCondition> {
    let in_vain = fleet.ledger().present().filter(|r| untrue(fleet, *r, now).is_some());
    let names: Vec<&str> = in_vain.map(|r| fleet.ledger().robots[r].name.as_str()).collect();
    (!names.is_empty()).then(|| {
        let said = alarms::robots_wait_in_vain(names);
        AlarmCondition::new(AlarmKind::WaitsInVain, AlarmSubject::floor(), said)
    })
}
