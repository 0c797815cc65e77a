//! Which restrictions bind a robot on its way ahead. If it is in a restricted place already, it may go wherever it
//! comes no nearer to what it is to leave.
//!
//! Refuses: to decide whether a robot waits or goes elsewhere.

use crate::state::floor::Floor;
use giveway_floor::geometry::Point;
use giveway_floor::id::{NodeId, RobotId};
use giveway_floor::route::{Cause, Condition, Effect, Exemption};
use giveway_floor::time::{Span, Time, Window};
use giveway_floor::timeline::Visit;
use giveway_people::aware::Zone;
use smallvec::SmallVec;
use std::collections::BTreeSet;

/// How far ahead holds are looked at: much can happen before later ones.
const AHEAD: Span = Span::from_secs(12);
/// About how long a robot needs to drive onto a node and off it again.
const PASSING: Span = Span::from_millis(1500);
/// How far ahead grants look at most: stops take as long as they take.
pub(crate) const STOPPING: Span = Span::from_secs(8);

/// Half of a robot with a rack plus a person beside it, metres: a robot on a node nearer than this to a person's way is
/// on that way.
pub(crate) const WAY_M: f64 = 0.9;

impl Floor<'_> {
    /// What does not bind a robot. If it is too near to a worker already, it may go wherever it comes no nearer. If it
    /// is in a closed area already, it may go on, since standing there would help no one.
    pub(crate) fn exemptions(&self, robot: RobotId, now: Time) -> SmallVec<[Exemption; 2]> {
        let chain = self.ledger.chain(robot);
        let node = chain.get(chain.granted() - 1).expect("what is granted is held").node;
        let mut exemptions: SmallVec<[Exemption; 2]> = SmallVec::new();
        for c in self.conditions(robot).of(node) {
            let binds = matches!(c.effect, Effect::NoEntryOrExit | Effect::Closed) && c.window.contains(now);
            // Only a robot on a way out may leave it: a grant for a node there does not let another robot on.
            let enters = c.cause == Cause::Evacuation && !self.is_on(robot, &self.restrictions.ways_out);
            if !binds || enters || exemptions.iter().any(|a| a.from == c.cause) {
                continue;
            }
            exemptions.extend(self.exemption_from(node, c.cause));
        }
        exemptions
    }

    /// Whether a robot is on one of these nodes.
    pub(crate) fn is_on(&self, robot: RobotId, nodes: &BTreeSet<NodeId>) -> bool {
        let chain = self.ledger.chain(robot);
        let at = self.place_of(robot);
        let held = (chain.first()..chain.granted()).filter_map(|s| chain.get(s)).map(|v| v.node);
        let mut on = held.filter(|n| nodes.contains(n));
        on.any(|n| (self.at(n) - at).norm() < WAY_M)
    }

    /// The exemption that lets a robot on a node go wherever it comes no nearer to what it is to leave.
    pub(crate) fn exemption_from(&self, node: NodeId, from: Cause) -> Option<Exemption> {
        let at = match from {
            Cause::Worker(worker) => self.restrictions.nearest_place(worker, self.at(node))?,
            Cause::Closure(_) | Cause::Evacuation => self.at(node),
            Cause::Robot(robot) => self.place_of(robot),
            Cause::Obstruction(there) => self.at(there),
        };
        Some(Exemption { from, at, distance_m: (self.at(node) - at).norm() })
    }

    /// The condition that keeps a visit from being granted, if one does.
    pub(crate) fn holds_back(&self, robot: RobotId, visit: &Visit, now: Time) -> Option<Condition> {
        self.holds_back_where(robot, visit, |_| true, now)
    }

    /// The condition, people aside, that keeps a visit from being granted to a robot that passes people, if one does.
    pub(crate) fn holds_back_besides_people(
        &self,
        robot: RobotId,
        visit: &Visit,
        now: Time,
    ) -> Option<Condition> {
        self.holds_back_where(robot, visit, |c| !matches!(c.cause, Cause::Worker(_)), now)
    }

    fn holds_back_where(
        &self,
        robot: RobotId,
        visit: &Visit,
        counts: impl Fn(&Condition) -> bool,
        now: Time,
    ) -> Option<Condition> {
        let conditions = self.conditions(robot);
        if conditions.of(visit.node).is_empty() {
            return None;
        }
        let exemptions = self.exemptions(robot, now);
        let long = if visit.leave.is_forever() { STOPPING } else { visit.leave - visit.enter };
        let there = Window::new(now, now + long.max(PASSING).min(STOPPING));
        let soon = Window::new(now, now + PASSING);
        let binds = |c: &&Condition| match c.effect {
            Effect::Closed => c.window.overlaps(there),
            Effect::NoEntryOrExit => c.window.overlaps(soon),
            Effect::SoftCost(_) | Effect::Slow(_) => false,
        };
        let mut binding = conditions.binding(visit.node, self.at(visit.node), &exemptions);
        binding.find(|c| counts(c) && binds(c)).copied()
    }

    /// The zones that the holds ahead of a robot share with people and closures. For each place, of the zones that the
    /// robot would meet, the one that ends last; if it would meet none, any other.
    pub(crate) fn zones(&self, robot: RobotId, now: Time) -> SmallVec<[(Cause, Zone); 4]> {
        let chain = self.ledger.chain(robot);
        let exemptions = self.exemptions(robot, now);
        let ahead = (chain.granted()..chain.end()).filter_map(|s| chain.get(s));
        let mut found = SmallVec::new();
        for visit in ahead.take_while(|v| v.enter <= now + AHEAD) {
            let enter = visit.enter.max(now);
            let stay = if visit.leave.is_forever() { STOPPING } else { visit.leave - visit.enter };
            let own = Window::new(enter, enter + stay.max(PASSING).min(STOPPING));
            let binding = self.conditions(robot).binding(visit.node, self.at(visit.node), &exemptions);
            let hard = |c: &&Condition| matches!(c.effect, Effect::Closed | Effect::NoEntryOrExit);
            let zones = binding.filter(hard).map(|c| (c.cause, Zone { robot: own, worker: c.window }));
            found.extend(zones.max_by_key(|(_, z)| z.meets().then(|| z.worker.end())));
        }
        found
    }

    /// Where the holds ahead of a robot meet the windows of people and closures.
    pub(crate) fn meetings(&self, robot: RobotId, now: Time) -> impl Iterator<Item = (Cause, Zone)> {
        self.zones(robot, now).into_iter().filter(|(_, zone)| zone.meets())
    }

    /// Until when the robot would have to wait because of conditions, not of other robots' holds.
    pub(crate) fn waits_until(&self, robot: RobotId, now: Time) -> Option<Time> {
        self.meetings(robot, now).map(|(_, zone)| zone.worker.end()).max()
    }

    fn at(&self, node: NodeId) -> Point {
        self.warehouse().nodes[node].at
    }
}
