//! The published reaction to a worker who left the path (Petković 2021, algorithm 6 and section 4.3.3), for
//! comparison.
//!
//! Main type: [`Procedure`]. All robots are interrupted; when they stand, the worker gets the common
//! beginning of the predicted paths if robots leave it free, else another way to its end, else robots are
//! asked to leave it, else the worker is told to stop. Then all robots are planned anew. Read with its
//! errata: the common segment is a prefix, and the most probable path stands in where paths share a single
//! node. Refuses: to be used by our own method.

use crate::aware::{BODY_M, Effects, HumanAwarePolicy};
use crate::fleet::Fleet;
use crate::fleet::people::intent::goal_of;
use crate::fleet::people::state::Mode;
use crate::fleet::state::fact::Fact;
use crate::fleet::state::floor::Floor;
use crate::fleet::state::worker::Reaction;
use crate::fleet::yielding::evade::TRIES;
use crate::geometry::{Point, Segment};
use crate::human::intention::reported_goals;
use crate::human::{Band, Hypothesis, Presence, common_prefix, straight_on, towards_goal};
use crate::id::{Dense, NodeId, RobotId, WorkerId};
use crate::route::{Cause, Effect, Route};
use crate::time::{Span, Time};
use crate::timeline::{Holder, Visit};
use std::collections::BTreeSet;

/// Whoever has not come to rest after this long is taken as it is.
const REST: Span = Span::from_secs(6);
/// A worker who was told to stop is tried again after this long.
const AGAIN: Span = Span::from_secs(5);
/// How far a path is predicted, metres.
const FAR_M: f64 = 30.0;
const STRAIGHT_M: f64 = 10.0;

/// The procedure in progress.
#[derive(Clone, Debug, Default)]
pub(in crate::fleet) struct Procedure {
    /// For whom robots stand, and since when.
    running: Option<(WorkerId, Time)>,
    /// Workers who left their path meanwhile.
    queue: BTreeSet<WorkerId>,
    /// Robots that are planned anew after it.
    again: BTreeSet<RobotId>,
}

impl Procedure {
    /// Whether a robot gets no further grants.
    pub fn holds(&self, robot: RobotId) -> bool {
        self.running.is_some() || self.again.contains(&robot)
    }
}

impl Fleet {
    /// Starts, and carries on with, the published procedure.
    pub(in crate::fleet) fn follow_procedure(&mut self, now: Time) {
        if self.settings.policy == HumanAwarePolicy::Giveway {
            return;
        }
        for worker in (0..self.crowd.people.len()).map(WorkerId::at) {
            if self.calls_for_procedure(worker, now) {
                self.crowd.procedure.queue.insert(worker);
            }
        }
        if self.crowd.procedure.running.is_none()
            && let Some(worker) = self.crowd.procedure.queue.pop_first()
        {
            self.interrupt_all(worker, now);
        }
        let Some((worker, since)) = self.crowd.procedure.running else { return };
        let all_stand = self.ledger.robots.ids().all(|r| self.is_at_rest(r));
        if all_stand || now - since > REST {
            self.crowd.procedure.running = None;
            self.crowd.procedure.again = self.ledger.robots.ids().collect();
            self.plan_for(worker, now);
        }
    }

    /// Whether a robot will not move any more without a grant, or while somebody is near.
    fn is_at_rest(&self, robot: RobotId) -> bool {
        let Some(seen) = self.scene.robot(robot) else { return true };
        let chain = self.ledger.chain(robot);
        let held = self.yielding.of(robot).is_told_to_stand();
        let stays = held || chain.first() + 1 == chain.granted();
        self.ledger.robots[robot].failed || seen.speed_mps < 0.05 && stays
    }

    fn calls_for_procedure(&self, worker: WorkerId, now: Time) -> bool {
        let person = &self.crowd.people[worker];
        let Some(place) = self.whereabouts(worker, now) else { return false };
        let running = self.crowd.procedure.running.is_some_and(|(w, _)| w == worker);
        if running || place.presence == Presence::Lost {
            return false;
        }
        match person.mode {
            Mode::Stopped { since } => now - since >= AGAIN,
            Mode::Deviating { .. } if self.settings.policy == HumanAwarePolicy::Nhir => {
                // Without a prediction nobody reacts before a robot had to.
                self.ledger.robots.ids().any(|r| {
                    let loaded = self.ledger.rack_on(r).is_some();
                    let radius = self.crowd.regions.stop_radius_m(loaded, 0.0);
                    (self.floor().place_of(r) - place.at).norm() < radius
                })
            }
            Mode::Deviating { since } => since == now,
            Mode::Idle | Mode::Following | Mode::Redirected => false,
        }
    }

    fn interrupt_all(&mut self, worker: WorkerId, now: Time) {
        self.crowd.procedure.running = Some((worker, now));
        for robot in self.ledger.robots.ids().collect::<Vec<_>>() {
            let drives = self.scene.robot(robot).is_some_and(|t| t.speed_mps > 0.05);
            let chain = self.ledger.chain(robot);
            if drives || chain.granted() < chain.end() {
                self.gives_way(robot, worker, Reaction::Stopped, now);
            }
        }
    }

    /// A path for the worker, once all robots stand.
    fn plan_for(&mut self, worker: WorkerId, now: Time) {
        let Some(place) = self.whereabouts(worker, now) else { return };
        let segment = self.predicted_segment(worker, place.at, now);
        let Some(end) = segment.last().copied() else { return };
        let in_the_way = self.floor().robots_on(&segment);
        if in_the_way.is_empty() {
            return self.accept(worker, segment, Mode::Following, now);
        }
        let mut cut = self.crowd.walkways.no_edges();
        let reach = self.warehouse().footprint_m / 2.0 + BODY_M;
        for robot in self.ledger.robots.ids() {
            self.crowd.walkways.edges_within(self.floor().place_of(robot), reach).into_iter().for_each(|e| {
                cut.insert(e);
            });
        }
        let other = self.crowd.walkways.path(place.at, end, &cut).map(|w| w.points);
        if let Some(path) = other.filter(|p| self.floor().robots_on(p).is_empty()) {
            return self.accept(worker, path, Mode::Redirected, now);
        }
        if self.all_leave(worker, &segment, &in_the_way, now) {
            return self.accept(worker, segment, Mode::Following, now);
        }
        self.crowd.people[worker].blocked_since = in_the_way.first().map(|r| (*r, now));
        self.crowd.people[worker].mode = Mode::Stopped { since: now };
    }

    fn accept(&mut self, worker: WorkerId, path: Vec<Point>, mode: Mode, now: Time) {
        let person = &mut self.crowd.people[worker];
        person.give(path, None, Span::ZERO, now);
        person.mode = mode;
    }

    /// Evasive moves: every robot on the path gets a route to a place off it, in time, or none of them moves.
    fn all_leave(&mut self, worker: WorkerId, path: &[Point], robots: &[RobotId], now: Time) -> bool {
        let before = self.crowd.conditions.clone();
        let warehouse = self.warehouse().clone();
        let effects =
            Effects { warehouse: &warehouse, regions: &self.crowd.regions, afoot: &self.crowd.afoot, now };
        let way = Hypothesis { probability: 1.0, path: path.to_vec(), stay: None };
        effects.plan(&mut self.crowd.conditions, worker, &way, Band::ANY);
        let routes = self.evasions(worker, robots, now);
        self.crowd.conditions = before;
        let Some(routes) = routes else { return false };
        let bookings = routes.into_iter().map(|(r, route)| self.floor().booking(r, route)).collect();
        self.record(Fact::Routed { bookings });
        for robot in robots {
            // It has just been planned; whatever else is earlier may lead back onto the path.
            self.crowd.procedure.again.remove(robot);
            self.tally.replans += 1;
            self.gives_way(*robot, worker, Reaction::Rerouted, now);
        }
        true
    }

    /// Routes off the path for all of these robots, each planned around those before it.
    fn evasions(&mut self, worker: WorkerId, robots: &[RobotId], now: Time) -> Option<Vec<(RobotId, Route)>> {
        let stands = |r: &RobotId| {
            let chain = self.ledger.chain(*r);
            let at_rest = chain.first() + 1 == chain.granted() && !self.floor().next_stop_is_granted(*r);
            at_rest && !self.ledger.robots[*r].failed
        };
        if !robots.iter().all(stands) {
            return None;
        }
        let mut scratch = self.ledger.timeline.clone();
        for robot in robots {
            scratch.withdraw(Holder::Robot(*robot), self.ledger.chain(*robot).granted() - 1);
        }
        let mut routes = Vec::new();
        for &robot in robots {
            // Where it stands is where nobody may be: any way off that comes no nearer is better.
            let mut away = self.away(robot, now);
            if away.iter().all(|a| a.from != Cause::Worker(worker)) {
                away.extend(self.away_from(self.ledger.node_of(robot), Cause::Worker(worker), now));
            }
            let mut places = self.places_out_of_the_way(robot, worker, now).into_iter().take(TRIES);
            let route = places.find_map(|place| {
                let route = self.way_aside(&scratch, robot, (place, &away), now)?;
                self.leaves_in_time(&route, place, worker).then_some(route)
            })?;
            let visits = std::iter::once(&route.kept).chain(&route.visits).cloned().collect();
            scratch.extend(Holder::Robot(robot), visits).ok()?;
            routes.push((robot, route));
        }
        Some(routes)
    }

    /// Whether a robot is off the path before a slow walker would be through: later, the worker would wait for
    /// the robot and the robot for the worker.
    fn leaves_in_time(&self, route: &Route, place: NodeId, worker: WorkerId) -> bool {
        let gone = |visit: &Visit| {
            let conditions = self.crowd.conditions.of(visit.node).iter();
            let mut closed =
                conditions.filter(|c| c.effect == Effect::Closed && c.cause == Cause::Worker(worker));
            closed.all(|c| visit.leave <= c.window.end())
        };
        std::iter::once(&route.kept).chain(&route.visits).take_while(|v| v.node != place).all(gone)
    }

    /// The path that is expected of a worker.
    fn predicted_segment(&self, worker: WorkerId, at: Point, now: Time) -> Vec<Point> {
        let home = || {
            let id = self.floor().next_assignment(worker)?;
            let goal = self.warehouse().nodes[self.ledger.assignments[&id].request.place].at;
            Some(self.crowd.walkways.path(at, goal, &self.crowd.walkways.no_edges())?.points)
        };
        match self.settings.policy {
            HumanAwarePolicy::Shir => {
                let heading = self.whereabouts(worker, now).and_then(|w| {
                    (w.velocity.norm() > 0.1).then(|| w.velocity.y.atan2(w.velocity.x)).or(w.heading)
                });
                straight_on(&self.crowd.walkways, at, heading.unwrap_or(0.0), STRAIGHT_M)
            }
            HumanAwarePolicy::Phir => {
                self.most_probable_segment(worker, at).or_else(home).unwrap_or_default()
            }
            HumanAwarePolicy::Nhir | HumanAwarePolicy::Giveway => home().unwrap_or_default(),
        }
    }

    fn most_probable_segment(&self, worker: WorkerId, at: Point) -> Option<Vec<Point>> {
        let mind = &self.crowd.mind;
        let belief = mind.belief(worker)?;
        let own = self.floor().next_assignment(worker).map(|id| self.ledger.assignments[&id].request.place);
        let end = own.map_or(crate::id::GoalId(u64::MAX), goal_of);
        let path = |goal| towards_goal(&mind.distances, goal, at, FAR_M);
        let paths: Vec<Vec<Point>> = reported_goals(&belief, end).into_iter().filter_map(path).collect();
        let prefix = common_prefix(&paths);
        if prefix.len() > 1 {
            return Some(prefix);
        }
        let best = belief.goals.iter().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))?;
        path(best.0)
    }

    /// Plans interrupted robots anew, a few in each step; who finds nothing better goes on as before.
    pub(in crate::fleet) fn plan_interrupted(&mut self, now: Time, budget: &mut u32) {
        while *budget > 0 {
            let Some(robot) = self.crowd.procedure.again.pop_first() else { return };
            let spent = self.plan_again(robot, now);
            *budget = budget.saturating_sub(spent);
        }
    }
}

impl Floor<'_> {
    /// Robots that stand where a path leads.
    fn robots_on(&self, path: &[Point]) -> Vec<RobotId> {
        let reach = self.warehouse().footprint_m / 2.0 + BODY_M;
        let on = |robot: &RobotId| {
            let at = self.place_of(*robot);
            path.windows(2).any(|s| Segment { a: s[0], b: s[1] }.distance_to(at) < reach)
        };
        self.ledger.robots.ids().filter(on).collect()
    }
}
