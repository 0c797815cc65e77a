//! Routes on a timeline that is not the booked one: what a robot could drive if others had made way.
//!
//! Refuses: to book anything.

use crate::state::floor::Floor;
use crate::traffic::state::Traffic;
use giveway_floor::id::{NodeId, RobotId};
use giveway_floor::route::{Exemption, Route, RouteQuery, Stage};
use giveway_floor::time::{Time, Window};
use giveway_floor::timeline::Overlay;

/// How many places to stay are tried at a time, nearest first.
pub(super) const PLACES: usize = 4;

impl Traffic {
    /// A route for the rest of a robot's task on another timeline, from which the robot's own holds have been
    /// withdrawn.
    pub(super) fn search_on(
        &mut self,
        floor: Floor<'_>,
        timeline: &Overlay<'_>,
        robot: RobotId,
        now: Time,
    ) -> Option<Route> {
        let stages = floor.stages_left(robot);
        if stages.is_empty() {
            // The robot has nothing to do and rests in the way: any other place to stay will do.
            return self.way_out_on(floor, timeline, robot, now);
        }
        let exemptions = floor.exemptions(robot, now);
        self.search_stages_on(floor, timeline, robot, &stages, &exemptions, now)
    }

    /// A route to a place aside and then on with the task, on a timeline from which the robot's own holds are
    /// withdrawn.
    pub(crate) fn way_aside(
        &mut self,
        floor: Floor<'_>,
        timeline: &Overlay<'_>,
        robot: RobotId,
        (place, exemptions): (NodeId, &[Exemption]),
        now: Time,
    ) -> Option<Route> {
        let stages = floor.stages_aside(robot, place)?;
        let route = self.search_stages_on(floor, timeline, robot, &stages, exemptions, now)?;
        Some(floor.with_own_stops(robot, route))
    }

    pub(super) fn search_stages_on(
        &mut self,
        floor: Floor<'_>,
        timeline: &Overlay<'_>,
        robot: RobotId,
        stages: &[Stage],
        exemptions: &[Exemption],
        now: Time,
    ) -> Option<Route> {
        if self.effort.is_spent() {
            return None;
        }
        let (from, heading) = floor.grant_end(robot);
        let ready = now.max(from.arrive) + floor.settings.period;
        let (budget, conditions) = (floor.settings.expansions_per_plan, floor.conditions(robot));
        let ask = RouteQuery { from: &from, heading, ready, stages, budget, conditions, exemptions };
        self.tally.plans += 1;
        let kind = floor.kind(robot);
        let planner = self.planners.of_mut(kind);
        let found = planner.plan(&ask, timeline).ok();
        self.effort.spend(planner.expanded());
        found
    }

    /// A route on another timeline to the nearest place where a robot may stay, other than where it rests.
    pub(super) fn way_out_on(
        &mut self,
        floor: Floor<'_>,
        timeline: &Overlay<'_>,
        robot: RobotId,
        now: Time,
    ) -> Option<Route> {
        let loaded = floor.ledger.rack_on(robot).is_some();
        let exemptions = floor.exemptions(robot, now);
        let rests = floor.ledger.chain(robot).last().map(|v| v.node);
        let fits = |n: NodeId| Some(n) != rests && floor.has_room_for_ever(timeline, robot, n);
        let places = floor.stays_near(robot, PLACES, fits);
        places.into_iter().find_map(|place| {
            let stage = Stage { loaded, ..Stage::to_stay(place) };
            let mut route = self.search_stages_on(floor, timeline, robot, &[stage], &exemptions, now)?;
            route.stops.clear();
            Some(route)
        })
    }
}

impl Floor<'_> {
    /// Whether no other robot stays on a node for ever, on another timeline.
    fn has_room_for_ever(&self, timeline: &Overlay<'_>, robot: RobotId, node: NodeId) -> bool {
        let loaded = self.ledger.rack_on(robot).is_some();
        let line = self.ledger.timeline().line(robot, loaded, self.warehouse().node_resource(node));
        let end = Window::new(Time(Time::MAX.0 - 1), Time::MAX);
        timeline.holders_during(line, end, robot).next().is_none()
    }
}
