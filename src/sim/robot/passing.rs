//! A simulated robot beside the line: it passes people within its granted corridor, by the local planner.
//!
//! Adds to [`RobotBody`]. The robot leaves the line only if a person is near and its order allows that, and it is on
//! the line again at the end. Its own scanner and the station's guard stop it as they do on the line. Refuses: to see
//! people where they truly are: it knows what the fleet believes.

use super::{RobotBody, THERE_M, Target};
use giveway_fleet::{Fault, ForeseenPerson, Waypoint};
use giveway_floor::geometry::{Point, Segment, Vector, wrap_angle};
use giveway_floor::id::NodeId;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{Corridor, Warehouse};
use giveway_people::aware::SLOW_MPS;
use giveway_people::local::{
    DriveLimits, DriveState, LocalPlanner, NearPerson, PassingRoom, RobotOutline, Twist,
};

/// Interval between two decisions of the local planner.
const PERIOD: Span = Span::from_millis(100);
/// The robot leaves the line only if a person is nearer than this, metres …
const NEAR_M: f64 = 6.0;
/// … and returns to it when no person is nearer than this, metres.
const CLEAR_M: f64 = 7.0;
/// A robot nearer to the line than this is on it, metres …
const ON_LINE_M: f64 = 0.02;
/// … if it also heads along it, radians.
const ALONG: f64 = 0.03;
/// A node is behind a robot beside the line when all of the robot is past it, by at least this much, metres.
const BEHIND_M: f64 = 0.05;
/// A robot this near to the end has arrived, metres.
const END_M: f64 = 0.06;
/// A robot at rest beside the end of its corridor, with no more than this left along the line, drives there straight,
/// metres …
const LAST_M: f64 = 1.0;
/// … if no person is this near to that path, metres.
const LAST_CLEAR_M: f64 = 1.5;
/// The robot passes people on a side where the probability that a person is in the way is at most this.
const DOUBT: f64 = 0.5;
/// A robot whose planner finds no way from the line for this long returns to the line, since it blocks a person while
/// it tries …
const TRIES: Span = Span::from_secs(8);
/// … and does not leave the line again for this long.
const KEEPS_TO_LINE: Span = Span::from_secs(30);
/// A robot slower than this stands, metres per second.
const STANDS_MPS: f64 = 0.02;

/// The corridor of a lane in its driving direction.
fn corridor(warehouse: &Warehouse, from: NodeId, to: NodeId) -> Option<Corridor> {
    let (_, arc) = warehouse.out(from).find(|(_, arc)| arc.to == to)?;
    let lane = &warehouse.lanes[arc.lane];
    lane.corridor.map(|c| if lane.a == from { c } else { c.reversed() })
}

impl RobotBody {
    /// Whether the robot may leave the line on its current lane.
    pub fn may_pass(&self) -> bool {
        self.path.front().is_some_and(|t| t.corridor.is_some())
    }

    /// The corridor of the lane to a waypoint, if the order allows the robot to leave its line and it can.
    pub(super) fn corridor_of(&self, w: &Waypoint, from: NodeId, warehouse: &Warehouse) -> Option<Corridor> {
        w.passes.filter(|_| self.beside.may).and_then(|_| corridor(warehouse, from, w.node))
    }

    /// Allows the robot to leave the line on its way to a known waypoint.
    pub(super) fn may_leave_line(&mut self, w: &Waypoint, warehouse: &Warehouse) {
        let Some(i) = self.path.iter().position(|t| t.serial == w.serial) else { return };
        let from = if i == 0 { self.stood_on } else { self.path[i - 1].node };
        self.path[i].corridor = self.corridor_of(w, from, warehouse);
    }

    /// Advances the robot for `dt` seconds beside the line, if it is there or leaves it now. Gives whether it is or
    /// does.
    pub(super) fn tick_beside(&mut self, now: Time, dt: f64) -> bool {
        if !self.begins(now) {
            return false;
        }
        let Some((line, corridor, goal)) = self.ahead() else {
            self.beside.end();
            return false;
        };
        let before = self.beside.twist.unwrap_or(Twist { speed_mps: self.speed_mps, turn_rps: 0.0 });
        let twist = if self.brakes() {
            self.beside.decided = None;
            let speed_mps = (before.speed_mps - self.accel() * dt).max(0.0);
            let share = if before.speed_mps > 0.0 { speed_mps / before.speed_mps } else { 0.0 };
            Twist { speed_mps, turn_rps: before.turn_rps * share }
        } else {
            if self.beside.decided.is_none_or(|t| now - t >= PERIOD) {
                self.beside.wanted = self.choose(before, line, corridor, goal.at);
                self.beside.decided = Some(now);
            }
            self.beside.wanted
        };
        let is_stuck = twist.speed_mps < STANDS_MPS && !self.brakes();
        self.beside.stuck = if is_stuck { self.beside.stuck.or(Some(now)) } else { None };
        self.pose = twist.moved(self.pose, dt);
        (self.speed_mps, self.beside.twist) = (twist.speed_mps, Some(twist));
        self.get_on(line, goal, now);
        true
    }

    /// Whether the robot steers by itself from now on: it already does, or heads along the line with a person near
    /// ahead.
    fn begins(&mut self, now: Time) -> bool {
        if self.beside.steers() {
            return true;
        }
        let Some(next) = self.path.front().filter(|t| t.corridor.is_some()) else { return false };
        let way = Segment { a: self.pose.at, b: next.at };
        let is_along = way.length() > THERE_M && wrap_angle(way.heading() - self.pose.heading).abs() < ALONG;
        is_along && now >= self.beside.on_line_until && self.acting.is_none() && self.somebody_within(NEAR_M)
    }

    /// Whether the robot stands beside the end and no person is in its way there. The corridor is convex, so a straight
    /// path stays within it.
    fn drives_last(&self, goal: Target, ahead: Vector) -> bool {
        let is_next = self.path.front().is_some_and(|t| t.serial == goal.serial);
        let is_beside = is_next && ahead.dot(&(goal.at - self.pose.at)) < LAST_M;
        let stands = self.speed_mps < STANDS_MPS && !self.brakes();
        let way = Segment { a: self.pose.at, b: goal.at };
        let is_clear = |p: &ForeseenPerson| way.distance_to(p.at) > LAST_CLEAR_M;
        is_beside && stands && self.beside.people.iter().all(is_clear)
    }

    /// Whether a person is within this distance, ahead of the robot or beside it.
    fn somebody_within(&self, metres: f64) -> bool {
        let ahead = Vector::new(self.pose.heading.cos(), self.pose.heading.sin());
        let is_near = |p: &ForeseenPerson| {
            let to = p.at - self.pose.at;
            to.norm() < metres && to.dot(&ahead) > -1.0
        };
        self.beside.people.iter().any(is_near)
    }

    /// Whether the robot must brake: whatever stops it on the line stops it beside the line, too.
    fn brakes(&self) -> bool {
        let is_out = self.is_immobile() || self.has(Fault::Obstructed) || self.flat_since.is_some();
        is_out || self.guard.stops() || self.hand_guard || self.limit_mps == Some(0.0)
    }

    /// The line of the lanes ahead with a usable corridor, the narrowest of their corridors, and the last waypoint
    /// there.
    fn ahead(&self) -> Option<(Segment, Corridor, Target)> {
        let mut all = self.path.iter().map_while(|t| Some((*t, t.corridor?)));
        let (mut goal, mut corridor) = all.next()?;
        for (target, next) in all {
            corridor.left_m = corridor.left_m.min(next.left_m);
            corridor.right_m = corridor.right_m.min(next.right_m);
            goal = target;
        }
        Some((Segment { a: self.stood_at, b: goal.at }, corridor, goal))
    }

    fn choose(&self, twist: Twist, line: Segment, corridor: Corridor, goal: Point) -> Twist {
        let mut limits = self.beside.limits[usize::from(self.rack.is_some())];
        let lane_mps = self.path.front().map_or(f64::INFINITY, |t| t.limit_mps);
        let most_mps = self.limit_mps.unwrap_or(f64::INFINITY).min(lane_mps);
        // The speed cannot fall faster than the brakes allow.
        let least_mps = twist.speed_mps - limits.brake_mps2 * limits.period_s;
        limits.speed_mps = limits.speed_mps.min(most_mps).max(least_mps);
        let planner = LocalPlanner::new(self.footprint(), limits, line, corridor, self.beside.method);
        let near: Vec<NearPerson<'_>> = self.beside.people.iter().map(ForeseenPerson::near).collect();
        let state = DriveState { pose: self.pose, twist };
        let slow = DriveLimits { speed_mps: limits.speed_mps.clamp(STANDS_MPS, SLOW_MPS), ..limits };
        let room = PassingRoom::new(self.footprint(), slow, line, corridor);
        match room.round(self.pose.at, &near, DOUBT) {
            Some((left_m, past)) => planner.beside(left_m).choose(&state, past, &near),
            None => planner.choose(&state, goal, &near),
        }
    }

    /// Passes waypoints. Returns to the line at the last waypoint that allows driving beside it, or earlier if the
    /// robot is on the line and no person is near.
    fn get_on(&mut self, line: Segment, goal: Target, now: Time) {
        let ahead = (line.b - line.a).normalize();
        let circle_m = RobotOutline::of(self.footprint()).circle_m();
        let off_m = ahead.perp(&(self.pose.at - line.a)).abs();
        while let Some(next) = self.path.front().copied().filter(|t| t.serial < goal.serial) {
            let behind_m = ahead.dot(&(self.pose.at - next.at));
            let needed_m = if off_m <= ON_LINE_M { 0.0 } else { circle_m + BEHIND_M };
            if behind_m < needed_m {
                break;
            }
            let at = self.pose.at;
            self.reach(next);
            self.pose.at = at;
        }
        let left_m = (goal.at - self.pose.at).norm();
        let along = wrap_angle(line.heading() - self.pose.heading).abs() < ALONG;
        let back = off_m <= ON_LINE_M && along && !self.somebody_within(CLEAR_M);
        let gives_up = off_m <= ON_LINE_M && self.beside.stuck.is_some_and(|t| now - t > TRIES);
        if self.path.front().is_some_and(|t| t.serial == goal.serial) && left_m < END_M {
            self.beside.end();
            self.speed_mps = 0.0;
            self.reach(goal);
        } else if back || gives_up || self.drives_last(goal, ahead) {
            self.beside.end();
            if gives_up {
                self.beside.on_line_until = now + KEEPS_TO_LINE;
            }
            if !back {
                // The robot turns to its goal on the spot.
                self.speed_mps = 0.0;
                self.path.front_mut().expect("it has not arrived").corridor = None;
            }
        }
    }
}
