//! Grants that are taken back. If a robot and a person wait for one another, neither gets on, since the robot may only
//! go on to where the person stands. The robot is called back to the node that it reached last, and is free to leave
//! from there.
//!
//! What was granted stays granted until the robot says that it is back and has forgotten the rest, whatever is lost or
//! late on the way. Refuses: to call back a robot that drives, or works.

use crate::fleet::state::core::Core;
use crate::fleet::state::fact::Fact;
use crate::fleet::state::floor::Floor;
use crate::fleet::state::io::{Command, Telemetry};
use crate::fleet::state::yielding::STANDS;
use crate::fleet::traffic::state::Traffic;
use crate::geometry::Point;
use crate::id::RobotId;
use crate::time::{Span, Time};

/// A robot that does not come back is called again after this.
const AGAIN: Span = Span::from_secs(1);
/// A robot slower than this stands, metres per second.
const STANDS_MPS: f64 = 0.01;

impl Traffic {
    /// Calls a robot back to the node that it reached last, if it can come and was not called just now.
    pub(in crate::fleet) fn revoke_grant(&mut self, core: &mut Core, robot: RobotId, now: Time) {
        let called = self.called_back.get(&robot).is_some_and(|t| now - *t < AGAIN);
        if called || !core.floor().can_be_revoked(robot, now) {
            return;
        }
        self.called_back.insert(robot, now);
        let (to, number) = (core.ledger.chain(robot).first(), core.ledger.robots[robot].recalls + 1);
        core.out.urgent.push((robot, Command::Revoke { to, number }));
    }

    /// Forgets calls that are so old that the robot has left, or will not.
    pub(in crate::fleet) fn forget_calls(&mut self, now: Time) {
        self.called_back.retain(|_, called| now - *called < STANDS);
    }

    /// Where a robot that was called back drives to, until it is there.
    pub(in crate::fleet) fn comes_back_to(&self, floor: Floor<'_>, robot: RobotId) -> Option<Point> {
        let seen = floor.scene.robot(robot)?;
        let chain = floor.ledger.chain(robot);
        let follows = seen.known == seen.reached && chain.first() + 1 < chain.granted();
        (follows && self.is_called_back(robot))
            .then(|| floor.warehouse().nodes[floor.ledger.node_of(robot)].at)
    }

    /// Where a robot drives from `at` to the end of what it was granted.
    pub(in crate::fleet) fn granted_way(&self, floor: Floor<'_>, robot: RobotId, at: Point) -> Vec<Point> {
        if let Some(back) = self.comes_back_to(floor, robot) {
            return vec![at, back];
        }
        let ahead = floor.granted_ahead(robot);
        std::iter::once(at).chain(ahead.map(|v| floor.warehouse().nodes[v.node].at)).collect()
    }
}

/// The robot says how often it came back.
pub(in crate::fleet) fn note_revoked(core: &mut Core, robot: RobotId, seen: &Telemetry, now: Time) {
    let chain = core.ledger.chain(robot);
    if seen.recalls <= core.ledger.robots[robot].recalls
        || !(chain.first()..chain.granted()).contains(&seen.known)
    {
        return;
    }
    let (serial, recalls) = (seen.known, seen.recalls);
    core.record(Fact::Revoked { robot, serial, recalls, at: now });
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
