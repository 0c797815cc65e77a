//! How fast each robot may be near people, now; and which robots met whom.
//!
//! Limits and stops leave at once, without waiting for the journal: they take nothing from anybody. Refuses:
//! to be a safety function; robots' own scanners and brakes are.

use super::Fleet;
use super::fact::Fact;
use super::io::Command;
use super::people::{Encounter, Reaction};
use crate::aware::{Arm, Near, SLOW_MPS};
use crate::geometry::{Point, to_mm};
use crate::human::{Presence, Whereabouts};
use crate::id::{RobotId, WorkerId};
use crate::route::{Cause, Effect};
use crate::time::{Span, Time};

/// Whoever is slower than this stands, more or less, metres per second.
const STROLL_MPS: f64 = 0.3;
/// Room beyond region 1 that a robot leaves to somebody who stands, metres.
const ROOM_M: f64 = 0.3;
/// Robots are told their limit again after this long, until they say that they know it.
const INSIST: Span = Span::from_millis(100);
/// Robots and workers farther apart than this are of no interest to one another, metres.
const FAR_M: f64 = 12.0;

impl Fleet {
    /// Tells every robot how fast it may be near people, where it does not know yet. This leaves at once.
    pub(super) fn limit_robots(&mut self, now: Time) {
        let present = self.present(now);
        for robot in self.ledger.robots.ids().collect::<Vec<_>>() {
            let Some(seen) = self.scene.robot(robot).copied() else { continue };
            let (limit, because) = self.limit_for(robot, &present, now);
            if let Some(worker) = because.filter(|_| limit == Some(0.0) && seen.speed_mps > 0.05) {
                self.gives_way(robot, worker, Reaction::Stopped, now);
            }
            let told = self.crowd.limits.get(&robot).copied();
            let same = told.map_or(limit.is_none(), |(l, _)| l == limit);
            let known = seen.limit_mps == limit;
            // A limit that nobody here set is older than a restart, or the server's own while the journal was full.
            if same && (known || told.is_some_and(|(_, at)| now - at < INSIST)) {
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
        now: Time,
    ) -> (Option<f64>, Option<WorkerId>) {
        let at = self.place_of(robot);
        let speed = self.scene.robot(robot).map_or(0.0, |t| t.speed_mps);
        let loaded = self.ledger.rack_on(robot).is_some();
        let mut slowest: (Option<f64>, Option<WorkerId>) = (None, None);
        if self.is_halted(robot) {
            return (Some(0.0), None);
        }
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
            // Down to the slow speed, at which the rules by distance decide: who stands face to face with somebody
            // has to get out of the way somehow.
            let is_fast = speed > SLOW_MPS && limit.is_none_or(|l| l > SLOW_MPS);
            let brakes = self.settings.arm == Arm::Giveway && is_fast;
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
    pub(super) fn meet(&mut self, now: Time) {
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
