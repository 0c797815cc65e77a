//! Workers on the timelines: a worker's way is planned between what robots are granted, as routes are planned between
//! reservations (Petković 2021, section 4.2.3, plans for people and robots on the same timelines).
//!
//! Robots drive what they were granted; what they were not granted, they leave to the worker, who has precedence. So
//! only what is granted takes walkways here, and what a robot that waits for the worker needs to come clear, if that
//! costs the worker less than waiting costs robots ([`Settings::worker_price`](crate::state::settings::Settings)). The
//! worker waits a few seconds for a robot to pass, or takes another aisle, whichever gets there earlier. Refuses: to
//! keep a worker waiting for longer than [`WAITS_AT_MOST`] in a row.

use crate::people::state::{HumanState, LetsPass, LetsPassStage, WalkMode};
use crate::state::floor::Floor;
use crate::state::wait_graph::{Edge, Party};
use crate::state::yielding::YieldingState;
use giveway_floor::geometry::{Point, Segment};
use giveway_floor::id::{ClosureId, RobotId, WorkerId};
use giveway_floor::time::{Span, Time, Window};
use giveway_floor::warehouse::walkway::{EdgeSet, Occupied, TimedPath};
use giveway_people::aware::{HumanAwarePolicy, SLOW_MPS};
use giveway_people::human::{BODY_M, Presence, Whereabouts};

/// Robots farther from a worker than this do not count, metres: what they do changes before the worker is there.
const FAR_M: f64 = 12.0;
/// How many labels one search may look at.
const LABELS: usize = 4000;
/// How often a way is compared with what robots are granted.
const AGAIN: Span = Span::from_millis(400);
/// How early and how late robots may be, on either side of a window.
const ABOUT: Span = Span::from_millis(300);
/// Room between a robot and a person who walks past, metres.
const BESIDE_M: f64 = 0.05;
/// Another way is shown only if it gets there this much earlier: a worker who is led to and fro gets nowhere.
const BETTER: Span = Span::from_secs(3);
/// A worker waits if a robot takes the way no farther ahead than this, metres; a driver, who needs room to stop, from
/// farther away …
const AHEAD_M: f64 = 1.5;
/// … for longer than this: a shorter wait is no more than walking slowly.
const LEAST: Span = Span::from_millis(800);
/// How long a worker waits in a row at most.
const WAITS_AT_MOST: Span = Span::from_secs(12);
/// A worker does not wait after robots have kept the worker in one spot for this long, whatever for.
const IN_ONE_SPOT: Span = Span::from_secs(25);
/// A worker who has waited for as long as a worker may does not wait again within this.
const GOES_FIRST: Span = Span::from_secs(10);
/// A robot that waits for a worker goes first only if it is clear of the worker's way after this distance, metres.
const CLEAR_M: f64 = 5.0;
/// How long the part of the worker's way is that the robot has to be clear of, metres.
const WAY_M: f64 = 6.0;
/// Time from when a worker is told to stand until a robot that waited sets off.
const SETS_OFF: Span = Span::from_millis(2500);
/// How long at most a worker is taken to keep a robot waiting.
const KEPT_AT_MOST: Span = Span::from_secs(30);

impl HumanState {
    /// The earliest way to a place between what robots are granted. It never comes with a closure that it leads round,
    /// since ways round closures are found without times.
    pub(super) fn route_on_time(
        &self,
        floor: Floor<'_>,
        (worker, at): (WorkerId, Point),
        goal: Point,
        cut: &EdgeSet,
        now: Time,
    ) -> Option<(Vec<Point>, Option<ClosureId>)> {
        let is_ours = floor.settings.policy == HumanAwarePolicy::Giveway;
        if !is_ours || !self.barred.is_empty(now) {
            return None;
        }
        let occupied = self.occupied(floor, worker, at, now);
        let usual_mps = self.mover(worker).usual_mps();
        let way = self.walkways.timed_path((at, goal), cut, &occupied, (now, usual_mps), LABELS)?;
        Some((way.points, None))
    }

    /// Has a worker wait if waiting a moment is the earliest way, or shows another way that gets there earlier. Returns
    /// whether the worker waits.
    pub(super) fn keep_on_time(
        &mut self,
        floor: Floor<'_>,
        yielding: &YieldingState,
        worker: WorkerId,
        place: &Whereabouts,
        now: Time,
    ) -> bool {
        let person = &self.people[worker];
        let waits = person.waits();
        let is_on_its_way = matches!(person.mode, WalkMode::Following | WalkMode::Redirected);
        let plan = person.plan.as_ref().filter(|p| is_on_its_way && !p.is_there(place.at));
        let plan = plan.filter(|_| place.presence == Presence::Tracked);
        let ours = floor.settings.policy == HumanAwarePolicy::Giveway;
        let Some(plan) = plan.filter(|_| ours) else {
            if waits.is_some() {
                self.people[worker].lets_pass = None;
            }
            return false;
        };
        if person.on_time_at.is_some_and(|t| now - t < AGAIN) {
            return waits.is_some();
        }
        let (goal, assignment, stay) = (plan.follower.goal(), plan.assignment, plan.stay);
        let path = person.rest_of_path(place.at).expect("there is a plan");
        let occupied = self.occupied(floor, worker, place.at, now);
        let (mover, usual_mps) = (place.mover, place.mover.usual_mps());
        let along = self.walkways.time_along(&path, &occupied, (now, usual_mps));
        let cut = self.edges_blocked_for_long(floor, yielding, mover, now);
        let best = self.walkways.timed_path((place.at, goal), &cut, &occupied, (now, usual_mps), LABELS);
        let other = match (&along, best) {
            (Some(a), Some(b)) => Some(b).filter(|b| b.arrival() + BETTER < a.arrival()),
            (None, best) => best,
            (Some(_), None) => None,
        };
        let other = other.filter(|way| self.barred.met(&way.points, now).is_none());
        let ahead_m = AHEAD_M + mover.stops_m(place.velocity.norm()) + mover.body_m() - BODY_M;
        let pace = WaitPace { ahead_m, usual_mps };
        let first_wait = other.as_ref().or(along.as_ref()).and_then(|way| first_wait(way, pace, now));
        let person = &mut self.people[worker];
        person.on_time_at = Some(now);
        if let Some(other) = other {
            person.give(other.points, assignment, stay, now);
            person.mode = WalkMode::Redirected;
        }
        self.wait_for(floor, worker, first_wait, now)
    }

    /// Has a worker wait for a robot, if there is one and the worker has not waited too long already. Returns whether
    /// the worker waits.
    fn wait_for(
        &mut self,
        floor: Floor<'_>,
        worker: WorkerId,
        first: Option<(RobotId, Time)>,
        now: Time,
    ) -> bool {
        let person = &mut self.people[worker];
        let waited = person.waits();
        person.lets_pass = None;
        let Some((robot, until)) = first else { return false };
        let since = waited.map_or(now, |w| w.since);
        let lately = person.waited_at.is_some_and(|t| now - t < GOES_FIRST);
        let spent = now - since >= WAITS_AT_MOST || floor.waits.kept_in_one_spot(worker) >= IN_ONE_SPOT;
        if lately || spent {
            if waited.is_some() {
                person.waited_at = Some(now);
            }
            return false;
        }
        let (reached, stage) = (floor.ledger.chain(robot).first(), LetsPassStage::Waits);
        let until = until.min(since + WAITS_AT_MOST);
        person.lets_pass = Some(LetsPass { robot, reached, since, until, stage });
        true
    }

    /// Which points of the walkways robots near a worker take, and when, as far as they were granted it.
    fn occupied(&self, floor: Floor<'_>, worker: WorkerId, at: Point, now: Time) -> Occupied {
        let (mut occupied, mover) = (Occupied::default(), self.mover(worker));
        let far_m = mover.far_m(FAR_M);
        for robot in floor.ledger.present().filter(|r| (floor.place_of(*r) - at).norm() <= far_m) {
            let reach = floor.beside_m(robot, mover.half_width_m()) + BESIDE_M;
            let mut take = |p: Point, window: Window| {
                self.walkways.around(p, reach).for_each(|n| occupied.add(n, window, robot));
            };
            floor.takes(robot, now).for_each(|(p, window)| take(p, window));
            if let Some((way, until)) = self.goes_first(floor, robot, (worker, at), now) {
                way.into_iter().for_each(|p| take(p, Window::new(now, until)));
            }
        }
        occupied.sort();
        occupied
    }

    /// The way of a robot that waits for a worker and goes first, and until when it takes that way: it is soon clear of
    /// the worker's way, does not come near the worker, and waiting costs the worker less than it costs the robots.
    fn goes_first(
        &self,
        floor: Floor<'_>,
        robot: RobotId,
        (worker, at): (WorkerId, Point),
        now: Time,
    ) -> Option<(Vec<Point>, Time)> {
        let waits = floor.waits.robot(robot).edge == Edge::On(Party::Worker(worker));
        if !waits || floor.scene.fit(robot, now).is_none() || floor.is_halted(robot) {
            return None;
        }
        let place = self.whereabouts(worker, now)?;
        let (way, length_m) = self.until_clear(floor, robot, (worker, at))?;
        let near_m = floor.regions(robot).towards(&place).stop_radius_m(true, place.sigma_m);
        if way.iter().any(|p| (p - at).norm() <= near_m) {
            return None;
        }
        let takes = SETS_OFF + Span::from_secs_f64(length_m / SLOW_MPS);
        // A robot that was told to stand waits until the worker has walked past.
        let passes = Span::from_secs_f64(WAY_M / place.mover.usual_mps());
        let kept = floor.waits_until(robot, now).map_or(passes, |t| (t - now).clamp(passes, KEPT_AT_MOST));
        let behind = Edge::On(Party::Robot(robot));
        let robots = 1 + floor.waits.parties().filter(|(_, wait)| wait.edge == behind).count();
        let costs_worker = floor.settings.worker_price * takes.as_secs_f64();
        (costs_worker < kept.as_secs_f64() * robots as f64).then_some((way, now + takes))
    }

    /// The way of a robot until it is clear of the next part of a worker's way, and its length in metres; nothing if
    /// the robot is not on that part, or not clear of it soon.
    fn until_clear(
        &self,
        floor: Floor<'_>,
        robot: RobotId,
        (worker, at): (WorkerId, Point),
    ) -> Option<(Vec<Point>, f64)> {
        let path = self.people[worker].rest_of_path(at)?;
        let mut left = WAY_M;
        let near = path.windows(2).map(|s| Segment { a: s[0], b: s[1] }).take_while(|s| {
            left -= s.length();
            left + s.length() > 0.0
        });
        let near: Vec<Segment> = near.collect();
        let reach = floor.beside_m(robot, self.mover(worker).half_width_m()) + BESIDE_M;
        let is_on = |p: &Point| near.iter().any(|s| s.distance_to(*p) < reach);
        let ahead = floor.ledger.chain(robot).visits().skip(1).map(|v| floor.warehouse().nodes[v.node].at);
        let mut way = vec![floor.place_of(robot)];
        let (mut length_m, mut was_on) = (0.0, is_on(&way[0]));
        for p in ahead {
            let from = *way.last().expect("it is somewhere");
            way.push(p);
            length_m += (p - from).norm();
            if length_m > CLEAR_M {
                return None;
            }
            let on = is_on(&p);
            if was_on && !on {
                return Some((way, length_m));
            }
            was_on |= on;
        }
        None
    }
}

impl Floor<'_> {
    /// Where a robot is and what it was granted, with the times at which it takes these places, later by its delay.
    fn takes(self, robot: RobotId, now: Time) -> impl Iterator<Item = (Point, Window)> {
        let chain = self.ledger.chain(robot);
        let record = &self.ledger.robots[robot];
        let stays = record.failed || record.interrupted;
        let reached = self.reached(robot);
        let next = chain.get(reached + 1);
        let late = next.map_or(Span::ZERO, |v| (now - v.enter).max(Span::ZERO));
        let until = move |leave: Time| match leave.is_forever() || stays {
            true => Time::MAX,
            false => (leave + late).max(now) + ABOUT,
        };
        let leaves = chain.get(reached).map_or(Time::MAX, |v| until(v.leave));
        let here = (self.place_of(robot), Window::new(now, leaves));
        let granted = (reached + 1..chain.granted()).filter_map(move |serial| chain.get(serial));
        let ahead = granted.map(move |v| {
            let enter = (v.enter + late - ABOUT).max(now);
            (self.warehouse().nodes[v.node].at, Window::new(enter, until(v.leave).max(enter + ABOUT)))
        });
        std::iter::once(here).chain(ahead)
    }
}

/// How far ahead on a way a wait counts, metres, and how fast the worker comes there, metres per second.
#[derive(Clone, Copy)]
struct WaitPace {
    ahead_m: f64,
    usual_mps: f64,
}

/// The robot for which the worker waits on the first metres of a way, and until when.
fn first_wait(way: &TimedPath, pace: WaitPace, now: Time) -> Option<(RobotId, Time)> {
    let mut walked = 0.0;
    for i in 1..way.points.len() {
        if walked >= pace.ahead_m {
            return None;
        }
        let length = (way.points[i] - way.points[i - 1]).norm();
        let sets_off = way.arrivals[i] - Span::from_secs_f64(length / pace.usual_mps);
        if let Some(robot) = way.waits_for[i].filter(|_| sets_off - way.arrivals[i - 1] > LEAST) {
            return Some((robot, sets_off.max(now + LEAST)));
        }
        walked += length;
    }
    None
}
