//! Second phase: what do people mean for robots? Beliefs become stops, regions and prices before anybody plans.
//!
//! Stops and slow-downs leave at once; everything else enters the search and the grants as conditions.
//! Refuses: to plan for robots, and to trust a sighting that cannot be true.

use super::Fleet;
use super::crowd::Mode;
use super::fact::Fact;
use super::io::Command;
use super::people::{AssignmentState, Encounter, Reaction};
use crate::aware::{Arm, BODY_M, Effects, Near, SLOW_MPS};
use crate::geometry::{Point, Segment, to_mm};
use crate::human::{Band, Conduct, Hypothesis, Presence, Sighting, Taken, Whereabouts};
use crate::id::{AssignmentId, Dense, RobotId, WorkerId};
use crate::route::{Cause, Effect};
use crate::time::{Span, Time};
use crate::warehouse::walkway::EdgeSet;

/// A worker this near to the end of the path is there, metres.
const THERE_M: f64 = 0.6;
/// Whoever follows a new path for this far is on the path again, metres.
const BACK_M: f64 = 1.0;
/// A worker off the path is shown a new one this often.
const REDIRECT: Span = Span::from_secs(1);
/// A robot that stands on a worker's path for this long is walked round.
const BLOCKED: Span = Span::from_secs(3);
/// How far a worker is sent out of the way at most, metres.
const REFUGE_M: f64 = 15.0;
/// How far such a place is from what robots are about to drive, metres.
const REFUGE_CLEAR_M: f64 = 2.5;
/// So many nodes ahead of a robot are what it is about to drive.
const REFUGE_AHEAD: usize = 6;
/// Whoever is slower than this stands, more or less, metres per second.
const STROLL_MPS: f64 = 0.3;
/// Room beyond region 1 that a robot leaves to somebody who stands, metres.
const ROOM_M: f64 = 0.3;
/// Robots are told their limit again after this long, until they say that they know it.
const INSIST: Span = Span::from_millis(100);
/// Robots and workers farther apart than this are of no interest to one another, metres.
const FAR_M: f64 = 12.0;
/// Somebody off the path walks anywhere within this of an alternative, metres: places off the map are absurd.
const MARGIN_M: f64 = 3.0;

impl Fleet {
    /// Takes a sighting in.
    pub(super) fn sight(&mut self, s: &Sighting, now: Time) {
        let (low, high) = self.warehouse().bounds();
        let is_on_map = |p: Point| {
            let x = (low.x - MARGIN_M..=high.x + MARGIN_M).contains(&p.x);
            x && (low.y - MARGIN_M..=high.y + MARGIN_M).contains(&p.y)
        };
        let person = self.crowd.person(s.worker);
        match person.track.see(s, now, is_on_map) {
            Taken::Ignored => {}
            Taken::Moved => person.fresh = true,
            Taken::Relocated => (person.fresh, person.relocated) = (true, true),
        }
    }

    pub(super) fn judge(&mut self, now: Time) {
        self.crowd.conditions.clear();
        if self.crowd.people.is_empty() && self.ledger.closures.is_empty() {
            return;
        }
        for worker in (0..self.crowd.people.len()).map(WorkerId::at) {
            self.watch(worker, now);
        }
        self.infer(now);
        self.follow_procedure(now);
        self.set_conditions(now);
        self.limit_robots(now);
        self.meet(now);
        self.guide(now);
        for worker in (0..self.crowd.people.len()).map(WorkerId::at) {
            let person = &mut self.crowd.people[worker];
            (person.fresh, person.relocated) = (false, false);
        }
    }

    /// Where a worker is, if on the floor.
    pub(super) fn whereabouts(&self, worker: WorkerId, now: Time) -> Option<Whereabouts> {
        self.crowd.people.get(worker)?.track.whereabouts(now)
    }

    /// Everybody on the floor.
    pub(super) fn present(&self, now: Time) -> Vec<(WorkerId, Whereabouts)> {
        let people = self.crowd.people.pairs();
        people.filter_map(|(w, p)| Some((w, p.track.whereabouts(now)?))).collect()
    }

    /// Follows one worker: assignment, path, deviation.
    fn watch(&mut self, worker: WorkerId, now: Time) {
        let Some(place) = self.whereabouts(worker, now) else { return };
        self.take_up_work(worker, place.at, now);
        let person = &mut self.crowd.people[worker];
        if person.relocated {
            // Nobody walked: the path starts here anew.
            self.lead_on(worker, place.at, now);
            return;
        }
        if !person.fresh {
            return;
        }
        self.look_ahead(worker, &place, now);
        let person = &mut self.crowd.people[worker];
        let Some(plan) = person.plan.as_mut() else { return };
        let conduct = plan.follower.observe(place.at, place.sigma_m);
        match (conduct, person.mode) {
            (Conduct::Deviating, Mode::Deviating { .. }) => self.show_the_way_back(worker, place.at, now),
            (Conduct::Deviating, _) => self.leaves_path(worker, place.at, now),
            (Conduct::Outside, _) => {}
            (Conduct::OnPath, Mode::Deviating { .. }) => {
                let start = plan.follower.path()[0];
                if (place.at - start).norm() > BACK_M {
                    person.mode = Mode::Following;
                }
            }
            (Conduct::OnPath, Mode::Redirected) if plan.follower.progress() == 0 => {}
            (Conduct::OnPath, Mode::Stopped { since }) if now - since < REDIRECT => {}
            (Conduct::OnPath, _) => person.mode = Mode::Following,
            (Conduct::Arrived, _) => self.at_the_end(worker, place.at, now),
        }
    }

    /// The assignment that a worker is at, or is to begin.
    pub(super) fn next_assignment(&self, worker: WorkerId) -> Option<AssignmentId> {
        let own = self.ledger.assignments.iter().filter(|(_, a)| a.worker == worker);
        own.map(|(id, _)| *id).next()
    }

    /// Starts the next assignment, or drops the path of one that was cancelled.
    fn take_up_work(&mut self, worker: WorkerId, at: Point, now: Time) {
        let next = self.next_assignment(worker);
        let person = &self.crowd.people[worker];
        let current = person.plan.as_ref().and_then(|p| p.assignment);
        if person.plan.is_some() && (current == next || current.is_none()) {
            return;
        }
        match next {
            Some(id) => {
                if self.ledger.assignments[&id].state == AssignmentState::Waiting {
                    let state = AssignmentState::Walking;
                    self.record(Fact::Advanced { assignment: id, state, at: now });
                }
                self.lead_on(worker, at, now);
            }
            None => {
                let person = &mut self.crowd.people[worker];
                (person.plan, person.mode) = (None, Mode::Idle);
            }
        }
    }

    /// Gives a worker the way from `at` to the next assignment.
    pub(super) fn lead_on(&mut self, worker: WorkerId, at: Point, now: Time) {
        let Some(id) = self.next_assignment(worker) else {
            self.crowd.people[worker].plan = None;
            return;
        };
        let request = &self.ledger.assignments[&id].request;
        let (goal, stay) = (self.warehouse().nodes[request.place].at, request.stay);
        let cut = self.edges_blocked_for_long(now);
        let free = self.crowd.walkways.no_edges();
        let way =
            self.crowd.walkways.path(at, goal, &cut).or_else(|| self.crowd.walkways.path(at, goal, &free));
        let person = &mut self.crowd.people[worker];
        match way {
            Some(mut way) => {
                self.crowd.walkways.on_floor(goal).into_iter().for_each(|g| {
                    *way.points.last_mut().expect("a way has two ends") = g;
                });
                person.give(way.points, Some(id), stay, now);
                if !matches!(person.mode, Mode::Deviating { .. }) {
                    person.mode = Mode::Following;
                }
            }
            None => person.mode = Mode::Stopped { since: now },
        }
    }

    /// A robot that stands on the path and does not go away in time: the worker is led round it, or told to
    /// wait.
    fn look_ahead(&mut self, worker: WorkerId, place: &Whereabouts, now: Time) {
        let robot = self.robot_on_path(worker, place);
        let person = &mut self.crowd.people[worker];
        let since = match (robot, person.blocked_since) {
            (None, _) => {
                person.blocked_since = None;
                return;
            }
            (Some(r), Some((before, since))) if r == before => since,
            (Some(r), _) => {
                person.blocked_since = Some((r, now));
                return;
            }
        };
        if now - since < BLOCKED {
            return;
        }
        person.blocked_since = robot.map(|r| (r, now));
        let Some(goal) = person.plan.as_ref().map(|p| p.follower.goal()) else { return };
        let mut cut = self.edges_blocked_for_long(now);
        for r in self.ledger.robots.ids().filter(|r| self.stands_near(*r, place.at)) {
            let reach = self.warehouse().footprint_m / 2.0 + 0.2;
            self.crowd.walkways.edges_within(self.place_of(r), reach).into_iter().for_each(|e| {
                cut.insert(e);
            });
        }
        let way = self.way_past(place.at, goal, &cut);
        let refuge = if way.is_none() { self.refuge(worker, place.at, &cut) } else { None };
        let person = &mut self.crowd.people[worker];
        let plan = person.plan.as_ref().expect("just seen");
        let (assignment, stay) = (plan.assignment, plan.stay);
        let (points, assignment) = match (way, refuge) {
            (Some(points), _) => (points, assignment),
            (None, Some(points)) => (points, None),
            (None, None) => {
                person.mode = Mode::Stopped { since: now };
                return;
            }
        };
        person.give(points, assignment, stay, now);
        person.mode = Mode::Redirected;
    }

    /// Where robots and a worker wait for one another and neither can pass: a way to the nearest place from
    /// which the worker leaves to those robots what they are about to drive.
    fn refuge(&self, worker: WorkerId, at: Point, cut: &EdgeSet) -> Option<Vec<Point>> {
        let waiting = self.crowd.yielding.iter().filter(|(_, y)| y.worker == worker).map(|(r, _)| *r);
        let wanted: Vec<Point> = waiting
            .flat_map(|r| self.ledger.chain(r).visits().take(REFUGE_AHEAD))
            .map(|v| self.warehouse().nodes[v.node].at)
            .collect();
        let walkways = &self.crowd.walkways;
        let mut near: Vec<(f64, Point)> = (walkways.within(at, REFUGE_M).into_iter())
            .map(|(n, length)| (length, walkways.nodes()[n].at))
            .filter(|(length, p)| *length > 1.0 && wanted.iter().all(|w| (w - p).norm() > REFUGE_CLEAR_M))
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        near.into_iter().take(12).find_map(|(_, p)| self.way_past(at, p, cut))
    }

    /// A way without the cut walkways for somebody who may stand face to face with a robot: the first steps
    /// lead to where no robot is, even if the walkway there is cut by the one in front.
    fn way_past(&self, at: Point, goal: Point, cut: &EdgeSet) -> Option<Vec<Point>> {
        let walkways = &self.crowd.walkways;
        if let Some(way) = walkways.path(at, goal, cut) {
            return Some(way.points);
        }
        let reach = self.warehouse().footprint_m / 2.0 + BODY_M;
        let robots: Vec<Point> = self.ledger.robots.ids().map(|r| self.place_of(r)).collect();
        let is_clear = |to: Point| {
            let step = Segment { a: at, b: to };
            robots.iter().all(|r| step.distance_to(*r) >= reach || (to - r).norm() > (at - r).norm() + 0.3)
        };
        let steps = walkways.near(at, 1.8).into_iter().map(|(n, _)| walkways.nodes()[n].at);
        let ways = steps.filter(|p| is_clear(*p)).filter_map(|p| {
            let way = walkways.path(p, goal, cut)?;
            Some((way.length_m + (p - at).norm(), way.points))
        });
        let (_, mut points) = ways.min_by(|a, b| a.0.total_cmp(&b.0))?;
        points.insert(0, at);
        Some(points)
    }

    fn stands_near(&self, robot: RobotId, at: Point) -> bool {
        let stands = self.scene.robot(robot).is_none_or(|t| t.speed_mps < 0.05);
        stands && (self.place_of(robot) - at).norm() < 3.0
    }

    /// A robot that stands where a worker would be within the next steps.
    fn robot_on_path(&self, worker: WorkerId, place: &Whereabouts) -> Option<RobotId> {
        let plan = self.crowd.people[worker].plan.as_ref()?;
        let reach = self.warehouse().footprint_m / 2.0 + BODY_M;
        let mut ahead = vec![place.at];
        ahead.extend(plan.follower.ahead().iter().take(3));
        let stops = |robot: &RobotId| {
            let at = self.place_of(*robot);
            let near = ahead.windows(2).any(|s| Segment { a: s[0], b: s[1] }.distance_to(at) < reach);
            near && (at - place.at).norm() < 2.0 && self.stands_near(*robot, place.at)
        };
        self.ledger.robots.ids().find(stops)
    }

    /// Walkways on which robots rest or are broken: nobody waits for those to go away.
    pub(super) fn edges_blocked_for_long(&self, _now: Time) -> EdgeSet {
        let mut cut = self.crowd.walkways.no_edges();
        let reach = self.warehouse().footprint_m / 2.0 + 0.2;
        for robot in self.ledger.robots.ids() {
            let chain = self.ledger.chain(robot);
            let rests = chain.first() + 1 == chain.end();
            if rests || self.ledger.robots[robot].failed {
                let at = self.place_of(robot);
                for e in self.crowd.walkways.edges_within(at, reach) {
                    cut.insert(e);
                }
            }
        }
        cut
    }

    /// Where a robot is, as far as it was seen.
    pub(super) fn place_of(&self, robot: RobotId) -> Point {
        let node = self.warehouse().nodes[self.ledger.node_of(robot)].at;
        self.scene.robot(robot).map_or(node, |t| t.pose.at)
    }

    fn leaves_path(&mut self, worker: WorkerId, at: Point, now: Time) {
        self.record(Fact::Deviated { worker, at: now });
        self.crowd.people[worker].mode = Mode::Deviating { since: now };
        if self.settings.arm == Arm::Giveway {
            self.lead_on(worker, at, now);
        }
    }

    /// Shows whoever left the path a new one from where they are, now and then.
    fn show_the_way_back(&mut self, worker: WorkerId, at: Point, now: Time) {
        let made = self.crowd.people[worker].plan.as_ref().map_or(Time::ZERO, |p| p.made);
        if self.settings.arm == Arm::Giveway && now - made >= REDIRECT {
            self.lead_on(worker, at, now);
        }
    }

    /// At the end of the path: at work, done, or on to the next.
    fn at_the_end(&mut self, worker: WorkerId, at: Point, now: Time) {
        let person = &mut self.crowd.people[worker];
        let plan = person.plan.as_ref().expect("only who has a path is at its end");
        let (goal, stay) = (plan.follower.goal(), plan.stay);
        let Some(id) = plan.assignment else {
            // A path that only led out of the way.
            person.mode = Mode::Following;
            return self.lead_on(worker, at, now);
        };
        if (at - goal).norm() > THERE_M {
            return;
        }
        person.mode = Mode::Following;
        let since = *person.there_since.get_or_insert(now);
        let state = if now - since >= stay { AssignmentState::Done } else { AssignmentState::Working };
        if self.ledger.assignments.get(&id).is_some_and(|a| a.state != state) {
            self.record(Fact::Advanced { assignment: id, state, at: now });
        }
    }

    /// What people mean for the search.
    fn set_conditions(&mut self, now: Time) {
        let warehouse = self.warehouse().clone();
        let closures: Vec<_> = self.ledger.closures.iter().map(|(id, c)| (*id, c.clone())).collect();
        let mut conditions = std::mem::take(&mut self.crowd.conditions);
        for (id, closure) in closures {
            let outline: Vec<Point> = closure.outline.iter().map(|s| Point::from(*s)).collect();
            let nodes = self.crowd.nodes_of(id, &outline, &warehouse).to_vec();
            let effects = Effects {
                warehouse: &warehouse,
                regions: &self.crowd.regions,
                afoot: &self.crowd.afoot,
                now,
            };
            effects.area(&mut conditions, id, &nodes, closure.window);
        }
        let effects =
            Effects { warehouse: &warehouse, regions: &self.crowd.regions, afoot: &self.crowd.afoot, now };
        for (worker, place) in self.present(now) {
            let person = &self.crowd.people[worker];
            if self.settings.arm == Arm::Giveway || place.presence == Presence::Lost {
                effects.presence(&mut conditions, worker, &place);
                let band = Band::around(place.velocity.norm());
                effects.forecast(&mut conditions, worker, &self.hypotheses(worker, &place), band);
            } else if let Some(path) = person.rest_of_path(place.at) {
                let stay = person.plan.as_ref().map(|p| p.stay);
                let path = Hypothesis { probability: 1.0, path, stay };
                effects.plan(&mut conditions, worker, &path, Band::ANY);
            }
        }
        self.crowd.conditions = conditions;
    }

    /// Tells every robot how fast it may be near people. This leaves at once.
    fn limit_robots(&mut self, now: Time) {
        let present = self.present(now);
        for robot in self.ledger.robots.ids().collect::<Vec<_>>() {
            let Some(seen) = self.scene.robot(robot).copied() else { continue };
            let (limit, because) = self.limit_for(robot, &present, now);
            if limit == Some(0.0) && seen.speed_mps > 0.05 {
                self.gives_way(robot, because.expect("a stop has a cause"), Reaction::Stopped, now);
            }
            let told = self.crowd.limits.get(&robot).copied();
            let same = told.is_some_and(|(l, _)| l == limit) || (told.is_none() && limit.is_none());
            let known = seen.limit_mps == limit;
            if same && (known || told.is_none_or(|(_, at)| now - at < INSIST)) {
                continue;
            }
            self.crowd.limits.insert(robot, (limit, now));
            self.out.urgent.push((robot, Command::Limit(limit)));
        }
    }

    fn limit_for(
        &self,
        robot: RobotId,
        present: &[(WorkerId, Whereabouts)],
        _now: Time,
    ) -> (Option<f64>, Option<WorkerId>) {
        let at = self.place_of(robot);
        let speed = self.scene.robot(robot).map_or(0.0, |t| t.speed_mps);
        let loaded = self.ledger.rack_on(robot).is_some();
        let mut slowest: (Option<f64>, Option<WorkerId>) = (None, None);
        for (worker, w) in present {
            let distance = (at - w.at).norm() - w.reach_m;
            if distance > FAR_M {
                continue;
            }
            let stop = self.crowd.regions.stop_radius_at_m(speed, loaded, w.sigma_m);
            let limit = if distance < stop {
                let off = w.presence != Presence::Lost && self.drives_away(robot, at, w.at);
                Some(if off && !self.is_caught_up(at, speed, loaded, w) { SLOW_MPS } else { 0.0 })
            } else {
                self.limit_here(robot, at, *worker, w, loaded)
            };
            if limit.is_some_and(|l| slowest.0.is_none_or(|s| l < s)) {
                slowest = (limit, Some(*worker));
            }
        }
        slowest
    }

    /// The limit that a worker means where the robot is, and where it drives next.
    fn limit_here(
        &self,
        robot: RobotId,
        at: Point,
        worker: WorkerId,
        w: &Whereabouts,
        loaded: bool,
    ) -> Option<f64> {
        let nodes = self.ledger.chain(robot).visits().take(2).map(|v| v.node);
        if self.settings.arm == Arm::Giveway && self.drives_away(robot, at, w.at) {
            // The separation distance counts speed towards the person, and there is none. But who would be
            // caught up with had better stand when the person comes.
            let speed = self.scene.robot(robot).map_or(0.0, |t| t.speed_mps);
            return self.is_caught_up(at, speed, loaded, w).then_some(0.0);
        }
        let conditions = nodes.flat_map(|n| self.crowd.conditions.of(n));
        let limits = conditions.filter(|c| c.cause == Cause::Worker(worker)).filter_map(|c| match c.effect {
            Effect::Slow(l) => Some(l[usize::from(loaded)]).filter(|l| l.is_finite()),
            Effect::Still if self.settings.arm == Arm::Giveway => {
                Some(if self.may_finish(robot, w, loaded) { SLOW_MPS } else { 0.0 })
            }
            Effect::Still | Effect::Closed => Some(SLOW_MPS),
            Effect::Price(_) => None,
        });
        limits.min_by(f64::total_cmp)
    }

    /// Whether somebody who comes nearer would get into region 1 of a robot that drives off before it is as
    /// fast.
    fn is_caught_up(&self, at: Point, speed: f64, loaded: bool, w: &Whereabouts) -> bool {
        let to = at - w.at;
        let distance = to.norm().max(1e-6);
        let approach = w.velocity.dot(&to) / distance - speed;
        let gained = approach.max(0.0).powi(2) / (2.0 * self.settings.kinematics.accel_mps2(loaded));
        let comes = w.velocity.norm() > STROLL_MPS && approach > 0.0;
        comes && distance - gained < self.crowd.regions.stop_radius_m(loaded, w.sigma_m)
    }

    /// Whether a robot within region 2 may drive on to the end of what it was granted: the worker stands, and
    /// it does not lead into region 1. Else it could not be at rest when the worker comes.
    fn may_finish(&self, robot: RobotId, w: &Whereabouts, loaded: bool) -> bool {
        let chain = self.ledger.chain(robot);
        let clear_m = self.crowd.regions.stop_radius_m(loaded, w.sigma_m) + ROOM_M;
        let mut ahead = (chain.first() + 1..chain.granted()).filter_map(|s| chain.get(s));
        let leaves_room = ahead.all(|v| (self.warehouse().nodes[v.node].at - w.at).norm() > clear_m);
        w.velocity.norm() < STROLL_MPS && leaves_room
    }

    /// Whether what a robot was granted next leads away from a place.
    fn drives_away(&self, robot: RobotId, at: Point, from: Point) -> bool {
        let chain = self.ledger.chain(robot);
        let next = chain.get(chain.first() + 1).filter(|_| chain.first() + 1 < chain.granted());
        next.is_some_and(|v| {
            let there = self.warehouse().nodes[v.node].at;
            let (on, off) = (there - at, at - from);
            on.dot(&off) > 0.5 * on.norm() * off.norm()
        })
    }

    /// Notes that a robot gives way to somebody, once until it is on its way again.
    pub(super) fn gives_way(&mut self, robot: RobotId, worker: WorkerId, reaction: Reaction, now: Time) {
        let before = self.crowd.yielding.get(&robot).copied();
        let since = before.map_or(now, |y| y.since);
        self.crowd.yielding.insert(robot, super::crowd::Yielding { worker, reaction, since });
        if before.is_none() {
            self.record(Fact::Interrupted { robot, worker, reaction, at: now });
        }
    }

    /// Encounters, as far as they are seen.
    fn meet(&mut self, now: Time) {
        let mut near = Vec::new();
        for (worker, w) in self.present(now) {
            for robot in self.ledger.robots.ids() {
                let Some(seen) = self.scene.robot(robot) else { continue };
                let distance_m = (seen.pose.at - w.at).norm();
                if distance_m > 4.0 || w.presence == Presence::Lost {
                    continue;
                }
                let loaded = self.ledger.rack_on(robot).is_some();
                let radius_m = self.crowd.regions.stop_radius_m(loaded, 0.0);
                let (robot_mps, worker_mps) = (seen.speed_mps, w.velocity.norm());
                near.push(Near { worker, robot, at: w.at, radius_m, distance_m, robot_mps, worker_mps });
            }
        }
        for meeting in self.crowd.meter.observe(now, &near) {
            let start = meeting.start;
            let yielding = self.crowd.yielding.get(&start.robot);
            let reaction = yielding.map_or(Reaction::Kept, |y| y.reaction);
            self.record(Fact::Encountered(Encounter {
                worker: start.worker,
                robot: start.robot,
                began: meeting.began,
                ended: now,
                at: start.at.into(),
                radius_mm: to_mm(start.radius_m),
                closest_mm: to_mm(meeting.closest_m),
                robot_mmps: to_mm(start.robot_mps),
                worker_mmps: to_mm(start.worker_mps),
                reaction,
                delay: meeting.stood,
            }));
        }
    }
}
