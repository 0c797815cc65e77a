//! Robots that give way: which grant has to wait for which worker, and which robot searches for another route.
//!
//! Decided by where windows meet (the cases of a potential collision zone, [`Zone`]): if the robot is through before
//! the worker comes, or comes after the worker is through, it keeps its route; if it would have to wait a little, it
//! waits; if it would have to wait for long, it searches for another route. Refuses: to look at robots whose holds no
//! worker touches.

use crate::people::state::HumanState;
use crate::state::binding::STOPPING;
use crate::state::floor::Floor;
use crate::state::passing::HeldChoice;
use crate::state::worker::Reaction;
use crate::state::writer::Writer;
use crate::traffic::state::Traffic;
use crate::yielding::state::Yielding;
use giveway_floor::id::{NodeId, RobotId, WorkerId};
use giveway_floor::route::{Cause, Condition, Effect};
use giveway_floor::time::{Span, Time, Window};
use giveway_people::aware::zone_answers::ZoneAnswer;
use giveway_people::aware::{Adaptation, HumanAwarePolicy, Zone};

/// Waiting up to this long is better than taking another route.
const PATIENCE: Span = Span::from_secs(3);
/// After a robot and a worker have waited for one another for this long, the robot leaves.
const CIRCLE: Span = Span::from_secs(5);
/// A robot searches for another route at most this often.
const AGAIN: Span = Span::from_secs(2);

/// What a robot does about a worker whose windows meet its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decision {
    /// No worker is expected where the robot drives.
    Free,
    /// The robot and the worker use the same places, but do not meet.
    Keep(WorkerId),
    /// The robot waits before it enters the zone, as its grants make it do by themselves.
    Wait(WorkerId),
    /// The robot searches for another route.
    Change(WorkerId),
    /// The robot stands in the worker's way, and searches for another place.
    Leave(WorkerId),
}

impl Decision {
    /// The answer to a potential collision zone, if the decision is one.
    fn answer(self) -> Option<(WorkerId, ZoneAnswer)> {
        match self {
            Decision::Keep(worker) => Some((worker, ZoneAnswer::Keep)),
            Decision::Wait(worker) => Some((worker, ZoneAnswer::Slow)),
            Decision::Change(worker) => Some((worker, ZoneAnswer::Change)),
            Decision::Free | Decision::Leave(_) => None,
        }
    }
}

impl Yielding {
    /// Looks at all robots whose holds a worker touches, and changes the routes of those that would wait for long.
    pub(crate) fn give_way(
        &mut self,
        writer: &mut Writer,
        people: &HumanState,
        traffic: &mut Traffic,
        now: Time,
    ) {
        if writer.restrictions.conditions.is_empty() {
            // There is no worker to give way to: what was noted of earlier waiting says nothing about the next time.
            self.state.no_worker_is_near(now);
            return;
        }
        let none_yields =
            || self.state.giving_way().next().is_none() && self.state.standing().next().is_none();
        if !writer.restrictions.conditions.has_passing() && none_yields() {
            return;
        }
        for robot in writer.ledger().present() {
            self.note_holding(writer, robot, now);
            if traffic.effort.is_spent() {
                continue;
            }
            let floor = writer.floor();
            let from = match floor.settings.policy {
                HumanAwarePolicy::Giveway => {
                    let decision = self.decide(floor, robot, now);
                    self.state.note_answer(robot, decision.answer(), now);
                    match decision {
                        Decision::Change(worker) | Decision::Leave(worker) => Some(worker),
                        Decision::Free | Decision::Keep(_) | Decision::Wait(_) => None,
                    }
                }
                // The published policies change routes by their procedure alone; a robot that stands before a person
                // for long may leave.
                _ if self.procedure.holds(robot) || floor.scene.fit(robot, now).is_none() => None,
                _ => self.has_stood_for_long(floor, robot, now),
            };
            match from {
                Some(worker) => self.change_route(writer, people, traffic, (robot, worker), now),
                None => self.pass_from_between(writer, people, robot, now),
            }
        }
    }

    /// Notes whether a robot stands because of a person, or is on its way again.
    fn note_holding(&mut self, writer: &mut Writer, robot: RobotId, now: Time) {
        let chain = writer.ledger().chain(robot);
        let at_end = chain.first() + 1 == chain.granted() && chain.granted() < chain.end();
        let stands = writer.scene.fit(robot, now).is_some_and(|t| t.speed_mps < 0.05);
        let due = chain.get(chain.granted()).filter(|v| at_end && stands && v.enter <= now);
        match due
            .and_then(|v| writer.floor().grant_waits_for(&self.state, robot, v, now))
            .map(|(cause, _)| cause)
        {
            Some(Cause::Worker(worker)) => self.gives_way(writer, robot, worker, Reaction::Held, now),
            Some(Cause::Closure(_) | Cause::Robot(_) | Cause::Obstruction(_) | Cause::Evacuation) => {}
            None if !stands => {
                let yielding = self.state.of_mut(robot);
                if !yielding.is_told_to_stand() && yielding.waited(now) > PATIENCE {
                    yielding.to = None;
                }
            }
            None => {}
        }
    }

    /// What a robot does by the cases of a potential collision zone, for its holds ahead.
    pub(crate) fn decide(&self, floor: Floor<'_>, robot: RobotId, now: Time) -> Decision {
        if floor.scene.fit(robot, now).is_none() {
            return Decision::Free;
        }
        if let Some(w) = self.must_leave(floor, robot, now) {
            return Decision::Leave(w);
        }
        let by_worker = |(c, zone): &(Cause, Zone)| match c {
            Cause::Worker(w) => Some((*w, *zone)),
            Cause::Closure(_) | Cause::Robot(_) | Cause::Obstruction(_) | Cause::Evacuation => None,
        };
        let zones = floor.zones(robot, now);
        let meets = zones.iter().filter(|(_, zone)| zone.meets()).find_map(by_worker);
        let Some((worker, zone)) = meets.or_else(|| zones.iter().find_map(by_worker)) else {
            return Decision::Free;
        };
        let waited = self.state.of(robot).waited(now);
        match zone.answer(PATIENCE - waited) {
            Adaptation::Keep => Decision::Keep(worker),
            Adaptation::Slow(_) => Decision::Wait(worker),
            Adaptation::Change => Decision::Change(worker),
        }
    }

    /// The worker on whose path the robot stands, if the robot can be asked to go at all.
    fn must_leave(&self, floor: Floor<'_>, robot: RobotId, now: Time) -> Option<WorkerId> {
        if !floor.could_be_sent_off(robot) {
            return None;
        }
        if let Some(worker) = self.has_stood_for_long(floor, robot, now) {
            return Some(worker);
        }
        let node = floor.ledger.node_of(robot);
        let soon = Window::new(now, now + STOPPING);
        floor.conditions(robot).of(node).iter().find_map(|c| match (c.effect, c.cause) {
            (Effect::Closed, Cause::Worker(w)) if c.window.overlaps(soon) => Some(w),
            _ => None,
        })
    }

    /// The worker for whom a robot has stood at the end of its grants for so long that it had better go elsewhere.
    fn has_stood_for_long(&self, floor: Floor<'_>, robot: RobotId, now: Time) -> Option<WorkerId> {
        if !floor.could_be_sent_off(robot) {
            return None;
        }
        let long = self.state.stood_for(robot, now).or(self.state.stuck_with(robot, now));
        let long = long.or_else(|| floor.waits_in_a_circle_with(robot, now));
        long.filter(|w| !floor.restrictions.let_pass.contains(w))
    }

    /// Searches for a route that does not meet the worker, and takes it if it is better than waiting and than passing
    /// the worker within the corridor.
    fn change_route(
        &mut self,
        writer: &mut Writer,
        people: &HumanState,
        traffic: &mut Traffic,
        (robot, worker): (RobotId, WorkerId),
        now: Time,
    ) {
        let last = self.state.of(robot).rerouted;
        if last.is_some_and(|t| now - t < AGAIN) || writer.ledger().robots[robot].failed {
            return;
        }
        let at_stop = writer.ledger().robots[robot].stops.first().map(|s| s.serial);
        let granted = writer.ledger().chain(robot).granted();
        if at_stop.is_some_and(|s| s < granted) {
            return;
        }
        self.state.of_mut(robot).rerouted = Some(now);
        let floor = writer.floor();
        let must_leave = self.must_leave(floor, robot, now).is_some() && !self.leads_off(floor, robot, now);
        if must_leave && self.pass_instead(writer, people, (robot, worker), now) {
            return;
        }
        if must_leave {
            return self.evade(writer, traffic, robot, worker, now);
        }
        let waited = self.state.of(robot).waited(now);
        let prospect = self.prospect(writer.floor(), people, (robot, worker), now);
        match (traffic.reroute(writer, robot, (waited, prospect.map(|p| p.arrives)), now), prospect) {
            (HeldChoice::Reroute, _) => self.gives_way(writer, robot, worker, Reaction::Rerouted, now),
            (HeldChoice::Pass, Some(prospect)) => self.pass(writer, robot, prospect),
            _ => {}
        }
    }

    /// Whether the next hold of a robot may be granted although the robot is too near to a person.
    fn leads_off(&self, floor: Floor<'_>, robot: RobotId, now: Time) -> bool {
        let chain = floor.ledger.chain(robot);
        let next = chain.get(chain.granted());
        next.is_some_and(|v| {
            let turn = || floor.ledger.timeline().waits_for(robot, chain.granted());
            floor.grant_waits_for(&self.state, robot, v, now).is_none() && turn().is_none()
        })
    }
}

/// How many nodes are looked at to find a place out of the way.
const PLACES: usize = 60;
/// How many of the places found a route is searched for.
pub(crate) const TRIES: usize = 3;

impl Yielding {
    /// Drives out of a worker's way to the nearest place where no person is expected, and on with the task from there.
    fn evade(
        &mut self,
        writer: &mut Writer,
        traffic: &mut Traffic,
        robot: RobotId,
        worker: WorkerId,
        now: Time,
    ) {
        let circle = writer.floor().waits_in_a_circle_with(robot, now);
        let stuck_with = circle.or(self.state.stuck_with(robot, now));
        if let Some(worker) = stuck_with {
            close_before(writer, robot, worker, now);
        }
        let places = writer.floor().places_out_of_the_way(robot, worker);
        let left = places.into_iter().take(TRIES).any(|place| traffic.detour(writer, robot, place, now));
        if left {
            traffic.tally.replans += 1;
        }
        let insert = !left && !writer.floor().waits_for_room(robot) && traffic.insert(writer, robot, now);
        let steps_out = |traffic: &mut Traffic, writer: &mut Writer| {
            stuck_with.is_some() && traffic.step_out(writer, robot, stuck_with, now)
        };
        if left || insert || steps_out(traffic, writer) {
            self.gives_way(writer, robot, worker, Reaction::Rerouted, now);
        }
    }
}

/// Closes what is nearer to a worker than a robot is, for the rest of the step. A worker who waits for a robot will not
/// have gone when the windows of a person who merely stands are over, so no route past that worker counts.
fn close_before(writer: &mut Writer, robot: RobotId, worker: WorkerId, now: Time) {
    let Some(at) = writer.restrictions.whereabouts(worker).map(|w| w.at) else { return };
    let own_m = (writer.floor().place_of(robot) - at).norm();
    let (window, cause) = (Window::new(now, Time::MAX), Cause::Worker(worker));
    for node in writer.ledger().warehouse().nodes_within(at, own_m) {
        writer.restrictions.conditions.add(node, Condition { window, effect: Effect::Closed, cause });
    }
}

impl Floor<'_> {
    /// Whether a robot is at the end of what it was granted, and can drive.
    fn could_be_sent_off(&self, robot: RobotId) -> bool {
        let chain = self.ledger.chain(robot);
        chain.first() + 1 == chain.granted() && !self.ledger.robots[robot].failed
    }

    /// The worker for whom a robot waits and who waits for the robot, directly or behind others, for over a moment.
    fn waits_in_a_circle_with(&self, robot: RobotId, now: Time) -> Option<WorkerId> {
        let (worker, since) = self.waits.circle_with(robot)?;
        (now - since > CIRCLE).then_some(worker)
    }

    /// Nodes near a robot without conditions, nearest first along lanes that the robot may drive, no nearer to the
    /// worker.
    pub(super) fn places_out_of_the_way(&self, robot: RobotId, worker: WorkerId) -> Vec<NodeId> {
        let floor = *self;
        let at = |n: NodeId| floor.warehouse().nodes[n].at;
        let Some(w) = floor.restrictions.whereabouts(worker) else { return Vec::new() };
        let loaded = floor.ledger.rack_on(robot).is_some();
        let start = floor.ledger.node_of(robot);
        let own = (at(start) - w.at).norm();
        let mut seen = vec![start];
        let mut found = Vec::new();
        let mut i = 0;
        while i < seen.len() && i < PLACES {
            let node = seen[i];
            i += 1;
            let hard = |c: &Condition| matches!(c.effect, Effect::Closed | Effect::NoEntryOrExit);
            if node != start && !floor.conditions(robot).of(node).iter().any(hard) {
                found.push(node);
                continue;
            }
            for (_, way) in floor.warehouse().ways(node) {
                let kind = floor.warehouse().kind(way.to);
                let open = way.users.allows(loaded)
                    && way.is_for(floor.body(robot))
                    && kind.reserved_for().is_none()
                    && !(loaded && kind == giveway_floor::warehouse::NodeKind::Storage);
                if open && (at(way.to) - w.at).norm() >= own - 0.15 && !seen.contains(&way.to) {
                    seen.push(way.to);
                }
            }
        }
        found
    }
}
