//! Robots that are taken off the floor, and brought back later.
//!
//! Main type: [`Leavers`]. Refuses: to take away a robot that the fleet has not released at its resting place, unless
//! the robot is broken.

use crate::askers::ROBOTS;
use crate::random::Stream;
use giveway_fleet::{Input, Ledger, RobotAction, Service, Task, Token};
use giveway_floor::id::{NodeId, RobotId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::NodeKind;

/// The token of requests about robots that leave and come back.
const TOKEN: Token = Token { asker: ROBOTS, number: 0 };
/// If there is no room for a returning robot, another place is tried after this time.
const AGAIN: Span = Span::from_secs(5);

/// Which robots leave, and when they are brought back.
#[derive(Debug)]
pub(crate) struct Leavers {
    per_hour: f64,
    away: Span,
    random: Stream,
    next_try: Time,
}

impl Leavers {
    /// `per_hour` robots leave in an hour, and each is brought back after `away_s` seconds.
    pub fn new(per_hour: f64, away_s: f64, seed: u64) -> Leavers {
        let random = Stream::new(seed, 8, 0);
        Leavers { per_hour, away: Span::from_secs_f64(away_s), random, next_try: Time::ZERO }
    }

    /// The request due now, if any. Robots that are away come back even after customers have `stopped`.
    pub fn say(&mut self, now: Time, period: Span, stopped: bool, ledger: &Ledger) -> Option<Input> {
        if self.per_hour <= 0.0 {
            return None;
        }
        let robots = &ledger.robots;
        let hours = period.as_secs_f64() / 3600.0;
        if !stopped && !robots.is_empty() && self.random.happens(self.per_hour * hours) {
            let robot = RobotId(self.random.below(robots.len()) as u32);
            return Some(Input::ask(TOKEN, RobotAction::Retire(robot)));
        }
        if now < self.next_try {
            return None;
        }
        self.next_try = now + AGAIN;
        let due = |s: Service| matches!(s, Service::Gone { since } if now - since >= self.away);
        let (_, record) = robots.pairs().find(|(_, r)| due(r.service))?;
        let w = ledger.warehouse();
        let body = w.body_of(&record.kind);
        let places: Vec<NodeId> =
            w.nodes_where(NodeKind::is_lasting).into_iter().filter(|n| w.may_be_at(body, *n)).collect();
        let node = places[self.random.below(places.len())];
        let (name, kind) = (record.name.clone(), record.kind.clone());
        let link = Some(record.link.clone());
        Some(Input::ask(TOKEN, RobotAction::Register { name, kind, node, link }))
    }
}

/// Whether a leaving robot can be switched off and taken away.
pub(crate) fn may_be_taken(ledger: &Ledger, robot: RobotId) -> bool {
    let (record, chain) = (&ledger.robots[robot], ledger.chain(robot));
    let rests = record.task == Task::Idle && chain.first() + 1 == chain.end();
    let empty = ledger.rack_on(robot).is_none();
    matches!(record.service, Service::Leaving { .. }) && empty && (rests || record.failed)
}
