//! The published reaction to a worker who left the path (Petković 2021, algorithm 6 and section 4.3.3), for
//! comparison.
//!
//! All robots are interrupted. When they stand, the worker gets the common beginning of the predicted paths if robots
//! leave it free; else another way to its end; else robots are asked to leave it; else the worker is told to stop. Then
//! all robots are replanned. Read with its errata: the common segment is a prefix, and the most probable path stands in
//! where paths share a single node. Refuses: to be used by our own method.

use crate::people::intents::goal_of;
use crate::people::state::{HumanState, Led, WalkMode};
use crate::state::floor::Floor;
use crate::state::regions::KindConditions;
use crate::state::worker::Reaction;
use crate::state::writer::Writer;
use crate::traffic::joint::{commit_all, in_turn};
use crate::traffic::state::Traffic;
use crate::yielding::evade::TRIES;
use crate::yielding::state::Yielding;
use giveway_floor::geometry::{Point, Segment};
use giveway_floor::id::{NodeId, RobotId, WorkerId};
use giveway_floor::route::{Cause, Effect, Route};
use giveway_floor::time::{Span, Time};
use giveway_floor::timeline::Visit;
use giveway_people::aware::{Effects, HumanAwarePolicy};
use giveway_people::human::intention::reported_goals;
use giveway_people::human::{Hypothesis, Mover, Presence, common_prefix, straight_on, towards_goal};

/// A robot that has not come to rest after this long is taken as it is.
const REST: Span = Span::from_secs(6);
/// If a worker who was told to stop is still in robots' way, all robots are interrupted again after this long.
const AGAIN: Span = Span::from_secs(30);
/// How far a path is predicted, metres.
const FAR_M: f64 = 30.0;
const STRAIGHT_M: f64 = 10.0;
/// A worker who has moved by less than this still stands in the same place, metres.
const STOOD_M: f64 = 1.0;
/// A worker who was told to stop goes on when this much of the expected path is free, metres: robots farther along it
/// have the time to leave.
const CLEAR_M: f64 = 5.0;

impl Yielding {
    /// Starts the published procedure and carries it on. When it ends, returns the worker for whom it ran and where
    /// that worker is to be led.
    pub(crate) fn follow_procedure(
        &mut self,
        writer: &mut Writer,
        people: &HumanState,
        traffic: &mut Traffic,
        now: Time,
    ) -> Option<(WorkerId, Led)> {
        if writer.settings.policy == HumanAwarePolicy::Giveway {
            return None;
        }
        if let Some(led) = self.lets_go_on(writer.floor(), people, now) {
            return Some(led);
        }
        for worker in people.people.ids() {
            if self.calls_for_procedure(writer.floor(), people, worker, now) {
                self.procedure.queue.insert(worker);
            }
        }
        if self.procedure.running.is_none()
            && let Some(worker) = self.procedure.queue.pop_first()
        {
            self.interrupt_all(writer, worker, now);
        }
        let (worker, since) = self.procedure.running?;
        let all_stand = writer.ledger().present().all(|r| self.is_at_rest(writer.floor(), r));
        if !all_stand && now - since <= REST {
            return None;
        }
        self.procedure.running = None;
        self.procedure.again = writer.ledger().present().collect();
        self.procedure.ended = Some(now);
        Some((worker, self.plan_for(writer, people, traffic, worker, now)?))
    }

    /// A worker who was told to stop and has a way by now, so that no robot needs to be interrupted: no robot is on the
    /// beginning of the expected path and none is broken on the rest, or another way is free.
    fn lets_go_on(&self, floor: Floor<'_>, people: &HumanState, now: Time) -> Option<(WorkerId, Led)> {
        let running = self.procedure.running.map(|(w, _)| w);
        people.people.ids().filter(|w| running != Some(*w)).find_map(|worker| {
            if !matches!(people.people[worker].mode, WalkMode::Stopped { since } if since < now) {
                return None;
            }
            let place = people.whereabouts(worker, now).filter(|w| w.presence != Presence::Lost)?;
            let (at, mover) = (place.at, place.mover);
            // A worker who stands gives no new direction.
            let before = self.procedure.stopped.get(&worker).filter(|path| (path[0] - at).norm() < STOOD_M);
            let path = before.cloned().unwrap_or_else(|| predicted_segment(floor, people, worker, at, now));
            let end = *path.last()?;
            let cannot_leave = |r: &RobotId| floor.ledger.robots[*r].failed;
            let begins_free = path.len() > 1 && floor.robots_on(mover, &beginning(&path, CLEAR_M)).is_empty();
            if begins_free && !floor.robots_on(mover, &path).iter().any(cannot_leave) {
                return Some((worker, Led::AsExpected(path)));
            }
            Some((worker, Led::Redirected(floor.way_between_robots(people, mover, (at, end))?)))
        })
    }

    /// Whether a robot will not move any more without a grant, or while a person is near.
    fn is_at_rest(&self, floor: Floor<'_>, robot: RobotId) -> bool {
        let Some(seen) = floor.scene.robot(robot) else { return true };
        let chain = floor.ledger.chain(robot);
        let held = self.state.of(robot).is_told_to_stand();
        let stays = held || chain.first() + 1 == chain.granted();
        floor.ledger.robots[robot].failed || seen.speed_mps < 0.05 && stays
    }

    fn calls_for_procedure(
        &self,
        floor: Floor<'_>,
        people: &HumanState,
        worker: WorkerId,
        now: Time,
    ) -> bool {
        let person = &people.people[worker];
        let Some(place) = people.whereabouts(worker, now) else { return false };
        let running = self.procedure.running.is_some_and(|(w, _)| w == worker);
        if running || place.presence == Presence::Lost {
            return false;
        }
        match person.mode {
            WalkMode::Stopped { since } => now - since >= AGAIN,
            WalkMode::Deviating { .. } if floor.settings.policy == HumanAwarePolicy::Nhir => {
                // Without a prediction, the fleet does not react before a robot has to.
                floor.ledger.present().any(|r| {
                    let loaded = floor.ledger.rack_on(r).is_some();
                    let radius = floor.regions(r).towards(&place).stop_radius_m(loaded, 0.0);
                    (floor.place_of(r) - place.at).norm() < radius
                })
            }
            WalkMode::Deviating { since } => since == now,
            WalkMode::Idle | WalkMode::Following | WalkMode::Redirected => false,
        }
    }

    fn interrupt_all(&mut self, writer: &mut Writer, worker: WorkerId, now: Time) {
        self.procedure.running = Some((worker, now));
        for robot in writer.ledger().present().collect::<Vec<_>>() {
            let drives = writer.scene.robot(robot).is_some_and(|t| t.speed_mps > 0.05);
            let chain = writer.ledger().chain(robot);
            if drives || chain.granted() < chain.end() {
                self.gives_way(writer, robot, worker, Reaction::Stopped, now);
            }
        }
    }

    /// A path for the worker, once all robots stand.
    fn plan_for(
        &mut self,
        writer: &mut Writer,
        people: &HumanState,
        traffic: &mut Traffic,
        worker: WorkerId,
        now: Time,
    ) -> Option<Led> {
        let place = people.whereabouts(worker, now)?;
        let segment = predicted_segment(writer.floor(), people, worker, place.at, now);
        let end = segment.last().copied()?;
        let in_the_way = writer.floor().robots_on(place.mover, &segment);
        if in_the_way.is_empty() {
            return Some(Led::AsExpected(segment));
        }
        if let Some(path) = writer.floor().way_between_robots(people, place.mover, (place.at, end)) {
            return Some(Led::Redirected(path));
        }
        let mut conditions = writer.restrictions.conditions.clone();
        conditions.withdraw(Cause::Worker(worker));
        let way = Hypothesis { probability: 1.0, path: segment.clone(), stay: None };
        for (conditions, regions) in conditions.with_regions(&writer.regions) {
            let effects = Effects { warehouse: writer.warehouse(), regions, afoot: &people.afoot, now };
            effects.plan(conditions, (worker, place.mover), &way, place.mover.any_band());
        }
        if self.all_leave(writer, traffic, conditions, worker, &in_the_way, now) {
            return Some(Led::AsExpected(segment));
        }
        self.procedure.stopped.insert(worker, segment);
        Some(Led::Stopped { by: in_the_way.first().copied() })
    }

    /// Evasive moves: every robot on the path gets a route to a place off it, in time, or none of them moves. In
    /// `conditions`, the path is what the worker will walk.
    fn all_leave(
        &mut self,
        writer: &mut Writer,
        traffic: &mut Traffic,
        conditions: KindConditions,
        worker: WorkerId,
        robots: &[RobotId],
        now: Time,
    ) -> bool {
        let before = std::mem::replace(&mut writer.restrictions.conditions, conditions);
        let routes = evasions(writer.floor(), traffic, worker, robots, now);
        writer.restrictions.conditions = before;
        let Some(routes) = routes else { return false };
        commit_all(writer, routes);
        for robot in robots {
            // The robot has just been planned; any earlier route may lead back onto the path.
            self.procedure.again.remove(robot);
            traffic.tally.replans += 1;
            self.gives_way(writer, *robot, worker, Reaction::Rerouted, now);
        }
        true
    }

    /// Replans interrupted robots, a few in each step; a robot that finds nothing better goes on as before.
    pub(crate) fn plan_interrupted(&mut self, writer: &mut Writer, traffic: &mut Traffic, now: Time) {
        if self.procedure.ended == Some(now) {
            return;
        }
        while !traffic.effort.is_spent() {
            let Some(robot) = self.procedure.again.pop_first() else { return };
            traffic.plan_again(writer, robot, self.state.of(robot).waited(now), now);
        }
    }
}

/// Routes off the path for all of these robots, each planned around the routes before it.
fn evasions(
    floor: Floor<'_>,
    traffic: &mut Traffic,
    worker: WorkerId,
    robots: &[RobotId],
    now: Time,
) -> Option<Vec<(RobotId, Route)>> {
    let stands = |r: &RobotId| {
        let chain = floor.ledger.chain(*r);
        let at_rest = chain.first() + 1 == chain.granted() && !floor.next_stop_is_granted(*r);
        at_rest && !floor.ledger.robots[*r].failed
    };
    if !robots.iter().all(stands) {
        return None;
    }
    in_turn(floor, robots, |timeline, robot| {
        // The robot stands where no robot may be: any way off that comes no nearer is better.
        let mut exemptions = floor.exemptions(robot, now);
        if exemptions.iter().all(|a| a.from != Cause::Worker(worker)) {
            exemptions.extend(floor.exemption_from(floor.ledger.node_of(robot), Cause::Worker(worker)));
        }
        let mut places = floor.places_out_of_the_way(robot, worker);
        floor.sort_by_goal(&mut places, robot);
        places.into_iter().take(TRIES).find_map(|place| {
            let route = traffic.way_aside(floor, timeline, robot, (place, &exemptions), now)?;
            floor.leaves_in_time(robot, &route, place, worker).then_some(route)
        })
    })
}

/// The path that is expected of a worker.
fn predicted_segment(
    floor: Floor<'_>,
    people: &HumanState,
    worker: WorkerId,
    at: Point,
    now: Time,
) -> Vec<Point> {
    let home = || {
        let id = floor.next_assignment(worker)?;
        let goal = floor.warehouse().nodes[floor.ledger.assignments[&id].request.place].at;
        Some(
            people
                .walkways
                .path(at, goal, &people.walkways.edges_narrower_than(people.mover(worker).clearance_m()))?
                .points,
        )
    };
    match floor.settings.policy {
        HumanAwarePolicy::Shir => {
            let heading = people.whereabouts(worker, now).and_then(|w| {
                (w.velocity.norm() > 0.1).then(|| w.velocity.y.atan2(w.velocity.x)).or(w.heading)
            });
            straight_on(&people.walkways, at, heading.unwrap_or(0.0), STRAIGHT_M)
        }
        HumanAwarePolicy::Phir => {
            most_probable_segment(floor, people, worker, at).or_else(home).unwrap_or_default()
        }
        HumanAwarePolicy::Nhir | HumanAwarePolicy::Giveway => home().unwrap_or_default(),
    }
}

fn most_probable_segment(
    floor: Floor<'_>,
    people: &HumanState,
    worker: WorkerId,
    at: Point,
) -> Option<Vec<Point>> {
    let mind = &people.intents;
    let belief = mind.belief(worker)?;
    let own = floor.next_assignment(worker).map(|id| floor.ledger.assignments[&id].request.place);
    let end = own.map_or(giveway_floor::id::GoalId(u64::MAX), goal_of);
    let path = |goal| towards_goal(&mind.distances, goal, at, FAR_M);
    let paths: Vec<Vec<Point>> = reported_goals(&belief, end).into_iter().filter_map(path).collect();
    let prefix = common_prefix(&paths);
    if prefix.len() > 1 {
        return Some(prefix);
    }
    let best = belief.goals.iter().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))?;
    path(best.0)
}

/// The first metres of a path.
fn beginning(path: &[Point], metres: f64) -> Vec<Point> {
    let mut far_m = 0.0;
    let mut taken = Vec::new();
    for point in path {
        far_m += taken.last().map_or(0.0, |last: &Point| (point - last).norm());
        taken.push(*point);
        if far_m >= metres {
            break;
        }
    }
    taken
}

impl Floor<'_> {
    /// Sorts places so that those nearest to where the robot is bound for come first (Petković 2021, section 4.3.3).
    fn sort_by_goal(&self, places: &mut [NodeId], robot: RobotId) {
        let at = |n: NodeId| self.warehouse().nodes[n].at;
        let chain = self.ledger.chain(robot);
        let stop = self.ledger.robots[robot].stops.first().and_then(|stop| chain.get(stop.serial));
        let Some(goal) = stop.or(chain.last()).map(|visit| at(visit.node)) else { return };
        places.sort_by(|a, b| (at(*a) - goal).norm().total_cmp(&(at(*b) - goal).norm()));
    }

    /// Whether a robot is off the path before a slow walker would be through: later, the worker and the robot would
    /// wait for each other.
    fn leaves_in_time(&self, robot: RobotId, route: &Route, place: NodeId, worker: WorkerId) -> bool {
        let gone = |visit: &Visit| {
            let conditions = self.conditions(robot).of(visit.node).iter();
            let mut closed =
                conditions.filter(|c| c.effect == Effect::Closed && c.cause == Cause::Worker(worker));
            closed.all(|c| visit.leave <= c.window.end())
        };
        std::iter::once(&route.kept).chain(&route.visits).take_while(|v| v.node != place).all(gone)
    }

    /// A way on which no robot stands.
    fn way_between_robots(
        &self,
        people: &HumanState,
        mover: Mover,
        (from, to): (Point, Point),
    ) -> Option<Vec<Point>> {
        let mut cut = people.walkways.edges_narrower_than(mover.clearance_m());
        for robot in self.ledger.present() {
            let (at, reach) = (self.place_of(robot), self.beside_m(robot, mover.half_width_m()));
            people.walkways.edges_within(at, reach).into_iter().for_each(|e| {
                cut.insert(e);
            });
        }
        let way = people.walkways.path(from, to, &cut).map(|w| w.points)?;
        self.robots_on(mover, &way).is_empty().then_some(way)
    }

    /// Robots that stand where a path leads.
    fn robots_on(&self, mover: Mover, path: &[Point]) -> Vec<RobotId> {
        let on = |robot: &RobotId| {
            let (at, reach) = (self.place_of(*robot), self.beside_m(*robot, mover.half_width_m()));
            path.windows(2).any(|s| Segment { a: s[0], b: s[1] }.distance_to(at) < reach)
        };
        self.ledger.present().filter(on).collect()
    }
}
