//! How walkers get past one another: they step aside early, keep to the right, and make room where they stand.
//!
//! Adds to [`Legs`]. Each tick a walker rates some directions and speeds by how soon they would bring it up against a
//! person who walks on as now (velocity obstacles, Fiorini and Shiller 1998), and takes the cheapest. The rule that two
//! bodies never overlap does not depend on that: a step that would bring it too near is never taken. Refuses: to know
//! where others are going beyond the way they face.

use super::legs::{ACCEL_MPS2, InTheWay, Legs, WALL_M, WalkerSurroundings};
use super::person::{APART_M, PASSING_M, PersonNear, SQUEEZE_M};
use giveway_floor::geometry::{Point, Vector};
use nalgebra::Rotation2;

/// How far ahead in time a walker looks, seconds.
const HORIZON_S: f64 = 3.0;
/// A walker that has been kept for a while squeezes past: it looks only this far ahead, seconds, and standing costs it
/// more.
const CLOSE_S: f64 = 0.6;
const KEPT_COST: f64 = 4.0;
/// How far ahead a walker looks for walls, seconds.
const WALLS_S: f64 = 0.3;
/// How quickly a walker brakes for a person, metres per second squared.
const BRAKE_MPS2: f64 = 4.0;
/// How quickly a walker swerves, radians per second.
const VEER_RADPS: f64 = 12.0;
/// A walker slower than this turns on the spot, metres per second.
const SLOW_MPS: f64 = 0.3;
/// Directions to rate, radians off the straight way.
const VEERS: [f64; 13] = [0.0, -0.2, 0.2, -0.4, 0.4, -0.7, 0.7, -1.0, 1.0, -1.3, 1.3, -1.6, 1.6];
/// Speeds to rate, as shares of the wanted one.
const PACES: [f64; 3] = [1.0, 0.5, 0.0];
/// Costs: a radian off, giving up all speed, being about to touch, a wall, keeping left, a radian of change.
const VEER_COST: f64 = 0.6;
const PACE_COST: f64 = 2.5;
const TOUCH_COST: f64 = 4.0;
const WALL_COST: f64 = 2.0;
const LEFT_COST: f64 = 0.15;
const CHANGE_COST: f64 = 0.1;
/// A standing walker makes room for people who come this near, metres, at this speed, metres per second.
const COMES_BY_M: f64 = 2.0;
const MAKES_ROOM_MPS: f64 = 0.5;

impl Legs {
    /// Takes a step in the direction and at the speed of least cost.
    pub(super) fn walk_among_people(
        &mut self,
        dt: f64,
        wanted: f64,
        way: Vector,
        foresight: f64,
        around: &WalkerSurroundings<'_>,
    ) {
        let straight = way.normalize();
        let mut robot = false;
        let mut best: Option<(f64, f64, f64, Point)> = None;
        for veer in VEERS {
            let direction = Rotation2::new(veer) * straight;
            // A walking person cannot turn at once.
            let most = if self.speed_mps < SLOW_MPS { f64::INFINITY } else { VEER_RADPS * dt };
            let turned = self.veer + (veer - self.veer).clamp(-most, most);
            let step = Rotation2::new(turned) * straight;
            for pace in PACES {
                let target = wanted * pace;
                let speed = target.clamp(self.speed_mps - BRAKE_MPS2 * dt, self.speed_mps + ACCEL_MPS2 * dt);
                let to = self.at + step * (speed * dt).clamp(0.0, way.norm());
                match self.taken(to, foresight, SQUEEZE_M, around) {
                    Some(what) => {
                        robot |= what == InTheWay::Robot;
                        continue;
                    }
                    None if around.people.iter().any(|p| p.is_hit(self.at, to)) => continue,
                    None => {}
                }
                let cost = self.cost(veer, pace, direction * target, around);
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, turned, speed.max(0.0), to));
                }
            }
        }
        let nearest = self.nearest_ahead(straight, around);
        let Some((_, veer, speed, to)) = best else {
            (self.speed_mps, self.blocked, self.kept_by) = (0.0, robot, nearest);
            if !robot && nearest.is_none() {
                self.leave_wall(around.walkways);
            }
            return;
        };
        self.walked_m += (to - self.at).norm();
        (self.at, self.veer, self.speed_mps) = (to, veer, speed);
        // A walker that shuffles about in front of a person is kept too: the time without progress shows whether it is.
        let stands = speed < 0.15 * wanted && nearest.is_none();
        (self.blocked, self.kept_by) = (robot && stands, nearest);
        if stands && !robot && speed == 0.0 {
            // Only a wall can be the cause.
            self.leave_wall(around.walkways);
        }
    }

    /// The cost of walking on in this direction at this pace.
    fn cost(&self, veer: f64, pace: f64, velocity: Vector, around: &WalkerSurroundings<'_>) -> f64 {
        let touches = around.people.iter().filter_map(|p| p.meets(self.at, velocity));
        let (horizon, stand) = if self.is_kept { (CLOSE_S, KEPT_COST) } else { (HORIZON_S, PACE_COST) };
        let touch: f64 = touches.filter(|s| *s < horizon).map(|s| 1.0 - s / horizon).sum();
        let soon = self.at + velocity * WALLS_S;
        let room = around.walkways.clearance_m(soon);
        let wall = room < SQUEEZE_M && room < around.walkways.clearance_m(self.at);
        // Being near walls without need is uncomfortable, so people return to the middle.
        let near = if room < WALL_M { 0.1 } else { 0.0 };
        VEER_COST * veer.abs()
            + stand * (1.0 - pace)
            + TOUCH_COST * touch
            + if wall { WALL_COST } else { near }
            + if veer > 0.0 { LEFT_COST } else { 0.0 }
            + CHANGE_COST * (veer - self.veer).abs()
    }

    /// The nearest person ahead.
    fn nearest_ahead(&self, way: Vector, around: &WalkerSurroundings<'_>) -> Option<usize> {
        let far = |p: &PersonNear| (p.at - self.at).norm();
        let ahead = |p: &&PersonNear| far(p) < 2.0 * APART_M && (p.at - self.at).dot(&way) > 0.0;
        around.people.iter().filter(ahead).min_by(|a, b| far(a).total_cmp(&far(b))).map(|p| p.who)
    }

    /// A standing walker steps out of the way of people who come by, as far as walls allow.
    pub(super) fn make_room(&mut self, dt: f64, foresight: f64, around: &WalkerSurroundings<'_>) {
        for p in around.people.iter().filter(|p| p.matters_to(self.at)) {
            let Some(aim) = p.aim.filter(|aim| (aim - p.at).norm() > 0.0) else { continue };
            let (way, d) = ((aim - p.at).normalize(), self.at - p.at);
            let (along, left) = (d.dot(&way), way.perp(&d));
            let ends = (aim - p.at).norm() + PASSING_M;
            if !(0.0..COMES_BY_M.min(ends)).contains(&along) || left.abs() >= PASSING_M {
                continue;
            }
            // People keep to the right, so there is less traffic on the left.
            let side = if left < -0.02 { -1.0 } else { 1.0 };
            let to = self.at + Vector::new(-way.y, way.x) * (side * MAKES_ROOM_MPS * dt);
            let hit = around.people.iter().any(|q| q.is_hit(self.at, to));
            if !hit && self.taken(to, foresight, SQUEEZE_M, around).is_none() {
                self.walked_m += (to - self.at).norm();
                self.at = to;
                return;
            }
        }
    }

    /// The point to aim at: on the route, or beside it if a colleague walks alongside and there is room for two.
    pub(super) fn beside(&self, aim: Point, around: &WalkerSurroundings<'_>) -> Point {
        let (Some(left_m), way) = (self.beside_m, aim - self.at) else { return aim };
        if way.norm() < 2.0 * left_m.abs() && self.route.len() == 1 {
            return aim;
        }
        let left = Vector::new(-way.y, way.x).normalize() * left_m;
        let ahead = self.at + way.normalize() * way.norm().min(1.0);
        let room = |p: Point| around.walkways.clearance_m(p) >= WALL_M;
        if room(ahead + left) && room(aim + left) { aim + left } else { aim }
    }
}
