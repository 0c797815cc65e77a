//! When a robot finds no route, others make way: the few robots whose holds block its best route are replanned together
//! with it, in the best of a few orders (thesis 4.2.3; carp.md section 2). All get routes, or none is touched.
//!
//! Refuses: to move robots that are broken or silent, and to take back what was granted.

use crate::state::fact::RouteFact;
use crate::state::floor::Floor;
use crate::state::writer::Writer;
use crate::traffic::state::{InsertionCounts, Traffic};
use giveway_floor::id::RobotId;
use giveway_floor::route::Route;
use giveway_floor::time::{Span, Time};
use giveway_floor::timeline::{Overlay, Visit};
use std::collections::BTreeMap;

/// How many other robots are moved at most.
const OTHERS: usize = 3;

/// Routes that were found together.
struct Inserted {
    /// The sum of all arrivals, microseconds from now.
    cost: i64,
    /// The same sum with the asking robot planned behind the others, if that order is possible.
    behind: Option<i64>,
    routes: Vec<Found>,
}

/// A robot with its new route.
pub(super) type Found = (RobotId, Route);

impl Traffic {
    /// Plans `robot` together with the few robots that stand most in its way. Returns whether that worked.
    pub(crate) fn insert(&mut self, writer: &mut Writer, robot: RobotId, now: Time) -> bool {
        if writer.floor().next_stop_is_granted(robot) {
            return false;
        }
        let start = (writer.settings.stopwatch)();
        self.tally.insertions.tried += 1;
        let movable = self.movable(writer.floor(), robot, now);
        let in_place = writer.floor().in_the_places_of(robot, &movable);
        let first =
            if in_place.is_empty() { None } else { self.insert_past(writer.floor(), robot, &in_place, now) };
        let found = first.or_else(|| self.insert_past(writer.floor(), robot, &movable, now));
        self.plan_times.push((writer.settings.stopwatch)() - start);
        let Some(Inserted { cost, behind, routes }) = found else { return false };
        self.tally.insertions.count(cost, behind);
        commit_all(writer, routes);
        true
    }

    /// Robots other than this one that can be replanned.
    fn movable(&self, floor: Floor<'_>, robot: RobotId, now: Time) -> Vec<RobotId> {
        let fit = |r: &RobotId| !floor.ledger.robots[*r].failed && floor.scene.fit(*r, now).is_some();
        let busy = |r: &RobotId| floor.next_stop_is_granted(*r) || floor.waits_for_room(*r);
        floor.ledger.present().filter(|r| *r != robot && fit(r) && !busy(r)).collect()
    }

    /// The best routes for `robot` and the few of `movable` that are most in its way.
    fn insert_past(
        &mut self,
        floor: Floor<'_>,
        robot: RobotId,
        movable: &[RobotId],
        now: Time,
    ) -> Option<Inserted> {
        let (others, broken) = self.influencers(floor, robot, movable, now);
        if let Some(need) = self.needs.waiting.get_mut(&robot) {
            need.behind = others.first().copied().or(broken);
        }
        assert!(others.len() <= OTHERS && !others.contains(&robot), "{robot:?} moves {others:?}");
        let mut best: Option<(i64, Vec<Found>)> = None;
        let mut behind: Option<i64> = None;
        for size in 1..=others.len() {
            for order in orders(robot, &others[..size]) {
                let Some((cost, routes)) = self.plan_in_order(floor, &order, now) else { continue };
                if order[..size] == others[..size] {
                    behind = Some(cost);
                }
                if best.as_ref().is_none_or(|(c, _)| cost < *c) {
                    best = Some((cost, routes));
                }
            }
            if best.is_some() {
                break;
            }
        }
        best.map(|(cost, routes)| Inserted { cost, behind, routes })
    }

    /// The robots of `movable` whose holds meet the windows of the route that `robot` would have if all of `movable`
    /// made way, most in the way first. If there is no route even then, the robot that cannot drive and blocks one.
    fn influencers(
        &mut self,
        floor: Floor<'_>,
        robot: RobotId,
        movable: &[RobotId],
        now: Time,
    ) -> (Vec<RobotId>, Option<RobotId>) {
        let mut without = floor.ledger.timeline().view();
        for r in movable.iter().chain([&robot]) {
            without.withdraw(*r, floor.ledger.chain(*r).granted() - 1);
        }
        let Some(route) = self.search_on(floor, &without, robot, now) else {
            return (Vec::new(), self.broken_in_the_way(floor, without, robot, now));
        };
        let mut met: BTreeMap<RobotId, usize> = BTreeMap::new();
        for visit in &route.visits {
            let timeline = floor.ledger.timeline();
            let line = timeline.line(robot, visit.loaded, floor.warehouse().node_resource(visit.node));
            for h in timeline.holders_during(line, visit.window(), robot) {
                *met.entry(h).or_default() += 1;
            }
        }
        let mut ranked: Vec<(usize, RobotId)> = met.into_iter().map(|(r, n)| (n, r)).collect();
        ranked.retain(|(_, r)| movable.contains(r));
        // A robot that stands in the way for ever meets few windows, but no order helps while it stands there.
        ranked.sort_by_key(|(n, r)| (!floor.lacks_route(*r), std::cmp::Reverse(*n), *r));
        (ranked.into_iter().take(OTHERS).map(|(_, r)| r).collect(), None)
    }

    /// The first robot that cannot drive on the route that `robot` would have without such robots. `without` is a
    /// timeline without the robots that can drive.
    fn broken_in_the_way(
        &mut self,
        floor: Floor<'_>,
        mut without: Overlay<'_>,
        robot: RobotId,
        now: Time,
    ) -> Option<RobotId> {
        let broken: Vec<RobotId> =
            floor.ledger.present().filter(|r| floor.ledger.robots[*r].failed).collect();
        if broken.is_empty() {
            return None;
        }
        broken.iter().for_each(|r| without.withdraw(*r, 0));
        let route = self.search_on(floor, &without, robot, now)?;
        let timeline = floor.ledger.timeline();
        let on = |node| {
            let line = timeline.line(
                robot,
                floor.ledger.rack_on(robot).is_some(),
                floor.warehouse().node_resource(node),
            );
            let held = timeline.held_by_others(line, robot).map(|h| h.holder);
            held.filter(|r| broken.contains(r)).min()
        };
        route.visits.iter().find_map(|v| on(v.node))
    }

    /// Plans robots one after another, each against the routes before it; adds the sum of arrivals, microseconds from
    /// now.
    fn plan_in_order(&mut self, floor: Floor<'_>, order: &[RobotId], now: Time) -> Option<(i64, Vec<Found>)> {
        let routes = in_turn(floor, order, |timeline, r| self.search_on(floor, timeline, r, now))?;
        let cost = routes.iter().map(|(_, route)| (route.arrival - now).0).sum();
        Some((cost, routes))
    }
}

impl InsertionCounts {
    /// Counts an insertion that worked: the sum of all arrivals, and that sum with the robot behind the others.
    fn count(&mut self, cost_us: i64, behind_us: Option<i64>) {
        self.succeeded += 1;
        match behind_us {
            Some(behind) => self.gain += Span(behind - cost_us),
            None => self.only_way += 1,
        }
    }
}

impl Floor<'_> {
    /// The robots of `movable` that rest where the task of `robot` leads. No route avoids them, while a route past
    /// robots on the way may be found without moving those.
    fn in_the_places_of(&self, robot: RobotId, movable: &[RobotId]) -> Vec<RobotId> {
        let stages = self.stages_left(robot);
        let rests = |r: &RobotId| self.ledger.chain(*r).last().map(|v| v.node);
        let in_place = |r: &&RobotId| stages.iter().any(|s| rests(r) == Some(s.goal));
        movable.iter().filter(in_place).take(OTHERS).copied().collect()
    }
}

/// Routes for robots one after another. Each is found on a timeline that has the routes of the robots before it and, of
/// the others, only what they were granted. All robots get a route, or none does.
pub(crate) fn in_turn(
    floor: Floor<'_>,
    order: &[RobotId],
    mut find: impl FnMut(&Overlay<'_>, RobotId) -> Option<Route>,
) -> Option<Vec<Found>> {
    let mut timeline = floor.ledger.timeline().view();
    for r in order {
        timeline.withdraw(*r, floor.ledger.chain(*r).granted() - 1);
    }
    let mut routes = Vec::new();
    for &r in order {
        let route = find(&timeline, r)?;
        let visits: Vec<Visit> = std::iter::once(&route.kept).chain(&route.visits).cloned().collect();
        timeline.add(r, &visits).ok()?;
        routes.push((r, route));
    }
    Some(routes)
}

/// Books routes that were found together.
pub(crate) fn commit_all(writer: &mut Writer, routes: Vec<Found>) {
    let bookings = routes.into_iter().map(|(r, route)| writer.floor().booking(r, route)).collect();
    writer.record(RouteFact::Routed { bookings });
}

/// The orders to try: the asking robot first, the asking robot last, and last with the others reversed.
fn orders(robot: RobotId, others: &[RobotId]) -> Vec<Vec<RobotId>> {
    let first: Vec<RobotId> = std::iter::once(robot).chain(others.iter().copied()).collect();
    let last: Vec<RobotId> = others.iter().copied().chain([robot]).collect();
    let turned: Vec<RobotId> = others.iter().rev().copied().chain([robot]).collect();
    let mut all = vec![first, last, turned];
    all.dedup();
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gain_is_over_the_robot_behind_the_others_where_that_was_possible() {
        let mut counts = InsertionCounts::default();
        counts.count(5_000_000, Some(8_000_000));
        counts.count(7_000_000, Some(7_000_000));
        counts.count(9_000_000, None);
        let gain = Span::from_secs(3);
        assert_eq!(counts, InsertionCounts { tried: 0, succeeded: 3, only_way: 1, gain });
    }

    #[test]
    fn the_second_order_has_the_robot_behind_the_others() {
        let [robot, a, b] = [0, 1, 2].map(RobotId);
        assert_eq!(orders(robot, &[a, b]), [vec![robot, a, b], vec![a, b, robot], vec![b, a, robot]]);
        assert_eq!(orders(robot, &[a]), [vec![robot, a], vec![a, robot]]);
    }
}
