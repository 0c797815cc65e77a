//! How a walker follows a route: gait, corners, and obstacles.
//!
//! Main types: [`Legs`], [`WalkerSurroundings`], [`RobotNear`]. Walls are never walked through; a walker stops before a
//! robot, and never steps in front of a moving one that it minds. How it gets past other people is in `people`.
//! Refuses: to know where the route comes from.

use super::person::{BODY_M, PersonNear, SQUEEZE_M, SWAY_M};
use giveway_floor::geometry::{Point, Vector, wrap_angle};
use giveway_floor::time::Time;
use giveway_floor::warehouse::walkway::{EdgeSet, Walkways};
use giveway_people::human::{Mover, Vehicle};
use nalgebra::Rotation2;
use std::collections::VecDeque;

/// Distance at which a walker stops before a robot, metres.
const STAND_OFF_M: f64 = 0.05;
/// Distance of the body's middle from walls, where there is room, metres.
pub(super) const WALL_M: f64 = 0.3;
/// Room that a walker leaves beside its body for a moving robot, metres.
const SIDE_M: f64 = 0.1;
/// A walker stops before an approaching robot that would reach it within this time, seconds.
const COMES_S: f64 = 1.2;
/// How far a walker caught between walls looks for a place from which to go on, metres.
const LEAVE_M: f64 = 2.5;
/// A walker nearer than this to a place has arrived, metres.
const THERE_M: f64 = 0.05;
/// Acceleration of a walker, metres per second squared.
pub(super) const ACCEL_MPS2: f64 = 2.0;
/// Turning rate of a walker, radians per second.
const TURN_RADPS: f64 = 4.0;
/// Frequency of strides, hertz.
const SWAY_HZ: f64 = 0.9;
/// Among people, a point of the route this near may be skipped, metres.
const SKIPS_M: f64 = 1.5;
/// A slower robot stands, metres per second.
pub(super) const STANDS_MPS: f64 = 0.05;
/// Directions tried in turn if the straight one is blocked, radians.
const TRIES: [f64; 7] = [0.0, 0.5, -0.5, 1.0, -1.0, 1.4, -1.4];

/// A robot as walkers see it.
#[derive(Clone, Copy, Debug)]
pub struct RobotNear {
    /// The robot's centre.
    pub at: Point,
    /// The robot's velocity, metres per second.
    pub velocity: Vector,
    /// Half the side of the square around the robot's outline, metres.
    pub half_m: f64,
}

/// The surroundings of a walker.
#[derive(Clone, Copy, Debug)]
pub struct WalkerSurroundings<'a> {
    /// The floor's walkways.
    pub walkways: &'a Walkways,
    /// All robots.
    pub robots: &'a [RobotNear],
    /// Other people within some metres.
    pub people: &'a [PersonNear],
}

impl RobotNear {
    /// Distance between a body and the robot's square, metres; negative if they overlap.
    pub fn gap(&self, p: Point) -> f64 {
        let (d, half_m) = (p - self.at, self.half_m);
        let out = Vector::new((d.x.abs() - half_m).max(0.0), (d.y.abs() - half_m).max(0.0));
        out.norm() - BODY_M
    }

    /// Whether a body at `p` is in the robot's way within the next `seconds`. A standing robot has no way.
    pub fn sweeps(&self, p: Point, seconds: f64) -> bool {
        let speed = self.velocity.norm();
        if speed < STANDS_MPS {
            return false;
        }
        let way = self.velocity / speed;
        let d = p - self.at;
        // Half the extent of the square along the way, and across it: the square is aligned to the map's axes.
        let reach = self.half_m * (way.x.abs() + way.y.abs()) + BODY_M;
        let along = d.dot(&way);
        along > 0.0 && along < reach + speed * seconds && d.perp(&way).abs() < reach + SIDE_M
    }
}

/// The place itself, or one close to it where a body has room.
pub fn ease(p: Point, walkways: &Walkways) -> Point {
    let Some((node, _)) = walkways.nearest(p).filter(|_| walkways.clearance_m(p) < WALL_M) else { return p };
    let to = walkways.nodes()[node].at - p;
    let steps = (to.norm() / THERE_M).ceil().max(1.0);
    let points = (0..=steps as u32).map(|i| p + to * (f64::from(i) / steps));
    let mut roomy = points.filter(|q| walkways.clearance_m(*q) >= WALL_M);
    roomy.next().unwrap_or(p + to)
}

/// Whether a body has room all along a straight line.
fn roomy(a: Point, b: Point, wall_m: f64, walkways: &Walkways) -> bool {
    let steps = ((b - a).norm() / 0.1).ceil().max(1.0) as u32;
    (0..=steps).all(|i| walkways.clearance_m(a + (b - a) * (f64::from(i) / f64::from(steps))) >= wall_m)
}

/// What blocks a walker from a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InTheWay {
    Wall,
    Robot,
}

/// Position and gait.
#[derive(Clone, Debug)]
pub struct Legs {
    /// Where the walker is, without its sway.
    pub at: Point,
    /// Direction of walking, radians.
    pub heading: f64,
    /// Walking speed, metres per second.
    pub speed_mps: f64,
    /// Points of the route ahead.
    pub route: VecDeque<Point>,
    /// Metres walked so far.
    pub walked_m: f64,
    /// Whether a robot keeps the walker from going on.
    pub blocked: bool,
    /// Whether one of those robots drives, so that it will soon be past.
    pub blocked_by_moving: bool,
    /// Number of the person who keeps the walker from going on.
    pub kept_by: Option<usize>,
    /// Whether people have kept the walker for a while.
    pub is_kept: bool,
    /// Deviation from the straight way to get past people, radians.
    pub(super) veer: f64,
    /// Offset to the left of the way if a colleague walks alongside, metres.
    pub(super) beside_m: Option<f64>,
    cut_m: f64,
    phase: f64,
    /// The vehicle, if the walker drives one, and whether it drives backwards.
    pub(super) vehicle: Option<Vehicle>,
    pub(super) is_reversing: bool,
}

impl Legs {
    /// A walker standing at a place.
    pub fn new(at: Point, cut_m: f64, phase: f64) -> Legs {
        let route = VecDeque::new();
        Legs {
            at,
            heading: 0.0,
            speed_mps: 0.0,
            route,
            walked_m: 0.0,
            blocked: false,
            blocked_by_moving: false,
            kept_by: None,
            is_kept: false,
            veer: 0.0,
            beside_m: None,
            cut_m,
            phase,
            vehicle: None,
            is_reversing: false,
        }
    }

    /// Distance of the walker's middle from walls, where there is room, metres.
    pub(super) fn wall_m(&self) -> f64 {
        self.vehicle.map_or(WALL_M, |vehicle| Mover::Vehicle(vehicle).clearance_m())
    }

    /// The walkways on which the walker does not fit.
    pub(super) fn too_narrow(&self, walkways: &Walkways) -> EdgeSet {
        match self.vehicle {
            Some(_) => walkways.edges_narrower_than(self.wall_m()),
            None => walkways.no_edges(),
        }
    }

    /// Sets off along these points.
    pub fn set_off(&mut self, points: impl IntoIterator<Item = Point>, walkways: &Walkways) {
        self.route = match self.vehicle {
            Some(_) => points.into_iter().collect(),
            None => points.into_iter().map(|p| ease(p, walkways)).collect(),
        };
    }

    /// Position of the trunk, which sways while walking.
    pub fn trunk(&self, now: Time) -> Point {
        if self.vehicle.is_some() {
            return self.at;
        }
        let swing = (std::f64::consts::TAU * SWAY_HZ * now.as_secs_f64() + self.phase).sin();
        let side = Vector::new(-self.heading.sin(), self.heading.cos());
        self.at + side * (SWAY_M * swing * (self.speed_mps / 0.8).min(1.0))
    }

    /// Walks for `dt` seconds at up to `wanted` metres per second, considering robots for `foresight` seconds ahead.
    pub fn walk(&mut self, dt: f64, wanted: f64, foresight: f64, around: &WalkerSurroundings<'_>) {
        (self.blocked, self.blocked_by_moving, self.kept_by) = (false, false, None);
        self.pass_corners(around.walkways);
        if let Some(vehicle) = self.vehicle {
            return self.drive(&vehicle, dt, wanted, foresight, around);
        }
        let among = around.people.iter().any(|p| p.matters_to(self.at));
        while among && self.can_skip(around.walkways) {
            self.route.pop_front();
        }
        let Some(&aim) = self.route.front() else {
            self.speed_mps = 0.0;
            return self.make_room(dt, foresight, around);
        };
        let way = self.beside(aim, around) - self.at;
        let off = wrap_angle(way.y.atan2(way.x) - self.heading);
        self.heading = wrap_angle(self.heading + off.clamp(-TURN_RADPS * dt, TURN_RADPS * dt));
        let wanted = wanted * off.cos().max(0.25);
        self.speed_mps += (wanted - self.speed_mps).clamp(-ACCEL_MPS2 * dt, ACCEL_MPS2 * dt);
        let length = (self.speed_mps * dt).min(way.norm());
        if length <= 0.0 {
            return self.make_room(dt, foresight, around);
        }
        if among {
            return self.walk_among_people(dt, wanted, way, foresight, around);
        }
        self.veer = 0.0;
        let step = way.normalize() * length;
        let mut robot = false;
        for turn in TRIES {
            let to = self.at + Rotation2::new(turn) * step;
            match self.taken(to, foresight, WALL_M, around) {
                None => {
                    self.walked_m += length;
                    self.at = to;
                    return;
                }
                Some(what) => {
                    robot |= what == InTheWay::Robot;
                    self.blocked |= turn == 0.0 && what == InTheWay::Robot;
                }
            }
        }
        // A walker caught between a wall and a robot is kept by the robot.
        self.blocked = robot;
        self.speed_mps = 0.0;
        if self.blocked {
            let near = |r: &RobotNear| r.velocity.norm() > STANDS_MPS && r.sweeps(self.at + step, foresight);
            self.blocked_by_moving = around.robots.iter().any(near);
        } else {
            self.leave_wall(around.walkways);
        }
    }

    /// With walls on all sides, goes to the middle of an aisle first, if possible to a point from which the rest has
    /// room.
    pub(super) fn leave_wall(&mut self, walkways: &Walkways) {
        let Some(&aim) = self.route.front() else { return };
        let near = walkways.near(self.at, LEAVE_M).into_iter().filter(|(_, far)| *far > 2.0 * THERE_M);
        let near: Vec<(Point, f64)> = near.map(|(n, far)| (walkways.nodes()[n].at, far)).collect();
        let others = near.iter().filter(|(at, _)| *at != aim);
        let whole = |(at, far): &&(Point, f64)| far + (aim - at).norm();
        let through = others.clone().filter(|(at, _)| roomy(*at, aim, WALL_M, walkways));
        let through = through.min_by(|a, b| whole(a).total_cmp(&whole(b)));
        if let Some((at, _)) = through.or_else(|| others.min_by(|a, b| a.1.total_cmp(&b.1))) {
            self.route.push_front(*at);
        }
    }

    /// Whether the next point can be skipped: a walker getting past people does not swing back to the middle for it.
    fn can_skip(&self, walkways: &Walkways) -> bool {
        let (Some(next), Some(then)) = (self.route.front(), self.route.get(1)) else { return false };
        (next - self.at).norm() < SKIPS_M && roomy(self.at, *then, SQUEEZE_M, walkways)
    }

    /// Drops points that are reached, and corners that can be cut.
    pub(super) fn pass_corners(&mut self, walkways: &Walkways) {
        while let Some(&next) = self.route.front() {
            let far = (next - self.at).norm();
            let cut_m = self.beside_m.map_or(self.cut_m, |aside| self.cut_m.max(2.0 * aside.abs()));
            let cut = self
                .route
                .get(1)
                .is_some_and(|then| far < cut_m && roomy(self.at, *then, self.wall_m(), walkways));
            if !cut && far >= THERE_M {
                break;
            }
            self.route.pop_front();
        }
    }

    /// What blocks the body from a place: walls nearer than `wall_m`, or a robot.
    pub(super) fn taken(
        &self,
        to: Point,
        foresight: f64,
        wall_m: f64,
        around: &WalkerSurroundings<'_>,
    ) -> Option<InTheWay> {
        let WalkerSurroundings { walkways, robots, .. } = *around;
        let room = walkways.clearance_m(to);
        if !walkways.is_free(to) || (room < wall_m && room < walkways.clearance_m(self.at)) {
            return Some(InTheWay::Wall);
        }
        let taken = robots.iter().any(|r| {
            let gap = r.gap(to);
            // A walker does not walk on towards a robot that cannot stop in time.
            let comes = if r.sweeps(to, 3.0) { COMES_S * r.velocity.norm() } else { 0.0 };
            let nearer = gap < STAND_OFF_M + comes && gap <= r.gap(self.at);
            let steps_in = || r.sweeps(to, foresight) && !r.sweeps(self.at, foresight);
            nearer || steps_in()
        });
        taken.then_some(InTheWay::Robot)
    }
}
