//! Places that robots cannot get to, and chargers that give no current: closed for a while, then tried again.
//!
//! A robot that cannot pass what stands on its way to the next node forgets its grant, goes back and takes another way,
//! as other robots do. So does a robot that stands for long though it may drive: for example, its scanner sees a person
//! whom the fleet believes to be elsewhere.
//! Refuses: to know what stands there, and to keep a place closed for good: operators close areas.

use crate::state::fault::Fault;
use crate::state::floor::Floor;
use crate::state::restrictions::ClosedNodes;
use crate::state::writer::Writer;
use crate::traffic::state::{Obstruction, Traffic};
use giveway_floor::id::{NodeId, RobotId};
use giveway_floor::route::{Cause, Condition, Effect};
use giveway_floor::time::{Span, Time, Window};
use giveway_floor::warehouse::NodeKind;
use std::collections::BTreeMap;

/// Robots try a place again this long after a robot reported an obstruction before it.
const CLOSED: Span = Span::from_secs(120);
/// Robots try a place again this long after a robot stopped before it without saying why.
const CLOSED_UNSAID: Span = Span::from_secs(30);
/// A charger that gave no current is tried again after this.
const OUT_OF_ORDER: Span = Span::from_secs(600);

impl Traffic {
    /// Notes where robots are obstructed or get no current. These places are closed while they are noted.
    pub(crate) fn note_obstructions(&mut self, floor: Floor<'_>, now: Time) -> ClosedNodes {
        for robot in floor.scene.kept_from_driving(now) {
            // An obstacle that the robot does not report may be a person, who goes on.
            let said = floor.scene.robot(robot).is_some_and(|t| t.fault == Some(Fault::Obstructed));
            let until = now + if said { CLOSED } else { CLOSED_UNSAID };
            if let Some(node) = floor.obstructed_at(robot, now) {
                let from = floor.ledger.node_of(robot);
                note(&mut self.obstructions, node, Obstruction { by: robot, from, since: now, until, said });
            }
        }
        for (robot, fault) in floor.scene.faults(now) {
            let charger = floor.unplugged_at(robot).filter(|_| fault == Fault::Unplugged);
            if let Some(node) = charger {
                let until = now + OUT_OF_ORDER;
                let found = Obstruction { by: robot, from: node, since: now, until, said: false };
                note(&mut self.obstructions, node, found);
            }
        }
        self.obstructions.retain(|_, found| now < found.until);
        // A charger can be passed, and left.
        let bars = |node: NodeId| floor.warehouse().kind(node) != NodeKind::Charger;
        let closed = |node: NodeId, until: Time| {
            let (window, cause) = (Window::new(now, until), Cause::Obstruction(node));
            (node, Condition { window, effect: Effect::Closed, cause })
        };
        let barred = self.obstructions.iter().filter(|(node, _)| bars(**node));
        ClosedNodes {
            conditions: barred.map(|(node, found)| closed(*node, found.until)).collect(),
            since: self.obstructions.keys().map(|node| (*node, now)).collect(),
        }
    }

    /// Whether any node is closed because a robot could not get there.
    pub(crate) fn has_obstructions(&self) -> bool {
        !self.obstructions.is_empty()
    }

    /// Until when an obstructed node is closed, if it is.
    pub(crate) fn obstructed_until(&self, node: NodeId) -> Option<Time> {
        self.obstructions.get(&node).map(|found| found.until)
    }

    /// Nodes that are closed because robots could not get there.
    pub(super) fn obstructed(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.obstructions.keys().copied()
    }

    /// Places before which a robot reported an obstacle and from which it has turned away since; with the robot, and
    /// since when the place is closed.
    pub(crate) fn left_obstacles<'a>(
        &'a self,
        floor: Floor<'a>,
    ) -> impl Iterator<Item = (NodeId, RobotId, Time)> + 'a {
        let said = self.obstructions.iter().filter(|(_, found)| found.said);
        let turned_away = move |(node, found): &(&NodeId, &Obstruction)| {
            let next = floor.ledger.chain(found.by).visits().nth(1).map(|v| v.node);
            next.is_some_and(|next| next != **node) || floor.ledger.node_of(found.by) != found.from
        };
        said.filter(turned_away).map(|(node, found)| (*node, found.by, found.since))
    }

    /// Revokes what obstructed robots were granted.
    pub(crate) fn revoke_obstructed(&mut self, writer: &mut Writer, now: Time) {
        for robot in writer.scene.kept_from_driving(now) {
            self.revoke_grant(writer, robot, now);
        }
    }
}

/// Notes an obstruction; if the place was obstructed before, the time since when stays.
fn note(known: &mut BTreeMap<NodeId, Obstruction>, node: NodeId, found: Obstruction) {
    let since = known.get(&node).map_or(found.since, |before| before.since);
    known.insert(node, Obstruction { since, ..found });
}

impl Floor<'_> {
    /// The node to which an obstructed robot was on its way.
    pub(crate) fn obstructed_at(&self, robot: RobotId, now: Time) -> Option<NodeId> {
        let kept = self.scene.is_kept_from_driving(robot, now);
        self.granted_ahead(robot).next().filter(|_| kept).map(|v| v.node)
    }

    /// The charger at which a robot stands and gets no current.
    fn unplugged_at(&self, robot: RobotId) -> Option<NodeId> {
        let node = self.ledger.node_of(robot);
        (self.warehouse().kind(node) == NodeKind::Charger).then_some(node)
    }
}
