//! Robots that give way: which grant has to wait for whom, and who looks for another route.
//!
//! Decided by where windows meet (the cases of a potential collision zone, [`Zone`]): if the robot is through
//! before the worker comes, or comes after the worker is through, it keeps its route; if it would have to wait
//! a little, it waits; if it would have to wait for long, it looks for another route. Refuses: to look at
//! anybody whose holds no worker touches.

use crate::aware::{Answer, HumanAwarePolicy, Zone};
use crate::fleet::Fleet;
use crate::fleet::state::floor::Floor;
use crate::fleet::state::worker::Reaction;
use crate::geometry::Point;
use crate::id::{NodeId, RobotId, WorkerId};
use crate::route::{Away, Cause, Condition, Effect};
use crate::time::{Span, Time, Window};
use crate::timeline::Visit;
use smallvec::SmallVec;

/// Waiting up to this is better than going elsewhere.
const PATIENCE: Span = Span::from_secs(3);
/// A robot looks for another route this often at most.
const AGAIN: Span = Span::from_secs(2);
/// Holds farther ahead than this are not looked at: much can happen before.
const AHEAD: Span = Span::from_secs(12);
/// A robot needs about this long to be on a node and off it again.
const PASSING: Span = Span::from_millis(1500);
/// Nobody looks farther ahead for a grant: stops take as long as they take.
const STOPPING: Span = Span::from_secs(8);

/// What a robot does about a worker whose windows meet its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::fleet) enum Decision {
    /// They do not meet.
    Keep,
    /// It waits before it enters the zone, as its grants do by themselves.
    Wait,
    /// It looks for another route.
    Change(WorkerId),
}

impl Fleet {
    /// Workers to whom a robot is too near already: it may go wherever it does not come nearer. Closed areas that it
    /// is in: it may go on, since nobody would be helped if it stood there.
    pub(in crate::fleet) fn away(&self, robot: RobotId, now: Time) -> SmallVec<[Away; 2]> {
        let chain = self.ledger.chain(robot);
        let node = chain.get(chain.granted() - 1).expect("what is granted is held").node;
        let mut away: SmallVec<[Away; 2]> = SmallVec::new();
        for c in self.crowd.conditions.of(node) {
            let binds = matches!(c.effect, Effect::Still | Effect::Closed) && c.window.contains(now);
            if !binds || away.iter().any(|a| a.from == c.cause) {
                continue;
            }
            away.extend(self.away_from(node, c.cause, now));
        }
        away
    }

    /// Leave to go from a node wherever it is not nearer to what is to be left.
    pub(in crate::fleet) fn away_from(&self, node: NodeId, from: Cause, now: Time) -> Option<Away> {
        let at = match from {
            Cause::Worker(worker) => self.whereabouts(worker, now)?.at,
            Cause::Closure(_) => self.floor().at(node),
            Cause::Robot(robot) => self.floor().place_of(robot),
        };
        Some(Away { from, at, distance_m: (self.floor().at(node) - at).norm() })
    }

    /// Because of what a visit cannot be granted now, and until when, where that is known.
    pub(in crate::fleet) fn grant_waits_for(
        &self,
        robot: RobotId,
        visit: &Visit,
        now: Time,
    ) -> Option<(Cause, Option<Time>)> {
        let faced = self.faces(robot, visit.node, now).map(|w| (Cause::Worker(w), None));
        faced.or_else(|| self.holds_back(robot, visit, now).map(|c| (c.cause, Some(c.window.end()))))
    }

    /// The condition that keeps a visit from being granted, if one does.
    fn holds_back(&self, robot: RobotId, visit: &Visit, now: Time) -> Option<Condition> {
        if self.crowd.conditions.of(visit.node).is_empty() {
            return None;
        }
        let away = self.away(robot, now);
        let long = if visit.leave.is_forever() { STOPPING } else { visit.leave - visit.enter };
        let there = Window::new(now, now + long.max(PASSING).min(STOPPING));
        let soon = Window::new(now, now + PASSING);
        let binds = |c: &&Condition| match c.effect {
            Effect::Closed => c.window.overlaps(there),
            Effect::Still => c.window.overlaps(soon),
            Effect::Price(_) | Effect::Slow(_) => false,
        };
        self.crowd.conditions.binding(visit.node, self.floor().at(visit.node), &away).find(binds).copied()
    }

    /// Looks at everybody whose holds a worker touches, and lets those change their route who would wait for
    /// long.
    pub(in crate::fleet) fn give_way(&mut self, now: Time, budget: &mut u32) {
        if self.crowd.conditions.is_empty() {
            // Nobody to give way to: what was noted of earlier waiting says nothing about the next one.
            self.yielding.no_worker_is_near();
            return;
        }
        let none_yields =
            || self.yielding.giving_way().next().is_none() && self.yielding.standing().next().is_none();
        if !self.crowd.conditions.has_passing() && none_yields() {
            return;
        }
        for robot in crate::fleet::state::ledger::all(&self.ledger.robots) {
            self.note_holding(robot, now);
            if *budget == 0 || self.settings.policy != HumanAwarePolicy::Giveway {
                continue;
            }
            if let Decision::Change(worker) = self.decide(robot, now) {
                self.change_route(robot, worker, now, budget);
            }
        }
    }

    /// Notes who stands because of somebody, and who is on the way again.
    fn note_holding(&mut self, robot: RobotId, now: Time) {
        let chain = self.ledger.chain(robot);
        let at_end = chain.first() + 1 == chain.granted() && chain.granted() < chain.end();
        let stands = self.scene.fit(robot, now).is_some_and(|t| t.speed_mps < 0.05);
        let due = chain.get(chain.granted()).filter(|v| at_end && stands && v.enter <= now);
        match due.and_then(|v| self.grant_waits_for(robot, v, now)).map(|(cause, _)| cause) {
            Some(Cause::Worker(worker)) => self.gives_way(robot, worker, Reaction::Held, now),
            Some(Cause::Closure(_) | Cause::Robot(_)) => {}
            None if !stands => {
                let yielding = self.yielding.of_mut(robot);
                if !yielding.is_told_to_stand() && yielding.waited(now) > PATIENCE {
                    yielding.to = None;
                }
            }
            None => {}
        }
    }

    /// Where the holds ahead of a robot meet the windows of somebody.
    fn meetings(&self, robot: RobotId, now: Time) -> SmallVec<[(Cause, Zone); 4]> {
        let chain = self.ledger.chain(robot);
        let away = self.away(robot, now);
        let ahead = (chain.granted()..chain.end()).filter_map(|s| chain.get(s));
        let mut found = SmallVec::new();
        for visit in ahead.take_while(|v| v.enter <= now + AHEAD) {
            let enter = visit.enter.max(now);
            let stay = if visit.leave.is_forever() { STOPPING } else { visit.leave - visit.enter };
            let own = Window::new(enter, enter + stay.max(PASSING).min(STOPPING));
            let binding = self.crowd.conditions.binding(visit.node, self.floor().at(visit.node), &away);
            let hard = |c: &&Condition| matches!(c.effect, Effect::Closed | Effect::Still);
            let zones = binding.filter(hard).map(|c| (c.cause, Zone { robot: own, worker: c.window }));
            let last = zones.filter(|(_, z)| z.meets()).max_by_key(|(_, z)| z.worker.end());
            found.extend(last);
        }
        found
    }

    /// The cases of a potential collision zone for the holds ahead.
    pub(in crate::fleet) fn decide(&self, robot: RobotId, now: Time) -> Decision {
        if self.scene.fit(robot, now).is_none() {
            return Decision::Keep;
        }
        if let Some(w) = self.must_leave(robot, now) {
            return Decision::Change(w);
        }
        let by_worker = |(c, zone): &(Cause, Zone)| match c {
            Cause::Worker(w) => Some((*w, *zone)),
            Cause::Closure(_) | Cause::Robot(_) => None,
        };
        let Some((worker, zone)) = self.meetings(robot, now).iter().find_map(by_worker) else {
            return Decision::Keep;
        };
        let waited = self.yielding.of(robot).waited(now);
        match zone.answer(PATIENCE - waited) {
            Answer::Keep => Decision::Keep,
            Answer::Slow(_) => Decision::Wait,
            Answer::Change => Decision::Change(worker),
        }
    }

    /// Until when the robot would have to wait for others than robots.
    pub(in crate::fleet) fn waits_until(&self, robot: RobotId, now: Time) -> Option<Time> {
        self.meetings(robot, now).iter().map(|(_, zone)| zone.worker.end()).max()
    }

    /// The worker on whose path the robot stands, if it can be asked to go at all.
    fn must_leave(&self, robot: RobotId, now: Time) -> Option<WorkerId> {
        let chain = self.ledger.chain(robot);
        if chain.first() + 1 != chain.granted() || self.ledger.robots[robot].failed {
            return None;
        }
        if let Some(worker) = self.stood_for(robot, now) {
            return Some(worker);
        }
        let node = self.ledger.node_of(robot);
        let soon = Window::new(now, now + STOPPING);
        self.crowd.conditions.of(node).iter().find_map(|c| match (c.effect, c.cause) {
            (Effect::Closed, Cause::Worker(w)) if c.window.overlaps(soon) => Some(w),
            _ => None,
        })
    }

    /// Looks for a route that does not meet the worker, and takes it where it is better than waiting.
    fn change_route(&mut self, robot: RobotId, worker: WorkerId, now: Time, budget: &mut u32) {
        let last = self.yielding.of(robot).rerouted;
        if last.is_some_and(|t| now - t < AGAIN) || self.ledger.robots[robot].failed {
            return;
        }
        let at_stop = self.ledger.robots[robot].stops.first().map(|s| s.serial);
        let granted = self.ledger.chain(robot).granted();
        if at_stop.is_some_and(|s| s < granted) {
            return;
        }
        self.yielding.of_mut(robot).rerouted = Some(now);
        let spent = if self.must_leave(robot, now).is_some() && !self.leads_off(robot, now) {
            self.evade(robot, worker, now)
        } else {
            self.reroute(robot, worker, now)
        };
        *budget = budget.saturating_sub(spent);
    }

    /// Whether the next hold of a robot may be granted although it is too near to somebody.
    fn leads_off(&self, robot: RobotId, now: Time) -> bool {
        let chain = self.ledger.chain(robot);
        let next = chain.get(chain.granted());
        next.is_some_and(|v| {
            self.grant_waits_for(robot, v, now).is_none()
                && self
                    .ledger
                    .timeline
                    .waits_for(crate::timeline::Holder::Robot(robot), chain.granted())
                    .is_none()
        })
    }
}

impl Floor<'_> {
    fn at(&self, node: NodeId) -> Point {
        self.warehouse().nodes[node].at
    }
}

/// Nodes to look at for a place out of the way.
const PLACES: usize = 60;
/// Searches for one.
pub(in crate::fleet) const TRIES: usize = 3;

impl Fleet {
    /// Sends a robot off a worker's path. Whether there was a way.
    pub(in crate::fleet) fn leaves(&mut self, robot: RobotId, worker: WorkerId, now: Time) -> bool {
        let places = self.places_out_of_the_way(robot, worker, now);
        let left = places.into_iter().take(TRIES).any(|place| self.detour(robot, place, now));
        if left {
            self.tally.replans += 1;
            self.gives_way(robot, worker, Reaction::Rerouted, now);
        }
        left
    }

    /// Drives out of a worker's way to the nearest place where nobody is expected, and on with the task from
    /// there.
    fn evade(&mut self, robot: RobotId, worker: WorkerId, now: Time) -> u32 {
        if !self.leaves(robot, worker, now) && !self.floor().waits_for_room(robot) && self.insert(robot, now)
        {
            self.gives_way(robot, worker, Reaction::Rerouted, now);
        }
        self.settings.expansions_per_plan
    }

    /// Nodes near a robot without conditions, nearest first over lanes that it may drive, not nearer to the
    /// worker.
    pub(in crate::fleet) fn places_out_of_the_way(
        &self,
        robot: RobotId,
        worker: WorkerId,
        now: Time,
    ) -> Vec<NodeId> {
        let Some(w) = self.whereabouts(worker, now) else { return Vec::new() };
        let loaded = self.ledger.rack_on(robot).is_some();
        let start = self.ledger.node_of(robot);
        let own = (self.floor().at(start) - w.at).norm();
        let mut seen = vec![start];
        let mut found = Vec::new();
        let mut i = 0;
        while i < seen.len() && i < PLACES {
            let node = seen[i];
            i += 1;
            let hard = |c: &Condition| matches!(c.effect, Effect::Closed | Effect::Still);
            if node != start && !self.crowd.conditions.of(node).iter().any(hard) {
                found.push(node);
                continue;
            }
            for (_, way) in self.warehouse().ways(node) {
                let kind = self.warehouse().kind(way.to);
                let open = way.users.allows(loaded)
                    && kind.reserved_for().is_none()
                    && !(loaded && kind == crate::warehouse::NodeKind::Storage);
                if open && (self.floor().at(way.to) - w.at).norm() >= own - 0.15 && !seen.contains(&way.to) {
                    seen.push(way.to);
                }
            }
        }
        found
    }
}
