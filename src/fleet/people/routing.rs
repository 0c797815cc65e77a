//! Where workers are led: to their next task, round a robot that stands in the way, out of the way of robots.
//!
//! Refuses: to move a worker, who is shown a path and may ignore it.

use crate::people::blocked::WaysPast;
use crate::people::state::{HumanState, WalkMode};
use crate::state::fact::{AssignmentFact, EncounterFact};
use crate::state::floor::Floor;
use crate::state::worker::{AssignmentState, GuidanceReason};
use crate::state::writer::Writer;
use crate::state::yielding::{STANDS, YieldingState};
use giveway_floor::geometry::{Point, Segment};
use giveway_floor::id::{NodeId, RobotId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::NodeKind;
use giveway_floor::warehouse::walkway::EdgeSet;
use giveway_people::aware::HumanAwarePolicy;
use giveway_people::human::{BODY_M, Mover, Whereabouts};

/// A worker off the path is shown a new one this often.
pub(crate) const REDIRECT: Span = Span::from_secs(1);
/// A robot that stands on a worker's path for this long is walked round.
const BLOCKED: Span = Span::from_secs(3);
/// How far off all walkways a worker may seem to be and still be led back, metres.
const BESIDE_M: f64 = 6.0;
/// How far a worker is sent out of the way at most, metres.
const REFUGE_M: f64 = 15.0;
/// A worker who stands is asked to make room when a robot that has nowhere else to go has waited for this long.
const ASKED: Span = Span::from_secs(5);
/// A worker cuts off racks and stations no farther away than this, metres.
const WANTED_M: f64 = 8.0;
/// Beyond this distance, places are searched for on middle lines alone, metres.
const EDGE_M: f64 = 8.0;
/// How many places aside are tried.
const PLACES: usize = 12;
/// How far a place aside is from what robots are about to drive, metres.
const REFUGE_CLEAR_M: f64 = 2.5;
/// A worker at a place aside is led on only to a place this much farther from what robots are about to drive, metres.
const FARTHER_M: f64 = 0.5;
/// For how many robots, one by one, a place is searched for that is out of the way of that robot alone.
const ALONE: usize = 4;
/// No person is sent nearer to a robot than this, metres beyond its side.
const BESIDE_ROBOT_M: f64 = 0.75;
/// How many nodes ahead of a robot are what it is about to drive.
const REFUGE_AHEAD: usize = 6;
/// How long after no way was found a worker's way is searched for again: not in every step, since that takes several
/// searches of the whole floor.
const LOOK_AGAIN: Span = Span::from_secs(1);

impl HumanState {
    /// Starts the next assignment, or drops the path of a cancelled one.
    pub(crate) fn take_up_work(
        &mut self,
        writer: &mut Writer,
        yielding: &YieldingState,
        worker: WorkerId,
        at: Point,
        now: Time,
    ) {
        if self.people[worker].looks_again.is_some_and(|again| now < again) {
            return;
        }
        let next = self.next_open_assignment(writer.floor(), worker, at, now);
        let person = &self.people[worker];
        let current = person.plan.as_ref().and_then(|p| p.assignment);
        if person.plan.is_some() && (current == next || current.is_none()) {
            return;
        }
        Self::lay_aside(writer, current.filter(|id| next != Some(*id)), now);
        match next {
            Some(id) => {
                if writer.ledger().assignments[&id].state == AssignmentState::Waiting {
                    let state = AssignmentState::Walking;
                    writer.record(AssignmentFact::Advanced { assignment: id, state, at: now });
                }
                self.route_on(writer.floor(), yielding, worker, at, now);
            }
            None => {
                let by_closure = self.waits_for_closure(writer.floor(), worker, at, now);
                let person = &mut self.people[worker];
                (person.plan, person.mode, person.by_closure) = (None, WalkMode::Idle, by_closure);
            }
        }
    }

    /// Gives a worker the way from `at` to the next assignment.
    pub(crate) fn route_on(
        &mut self,
        floor: Floor<'_>,
        yielding: &YieldingState,
        worker: WorkerId,
        at: Point,
        now: Time,
    ) {
        let next = self.next_open_assignment(floor, worker, at, now);
        let Some(id) = next.filter(|_| floor.ledger.evacuation.is_none()) else {
            self.people[worker].plan = None;
            return;
        };
        let request = &floor.ledger.assignments[&id].request;
        let (place, stay) = (floor.warehouse().nodes[request.place].at, request.stay);
        let mover = self.mover(worker);
        let stand = self.walkways.stand_near(place, mover.clearance_m());
        // People are led to the node itself, and then to the floor beside it; vehicles to where they fit.
        let goal = if mover == Mover::OnFoot { place } else { stand.unwrap_or(place) };
        let cut = self.edges_robots_block(floor, yielding, mover, now);
        let free = self.edges_too_narrow(mover);
        let way = |cut| self.barred.way_round(&self.walkways, (at, goal), cut, now);
        let beside = || self.way_from_beside((mover, at), goal).map(|points| (points, None));
        let on_time = self.route_on_time(floor, (worker, at), goal, &cut, now);
        let way = on_time.or_else(|| way(&cut)).or_else(|| way(&free)).or_else(beside);
        let person = &mut self.people[worker];
        person.looks_again = None;
        match way {
            Some((mut points, round)) => {
                stand.into_iter().for_each(|g| {
                    *points.last_mut().expect("a way has two ends") = g;
                });
                person.give(points, Some(id), stay, now);
                person.by_closure = round.map(GuidanceReason::RoundClosure);
                if !matches!(person.mode, WalkMode::Deviating { .. }) {
                    person.mode = WalkMode::Following;
                }
            }
            None => {
                person.mode = WalkMode::Stopped { since: now };
                person.looks_again = Some(now + LOOK_AGAIN);
            }
        }
    }

    /// The way of a worker who seems to be where no one can stand: from the nearest walkway. The headset is wrong by a
    /// few metres; told to stop there, its wearer would wait for ever.
    pub(super) fn way_from_beside(&self, (mover, at): (Mover, Point), goal: Point) -> Option<Vec<Point>> {
        let (node, distance_m) = self.walkways.nearest(at)?;
        let from = self.walkways.nodes()[node].at;
        let free = self.edges_too_narrow(mover);
        let way = (distance_m < BESIDE_M).then(|| self.walkways.path(from, goal, &free)).flatten()?;
        Some(std::iter::once(at).chain(way.points).collect())
    }

    /// If a robot stands on the path and does not go away in time, leads the worker round it, or tells the worker to
    /// wait.
    pub(crate) fn look_ahead(
        &mut self,
        floor: Floor<'_>,
        yielding: &YieldingState,
        worker: WorkerId,
        place: &Whereabouts,
        now: Time,
    ) {
        let robot = self.robot_on_path(floor, worker, place);
        let person = &mut self.people[worker];
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
        let mover = place.mover;
        let mut cut = self.edges_blocked_for_long(floor, yielding, mover, now);
        for r in floor.ledger.present().filter(|r| floor.stands_near(*r, place.at)) {
            let reach = floor.beside_m(r, mover.squeezes_m());
            self.walkways.edges_within(floor.place_of(r), reach).into_iter().for_each(|e| {
                cut.insert(e);
            });
        }
        // A robot that has waited for the worker for long has nowhere to go: the worker makes room, not the robot.
        let is_stuck = robot.is_some_and(|r| yielding.stuck_with(r, now) == Some(worker));
        let refuge = || self.refuge(floor, worker, place.at, &cut);
        let kept = floor.waits.kept_in_one_spot(worker);
        let way = || WaysPast::new(self, floor, (mover, place.at), &cut).by_sides(kept).to(goal);
        let (way, refuge) = match is_stuck.then(refuge).flatten() {
            Some(points) => (None, Some(points)),
            None => way().map_or_else(|| (None, refuge()), |points| (Some(points), None)),
        };
        let person = &mut self.people[worker];
        let plan = person.plan.as_ref().expect("just seen");
        let (assignment, stay) = (plan.assignment, plan.stay);
        let (points, assignment) = match (way, refuge) {
            (Some(points), _) => (points, assignment),
            (None, Some(points)) => (points, None),
            (None, None) => {
                person.mode = WalkMode::Stopped { since: now };
                return;
            }
        };
        person.give(points, assignment, stay, now);
        person.mode = WalkMode::Redirected;
    }

    /// If a robot that has nowhere else to go waits for a worker who stands and has no way to go, leads the worker to a
    /// place aside.
    pub(crate) fn make_room(
        &mut self,
        floor: Floor<'_>,
        yielding: &YieldingState,
        worker: WorkerId,
        at: Point,
        now: Time,
    ) {
        if floor.settings.policy != HumanAwarePolicy::Giveway || self.is_asked(floor, worker, now).is_none() {
            return;
        }
        let cut = self.edges_blocked_for_long(floor, yielding, self.mover(worker), now);
        if let Some(points) = self.refuge(floor, worker, at, &cut) {
            let person = &mut self.people[worker];
            person.give(points, None, Span::ZERO, now);
            person.mode = WalkMode::Redirected;
        }
    }

    /// Why a worker who stands and has no way to go is asked to make room, if so.
    pub(crate) fn is_asked(&self, floor: Floor<'_>, worker: WorkerId, now: Time) -> Option<GuidanceReason> {
        let person = &self.people[worker];
        if person.plan.is_some() && !matches!(person.mode, WalkMode::Stopped { .. }) {
            return None;
        }
        let waits = floor.waits.waits_for_worker(worker).filter(|(_, since)| now - *since > ASKED);
        let stood = person.stands_since.map_or(Span::ZERO, |since| now - since);
        let cuts_off = || stood > STANDS + ASKED && !floor.wanted_near(worker).is_empty();
        waits
            .map(|(robot, _)| GuidanceReason::RobotWaits(robot))
            .or_else(|| cuts_off().then_some(GuidanceReason::CutsOff))
    }

    /// If robots and a worker wait for one another and neither can pass: a way to the nearest place from which the
    /// worker leaves to those robots what they are about to drive. If the worker is at such a place already, only a
    /// place farther from the robots' ways counts: a person who is led to and fro is in the way again each time.
    fn refuge(&self, floor: Floor<'_>, worker: WorkerId, at: Point, cut: &EdgeSet) -> Option<Vec<Point>> {
        let place = |n: NodeId| floor.warehouse().nodes[n].at;
        let ahead = |r: &RobotId| floor.ledger.chain(*r).visits().take(REFUGE_AHEAD).map(|v| place(v.node));
        let robots = floor.waits.waiting_for(worker);
        let mut all: Vec<Point> = robots.iter().flat_map(ahead).collect();
        if robots.is_empty() {
            all.extend(floor.wanted_near(worker).into_iter().map(place));
        }
        // If no place is clear of all their ways: one that is clear of the way of one robot, the longest waiting first.
        let mover = self.mover(worker);
        let beside = (mover != Mover::OnFoot).then(|| self.edges_beside_robots(floor, (mover, at), cut));
        let cut = beside.as_ref().unwrap_or(cut);
        let ways = WaysPast::new(self, floor, (mover, at), cut);
        let enough_m = REFUGE_CLEAR_M + mover.body_m() - BODY_M;
        let clear = |wanted: &[Point]| self.place_aside(floor, wanted, (mover, at), enough_m, &ways);
        let one = |r: &RobotId| clear(&ahead(r).collect::<Vec<_>>());
        let alone = || robots.iter().take(ALONE).find_map(one);
        clear(&all).or_else(|| (robots.len() > 1).then(alone).flatten())
    }

    /// A way to the nearest place from which a worker leaves these places to robots: over `enough_m` metres from each.
    pub(super) fn place_aside(
        &self,
        floor: Floor<'_>,
        wanted: &[Point],
        (mover, at): (Mover, Point),
        enough_m: f64,
        ways: &WaysPast<'_>,
    ) -> Option<Vec<Point>> {
        if wanted.is_empty() {
            return None;
        }
        let walkways = &self.walkways;
        let beside_m = BESIDE_ROBOT_M + mover.body_m() - BODY_M;
        let beside = |r: RobotId, p: Point| (floor.place_of(r) - p).norm() < floor.beside_m(r, beside_m);
        let fits = |p: Point| walkways.clearance_m(p) >= mover.clearance_m();
        let has_room = |p: Point| fits(p) && !floor.ledger.present().any(|r| beside(r, p));
        let clear_m = |p: Point| wanted.iter().map(|w| (w - p).norm()).fold(f64::INFINITY, f64::min);
        let enough_m = if clear_m(at) > enough_m { clear_m(at) + FARTHER_M } else { enough_m };
        let mut near: Vec<(f64, Point)> = (walkways.within(at, REFUGE_M).into_iter())
            .map(|(n, length)| (length, walkways.nodes()[n].at))
            .filter(|(length, p)| *length > 1.0 && clear_m(*p) > enough_m && has_room(*p))
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let way_to = |p: Point| ways.to(p);
        let along = near.into_iter().take(PLACES).find_map(|(_, p)| way_to(p));
        // Narrow floors have no such place on a middle line, but may have one at the edge.
        let at_the_edge = || {
            let places = walkways.standing_places(at, EDGE_M).into_iter();
            let fits = |p: &Point| (p - at).norm() > 1.0 && clear_m(*p) > enough_m && has_room(*p);
            places.filter(fits).take(PLACES).find_map(way_to)
        };
        along.or_else(at_the_edge)
    }

    /// A robot that stands where a worker would be within the next steps.
    fn robot_on_path(&self, floor: Floor<'_>, worker: WorkerId, place: &Whereabouts) -> Option<RobotId> {
        let plan = self.people[worker].plan.as_ref()?;
        // A worker at the end of the path has no way ahead that a robot beside it could block.
        if plan.is_there(place.at) {
            return None;
        }
        let mover = place.mover;
        // A driver stops farther from a robot than a person does, and is there sooner.
        let near_m = mover.far_m(2.0);
        let mut ahead = vec![place.at];
        ahead.extend(plan.follower.ahead().iter().take(3));
        let stops = |robot: &RobotId| {
            let (at, reach) = (floor.place_of(*robot), floor.beside_m(*robot, mover.half_width_m()));
            let near = ahead.windows(2).any(|s| Segment { a: s[0], b: s[1] }.distance_to(at) < reach);
            near && (at - place.at).norm() < near_m && floor.stands_near(*robot, place.at)
        };
        floor.ledger.present().find(stops)
    }

    pub(crate) fn leaves_path(
        &mut self,
        writer: &mut Writer,
        yielding: &YieldingState,
        worker: WorkerId,
        at: Point,
        now: Time,
    ) {
        writer.record(EncounterFact::Deviated { worker, at: now });
        self.people[worker].mode = WalkMode::Deviating { since: now };
        if writer.settings.policy == HumanAwarePolicy::Giveway {
            self.route_on(writer.floor(), yielding, worker, at, now);
        }
    }

    /// Shows a worker who left the path a new one from the worker's present place, now and then.
    pub(crate) fn show_the_way_back(
        &mut self,
        floor: Floor<'_>,
        yielding: &YieldingState,
        worker: WorkerId,
        at: Point,
        now: Time,
    ) {
        let made = self.people[worker].plan.as_ref().map_or(Time::ZERO, |p| p.made);
        if floor.settings.policy == HumanAwarePolicy::Giveway && now - made >= REDIRECT {
            self.route_on(floor, yielding, worker, at, now);
        }
    }

    /// Handles a worker at the end of the path: at work, done, or on to the next assignment.
    pub(crate) fn at_the_end(
        &mut self,
        writer: &mut Writer,
        yielding: &YieldingState,
        worker: WorkerId,
        at: Point,
        now: Time,
    ) {
        let person = &mut self.people[worker];
        let plan = person.plan.as_ref().expect("only who has a path is at its end");
        let (is_there, stay) = (plan.is_there(at), plan.stay);
        let Some(id) = plan.assignment else {
            // The path only led out of the way.
            person.mode = WalkMode::Following;
            return self.route_on(writer.floor(), yielding, worker, at, now);
        };
        if !is_there {
            return;
        }
        person.mode = WalkMode::Following;
        let before = person.was_there.filter(|(left, _)| *left == id).map_or(Span::ZERO, |(_, t)| t);
        let since = *person.there_since.get_or_insert(now - before);
        let state = if now - since >= stay { AssignmentState::Done } else { AssignmentState::Working };
        if writer.ledger().assignments.get(&id).is_some_and(|a| a.state != state) {
            writer.record(AssignmentFact::Advanced { assignment: id, state, at: now });
        }
    }
}

impl Floor<'_> {
    /// Nodes near a worker that count as closed because of the worker, with a rack or a station that waiting jobs need.
    fn wanted_near(&self, worker: WorkerId) -> Vec<NodeId> {
        let Some(at) = self.restrictions.whereabouts(worker).map(|w| w.at) else { return Vec::new() };
        let index = self.ledger.index();
        let is_wanted = |n: NodeId| match self.warehouse().kind(n) {
            NodeKind::Station(_) => index.queue.has_offers(),
            _ => index.places.rack_on(n).is_some_and(|rack| index.queue.is_wanted(rack)),
        };
        let near = |n: &NodeId| (self.warehouse().nodes[*n].at - at).norm() < WANTED_M;
        self.restrictions.closing.keys().copied().filter(near).filter(|n| is_wanted(*n)).collect()
    }
}
