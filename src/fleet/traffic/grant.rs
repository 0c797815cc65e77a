//! Fifth phase: how far may each robot drive now? Grants follow the order on each resource, not the clock.
//!
//! Refuses: to grant past a stop that is not done, past somebody who was promised a resource first, or to robots that
//! are silent or halted; and to grant more than a robot needs to keep its speed, since a grant can be called back only
//! from a robot that stands, and on its word.

use crate::aware::SLOW_MPS;
use crate::fleet::Fleet;
use crate::fleet::state::fact::Fact;
use crate::fleet::state::floor::Floor;
use crate::fleet::state::io::{Command, Waypoint};
use crate::fleet::state::ledger;
use crate::id::{ResourceId, RobotId};
use crate::route::Cause;
use crate::time::{Span, Time};
use crate::timeline::Holder;

/// How long before its planned time a hold may be granted.
const EARLY: Span = Span::from_secs(4);
/// A node more than needed is granted, metres.
const NODE_M: f64 = 1.0;
/// Orders are repeated this often until the robot says that it knows them.
const REPEAT: Span = Span::from_millis(600);
/// A robot at a stop is reminded this often of what it is to do there.
const REMIND: Span = Span::from_secs(3);

/// Why the visit after the last granted one was not granted. The grant itself finds it, and *why waiting* reads it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::fleet) enum Withheld {
    /// Nothing is reserved beyond.
    End,
    /// What the robot is to do at a stop is not done.
    Stop,
    /// It is not due for a while.
    Early,
    /// This holder comes first on this resource.
    Turn(ResourceId, Holder),
    /// It would meet a person, a closed area or a robot that stands there; until then, where that is known.
    Condition(Cause, Option<Time>),
}

impl Fleet {
    pub(in crate::fleet) fn grant(&mut self, now: Time) {
        if self.waits_for_first_reports(now) {
            return;
        }
        while self.withheld.len() < self.ledger.robots.len() {
            self.withheld.push(None);
        }
        for robot in ledger::all(&self.ledger.robots) {
            self.at_hand = Some(robot);
            if self.ledger.robots[robot].failed || self.scene.fit(robot, now).is_none() {
                continue;
            }
            let held_back = self.floor().is_halted(robot) || self.crowd.procedure.holds(robot);
            let before = self.ledger.chain(robot).granted();
            self.withheld[robot] = match held_back {
                true => self.withholds(robot, before, now),
                false => self.extend_grant(robot, now),
            };
            let granted = self.ledger.chain(robot).granted() > before;
            if granted || self.must_repeat(robot, now) {
                self.send(robot, now);
            }
        }
    }

    /// Grants as many further visits as the robot needs to keep its speed; says why no more, if it needs more.
    fn extend_grant(&mut self, robot: RobotId, now: Time) -> Option<Withheld> {
        let holder = Holder::Robot(robot);
        let mut serial = self.ledger.chain(robot).granted();
        let first = serial;
        let mut ahead = self.floor().granted_ahead_m(robot);
        let enough = self.needed_ahead_m(robot);
        let mut withheld = None;
        while ahead < enough {
            withheld = self.withholds(robot, serial, now);
            if withheld.is_some() {
                break;
            }
            ahead += self.floor().step_m(robot, serial);
            serial += 1;
        }
        if serial > first {
            debug_assert!(self.ledger.timeline.waits_for(holder, first).is_none());
            self.record(Fact::Granted { robot, serial: serial - 1, at: now });
        }
        withheld
    }

    /// Why a visit cannot be granted now, if it cannot. Where a robot waits for its turn and for a person, and is due,
    /// the person is named.
    fn withholds(&self, robot: RobotId, serial: u64, now: Time) -> Option<Withheld> {
        let Some(visit) = self.ledger.chain(robot).get(serial) else { return Some(Withheld::End) };
        if self.ledger.robots[robot].stops.first().is_some_and(|s| s.serial < serial) {
            return Some(Withheld::Stop);
        }
        let turn = self.ledger.timeline.waits_for(Holder::Robot(robot), serial);
        let turn = turn.map(|(resource, holder)| Withheld::Turn(resource, holder));
        let soon = visit.enter <= now + EARLY;
        let asked = if turn.is_some() { visit.enter <= now } else { soon };
        if !asked {
            return turn.or(Some(Withheld::Early));
        }
        let condition = self.grant_waits_for(robot, visit, now);
        condition.map(|(cause, until)| Withheld::Condition(cause, until)).or(turn)
    }

    /// How far ahead it must be sure of its way to go on as fast as it may: its braking distance, what it drives
    /// until the next grant reaches it, and a node more. That is less near people, so that it can still decide
    /// otherwise there.
    pub(in crate::fleet) fn needed_ahead_m(&self, robot: RobotId) -> f64 {
        let k = *self.floor().kinematics(robot);
        let loaded = self.ledger.rack_on(robot).is_some();
        let limit = self.yielding.of(robot).limit_mps();
        let speed = k.top_mps(loaded).min(limit.unwrap_or(f64::INFINITY).max(SLOW_MPS));
        let latency = (self.settings.period * 2 + k.reaction).as_secs_f64();
        k.braking_m(speed, loaded) + speed * latency + NODE_M
    }

    /// Whether the robot may not know its orders: it does not say that it does, or it has been standing at a stop for a
    /// while without being done (a robot that was restarted there has forgotten what it was to do).
    fn must_repeat(&mut self, robot: RobotId, now: Time) -> bool {
        let chain = self.ledger.chain(robot);
        let (here, granted) = (chain.first(), chain.granted());
        let at_stop = self.ledger.robots[robot].stops.first().is_some_and(|s| s.serial == here);
        let knows = self.scene.robot(robot).is_some_and(|t| t.known + 1 >= granted);
        let told = self.scene.robot_mut(robot).told;
        let pause = if knows { REMIND } else { REPEAT };
        (!knows || at_stop) && told.is_none_or(|t| now - t >= pause)
    }

    /// Sends everything granted from where the robot is.
    fn send(&mut self, robot: RobotId, now: Time) {
        let grant = self.ledger.timeline.granted(Holder::Robot(robot)).expect("every robot stands somewhere");
        let chain = self.ledger.chain(robot);
        let stops = &self.ledger.robots[robot].stops;
        let waypoints = (grant.serials())
            .map(|serial| Waypoint {
                serial,
                node: chain.get(serial).expect("granted visits are held").node,
                act: stops.iter().find(|s| s.serial == serial).map(|s| s.act),
            })
            .collect();
        let recalls = self.ledger.robots[robot].recalls;
        self.out.commands.push((robot, Command::Drive { grant, waypoints, recalls }));
        self.scene.robot_mut(robot).told = Some(now);
    }
}

impl Floor<'_> {
    /// Distance from the visit before to this one, metres.
    fn step_m(&self, robot: RobotId, serial: u64) -> f64 {
        let chain = self.ledger.chain(robot);
        let at = |s: u64| chain.get(s).map(|v| self.warehouse().nodes[v.node].at);
        match (serial.checked_sub(1).and_then(at), at(serial)) {
            (Some(a), Some(b)) => (b - a).norm(),
            _ => 0.0,
        }
    }

    /// How far the robot can drive already, metres.
    fn granted_ahead_m(&self, robot: RobotId) -> f64 {
        let chain = self.ledger.chain(robot);
        let whole: f64 = (chain.first() + 1..chain.granted()).map(|s| self.step_m(robot, s)).sum();
        let here = self.warehouse().nodes[self.ledger.node_of(robot)].at;
        let driven = self.scene.robot(robot).map_or(0.0, |t| (t.pose.at - here).norm());
        (whole - driven).max(0.0)
    }
}
