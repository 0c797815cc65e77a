//! Grants that are revoked. If a robot and a person wait for each other, neither can go on, since the robot may only
//! drive on to where the person stands. So the robot forgets what it was granted, and reports where it stands: on a
//! node, or between two nodes, both of which it holds. From between two nodes it goes on to either, whichever way is
//! open; the direction is chosen anew whenever the robot stands.
//!
//! What was granted stays granted until the robot confirms that it has forgotten it, whatever is lost or late on the
//! way. Refuses: to revoke the grant of a robot that drives or works.

use crate::state::fact::RouteFact;
use crate::state::floor::Floor;
use crate::state::io::{Command, Telemetry};
use crate::state::writer::Writer;
use crate::state::yielding::STANDS;
use crate::traffic::state::{Direction, Traffic};
use giveway_floor::geometry::Point;
use giveway_floor::id::RobotId;
use giveway_floor::time::{Span, Time};

/// A robot that does not confirm a revocation is told again after this.
const AGAIN: Span = Span::from_secs(1);
/// A robot between two nodes that has made no progress for this long tries the other direction.
const PATIENCE: Span = Span::from_secs(10);
/// A robot nearer to a node than this counts as on it, metres. Less than [`crate::OFF_ROUTE_M`], since what the robot
/// gives back is free for others at once.
const ON_NODE_M: f64 = 0.02;

impl Traffic {
    /// Revokes a robot's grant beyond where it stands, if the robot can forget it and was not told to just now.
    pub(crate) fn revoke_grant(&mut self, writer: &mut Writer, robot: RobotId, now: Time) {
        let told = self.revoked.get(&robot).is_some_and(|t| now - *t < AGAIN);
        if told || !writer.floor().can_be_revoked(robot, now) {
            return;
        }
        self.revoked.insert(robot, now);
        let (reached, number) =
            (writer.ledger().chain(robot).first(), writer.ledger().robots[robot].recalls + 1);
        assert!(reached < writer.ledger().chain(robot).granted(), "{robot:?} stands where it may be");
        writer.tell_at_once(robot, Command::Revoke { reached, number });
    }

    /// Forgets revocations so old that the robot has left by now, or will not leave.
    pub(crate) fn forget_revoked(&mut self, now: Time) {
        self.revoked.retain(|_, told| now - *told < STANDS);
    }

    /// Robots between two nodes that have forgotten what they were granted. A robot that has driven back from there and
    /// still holds the second node is told to give it up.
    pub(crate) fn halfway(&mut self, writer: &mut Writer, now: Time) -> Vec<RobotId> {
        let back: Vec<RobotId> = self.directions.keys().copied().collect();
        for robot in back {
            let floor = writer.floor();
            if !floor.is_halfway(robot) {
                let came_back =
                    self.direction(robot) == Some(Direction::Back) && floor.can_be_revoked(robot, now);
                if came_back {
                    self.revoke_grant(writer, robot, now);
                } else if let Some((Direction::Back, _)) = self.directions.remove(&robot) {
                    // The robot stands where it came from: the best route from there is searched for at once.
                    self.needs.early.insert(robot);
                }
            }
        }
        let floor = writer.floor();
        floor
            .ledger
            .present()
            .filter(|r| floor.is_halfway(*r) && floor.scene.fit(*r, now).is_some())
            .collect()
    }

    /// Where a robot between two nodes goes on to, if that was chosen.
    pub fn direction(&self, robot: RobotId) -> Option<Direction> {
        self.directions.get(&robot).map(|(direction, _)| *direction)
    }

    /// The directions in which a robot that stands between two nodes may go on, the better first: its present
    /// direction, unless it has made no progress that way for a while; if it has none, forward, unless something stood
    /// there. A robot that cannot drive back has only one.
    pub fn directions_for(&self, floor: Floor<'_>, robot: RobotId, now: Time) -> &'static [Direction] {
        const FORWARD_FIRST: &[Direction] = &[Direction::Forward, Direction::Back];
        const BACK_FIRST: &[Direction] = &[Direction::Back, Direction::Forward];
        if !floor.kind(robot).capabilities.drives_back {
            return &[Direction::Forward];
        }
        match self.directions.get(&robot) {
            None if self.is_obstructed_ahead(floor, robot) => BACK_FIRST,
            Some((Direction::Back, since)) if now - *since < PATIENCE => BACK_FIRST,
            Some((Direction::Forward, since)) if now - *since >= PATIENCE => BACK_FIRST,
            _ => FORWARD_FIRST,
        }
    }

    /// Whether something recently stood before the next node of a robot.
    pub(crate) fn is_obstructed_ahead(&self, floor: Floor<'_>, robot: RobotId) -> bool {
        let chain = floor.ledger.chain(robot);
        let ahead = chain.get(chain.first() + 1);
        ahead.is_some_and(|v| self.obstructions.contains_key(&v.node))
    }

    /// Lets a robot between two nodes go on in a direction, or stay there.
    pub(crate) fn direct(&mut self, robot: RobotId, direction: Option<Direction>, now: Time) {
        match direction {
            None => drop(self.directions.remove(&robot)),
            Some(direction) if self.direction(robot) == Some(direction) => {}
            Some(direction) => drop(self.directions.insert(robot, (direction, now))),
        }
    }

    /// The place to which a robot that drives back is on its way, until it is there.
    pub(crate) fn drives_back_to(&self, floor: Floor<'_>, robot: RobotId) -> Option<Point> {
        let back = self.direction(robot) == Some(Direction::Back) && floor.is_halfway(robot);
        back.then(|| floor.last_reached(robot))
    }
}

/// Takes a robot's count of forgotten grants. The robot keeps the node that it reached last and, if it stands between
/// two nodes, the one that it is on its way to.
pub(crate) fn note_revoked(writer: &mut Writer, robot: RobotId, seen: &Telemetry, now: Time) {
    let chain = writer.ledger().chain(robot);
    let told = seen.recalls > writer.ledger().robots[robot].recalls;
    if !told || !(chain.first()..chain.granted()).contains(&seen.known) {
        return;
    }
    let between = seen.known == seen.reached && !writer.floor().is_on_node(seen);
    let serial = (seen.known + u64::from(between)).min(chain.granted() - 1);
    writer.record(RouteFact::Revoked { robot, serial, recalls: seen.recalls, at: now });
}

impl Floor<'_> {
    fn can_be_revoked(&self, robot: RobotId, now: Time) -> bool {
        let (chain, record) = (self.ledger.chain(robot), &self.ledger.robots[robot]);
        let works = record.stops.first().is_some_and(|s| s.serial == chain.first());
        let stands = |t: &Telemetry| {
            let at_rest = t.limit_mps == Some(0.0) || t.known == t.reached;
            at_rest && t.stands() && t.reached == chain.first() && t.recalls == record.recalls
        };
        let more = chain.first() + 1 < chain.granted() && !self.is_halfway(robot);
        let obeys = self.kind(robot).capabilities.revocation;
        obeys && more && !works && self.scene.fit(robot, now).is_some_and(stands)
    }

    /// Whether a robot is between two nodes and has forgotten what it was granted, so that it may go on to either.
    pub fn is_halfway(&self, robot: RobotId) -> bool {
        let (chain, record) = (self.ledger.chain(robot), &self.ledger.robots[robot]);
        chain.first() + 2 == chain.granted()
            && self.scene.robot(robot).is_some_and(|t| {
                let knows_no_more = t.known == t.reached && t.reached == chain.first();
                knows_no_more && t.recalls == record.recalls && !self.is_on_node(t)
            })
    }

    /// The points along which a robot drives from `at` to the end of what it was granted, or to `back`.
    pub(crate) fn granted_way(self, robot: RobotId, at: Point, back: Option<Point>) -> Vec<Point> {
        if let Some(back) = back {
            return vec![at, back];
        }
        let ahead = self.granted_ahead(robot);
        std::iter::once(at).chain(ahead.map(|v| self.warehouse().nodes[v.node].at)).collect()
    }

    /// The place of the node that a robot reached last.
    pub(crate) fn last_reached(&self, robot: RobotId) -> Point {
        self.warehouse().nodes[self.ledger.node_of(robot)].at
    }

    /// Whether a robot is on the node that it reached last.
    fn is_on_node(&self, seen: &Telemetry) -> bool {
        (seen.pose.at - self.last_reached(seen.robot)).norm() <= ON_NODE_M
    }
}
