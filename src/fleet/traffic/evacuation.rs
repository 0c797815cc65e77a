//! While the building is evacuated, robots on the ways to the doors leave them, robots in their way make room, and all
//! others stand.
//!
//! Refuses: to send a robot that is not on a way out onto one, and to end anything that is promised: jobs and racks are
//! kept, and robots go on with them when the evacuation is over.

use crate::state::binding::WAY_M;
use crate::state::floor::Floor;
use crate::state::restrictions::{ClearedWays, ClosedNodes};
use crate::state::writer::Writer;
use crate::traffic::state::{Traffic, Withheld};
use giveway_floor::geometry::{Point, Segment};
use giveway_floor::id::{NodeId, RobotId};
use giveway_floor::route::{Cause, Condition, Effect};
use giveway_floor::time::{Span, Time, Window};
use std::collections::BTreeSet;

/// A robot that found no place to leave for tries again after this.
const AGAIN: Span = Span::from_secs(2);

impl Traffic {
    /// The ways out, which are closed for robots, and the robots that may move to clear them. Both are empty without an
    /// evacuation.
    pub(crate) fn ways_out(&mut self, floor: Floor<'_>, ways: &[Vec<Point>], now: Time) -> ClearedWays {
        if floor.ledger.evacuation.is_none() {
            self.cleared.clear();
            return ClearedWays::default();
        }
        let nodes = floor.nodes_on(ways);
        let (window, cause) = (Window::new(now, Time::MAX), Cause::Evacuation);
        let closed = Condition { window, effect: Effect::Closed, cause };
        let closing = ClosedNodes {
            conditions: nodes.iter().map(|node| (*node, closed)).collect(),
            since: nodes.iter().map(|node| (*node, now)).collect(),
        };
        ClearedWays { closing, clears: floor.clear(&nodes), nodes }
    }

    /// Robots on the ways out leave for the nearest place where they may stay. So do the robots for which they wait, if
    /// these have no route or their routes lead onto a way out. A robot that finds no place drives on along its route,
    /// which leads off the ways out, too.
    pub(crate) fn clear_ways_out(&mut self, writer: &mut Writer, now: Time) {
        let kept_off =
            |r: &RobotId| matches!(self.withheld(*r), Some(Withheld::Condition(Cause::Evacuation, _)));
        let moving = writer.restrictions.clears_ways_out.iter().copied();
        let floor = writer.floor();
        let stays = |r: &RobotId| kept_off(r) || floor.lacks_route(*r);
        let leaves: Vec<RobotId> =
            moving.filter(|r| floor.is_on(*r, &floor.restrictions.ways_out) || stays(r)).collect();
        for robot in leaves {
            let tried = self.cleared.get(&robot).is_some_and(|t| now - *t < AGAIN);
            let fit = writer.scene.fit(robot, now).is_some() && !writer.ledger().robots[robot].failed;
            if self.effort.is_spent() || tried || !fit || writer.floor().only_leaves(robot) {
                continue;
            }
            self.cleared.insert(robot, now);
            // The robot leaves away from a worker who comes towards it: on the way past, each would wait for the other.
            let worker = match self.withheld(robot) {
                Some(Withheld::Condition(Cause::Worker(worker), _)) => Some(worker),
                _ => None,
            };
            self.step_out(writer, robot, worker, now);
        }
    }

    /// Robots that stand beside the ways out and were granted a way onto one forget it.
    pub(crate) fn revoke_ways_out(&mut self, writer: &mut Writer, now: Time) {
        if writer.ledger().evacuation.is_none() {
            return;
        }
        for robot in writer.ledger().present() {
            let (floor, ways_out) = (writer.floor(), &writer.restrictions.ways_out);
            let enters = floor.granted_ahead(robot).any(|v| ways_out.contains(&v.node));
            if enters && !floor.is_on(robot, ways_out) {
                self.revoke_grant(writer, robot, now);
            }
        }
    }
}

impl Floor<'_> {
    /// Nodes on which a robot would be in people's way. Nodes where robots may stay for ever are beside the ways out.
    fn nodes_on(&self, ways: &[Vec<Point>]) -> BTreeSet<NodeId> {
        let w = self.warehouse();
        let mut nodes = BTreeSet::new();
        for step in ways.iter().flat_map(|way| way.windows(2)) {
            let step = Segment { a: step[0], b: step[1] };
            let near = w.nodes_within(step.point(0.5), step.length() / 2.0 + WAY_M);
            let on = |n: &NodeId| step.distance_to(w.nodes[*n].at) < WAY_M && !w.kind(*n).is_lasting();
            nodes.extend(near.into_iter().filter(on));
        }
        nodes
    }

    /// Whether a robot drives to a place where it may stay, and does nothing before. A robot that has come to a stand
    /// on its way there looks for another place.
    fn only_leaves(&self, robot: RobotId) -> bool {
        let chain = self.ledger.chain(robot);
        self.ledger.robots[robot].stops.is_empty() && chain.first() + 1 < chain.granted()
    }

    /// Robots that may move: the robots on these nodes, and the robots for which they wait.
    fn clear(&self, nodes: &BTreeSet<NodeId>) -> BTreeSet<RobotId> {
        let mut ahead: Vec<RobotId> = self.ledger.present().filter(|r| self.is_on(*r, nodes)).collect();
        let mut moving = BTreeSet::new();
        while let Some(robot) = ahead.pop() {
            if !moving.insert(robot) {
                continue;
            }
            let turn = self.ledger.timeline().waits_for(robot, self.ledger.chain(robot).granted());
            if let Some((_, other)) = turn {
                ahead.push(other);
            }
        }
        moving
    }
}
