//! Turns at stations: each robot that has lifted a rack for a station has a ticket, in the order of lifting.
//!
//! Main types: [`Tickets`], [`Ticket`]. A station has one place more than its queue. A place goes to the robot with the
//! oldest ticket, and no robot overtakes another unless that one lies still. Lost at a restart: robots that carry racks
//! then get new tickets, in the order of their numbers. Refuses: to search for routes, and to take away a place for
//! which a robot has a route.

use super::floor::Floor;
use giveway_floor::id::{IdVec, RobotId, StationId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::NodeKind;
use std::collections::BTreeMap;

/// A robot that has stood for this long without a prospect, or has found no route for this long, lies still: the place
/// that it was promised lapses, and others may overtake.
pub(crate) const LAPSE: Span = Span::from_secs(60);

/// A robot's turn at a station.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ticket {
    /// The station to which the robot carries its rack.
    pub station: StationId,
    /// When the robot lifted the rack.
    pub since: Time,
    /// When the robot's place lapsed. The robot comes after all others until as long has passed as it lay still.
    lapsed: Option<Time>,
}

impl Ticket {
    /// The key by which robots' turns are ordered.
    pub fn turn(&self, robot: RobotId) -> (bool, Time, RobotId) {
        (self.lapsed.is_some(), self.since, robot)
    }
}

/// The tickets of all robots that carry racks to stations.
#[derive(Clone, Debug, Default)]
pub struct Tickets(BTreeMap<RobotId, Ticket>);

impl Tickets {
    /// Gives tickets to robots that have lifted racks, and forgets the tickets of robots that no longer go to their
    /// station. O(robots).
    pub fn note(&mut self, floor: Floor<'_>, now: Time) {
        self.0.retain(|robot, ticket| floor.station_of(*robot) == Some(ticket.station));
        for robot in floor.ledger.present() {
            let Some(station) = floor.station_of(robot) else { continue };
            let ticket = self.0.entry(robot).or_insert(Ticket { station, since: now, lapsed: None });
            ticket.lapsed = ticket.lapsed.filter(|since| now - *since < LAPSE);
            debug_assert_eq!(ticket.station, station, "{robot:?} has the ticket of another station");
        }
    }

    /// When a robot lifted its rack for a station.
    pub fn since(&self, robot: RobotId) -> Option<Time> {
        self.0.get(&robot).map(|ticket| ticket.since)
    }

    /// The ticket of a robot.
    pub fn of(&self, robot: RobotId) -> Option<Ticket> {
        self.0.get(&robot).copied()
    }

    /// All tickets, by robot.
    pub fn all(&self) -> impl Iterator<Item = (RobotId, Ticket)> {
        self.0.iter().map(|(robot, ticket)| (*robot, *ticket))
    }

    /// Takes from a robot the place that it was promised.
    pub fn lapse(&mut self, robot: RobotId, now: Time) {
        let ticket = self.0.get_mut(&robot).expect("only a robot with a ticket was promised a place");
        ticket.lapsed = Some(now);
    }
}

impl Floor<'_> {
    /// Whether a robot has stood for long, nothing that it waits for goes on by itself, and it has nothing to do where
    /// it stands.
    pub fn has_no_prospect(&self, robot: RobotId, now: Time) -> bool {
        let wait = self.waits.robot(robot);
        let long = wait.standstill.or(wait.since.filter(|_| wait.is_for_an_operator()));
        !self.next_stop_is_granted(robot) && long.is_some_and(|since| now - since > LAPSE)
    }

    /// For each station, how many of its places are taken: by robots that stand there, robots that have a route there,
    /// and robots that have failed in its queue. A robot that has failed elsewhere takes none until it can go on.
    pub fn bound_for_stations(&self) -> IdVec<StationId, usize> {
        let mut bound = IdVec::filled(0, self.warehouse().stations.len());
        for robot in self.ledger.present() {
            let failed = self.ledger.robots[robot].failed;
            let there = match self.warehouse().kind(self.ledger.node_of(robot)) {
                NodeKind::Station(s) => Some(s),
                NodeKind::Queue(s) if failed => Some(s),
                _ => None,
            };
            let under_way = || self.station_of(robot).filter(|_| !failed && !self.lacks_route(robot));
            if let Some(station) = under_way().or(there) {
                bound[station] += 1;
            }
        }
        debug_assert!(
            bound.iter().sum::<usize>() <= self.ledger.present().count(),
            "each robot has one place"
        );
        bound
    }
}
