//! Robots that need a route: since when, how often one was searched for, and whose turn it is at stations.
//!
//! Main type: [`Needs`]. Refuses: to search for routes.

use super::cut_off::Barrier;
use super::floor::Floor;
use super::tickets::{LAPSE, Ticket, Tickets};
use giveway_floor::id::{IdVec, RobotId, StationId};
use giveway_floor::time::{Span, Time};
use std::collections::{BTreeMap, BTreeSet};

/// A robot without the route that its task asks for.
#[derive(Clone, Copy, Debug)]
pub struct Need {
    pub since: Time,
    pub next_try: Time,
    pub tries: u32,
    /// Since when searches have failed while it was the robot's turn.
    pub fails_since: Option<Time>,
    /// The robot that is most in the way of the route that this robot would have if others made way, when last looked
    /// at; a robot that cannot drive, if there is no route past that one.
    pub behind: Option<RobotId>,
    /// What cut the robot off from its goal when its last search failed.
    pub cut: Option<Barrier>,
}

/// Robots that need a route, and when each robot last searched for a better one.
#[derive(Clone, Debug, Default)]
pub struct Needs {
    pub waiting: BTreeMap<RobotId, Need>,
    /// The robots' turns at stations.
    pub tickets: Tickets,
    pub looked: BTreeMap<RobotId, Time>,
    /// Robots that may go on earlier than planned.
    pub early: BTreeSet<RobotId>,
    /// Robots whose search was put off because the step had spent its budget, and since when.
    pub postponed: BTreeMap<RobotId, Time>,
    /// How long the last robot waited for room at each station before it set off.
    pub set_off: BTreeMap<StationId, Span>,
}

impl Needs {
    /// Robots without a route that come before this one at its station, the oldest ticket first.
    pub fn ahead<'a>(
        &'a self,
        floor: Floor<'a>,
        robot: RobotId,
        now: Time,
    ) -> impl Iterator<Item = RobotId> + 'a {
        let own = self.tickets.of(robot);
        let is_ahead = move |(other, ticket): &(RobotId, Ticket)| {
            own.is_some_and(|own| own.station == ticket.station && ticket.turn(*other) < own.turn(robot))
        };
        let expects_one =
            move |other: &RobotId| floor.lacks_route(*other) && !self.lies_still(floor, *other, now);
        let mut ahead: Vec<_> = self.tickets.all().filter(is_ahead).map(|(r, t)| t.turn(r)).collect();
        ahead.sort_unstable();
        ahead.into_iter().map(|(_, _, other)| other).filter(expects_one)
    }

    /// Whether a robot without a route is not expected to have one soon.
    fn lies_still(&self, floor: Floor<'_>, robot: RobotId, now: Time) -> bool {
        let fails = self.waiting.get(&robot).and_then(|need| need.fails_since);
        let is_fit = floor.scene.fit(robot, now).is_some() && !floor.ledger.robots[robot].failed;
        !is_fit || floor.is_halted(robot) || fails.is_some_and(|since| now - since > LAPSE)
    }

    /// Whether a loaded robot may set off to its station: the station has a place for it and for all robots that come
    /// before it, so whatever happens there, no robot on its way has to wait outside. `bound` says how many places of
    /// each station are taken. True for a robot that goes to no station, and for a robot that already stands at its
    /// station: none of the robots before it gets there as long as it does.
    pub fn has_its_turn(
        &self,
        floor: Floor<'_>,
        robot: RobotId,
        bound: &IdVec<StationId, usize>,
        now: Time,
    ) -> bool {
        let Some(station) = floor.station_of(robot).filter(|_| !floor.settings.without_conflicts) else {
            return true;
        };
        let places = floor.warehouse().stations[station].queue.len() + 1;
        let left = places.saturating_sub(bound[station]);
        let is_paused = floor.ledger.paused_stations.contains_key(&station);
        let is_there = floor.ledger.node_of(robot) == floor.warehouse().stations[station].node;
        !is_paused && (is_there || left > 0 && self.ahead(floor, robot, now).take(left).count() < left)
    }

    /// Whether a search for this robot failed lately.
    pub fn failed_before(&self, robot: RobotId) -> bool {
        self.waiting.get(&robot).is_some_and(|n| n.tries > 0)
    }

    /// Notes robots that may go on earlier than planned.
    pub fn left_early(&mut self, robots: Vec<RobotId>) {
        self.early.extend(robots);
    }

    /// Robots whose searches are put off until the next step, and since when: those put off before keep their time.
    pub fn still_postponed(
        &self,
        robots: impl Iterator<Item = RobotId>,
        now: Time,
    ) -> BTreeMap<RobotId, Time> {
        robots.map(|r| (r, self.postponed.get(&r).copied().unwrap_or(now))).collect()
    }

    /// How long a robot has needed a route.
    pub fn waited(&self, robot: RobotId, now: Time) -> Span {
        let waited = self.waiting.get(&robot).map_or(Span::ZERO, |n| now - n.since);
        debug_assert!(waited >= Span::ZERO, "{robot:?} needs a route from later on");
        waited
    }
}
