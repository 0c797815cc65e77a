//! Out first, then on: a robot that finds no route for its task, and stands where it may not stay for ever, drives to
//! the nearest place where it may stay. It plans its task from there.
//!
//! Robots that stand close together after a repair each need a route that ends where others stand. The outermost robot
//! can always leave for a place to stay; then the next one can. In an aisle where a person stands at one end, the
//! outermost robot wants to come in: then all robots on the way out leave together, the farthest out first. Refuses: to
//! send off a robot that stands where it may stay, unless it is in the way of another.

use crate::state::floor::Floor;
use crate::state::writer::Writer;
use crate::traffic::joint::{commit_all, in_turn};
use crate::traffic::stages::commit;
use crate::traffic::state::Traffic;
use crate::traffic::tentative::PLACES;
use giveway_floor::id::{NodeId, RobotId, WorkerId};
use giveway_floor::route::Stage;
use giveway_floor::time::{Span, Time};

/// How much farther from a worker a place to leave for has to be, metres: one node.
const FARTHER_M: f64 = 1.0;
/// How many other robots are moved at most.
const TOGETHER: usize = 8;
/// Robots that are to enter the way out within this time are in the way.
const SOON: Span = Span::from_secs(30);

impl Traffic {
    /// Sends a robot out of the way to a place where it may stay, if there is a route to one. If a worker waits for the
    /// robot, only places count that are farther from the worker than the robot is. Returns whether the robot goes.
    pub(crate) fn step_out(
        &mut self,
        writer: &mut Writer,
        robot: RobotId,
        worker: Option<WorkerId>,
        now: Time,
    ) -> bool {
        let floor = writer.floor();
        let (from, _) = floor.grant_end(robot);
        if floor.warehouse().kind(from.node).is_lasting() || floor.next_stop_is_granted(robot) {
            return false;
        }
        let loaded = floor.ledger.rack_on(robot).is_some();
        let person = worker.and_then(|w| Some(floor.restrictions.whereabouts(w)?.at));
        let own_m = person.map_or(0.0, |p| (floor.place_of(robot) - p).norm());
        let at = |n: NodeId| floor.warehouse().nodes[n].at;
        let leads_off = |n: NodeId| person.is_none_or(|p| (at(n) - p).norm() > own_m + FARTHER_M);
        for place in floor.stays_near(robot, PLACES, leads_off) {
            let stage = Stage { loaded, ..Stage::to_stay(place) };
            if let Ok(mut route) = self.search(writer.floor(), robot, &[stage], now) {
                // The robot does nothing of its task there.
                route.stops.clear();
                commit(writer, robot, route);
                return true;
            }
        }
        self.step_out_together(writer, robot, now)
    }

    /// Sends a robot out of the way together with the robots that stand on its way out, which go first. Robots that are
    /// to enter that way soon go after it.
    fn step_out_together(&mut self, writer: &mut Writer, robot: RobotId, now: Time) -> bool {
        let (mut leave, come) = self.in_the_way_out(writer.floor(), robot, now);
        if leave.is_empty() && come.is_empty() || leave.len() + come.len() > TOGETHER {
            return false;
        }
        leave.push(robot);
        let order = [leave, come.clone()].concat();
        let routes = in_turn(writer.floor(), &order, |timeline, r| {
            let on = if come.contains(&r) { self.search_on(writer.floor(), timeline, r, now) } else { None };
            on.or_else(|| self.way_out_on(writer.floor(), timeline, r, now))
        });
        let Some(routes) = routes else { return false };
        commit_all(writer, routes);
        true
    }

    /// Robots on the way out that a robot would have if no movable robot were there: the robots that stand on it or are
    /// granted a part of it, the farthest along it first; and the robots that are to enter it soon.
    fn in_the_way_out(
        &mut self,
        floor: Floor<'_>,
        robot: RobotId,
        now: Time,
    ) -> (Vec<RobotId>, Vec<RobotId>) {
        let fit = |r: &RobotId| !floor.ledger.robots[*r].failed && floor.scene.fit(*r, now).is_some();
        let movable =
            |r: &RobotId| *r != robot && fit(r) && !floor.next_stop_is_granted(*r) && !floor.is_halted(*r);
        let movable: Vec<RobotId> = floor.ledger.present().filter(movable).collect();
        let mut without = floor.ledger.timeline().without(&movable);
        without.withdraw(robot, floor.ledger.chain(robot).granted() - 1);
        let Some(route) = self.way_out_on(floor, &without, robot, now) else {
            return (Vec::new(), Vec::new());
        };
        let along = |node: NodeId| route.visits.iter().rposition(|v| v.node == node);
        let (mut there, mut come) = (Vec::new(), Vec::new());
        for r in movable {
            let chain = floor.ledger.chain(r);
            let granted = (chain.granted() - chain.first()) as usize;
            let here = chain.visits().take(granted).filter_map(|v| along(v.node)).max();
            let mut soon = chain.visits().skip(granted).take_while(|v| v.enter <= now + SOON);
            match here {
                Some(at) => there.push((at, r)),
                None if soon.any(|v| along(v.node).is_some()) => come.push(r),
                None => {}
            }
        }
        there.sort_unstable_by_key(|(at, r)| (std::cmp::Reverse(*at), *r));
        (there.into_iter().map(|(_, r)| r).collect(), come)
    }
}
