//! Grants that are taken back: a robot and somebody who wait for one another get nowhere, since the robot may only go
//! on to where the other stands. It is called back to the node that it reached last, and is free to leave from there.
//!
//! What was granted stays granted until the robot says that it is back and has forgotten the rest, whatever is lost or
//! late on the way. Refuses: to call back a robot that drives, or works.

use crate::aware::HumanAwarePolicy;
use crate::fleet::Fleet;
use crate::fleet::state::fact::Fact;
use crate::fleet::state::floor::Floor;
use crate::fleet::state::io::{Command, Telemetry};
use crate::fleet::traffic::closures::STANDS;
use crate::geometry::Point;
use crate::id::{NodeId, RobotId, WorkerId};
use crate::time::{Span, Time};

/// A robot that stood for somebody for so long leaves, if it can.
const LEAVES: Span = STANDS;
/// A robot that does not come back is called again after this.
const AGAIN: Span = Span::from_secs(1);
/// Nobody minds places farther from somebody than this, metres.
const FACES_M: f64 = 6.0;
/// Whoever is slower than this stands, metres per second.
const STANDS_MPS: f64 = 0.01;

impl Fleet {
    /// Calls back those who have stood for somebody for long and were granted more than the place where they stand.
    pub(in crate::fleet) fn revoke_grants(&mut self, now: Time) {
        if self.settings.policy != HumanAwarePolicy::Giveway {
            return;
        }
        let standing: Vec<RobotId> = self.yielding.standing().collect();
        for robot in standing {
            let leaves = |w| self.drives_away(robot, self.floor().place_of(robot), w, now);
            let stood_for = self.stood_for(robot, now).and_then(|w| self.whereabouts(w, now));
            if stood_for.is_some_and(|w| !leaves(w.at)) {
                self.revoke_grant(robot, now);
            }
        }
        self.yielding.forget_calls(now, LEAVES);
    }

    /// Calls a robot back to the node that it reached last, if it can come and was not called just now.
    pub(in crate::fleet) fn revoke_grant(&mut self, robot: RobotId, now: Time) {
        let called = self.yielding.of(robot).called_back.is_some_and(|t| now - t < AGAIN);
        if called || !self.floor().can_be_revoked(robot, now) {
            return;
        }
        self.yielding.of_mut(robot).called_back = Some(now);
        let (to, number) = (self.ledger.chain(robot).first(), self.ledger.robots[robot].recalls + 1);
        self.out.urgent.push((robot, Command::Revoke { to, number }));
    }

    /// The robot says how often it came back.
    pub(in crate::fleet) fn note_revoked(&mut self, robot: RobotId, seen: &Telemetry, now: Time) {
        let chain = self.ledger.chain(robot);
        if seen.recalls <= self.ledger.robots[robot].recalls
            || !(chain.first()..chain.granted()).contains(&seen.known)
        {
            return;
        }
        let (serial, recalls) = (seen.known, seen.recalls);
        self.record(Fact::Revoked { robot, serial, recalls, at: now });
    }

    /// Where a robot that was called back drives to, until it is there.
    pub(in crate::fleet) fn comes_back_to(&self, robot: RobotId) -> Option<Point> {
        let seen = self.scene.robot(robot)?;
        let chain = self.ledger.chain(robot);
        let follows = seen.known == seen.reached && chain.first() + 1 < chain.granted();
        (follows && self.yielding.of(robot).called_back.is_some())
            .then(|| self.warehouse().nodes[self.ledger.node_of(robot)].at)
    }

    /// For whom a robot has been standing for so long that it should leave: for one, or for some who take turns.
    pub(in crate::fleet) fn stood_for(&self, robot: RobotId, now: Time) -> Option<WorkerId> {
        let standing = self.yielding.of(robot).stands?;
        let long = now - standing.facing_since > LEAVES || now - standing.since > LEAVES * 2;
        long.then_some(standing.worker)
    }

    /// The one for whom the robot has been standing for long and to whom this place is nearer than its own: nobody
    /// is helped if it drives up again. Between those who take turns, it has to go nearer to one of them.
    pub(in crate::fleet) fn faces(&self, robot: RobotId, node: NodeId, now: Time) -> Option<WorkerId> {
        let standing = self.yielding.of(robot).stands?;
        if now - standing.facing_since <= LEAVES || self.settings.policy != HumanAwarePolicy::Giveway {
            return None;
        }
        let w = self.whereabouts(standing.worker, now)?.at;
        let (there, here) = (self.warehouse().nodes[node].at, self.floor().place_of(robot));
        let near = (there - w).norm();
        (near < (here - w).norm() && near < FACES_M).then_some(standing.worker)
    }
}

impl Floor<'_> {
    fn can_be_revoked(&self, robot: RobotId, now: Time) -> bool {
        let (chain, record) = (self.ledger.chain(robot), &self.ledger.robots[robot]);
        let works = record.stops.first().is_some_and(|s| s.serial == chain.first());
        let stands = |t: &Telemetry| {
            let at_rest = t.limit_mps == Some(0.0) && t.speed_mps < STANDS_MPS;
            at_rest && t.reached == chain.first() && t.recalls == record.recalls
        };
        chain.first() + 1 < chain.granted() && !works && self.scene.fit(robot, now).is_some_and(stands)
    }
}
