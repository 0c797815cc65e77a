//! How fast each robot may be near people, now; and which robots met whom.
//!
//! Limits and stops leave at once, without waiting for the journal: they take nothing from anybody. Refuses:
//! to be a safety function; robots' own scanners and brakes are.

use crate::aware::{Drive, HumanAwarePolicy, Near, SLOW_MPS, Walk, moves_within};
use crate::fleet::Fleet;
use crate::fleet::people::state::Mode;
use crate::fleet::state::fact::Fact;
use crate::fleet::state::floor::Floor;
use crate::fleet::state::io::Command;
use crate::fleet::state::worker::{Encounter, Reaction};
use crate::fleet::traffic::closures::STANDS;
use crate::fleet::yielding::state::{GivesWay, Standing};
use crate::geometry::{Point, Segment, to_mm};
use crate::human::{Presence, Whereabouts};
use crate::id::{RobotId, WorkerId};
use crate::route::{Cause, Effect};
use crate::time::{Span, Time};
use crate::timeline::Visit;

/// Whoever is slower than this stands, more or less, metres per second.
pub(in crate::fleet) const STROLL_MPS: f64 = 0.3;
/// A robot slower than this stands, metres per second.
const STANDS_MPS: f64 = 0.05;
/// Room beyond region 1 that a robot leaves to somebody who stands, metres.
const ROOM_M: f64 = 0.3;
/// Room beyond region 1 that is left to somebody who comes: what is walked while a stop is on its way, metres.
const CLEAR_M: f64 = 0.35;
/// Who stands sets off only with so much more room, metres: poses and speeds waver, and a robot that starts and stops
/// by turns creeps just when somebody comes.
const SET_OFF_M: f64 = 0.3;
/// Whoever is farther away does not come into region 1 before a robot has stopped, metres.
const PASSING_M: f64 = 6.0;
/// How fast people walk once they set off, metres per second.
const GAIT_MPS: f64 = 1.3;
/// Robots are told their limit again after this long, until they say that they know it.
const INSIST: Span = Span::from_millis(100);
/// Who comes nearer by no more than this passes, metres.
const NEARER_M: f64 = 0.05;
/// Robots and workers farther apart than this are of no interest to one another, metres.
const FAR_M: f64 = 12.0;

impl Fleet {
    /// Tells every robot how fast it may be near people, where it does not know yet. This leaves at once.
    pub(in crate::fleet) fn limit_robots(&mut self, now: Time) {
        let present = self.present(now);
        for robot in self.ledger.robots.ids().collect::<Vec<_>>() {
            let Some(seen) = self.scene.robot(robot).copied() else { continue };
            let (limit, because) = self.limit_for(robot, &present, now);
            if let Some(worker) = because.filter(|_| limit == Some(0.0) && seen.speed_mps > STANDS_MPS) {
                self.gives_way(robot, worker, Reaction::Stopped, now);
            }
            self.note_standing(robot, limit, because, now);
            let told = self.yielding.of(robot).limit_told;
            let same = told.map_or(limit.is_none(), |(l, _)| l == limit);
            let known = seen.limit_mps == limit;
            // A limit that nobody here set is older than a restart, or the server's own while the journal was full.
            if same && (known || told.is_some_and(|(_, at)| now - at < INSIST)) {
                continue;
            }
            self.yielding.of_mut(robot).limit_told = Some((limit, now));
            self.out.urgent.push((robot, Command::Limit(limit)));
        }
    }

    pub(in crate::fleet) fn limit_for(
        &self,
        robot: RobotId,
        present: &[(WorkerId, Whereabouts)],
        now: Time,
    ) -> (Option<f64>, Option<WorkerId>) {
        let at = self.floor().place_of(robot);
        let speed = self.scene.robot(robot).map_or(0.0, |t| t.speed_mps);
        let loaded = self.ledger.rack_on(robot).is_some();
        let mut slowest: (Option<f64>, Option<WorkerId>) = (None, None);
        let is_displaced = self.scene.displaced(robot).is_some();
        if self.floor().is_halted(robot) || is_displaced || self.drives_into(robot).is_some() {
            return (Some(0.0), None);
        }
        for (worker, w) in present {
            let distance = (at - w.at).norm() - w.reach_m;
            if distance > FAR_M {
                continue;
            }
            let off = w.presence != Presence::Lost && self.drives_away(robot, at, w.at, now);
            // Who drives away needs no room to brake towards anybody, and braking would let the other catch up.
            let towards_mps = if off { 0.0 } else { speed };
            let stop = self.crowd.regions.stop_radius_at_m(towards_mps, loaded, w.sigma_m);
            let limit = if distance < stop {
                Some(if off && !self.is_caught_up(robot, *worker, w, now) { SLOW_MPS } else { 0.0 })
            } else {
                self.limit_here(robot, at, *worker, w, now)
            };
            // Down to the slow speed, at which the rules by distance decide: who stands face to face with somebody
            // has to get out of the way somehow.
            let is_fast = speed > SLOW_MPS && limit.is_none_or(|l| l > SLOW_MPS);
            let brakes = self.settings.policy == HumanAwarePolicy::Giveway && is_fast;
            let limit =
                if brakes && self.would_meet(robot, *worker, at, now) { Some(SLOW_MPS) } else { limit };
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
        now: Time,
    ) -> Option<f64> {
        let loaded = self.ledger.rack_on(robot).is_some();
        let (chain, reached) = (self.ledger.chain(robot), self.floor().reached(robot));
        let nodes = (reached..).map_while(|serial| chain.get(serial)).take(2).map(|v| v.node);
        if self.settings.policy == HumanAwarePolicy::Giveway {
            if self.is_caught_up(robot, worker, w, now) {
                return Some(0.0);
            }
            // The separation distance counts speed towards the person, and there is none.
            if self.drives_away(robot, at, w.at, now) {
                return None;
            }
        }
        let conditions = nodes.flat_map(|n| self.crowd.conditions.of(n));
        let limits = conditions.filter(|c| c.cause == Cause::Worker(worker)).filter_map(|c| match c.effect {
            Effect::Slow(l) => Some(l[usize::from(loaded)]).filter(|l| l.is_finite()),
            Effect::Still if self.settings.policy == HumanAwarePolicy::Giveway => {
                Some(if self.may_finish(robot, w, loaded) { SLOW_MPS } else { 0.0 })
            }
            Effect::Still | Effect::Closed => Some(SLOW_MPS),
            Effect::Price(_) => None,
        });
        limits.min_by(f64::total_cmp)
    }

    /// Notes since when a robot has to stand for somebody; it may come back slowly meanwhile. Who stands for one and
    /// then for another has stood all the while.
    fn note_standing(&mut self, robot: RobotId, limit: Option<f64>, because: Option<WorkerId>, now: Time) {
        let (node, noted) = (self.ledger.node_of(robot), self.yielding.of_mut(robot));
        let before = noted.stands;
        match because.filter(|_| limit.is_some_and(|l| l <= SLOW_MPS)) {
            Some(worker) if before.is_some_and(|s| s.worker == worker) => {}
            Some(worker) if limit == Some(0.0) => {
                let since = before.filter(|s| s.node == node).map_or(now, |s| s.since);
                noted.stands = Some(Standing { worker, since, facing_since: now, node });
            }
            // Who was called back has not left yet.
            _ if noted.called_back.is_some() => {}
            _ => noted.stands = None,
        }
    }

    /// Whether a robot that drives on to the end of what it was granted would still move when somebody comes into
    /// region 1.
    fn is_caught_up(&self, robot: RobotId, worker: WorkerId, w: &Whereabouts, now: Time) -> bool {
        let Some(seen) = self.scene.robot(robot) else { return false };
        let at = seen.pose.at;
        let way = self.granted_way(robot, at);
        if way.len() < 2 || (at - w.at).norm() > PASSING_M {
            return false;
        }
        let walk = self.walk_of(worker, w, (robot, at), now);
        if walk.speed_mps < STROLL_MPS {
            return false;
        }
        let loaded = self.ledger.rack_on(robot).is_some();
        let k = *self.floor().kinematics(robot);
        let drive = Drive {
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
        moves_within(&drive, &walk, self.crowd.regions.stop_radius_m(loaded, w.sigma_m) + room_m)
    }

    /// Where a robot drives from `at` to the end of what it was granted.
    pub(in crate::fleet) fn granted_way(&self, robot: RobotId, at: Point) -> Vec<Point> {
        if let Some(back) = self.comes_back_to(robot) {
            return vec![at, back];
        }
        let ahead = self.floor().granted_ahead(robot);
        std::iter::once(at).chain(ahead.map(|v| self.warehouse().nodes[v.node].at)).collect()
    }

    /// How a worker will walk on, as far as that is known: along the path, straight on without one, and from where
    /// there is work to do in any direction as soon as it is done, or a while later.
    pub(in crate::fleet) fn walk_of(
        &self,
        worker: WorkerId,
        w: &Whereabouts,
        (robot, at): (RobotId, Point),
        now: Time,
    ) -> Walk {
        let person = &self.crowd.people[worker];
        let speed = w.velocity.norm();
        if let (Some(since), Some(plan)) = (person.there_since, &person.plan)
            && speed < STROLL_MPS
            && now - (since + plan.stay) < STANDS
        {
            let waits_s = (since + plan.stay - now).max(Span::ZERO).as_secs_f64();
            return Walk { way: vec![w.at, at], speed_mps: GAIT_MPS, waits_s };
        }
        let follows = matches!(person.mode, Mode::Following | Mode::Redirected);
        let path = person.rest_of_path(w.at).filter(|p| follows && p.len() > 1);
        // Whoever has stopped on the way may set off again, unless it is to let the robot leave; whoever has stood for
        // long waits for something, maybe for the robot to go on.
        let lately = person.stands_since.is_none_or(|t| now - t < STANDS);
        let sets_off = path.is_some() && lately && !self.drives_away(robot, at, w.at, now);
        let way = path.unwrap_or_else(|| vec![w.at, w.at + w.velocity * 5.0]);
        Walk { way, speed_mps: if sets_off && speed < STROLL_MPS { GAIT_MPS } else { speed }, waits_s: 0.0 }
    }

    /// Whether a robot within region 2 may drive on to the end of what it was granted: the worker stands, and
    /// it does not lead into region 1. Else it could not be at rest when the worker comes.
    fn may_finish(&self, robot: RobotId, w: &Whereabouts, loaded: bool) -> bool {
        let clear_m = self.crowd.regions.stop_radius_m(loaded, w.sigma_m) + ROOM_M;
        let leaves_room = self
            .floor()
            .granted_ahead(robot)
            .all(|v| (self.warehouse().nodes[v.node].at - w.at).norm() > clear_m);
        w.velocity.norm() < STROLL_MPS && leaves_room
    }

    /// Whether a robot's next piece of way leads away from a place: what it was granted, or back where it is called to.
    /// Who comes back, or has stood there for long, may also pass, where that is not nearer than it is already.
    pub(in crate::fleet) fn drives_away(&self, robot: RobotId, at: Point, from: Point, now: Time) -> bool {
        let next = self.floor().granted_ahead(robot).next();
        let back = self.comes_back_to(robot);
        let Some(there) = back.or(next.map(|v| self.warehouse().nodes[v.node].at)) else { return false };
        let (on, off) = (there - at, at - from);
        let passes = || {
            let nearest = Segment { a: at, b: there }.distance_to(from);
            nearest > off.norm() - NEARER_M && (there - from).norm() > off.norm()
        };
        let lax = back.is_some() || self.stood_for(robot, now).is_some();
        on.dot(&off) > 0.5 * on.norm() * off.norm() || lax && passes()
    }

    /// Notes that a robot gives way to somebody, once until it is on its way again.
    pub(in crate::fleet) fn gives_way(
        &mut self,
        robot: RobotId,
        worker: WorkerId,
        reaction: Reaction,
        now: Time,
    ) {
        let before = self.yielding.of(robot).to;
        let since = before.map_or(now, |y| y.since);
        self.yielding.of_mut(robot).to = Some(GivesWay { worker, reaction, since });
        if before.is_none() {
            self.record(Fact::Interrupted { robot, worker, reaction, at: now });
        }
    }

    /// Encounters, as far as they are seen.
    pub(in crate::fleet) fn meet(&mut self, now: Time) {
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
            let yielding = self.yielding.of(start.robot).to;
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

impl<'a> Floor<'a> {
    /// The number of the visit whose centre a robot has reached, by its own word: the ledger follows later in the step,
    /// and a robot that drove on meanwhile would seem to turn back.
    fn reached(&self, robot: RobotId) -> u64 {
        let chain = self.ledger.chain(robot);
        let said = self.scene.robot(robot).map_or(0, |t| t.reached);
        said.clamp(chain.first(), chain.granted() - 1)
    }

    /// What a robot was granted and has not reached.
    fn granted_ahead(self, robot: RobotId) -> impl Iterator<Item = &'a Visit> {
        let chain = self.ledger.chain(robot);
        (self.reached(robot) + 1..chain.granted()).filter_map(|serial| chain.get(serial))
    }
}
