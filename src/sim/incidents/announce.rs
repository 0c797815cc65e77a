//! What a scenario tells the fleet besides orders: the areas closed for a time, at the start, and when the building is
//! evacuated.
//!
//! Main type: [`Announcements`]. Refuses: to repeat an announcement to a fleet that got it before a restart.

use crate::askers::SUPERVISORS;
use crate::scenario::Scenario;
use giveway_fleet::{FloorAction, Input, Ledger, Token};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::Warehouse;

/// Announcements to come, each with its time.
#[derive(Debug)]
pub(crate) struct Announcements {
    /// Pending announcements with their times; those of one time leave in this order.
    ahead: Vec<(Time, FloorAction)>,
    said: u64,
}

impl Announcements {
    /// The announcements of a scenario that begins at `start`, to a fleet that may already have got them.
    ///
    /// # Panics
    /// If the map does not have a node that the scenario closes: see [`Scenario::areas`].
    pub fn new(scenario: &Scenario, warehouse: &Warehouse, ledger: &Ledger, start: Time) -> Announcements {
        let told = ledger.next_closure > 1 || ledger.next_series > 1;
        let known = "whoever reads a scenario looks at its areas";
        let areas = scenario.areas(warehouse, start).expect(known).into_iter();
        let recurring = scenario.recurring(warehouse, start).expect(known).into_iter();
        let mut ahead: Vec<(Time, FloorAction)> = Vec::new();
        if !told {
            ahead.extend(areas.map(|area| (start, FloorAction::Close(area))));
            ahead.extend(recurring.map(|closure| (start, FloorAction::Recur(closure))));
        }
        // A fleet with robots has been running: its evacuations were ordered before.
        for e in scenario.evacuations.iter().filter(|_| ledger.robots.is_empty()) {
            let at = |s: f64| start + Span::from_secs_f64(s);
            ahead.push((at(e.at_s), FloorAction::Evacuate));
            ahead.push((at(e.until_s), FloorAction::EndEvacuation));
        }
        Announcements { ahead, said: 0 }
    }

    /// Announcements that are due.
    pub fn say(&mut self, now: Time) -> Vec<Input> {
        let due = self.ahead.extract_if(.., |(at, _)| *at <= now);
        let ask = |(_, action)| {
            self.said += 1;
            Input::ask(Token { asker: SUPERVISORS, number: self.said }, action)
        };
        due.map(ask).collect()
    }
}
