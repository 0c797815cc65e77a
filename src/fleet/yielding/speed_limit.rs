//! How fast each robot may now drive near people, and which robots that stand for people lose what they were granted.
//!
//! Limits and stops leave at once, without waiting for the journal: they take no hold from any robot. Refuses:
//! to be a safety function; robots' own scanners and brakes are.

use crate::people::state::{HumanState, STROLL_MPS, WalkMode};
use crate::state::floor::Floor;
use crate::state::io::Command;
use crate::state::kind::ObeyedLimits;
use crate::state::worker::Reaction;
use crate::state::writer::Writer;
use crate::state::yielding::{RobotYielding, STANDS, Standing, YieldingState};
use crate::traffic::state::{Direction, Traffic};
use crate::yielding::state::Yielding;
use giveway_floor::geometry::{Point, Segment};
use giveway_floor::id::{NodeId, RobotId, WorkerId};
use giveway_floor::route::{Cause, Effect};
use giveway_floor::time::{Span, Time};
use giveway_people::aware::{
    BEYOND, DriveAhead, HumanAwarePolicy, SLOW_MPS, Swept, THRESHOLD, Walk, collision, moves_within,
    quantised,
};
use giveway_people::human::{Mover, Presence, Whereabouts};

/// A robot slower than this stands, metres per second.
const STANDS_MPS: f64 = 0.05;
/// Room beyond region 1 that a robot leaves to a person who stands, metres.
const ROOM_M: f64 = 0.3;
/// Room beyond region 1 that is left to a person who comes: what the person walks while a stop is on its way, metres.
const CLEAR_M: f64 = 0.35;
/// How much more room a robot that stands needs to set off, metres: poses and speeds waver, and a robot that starts and
/// stops by turns would be creeping just when a person comes.
const SET_OFF_M: f64 = 0.3;
/// A person farther away does not come into region 1 before a robot has stopped, metres.
const PASSING_M: f64 = 6.0;
/// Robots are told their limit again after this long, until they confirm it.
const INSIST: Span = Span::from_millis(100);
/// A robot comes towards a person if at least this share of its speed leads there.
const TOWARDS: f64 = 0.1;
/// How far the measured speed of a person may be wrong, metres per second.
const MEASURED_MPS: f64 = 0.2;
/// A robot that comes nearer by no more than this passes, metres.
const NEARER_M: f64 = 0.05;
/// Robots and workers farther apart than this do not count for each other, metres.
const FAR_M: f64 = 12.0;
/// A robot farther from a person than this does not meet that person within the time of braking, metres.
const MEETS_M: f64 = 12.0;

/// What decides how fast robots may be near people, in this step.
#[derive(Clone, Copy)]
pub struct SpeedLimits<'a> {
    pub floor: Floor<'a>,
    pub people: &'a HumanState,
    pub traffic: &'a Traffic,
    pub yielding: &'a YieldingState,
    /// The direction in which a robot between two nodes is assumed to go on; nothing for its actual direction.
    pub direction: Option<Direction>,
}

impl Yielding {
    /// Tells every robot its speed limit near people, unless the robot already knows it. This leaves at once.
    pub(crate) fn limit_robots(
        &mut self,
        writer: &mut Writer,
        people: &HumanState,
        traffic: &Traffic,
        now: Time,
    ) {
        let present = people.places(now);
        for robot in writer.ledger().present().collect::<Vec<_>>() {
            let Some(seen) = writer.scene.robot(robot).copied() else { continue };
            let (limit, because) =
                self.limits(writer.floor(), people, traffic).limit_for(robot, &present, now);
            let limit = if writer.visits.at_hands(robot).is_some() { Some(0.0) } else { limit };
            let obeys = writer.floor().obeyed_limits(robot);
            let wished = limit;
            let limit = match obeys {
                ObeyedLimits::Speeds => limit,
                ObeyedLimits::Stops => {
                    self.limits(writer.floor(), people, traffic).as_stop(robot, limit, because, now)
                }
                // Such a robot is granted less instead, and not told what it was granted and does not know.
                ObeyedLimits::Nothing => {
                    if limit == Some(0.0) {
                        writer.hold_back(robot);
                    }
                    self.state.of_mut(robot).limit_told = Some((limit, now));
                    continue;
                }
            };
            if let Some(worker) = because.filter(|_| limit == Some(0.0) && seen.speed_mps > STANDS_MPS) {
                self.gives_way(writer, robot, worker, Reaction::Stopped, now);
            }
            assert!(limit.is_none_or(|mps| mps >= 0.0), "{robot:?} is told to drive at {limit:?} m/s");
            let node = writer.ledger().node_of(robot);
            let is_revoked = traffic.is_revoked(robot);
            self.state.of_mut(robot).note_standing(node, limit.or(wished), because, is_revoked, now);
            let told = self.state.of(robot).limit_told;
            let same = told.map_or(limit.is_none(), |(l, _)| l == limit);
            // One that only stops does not say what else it was told.
            let is_obeyed = |mps: &f64| obeys == ObeyedLimits::Speeds || *mps == 0.0;
            let known = seen.limit_mps == limit.filter(is_obeyed);
            // A limit that was not set here is older than a restart, or the server's own while the journal was full.
            if same && (known || told.is_some_and(|(_, at)| now - at < INSIST)) {
                continue;
            }
            self.state.of_mut(robot).limit_told = Some((limit, now));
            writer.tell_at_once(robot, Command::Limit(limit));
        }
    }

    /// Revokes the grants of robots that have yielded to a person for long, beyond where they stand.
    pub(crate) fn revoke_grants(
        &mut self,
        writer: &mut Writer,
        people: &HumanState,
        traffic: &mut Traffic,
        now: Time,
    ) {
        for robot in self.state.standing() {
            let stood_for = self.state.stood_for(robot, now);
            // A robot that passes a person is beside the line, and goes on from there.
            let passes = self.state.of(robot).passing.is_some();
            let stood_for = stood_for.filter(|w| !passes && !writer.restrictions.let_pass.contains(w));
            let Some(w) = stood_for.and_then(|w| people.whereabouts(w, now)) else {
                continue;
            };
            let at = writer.floor().place_of(robot);
            if !self.limits(writer.floor(), people, traffic).drives_away(robot, at, &w, now) {
                traffic.revoke_grant(writer, robot, now);
            }
        }
        traffic.forget_revoked(now);
    }

    /// What decides how fast robots may be.
    pub fn limits<'a>(
        &'a self,
        floor: Floor<'a>,
        people: &'a HumanState,
        traffic: &'a Traffic,
    ) -> SpeedLimits<'a> {
        SpeedLimits { floor, people, traffic, yielding: &self.state, direction: None }
    }
}

impl RobotYielding {
    /// Records when a robot started standing still to yield; it may come back slowly meanwhile. Yielding to a second
    /// person right after the first, at the same node, continues the same interval.
    fn note_standing(
        &mut self,
        node: NodeId,
        limit: Option<f64>,
        because: Option<WorkerId>,
        is_revoked: bool,
        now: Time,
    ) {
        let before = self.stands;
        match because.filter(|_| limit.is_some_and(|l| l <= SLOW_MPS)) {
            Some(worker) if before.is_some_and(|s| s.worker == worker) => {}
            Some(worker) if limit == Some(0.0) => {
                let since = before.filter(|s| s.node == node).map_or(now, |s| s.since);
                self.stands = Some(Standing { worker, since, facing_since: now, node });
            }
            // A robot whose grant was revoked has not left yet.
            _ if is_revoked => {}
            _ => self.stands = None,
        }
    }
}

impl SpeedLimits<'_> {
    /// The speed limit of a robot, metres per second, if it may not drive as fast as it can, and which worker causes
    /// it.
    pub(crate) fn limit_for(
        &self,
        robot: RobotId,
        present: &[(WorkerId, Whereabouts)],
        now: Time,
    ) -> (Option<f64>, Option<WorkerId>) {
        let seen = self.floor.scene.robot(robot);
        let is_obstructed = self.floor.scene.is_kept_from_driving(robot, now);
        let back = self.drives_back_to(robot);
        let is_displaced = self.floor.scene.displaced(robot).is_some();
        // The robot stands to be called back; a robot that cannot be called back goes on as soon as it is free.
        let is_called = is_obstructed && back.is_none() && self.floor.kind(robot).capabilities.revocation;
        let stands = self.floor.is_halted(robot) || is_displaced || is_called;
        if stands || self.floor.drives_into(robot, back).is_some() {
            return (Some(0.0), None);
        }
        if present.is_empty() {
            return (None, None);
        }
        if let Some(passing) = self.yielding.of(robot).passing {
            return passing.limit(self.floor, robot, present, now);
        }
        let at = self.floor.place_of(robot);
        let speed = seen.map_or(0.0, |t| t.speed_mps);
        let loaded = self.floor.ledger.rack_on(robot).is_some();
        let mut slowest: (Option<f64>, Option<WorkerId>) = (None, None);
        for (worker, w) in present {
            let distance = (at - w.at).norm() - w.reach_m;
            if distance > w.mover.far_m(FAR_M) || w.reach_m > 0.0 && !self.is_within_reach(robot, *worker, w)
            {
                continue;
            }
            let off = w.presence != Presence::Lost && self.drives_away(robot, at, w, now);
            // A robot that drives away needs no room to brake, and braking would let the person catch up.
            let towards_mps = if off { 0.0 } else { speed };
            let regions = self.floor.regions(robot).towards(w);
            let stop = regions.stop_radius_at_m(towards_mps, loaded, w.sigma_m);
            let limit = if distance < stop {
                Some(if off && !self.is_caught_up(robot, *worker, w, now) { SLOW_MPS } else { 0.0 })
            } else {
                self.limit_here(robot, at, *worker, w, now)
            };
            let approach = if off { None } else { self.approach_limit(robot, at, w, loaded) };
            let limit = limit.into_iter().chain(approach).reduce(f64::min);
            // Down to the slow speed, at which the rules by distance decide: a robot face to face with a person
            // has to get out of the way somehow.
            let is_fast = speed > SLOW_MPS && limit.is_none_or(|l| l > SLOW_MPS);
            let brakes = self.floor.settings.policy == HumanAwarePolicy::Giveway && is_fast;
            let limit =
                if brakes && self.would_meet(robot, *worker, at, now) { Some(SLOW_MPS) } else { limit };
            if limit.is_some_and(|l| slowest.0.is_none_or(|s| l < s)) {
                slowest = (limit, Some(*worker));
            }
        }
        match self.arrival_limit(robot, now) {
            Some(limit) if slowest.0.is_none_or(|s| limit < s) => (Some(limit), None),
            _ => slowest,
        }
    }

    /// The limit for a robot that can stop but cannot be slow at once: it stands where others would be slow, unless it
    /// drives away from the person or has stood there for long, since it could not get out of the way otherwise. In
    /// that case, the robot is granted one node at a time, and its link is told the limit for what it orders next.
    fn as_stop(
        &self,
        robot: RobotId,
        limit: Option<f64>,
        because: Option<WorkerId>,
        now: Time,
    ) -> Option<f64> {
        let slow = limit.filter(|l| *l > 0.0);
        let Some(worker) = because.filter(|_| slow.is_some()) else { return limit.filter(|l| *l == 0.0) };
        let at = self.floor.place_of(robot);
        let drives_away =
            self.people.whereabouts(worker, now).is_none_or(|w| self.drives_away(robot, at, &w, now));
        if drives_away || self.yielding.stood_for(robot, now).is_some() { slow } else { Some(0.0) }
    }

    /// How fast a robot may be so that it does not come towards a person too fast: of its speed along its way, the
    /// share that leads towards the person counts.
    fn approach_limit(&self, robot: RobotId, at: Point, w: &Whereabouts, loaded: bool) -> Option<f64> {
        if self.floor.settings.policy != HumanAwarePolicy::Giveway || w.presence == Presence::Lost {
            return None;
        }
        let (on, to) = (self.next_place(robot)? - at, w.at - at);
        let share = on.dot(&to) / (on.norm() * to.norm());
        if share.is_nan() || share < TOWARDS {
            return None;
        }
        let walks_mps = match w.presence {
            Presence::Tracked => w.velocity.norm() + MEASURED_MPS,
            _ => w.mover.assumed_mps(),
        };
        let distance_m = to.norm() - w.reach_m;
        let regions = self.floor.regions(robot).towards(w);
        let limit = regions.approach_limit_mps(distance_m, walks_mps, loaded, w.sigma_m)?;
        let (along, top) = (limit / share, self.floor.kinematics(robot).top_mps(loaded));
        (along < top).then(|| quantised(along))
    }

    /// Whether a person who is not seen can come near a robot on foot: racks and walls are no way through. A person
    /// seen a moment ago is near as the crow flies.
    fn is_within_reach(&self, robot: RobotId, worker: WorkerId, w: &Whereabouts) -> bool {
        let is_cause =
            |n: NodeId| self.floor.conditions(robot).of(n).iter().any(|c| c.cause == Cause::Worker(worker));
        w.presence != Presence::Lost || self.nodes_here(robot).any(is_cause)
    }

    /// The node that a robot reached last, and the next.
    fn nodes_here(&self, robot: RobotId) -> impl Iterator<Item = NodeId> {
        let (chain, reached) = (self.floor.ledger.chain(robot), self.floor.reached(robot));
        (reached..).map_while(move |serial| chain.get(serial)).take(2).map(|v| v.node)
    }

    /// Where a robot drives back to, if it drives back.
    fn drives_back_to(&self, robot: RobotId) -> Option<Point> {
        match self.direction {
            Some(Direction::Back) => Some(self.floor.last_reached(robot)),
            Some(Direction::Forward) => None,
            None => self.traffic.drives_back_to(self.floor, robot),
        }
    }

    /// The limit that a worker causes where the robot is, and where it drives next.
    fn limit_here(
        &self,
        robot: RobotId,
        at: Point,
        worker: WorkerId,
        w: &Whereabouts,
        now: Time,
    ) -> Option<f64> {
        let loaded = self.floor.ledger.rack_on(robot).is_some();
        let nodes = self.nodes_here(robot);
        if self.floor.settings.policy == HumanAwarePolicy::Giveway {
            if self.is_caught_up(robot, worker, w, now) {
                return Some(0.0);
            }
            // The separation distance counts speed towards the person, of which there is none here.
            if self.drives_away(robot, at, w, now) && !self.passes_slowly(robot, at, w, now) {
                return None;
            }
        }
        let conditions = nodes.flat_map(|n| self.floor.conditions(robot).of(n));
        let limits = conditions.filter(|c| c.cause == Cause::Worker(worker)).filter_map(|c| match c.effect {
            Effect::Slow(l) => Some(l[usize::from(loaded)]).filter(|l| l.is_finite()),
            Effect::NoEntryOrExit if self.floor.settings.policy == HumanAwarePolicy::Giveway => {
                let slowly = self.passes_slowly(robot, at, w, now) || self.may_finish(robot, w, loaded);
                Some(if slowly { SLOW_MPS } else { 0.0 })
            }
            Effect::NoEntryOrExit | Effect::Closed => Some(SLOW_MPS),
            Effect::SoftCost(_) => None,
        });
        limits.min_by(f64::total_cmp)
    }

    /// Whether a robot that drives on to the end of what it was granted would still move when a person comes into
    /// region 1.
    fn is_caught_up(&self, robot: RobotId, worker: WorkerId, w: &Whereabouts, now: Time) -> bool {
        // A robot that has stood for long leaves: a person who wants to pass where it stands comes near all the time.
        if self.yielding.stuck_with(robot, now).is_some() {
            return false;
        }
        let Some(seen) = self.floor.scene.robot(robot) else { return false };
        let at = seen.pose.at;
        let way = self.floor.granted_way(robot, at, self.drives_back_to(robot));
        if way.len() < 2 || (at - w.at).norm() > w.mover.far_m(PASSING_M) {
            return false;
        }
        let walk = self.walk_of(worker, w, (robot, at), now);
        if walk.speed_mps < STROLL_MPS {
            return false;
        }
        let loaded = self.floor.ledger.rack_on(robot).is_some();
        let k = *self.floor.kinematics(robot);
        let drive = DriveAhead {
            way,
            speed_mps: seen.speed_mps,
            top_mps: k.top_mps(loaded),
            accel_mps2: k.accel_mps2(loaded),
            heading: seen.pose.heading,
            turn_radps: k.turn_radps,
        };
        let told_to = self.yielding.of(robot).is_told_to_stand();
        let stands = told_to || seen.speed_mps < STANDS_MPS;
        let room_m = CLEAR_M + if stands { SET_OFF_M } else { 0.0 };
        let regions = self.floor.regions(robot).towards(w);
        moves_within(&drive, &walk, regions.stop_radius_m(loaded, w.sigma_m) + room_m)
    }

    /// How a worker will walk on, as far as that is known: along the path; without one, straight on; from a place of
    /// work, in any direction as soon as the work is done, or a while later.
    pub fn walk_of(
        &self,
        worker: WorkerId,
        w: &Whereabouts,
        (robot, at): (RobotId, Point),
        now: Time,
    ) -> Walk {
        let person = &self.people.people[worker];
        let speed = w.velocity.norm();
        if self.people.stands_aside(worker, now) {
            return Walk { way: vec![w.at], speed_mps: 0.0, waits_s: 0.0 };
        }
        if let (Some(since), Some(plan)) = (person.there_since, &person.plan)
            && speed < STROLL_MPS
            && now - (since + plan.stay) < STANDS
        {
            let waits_s = (since + plan.stay - now).max(Span::ZERO).as_secs_f64();
            return Walk { way: vec![w.at, at], speed_mps: w.mover.sets_off_mps(), waits_s };
        }
        let follows = matches!(person.mode, WalkMode::Following | WalkMode::Redirected);
        let path = person.rest_of_path(w.at).filter(|p| follows && p.len() > 1);
        // A person who has stopped on the way may set off again, unless it was to let the robot leave. A person who has
        // stood for long waits for something, maybe for the robot to go on.
        let lately = person.stands_since.is_none_or(|t| now - t < STANDS);
        let sets_off = path.is_some() && lately && !self.drives_away(robot, at, w, now);
        let way = path.unwrap_or_else(|| vec![w.at, w.at + w.velocity * 5.0]);
        let speed_mps = if sets_off && speed < STROLL_MPS { w.mover.sets_off_mps() } else { speed };
        Walk { way, speed_mps, waits_s: 0.0 }
    }

    /// Whether a robot within region 2 may drive on to the end of what it was granted: the worker stands, and the grant
    /// does not lead into region 1. Otherwise the robot could not be at rest when the worker comes.
    fn may_finish(&self, robot: RobotId, w: &Whereabouts, loaded: bool) -> bool {
        let clear_m = self.floor.regions(robot).towards(w).stop_radius_m(loaded, w.sigma_m) + ROOM_M;
        let leaves_room = self
            .floor
            .granted_ahead(robot)
            .all(|v| (self.floor.warehouse().nodes[v.node].at - w.at).norm() > clear_m);
        w.velocity.norm() < STROLL_MPS && leaves_room
    }

    /// Whether a robot's next piece of way leads away from a person: along what it was granted, or back where it is
    /// called to. A robot that drives back, or has yielded there for long, may also pass, if that is no nearer than it
    /// is already; so may any robot past a person who stands, since neither gets anywhere while the robot stands in the
    /// way. Not so past a vehicle whose turning circle the robot is in, until it has yielded for long: nobody knows
    /// which way the vehicle is turned.
    pub(crate) fn drives_away(&self, robot: RobotId, at: Point, w: &Whereabouts, now: Time) -> bool {
        let back = self.drives_back_to(robot);
        let lax = back.is_some() || self.yielding.stood_for(robot, now).is_some();
        let may_pass = lax || stands(w) && !self.is_in_circle(at, w);
        self.next_place(robot)
            .is_some_and(|there| leads_off(at, there, w.at) || may_pass && comes_no_nearer(at, there, w.at))
    }

    /// Whether a robot at a place reaches into the circle in which a vehicle turns.
    fn is_in_circle(&self, at: Point, w: &Whereabouts) -> bool {
        let half_m = self.floor.warehouse().footprint_m / 2.0;
        match w.mover {
            Mover::OnFoot => false,
            Mover::Vehicle(_) => (at - w.at).norm() < w.mover.body_m() + half_m,
        }
    }

    /// Whether a robot drives past a person who stands, no nearer than it is and not straight away either: slowly,
    /// since the person may set off.
    fn passes_slowly(&self, robot: RobotId, at: Point, w: &Whereabouts, now: Time) -> bool {
        let lax = self.drives_back_to(robot).is_some() || self.yielding.stood_for(robot, now).is_some();
        let is_near = self.is_in_circle(at, w);
        let passes = |there| !is_near && !leads_off(at, there, w.at) && comes_no_nearer(at, there, w.at);
        !lax && stands(w) && self.next_place(robot).is_some_and(passes)
    }

    /// The place to which a robot drives next: back where it is called to, or along what it was granted.
    fn next_place(&self, robot: RobotId) -> Option<Point> {
        let next = || self.floor.granted_ahead(robot).next();
        self.drives_back_to(robot).or_else(|| next().map(|v| self.floor.warehouse().nodes[v.node].at))
    }

    /// Whether a robot would probably meet a worker if it did not brake now: the probability within the time that
    /// braking takes is at the threshold or beyond.
    fn would_meet(&self, robot: RobotId, worker: WorkerId, at: Point, now: Time) -> bool {
        let mover = self.people.mover(worker);
        let meets_m = mover.far_m(MEETS_M);
        let far = self.people.people[worker].track.newest().is_none_or(|s| (s.at - at).norm() > meets_m);
        if far {
            return false;
        }
        let way = self.floor.granted_way(robot, at, self.drives_back_to(robot));
        if way.len() < 2 {
            return false;
        }
        let loaded = self.floor.ledger.rack_on(robot).is_some();
        let seen_mps = self.floor.scene.robot(robot).map_or(0.0, |t| t.speed_mps);
        let speed_mps = seen_mps.max(SLOW_MPS);
        let times = self.floor.regions(robot).times(speed_mps, loaded);
        let time = Span::from_secs_f64(times.react_s + times.stop_s) + BEYOND;
        let robot = Swept { way, speed_mps, half_m: self.floor.footprint(robot).half_m(), mover };
        collision(|t| self.people.forecast(self.floor, worker, t), &robot, now, time)
            .is_some_and(|p| p >= THRESHOLD)
    }
}

/// Whether a person stands, as far as that is seen.
fn stands(w: &Whereabouts) -> bool {
    w.presence == Presence::Tracked && w.velocity.norm() < STROLL_MPS
}

/// Whether the way from one place to the next leads away from a person: within 60° of straight away.
fn leads_off(at: Point, there: Point, from: Point) -> bool {
    let (on, off) = (there - at, at - from);
    on.dot(&off) > 0.5 * on.norm() * off.norm()
}

/// Whether the way from one place to the next comes no nearer to a person, and ends farther away.
fn comes_no_nearer(at: Point, there: Point, from: Point) -> bool {
    let away_m = (at - from).norm();
    Segment { a: at, b: there }.distance_to(from) > away_m - NEARER_M && (there - from).norm() > away_m
}
