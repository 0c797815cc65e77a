//! Walkways on which nobody is led, since robots block them for long or they are in a closed area; and ways past
//! those robots.
//!
//! Refuses: to cut what a robot leaves by itself.

use crate::aware::BODY_M;
use crate::fleet::people::state::HumanState;
use crate::fleet::state::floor::Floor;
use crate::fleet::state::yielding::{STANDS, YieldingState};
use crate::geometry::{Point, Segment};
use crate::id::RobotId;
use crate::time::Time;
use crate::warehouse::walkway::{EdgeSet, Square};

/// Room between a person and a robot along whose side the person walks, metres.
const ALONG_M: f64 = 0.07;
/// Ways between robots are looked for as far as this, metres …
const BETWEEN_M: f64 = 4.0;
/// … and not to a place nearer than this: it would be no way out, metres …
const LEAST_M: f64 = 1.0;
/// … and from so many places on.
const ENDS: usize = 8;

impl HumanState {
    /// Walkways that robots block for long, and those in areas that are closed to people.
    pub(super) fn edges_blocked_for_long(
        &self,
        floor: Floor<'_>,
        yielding: &YieldingState,
        now: Time,
    ) -> EdgeSet {
        let mut cut = self.edges_robots_block(floor, yielding, now);
        self.barred.cut_shut(&self.walkways, &mut cut, now);
        cut
    }

    /// Walkways on which robots rest, are broken, or have yielded for long: no worker waits for those to go away. One
    /// that yields and has nowhere to go would be met again and again, by a worker who is led from one to the next.
    pub(super) fn edges_robots_block(
        &self,
        floor: Floor<'_>,
        yielding: &YieldingState,
        now: Time,
    ) -> EdgeSet {
        let mut cut = self.walkways.no_edges();
        for robot in floor.ledger.present() {
            let chain = floor.ledger.chain(robot);
            let rests = chain.first() + 1 == chain.end();
            let stays = yielding.of(robot).waited(now) > STANDS && floor.stands(robot);
            if rests || stays || floor.ledger.robots[robot].failed {
                let at = floor.place_of(robot);
                for e in self.walkways.edges_within(at, floor.beside_m(robot, 0.2)) {
                    cut.insert(e);
                }
            }
        }
        cut
    }

    /// A way without the cut walkways for a person who may stand face to face with a robot: the first steps
    /// lead to where no robot is, even if the walkway there is cut by the one in front.
    pub(super) fn way_past(
        &self,
        floor: Floor<'_>,
        at: Point,
        goal: Point,
        cut: &EdgeSet,
    ) -> Option<Vec<Point>> {
        let walkways = &self.walkways;
        if let Some(way) = walkways.path(at, goal, cut) {
            return Some(way.points);
        }
        let robots = floor.ledger.present().map(|r| (floor.place_of(r), floor.beside_m(r, BODY_M)));
        let robots: Vec<(Point, f64)> = robots.collect();
        let is_clear = |to: Point| {
            let step = Segment { a: at, b: to };
            let leaves = |r: &Point| (to - r).norm() > (at - r).norm() + 0.3;
            robots.iter().all(|(r, reach)| step.distance_to(*r) >= *reach || leaves(r))
        };
        let steps = walkways.near(at, 1.8).into_iter().map(|(n, _)| walkways.nodes()[n].at);
        let ways = steps.filter(|p| is_clear(*p)).filter_map(|p| {
            let way = walkways.path(p, goal, cut)?;
            Some((way.length_m + (p - at).norm(), way.points))
        });
        let Some((_, mut points)) = ways.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            return self.way_between(floor, at, goal, cut);
        };
        points.insert(0, at);
        Some(points)
    }

    /// A way along the sides of robots that stand, as far as the nearest walkway from which one leads on.
    fn way_between(&self, floor: Floor<'_>, at: Point, goal: Point, cut: &EdgeSet) -> Option<Vec<Point>> {
        let walkways = &self.walkways;
        let standing = floor.ledger.present().filter(|r| floor.stands_near(*r, at));
        let square = |r| Square { at: floor.place_of(r), half_m: floor.beside_m(r, BODY_M) + ALONG_M };
        let ways = walkways.ways_between(at, &standing.map(square).collect::<Vec<_>>(), BETWEEN_M);
        let nodes = walkways.around(at, BETWEEN_M).map(|n| walkways.nodes()[n].at);
        let clear = nodes.filter(|p| ways.is_clear(*p));
        let mut ends: Vec<_> = clear.filter_map(|p| Some((ways.length_m(p)?, p))).collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        ends.into_iter().filter(|(length, _)| *length > LEAST_M).take(ENDS).find_map(|(_, p)| {
            let on = walkways.path(p, goal, cut)?;
            let mut points = ways.way_to(p)?;
            points.extend(on.points.into_iter().skip(1));
            Some(points)
        })
    }
}

impl Floor<'_> {
    pub(super) fn stands(&self, robot: RobotId) -> bool {
        self.scene.robot(robot).is_none_or(|t| t.speed_mps < 0.05)
    }

    pub(super) fn stands_near(&self, robot: RobotId, at: Point) -> bool {
        self.stands(robot) && (self.place_of(robot) - at).norm() < 3.0
    }
}
