//! Robots that need a route: since when, how often one was looked for, and whose turn it is at stations.
//!
//! Main type: [`Needs`]. Refuses: to look for routes.

use super::tickets::Tickets;
use crate::id::{RobotId, StationId};
use crate::time::{Span, Time};
use std::collections::{BTreeMap, BTreeSet};

/// A robot without the route that its task asks for.
#[derive(Clone, Copy, Debug)]
pub(in crate::fleet) struct Need {
    pub since: Time,
    pub next_try: Time,
    pub tries: u32,
    /// Since when searches have failed, while it was its turn.
    pub fails_since: Option<Time>,
    /// The robot most in the way of the route that it would have if others made way, when that was looked at last; one
    /// that cannot drive if there is no route past it.
    pub behind: Option<RobotId>,
}

/// Robots that need a route, and when each looked for a better one last.
#[derive(Clone, Debug, Default)]
pub(in crate::fleet) struct Needs {
    pub waiting: BTreeMap<RobotId, Need>,
    /// Whose turn it is at stations.
    pub tickets: Tickets,
    pub looked: BTreeMap<RobotId, Time>,
    /// Robots that may go on earlier than planned.
    pub early: BTreeSet<RobotId>,
    /// How long the last one waited for room at a station before it set off.
    pub set_off: BTreeMap<StationId, Span>,
}

impl Needs {
    /// Whether a search for this robot failed lately.
    pub fn failed_before(&self, robot: RobotId) -> bool {
        self.waiting.get(&robot).is_some_and(|n| n.tries > 0)
    }

    /// These robots may go on earlier than planned.
    pub fn left_early(&mut self, robots: Vec<RobotId>) {
        self.early.extend(robots);
    }

    /// How long a robot has needed a route.
    pub fn waited(&self, robot: RobotId, now: Time) -> Span {
        let waited = self.waiting.get(&robot).map_or(Span::ZERO, |n| now - n.since);
        debug_assert!(waited >= Span::ZERO, "{robot:?} needs a route from later on");
        waited
    }
}
