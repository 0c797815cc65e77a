//! Walkways that robots block for long or closed areas cover, where people are not led; and ways past those robots.
//!
//! Main type: [`WaysPast`]. Refuses: to cut walkways that a robot leaves by itself.

use crate::people::state::HumanState;
use crate::state::floor::Floor;
use crate::state::yielding::{STANDS, YieldingState};
use giveway_floor::geometry::{Point, Segment};
use giveway_floor::id::RobotId;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::walkway::{EdgeSet, Square, WalkPath, Walkways, WaysBetween};
use giveway_people::human::Mover;
use std::cell::OnceCell;

/// Room between a robot and a person who walks along its side, metres.
const ALONG_M: f64 = 0.07;
/// How far ways between robots are searched for, metres.
const BETWEEN_M: f64 = 4.0;
/// The nearest place to which such a way leads, metres: anything nearer would be no way out.
const LEAST_M: f64 = 1.0;
/// How many places at which such ways end are tried.
const ENDS: usize = 8;
/// A person who has been kept beside a robot for this long is not at the side of it that was measured.
const WRONG_SIDE: Span = Span::from_secs(20);
/// How long each of the other sides is tried.
const EACH_SIDE: Span = Span::from_secs(9);
/// How far one straight step leads, metres.
const STEP_M: f64 = 1.8;

/// Ways on for a person who may stand face to face with a robot. What does not depend on the goal is searched for once,
/// and only if it is needed.
pub struct WaysPast<'a> {
    walkways: &'a Walkways,
    floor: Floor<'a>,
    at: Point,
    mover: Mover,
    cut: &'a EdgeSet,
    /// Where the person steps first.
    first: Option<Point>,
    steps: OnceCell<Vec<Point>>,
    between: OnceCell<(WaysBetween<'a>, Vec<Point>)>,
}

impl HumanState {
    /// Walkways on which the worker does not fit.
    pub(crate) fn edges_too_narrow(&self, mover: Mover) -> EdgeSet {
        self.walkways.edges_narrower_than(mover.clearance_m())
    }

    /// Besides, walkways beside robots that stand nearby: a vehicle does not get past them.
    pub(super) fn edges_beside_robots(
        &self,
        floor: Floor<'_>,
        (mover, at): (Mover, Point),
        cut: &EdgeSet,
    ) -> EdgeSet {
        let mut cut = cut.clone();
        let is_near =
            |r: &RobotId| floor.stands(*r) && (floor.place_of(*r) - at).norm() < mover.far_m(BETWEEN_M);
        for robot in floor.ledger.present().filter(is_near) {
            let reach_m = floor.beside_m(robot, mover.half_width_m());
            self.walkways.edges_within(floor.place_of(robot), reach_m).into_iter().for_each(|e| {
                cut.insert(e);
            });
        }
        cut
    }

    /// Walkways that robots block for long, and those in areas that are closed to people.
    pub(super) fn edges_blocked_for_long(
        &self,
        floor: Floor<'_>,
        yielding: &YieldingState,
        mover: Mover,
        now: Time,
    ) -> EdgeSet {
        let mut cut = self.edges_robots_block(floor, yielding, mover, now);
        self.barred.cut_shut(&self.walkways, &mut cut, now);
        cut
    }

    /// Walkways on which robots rest, are broken, or have yielded for long: no worker waits for these to go away. A
    /// robot that yields and has nowhere to go would be met again and again by a worker who is led from one to the
    /// next.
    pub(super) fn edges_robots_block(
        &self,
        floor: Floor<'_>,
        yielding: &YieldingState,
        mover: Mover,
        now: Time,
    ) -> EdgeSet {
        let mut cut = self.edges_too_narrow(mover);
        for robot in floor.ledger.present() {
            let chain = floor.ledger.chain(robot);
            let rests = chain.first() + 1 == chain.end();
            let stays = yielding.of(robot).waited(now) > STANDS && floor.stands(robot);
            if rests || stays || floor.ledger.robots[robot].failed {
                let at = floor.place_of(robot);
                for e in self.walkways.edges_within(at, floor.beside_m(robot, mover.squeezes_m())) {
                    cut.insert(e);
                }
            }
        }
        cut
    }
}

impl<'a> WaysPast<'a> {
    /// Ways from a place, with these edges of the walkways cut.
    pub fn new(
        people: &'a HumanState,
        floor: Floor<'a>,
        (mover, at): (Mover, Point),
        cut: &'a EdgeSet,
    ) -> WaysPast<'a> {
        let (steps, between) = (OnceCell::new(), OnceCell::new());
        WaysPast { walkways: &people.walkways, floor, at, mover, cut, first: None, steps, between }
    }

    /// Ways that begin at one side of a robot after the other, for a person who has been kept there for long: a person
    /// who is measured to be inside a robot is at one of its sides, and the nearest side need not be the right one.
    pub fn by_sides(self, kept: Span) -> WaysPast<'a> {
        if kept < WRONG_SIDE {
            return self;
        }
        let squares: Vec<Square> = self.standing().collect();
        let Some(inside) = squares.iter().find(|s| s.depth_m(self.at) > ALONG_M) else { return self };
        let reach_m = inside.half_m + ALONG_M;
        let (x, y) = (self.at.x, self.at.y);
        let sides = [
            Point::new(inside.at.x + reach_m, y),
            Point::new(inside.at.x - reach_m, y),
            Point::new(x, inside.at.y + reach_m),
            Point::new(x, inside.at.y - reach_m),
        ];
        let is_open =
            |p: &Point| self.walkways.is_free(*p) && squares.iter().all(|s| s.depth_m(*p) <= ALONG_M);
        let mut open: Vec<Point> = sides.into_iter().filter(is_open).collect();
        open.sort_by(|a, b| (a - self.at).norm().total_cmp(&(b - self.at).norm()));
        // The nearest side was tried until now.
        let turns = 1 + ((kept - WRONG_SIDE).0 / EACH_SIDE.0) as usize;
        let first = (!open.is_empty()).then(|| open[turns % open.len()]);
        WaysPast { first, ..self }
    }

    /// A way to a place: on walkways that are not cut, else after one straight step past the robots, else along the
    /// sides of robots that stand. Vehicles keep to the walkways.
    pub fn to(&self, goal: Point) -> Option<Vec<Point>> {
        let on = |p: Point| self.walkways.path(p, goal, self.cut);
        if let Some(way) = self.first.and_then(on) {
            return Some([self.at].into_iter().chain(way.points).collect());
        }
        if let Some(way) = on(self.at) {
            return Some(way.points);
        }
        if self.mover != Mover::OnFoot {
            return None;
        }
        let steps = self.steps.get_or_init(|| self.steps());
        let ways = steps.iter().filter_map(|p| Some(((p - self.at).norm(), on(*p)?)));
        let length_m = |(step_m, way): &(f64, WalkPath)| step_m + way.length_m;
        if let Some((_, way)) = ways.min_by(|a, b| length_m(a).total_cmp(&length_m(b))) {
            return Some([self.at].into_iter().chain(way.points).collect());
        }
        let (between, ends) = self.between.get_or_init(|| self.between());
        let (end, way) = ends.iter().find_map(|end| Some((*end, on(*end)?)))?;
        let mut points = between.way_to(end)?;
        points.extend(way.points.into_iter().skip(1));
        Some(points)
    }

    /// Where one straight step leads, if it comes near no robot except one that it leads away from.
    fn steps(&self) -> Vec<Point> {
        let robots = self.floor.ledger.present();
        let robots: Vec<_> = robots
            .map(|r| (self.floor.place_of(r), self.floor.beside_m(r, self.mover.half_width_m())))
            .collect();
        let is_clear = |to: &Point| {
            let step = Segment { a: self.at, b: *to };
            let leaves = |r: &Point| (to - r).norm() > (self.at - r).norm() + 0.3;
            robots.iter().all(|(r, reach)| step.distance_to(*r) >= *reach || leaves(r))
        };
        let near = self.walkways.near(self.at, STEP_M).into_iter();
        near.map(|(n, _)| self.walkways.nodes()[n].at).filter(is_clear).collect()
    }

    /// The squares of floor taken by robots that stand nearby.
    fn standing(&self) -> impl Iterator<Item = Square> {
        let (floor, half_width_m) = (self.floor, self.mover.half_width_m());
        let standing = floor.ledger.present().filter(move |r| floor.stands_near(*r, self.at));
        standing
            .map(move |r| Square { at: floor.place_of(r), half_m: floor.beside_m(r, half_width_m) + ALONG_M })
    }

    /// Ways between the robots that stand nearby, and the walkways that they lead to, the nearest first.
    fn between(&self) -> (WaysBetween<'a>, Vec<Point>) {
        let ways = self.walkways.ways_between(self.at, self.standing().collect(), BETWEEN_M);
        let nodes = self.walkways.around(self.at, BETWEEN_M).map(|n| self.walkways.nodes()[n].at);
        let clear = nodes.filter(|p| ways.is_clear(*p));
        let with_length = clear.filter_map(|p| Some((ways.length_m(p)?, p)));
        let mut ends: Vec<_> = with_length.filter(|(length_m, _)| *length_m > LEAST_M).collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        ends.truncate(ENDS);
        (ways, ends.into_iter().map(|(_, p)| p).collect())
    }
}

impl Floor<'_> {
    /// Whether a robot stands, as far as is seen.
    pub(super) fn stands(&self, robot: RobotId) -> bool {
        self.scene.robot(robot).is_none_or(|t| t.speed_mps < 0.05)
    }

    /// Whether a robot stands within three metres of a place.
    pub(super) fn stands_near(&self, robot: RobotId, at: Point) -> bool {
        self.stands(robot) && (self.place_of(robot) - at).norm() < 3.0
    }
}
