//! What a scenario says to the fleet beside orders: the areas that are closed for a time, at the start, and when the
//! building is evacuated.
//!
//! Main type: [`Announcements`]. Refuses: to say it again to a fleet that was told before a restart.

use super::customers::FIRST_TOKEN;
use super::scenario::Scenario;
use crate::fleet::{Fleet, Input};
use crate::time::{Span, Time};
use crate::warehouse::Warehouse;

/// Requests of this kind carry tokens from here on.
const ANNOUNCED: u64 = FIRST_TOKEN | 1 << 61;

/// What is still to be said, and when.
#[derive(Debug)]
pub(super) struct Announcements {
    ahead: Vec<(Time, Input)>,
}

impl Announcements {
    /// What a scenario says that begins at `start`, with a fleet that may have been told.
    ///
    /// # Panics
    /// If the map does not have a node that the scenario closes: see [`Scenario::areas`].
    pub fn new(scenario: &Scenario, warehouse: &Warehouse, fleet: &Fleet, start: Time) -> Announcements {
        let ledger = fleet.ledger();
        let told = ledger.next_closure > 1 || ledger.next_series > 1;
        let known = "whoever reads a scenario looks at its areas";
        let areas = scenario.areas(warehouse, start).expect(known).into_iter();
        let recurring = scenario.recurring(warehouse, start).expect(known).into_iter();
        let mut ahead: Vec<(Time, Input)> = Vec::new();
        if !told {
            ahead.extend(areas.map(|area| (start, Input::Close { token: 0, area })));
            ahead.extend(recurring.map(|closure| (start, Input::Recur { token: 0, closure })));
        }
        // A fleet with robots has been at work: its evacuations were ordered before.
        for e in scenario.evacuations.iter().filter(|_| ledger.robots.is_empty()) {
            let at = |s: f64| start + Span::from_secs_f64(s);
            ahead.push((at(e.at_s), Input::Evacuate { token: 0 }));
            ahead.push((at(e.until_s), Input::EndEvacuation { token: 0 }));
        }
        for ((_, input), token) in ahead.iter_mut().zip(ANNOUNCED..) {
            match input {
                Input::Close { token: t, .. }
                | Input::Recur { token: t, .. }
                | Input::Evacuate { token: t }
                | Input::EndEvacuation { token: t } => *t = token,
                _ => {}
            }
        }
        Announcements { ahead }
    }

    /// What is due.
    pub fn say(&mut self, now: Time) -> Vec<Input> {
        self.ahead.extract_if(.., |(at, _)| *at <= now).map(|(_, input)| input).collect()
    }
}
