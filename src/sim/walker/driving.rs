//! How a driver follows a route: speed, corners, and what is in the way.
//!
//! Adds to [`Legs`]. The point of the tag follows the route, and the vehicle turns to where it drives, forwards or
//! backwards. The driver looks along the route as far as the vehicle needs to stop, and brakes for whatever is there or
//! will be; a step or a turn that would bring the vehicle nearer than a hand's breadth to a robot or a person is never
//! taken. Refuses: steering geometry, and the swing of the rear beyond the vehicle's outline.

use super::legs::{Legs, RobotNear, STANDS_MPS, WalkerSurroundings};
use super::person::BODY_M;
use giveway_floor::geometry::{Point, Pose, Vector, wrap_angle};
use giveway_people::human::{Mover, Vehicle};
use nalgebra::Rotation2;

/// Room that a driver keeps to everything else, metres.
const ROOM_M: f64 = 0.15;
/// Besides, a driver stops this far before what is ahead, metres.
const BEFORE_M: f64 = 0.5;
/// Distance between two places that the driver looks at, metres.
const LOOK_M: f64 = 0.25;
/// Turning rate of a vehicle, radians per second.
const TURN_RADPS: f64 = 0.8;
/// A vehicle that is turned this far from its way stops to turn, radians.
const STOPS_TO_TURN: f64 = 0.8;
/// Share of the brakes that a driver uses when nothing is sudden.
const GENTLY: f64 = 0.4;
/// Bends, radians: up to the first a driver keeps the speed; from the second on it is the slow one, metres per second.
const BENDS: (f64, f64) = (0.15, 0.9);
const BEND_MPS: f64 = 0.5;
/// A vehicle changes between forwards and backwards only below this speed, metres per second.
const SHIFTS_MPS: f64 = 0.1;
/// How far ahead in time a driver expects others to go on as they do, seconds.
const GOES_ON_S: f64 = 1.5;
/// Reaction time of a driver who looks ahead, seconds.
const REACTS_S: f64 = 0.4;

/// The discs of a person's size that cover a vehicle at a pose: what a scanner or another person sees of it.
pub fn parts(mover: &Mover, pose: Pose) -> Vec<Point> {
    let Mover::Vehicle(vehicle) = mover else { return vec![pose.at] };
    let figures = vehicle.figures();
    let along = spread(-figures.behind_m + BODY_M, vehicle.ahead_m() - BODY_M);
    let half_m = (figures.width_m / 2.0 - BODY_M).max(0.0);
    let across = spread(-half_m, half_m);
    let turn = Rotation2::new(pose.heading);
    let all = along.iter().flat_map(|x| across.iter().map(move |y| Vector::new(*x, *y)));
    all.map(|offset| pose.at + turn * offset).collect()
}

/// Places from one end to the other, no farther apart than half a disc.
fn spread(from: f64, to: f64) -> Vec<f64> {
    let steps = ((to - from) / BODY_M).ceil().max(0.0) as u32;
    (0..=steps).map(|i| from + (to - from) * f64::from(i) / f64::from(steps.max(1))).collect()
}

/// Distance between a vehicle at a pose and the square of a robot at a place, metres; negative if they overlap.
fn gap_m(vehicle: &Vehicle, pose: Pose, at: Point, half_m: f64) -> f64 {
    let d = Rotation2::new(-pose.heading) * (at - pose.at);
    // The square is aligned to the map's axes; the rectangle around it along the vehicle's.
    let reach = half_m * (pose.heading.cos().abs() + pose.heading.sin().abs());
    let figures = vehicle.figures();
    let x = (-figures.behind_m - reach - d.x).max(d.x - vehicle.ahead_m() - reach);
    let y = d.y.abs() - figures.width_m / 2.0 - reach;
    if x > 0.0 || y > 0.0 { Vector::new(x.max(0.0), y.max(0.0)).norm() } else { x.max(y) }
}

impl Legs {
    /// Drives for `dt` seconds at up to `wanted` metres per second.
    pub(super) fn drive(
        &mut self,
        vehicle: &Vehicle,
        dt: f64,
        wanted: f64,
        foresight: f64,
        around: &WalkerSurroundings<'_>,
    ) {
        let figures = vehicle.figures();
        let Some(&aim) = self.route.front() else { return self.roll_out(vehicle, dt, around) };
        let way = aim - self.at;
        if way.norm() <= 0.0 {
            return;
        }
        let course = way.y.atan2(way.x);
        if self.speed_mps < SHIFTS_MPS {
            self.is_reversing = wrap_angle(course - self.heading).abs() > std::f64::consts::FRAC_PI_2;
        }
        let off = wrap_angle(self.facing(course) - self.heading);
        let turned = wrap_angle(self.heading + off.clamp(-TURN_RADPS * dt, TURN_RADPS * dt));
        let is_clear = self.may_be(vehicle, Pose { at: self.at, heading: turned }, around);
        if is_clear {
            self.heading = turned;
        } else {
            self.note_blocked(vehicle, around);
        }
        let mut most = wanted.min(figures.speed_mps).min(self.bends_mps(&figures.brake_mps2));
        if off.abs() > STOPS_TO_TURN {
            most = 0.0;
        } else {
            most *= off.cos().powi(2);
        }
        let free_m = self.looks_ahead(vehicle, foresight, around);
        if let Some(free_m) = free_m {
            most = most.min((2.0 * figures.brake_mps2 * (free_m - BEFORE_M).max(0.0)).sqrt());
        }
        let (gains, brakes) = (figures.accel_mps2 * dt, figures.brake_mps2 * dt);
        self.speed_mps += (most - self.speed_mps).clamp(-brakes, gains);
        let length = (self.speed_mps * dt).min(way.norm());
        if length <= 0.0 {
            if wanted > 0.0 && free_m.is_some_and(|m| m <= BEFORE_M) {
                self.note_blocked(vehicle, around);
            }
            return;
        }
        let to = self.at + way.normalize() * length;
        if self.may_be(vehicle, Pose { at: to, heading: self.heading }, around) {
            (self.at, self.walked_m) = (to, self.walked_m + length);
        } else {
            self.speed_mps = 0.0;
            self.note_blocked(vehicle, around);
        }
    }

    /// The heading of the vehicle while it drives in a direction.
    fn facing(&self, course: f64) -> f64 {
        if self.is_reversing { wrap_angle(course + std::f64::consts::PI) } else { course }
    }

    /// Without a route, the vehicle rolls out straight on, as far as it is free there.
    fn roll_out(&mut self, vehicle: &Vehicle, dt: f64, around: &WalkerSurroundings<'_>) {
        self.speed_mps = (self.speed_mps - vehicle.figures().brake_mps2 * dt).max(0.0);
        let sign = if self.is_reversing { -1.0 } else { 1.0 };
        let ahead = Vector::new(self.heading.cos(), self.heading.sin()) * sign;
        let to = self.at + ahead * (self.speed_mps * dt);
        let is_wide =
            around.walkways.clearance_m(to) >= self.wall_m().min(around.walkways.clearance_m(self.at));
        if self.speed_mps > 0.0
            && is_wide
            && self.may_be(vehicle, Pose { at: to, heading: self.heading }, around)
        {
            self.walked_m += self.speed_mps * dt;
            self.at = to;
        } else {
            self.speed_mps = 0.0;
        }
    }

    /// Whether the vehicle may be at a pose: nothing is too near there, or no nearer than it is now.
    fn may_be(&self, vehicle: &Vehicle, pose: Pose, around: &WalkerSurroundings<'_>) -> bool {
        let here = Pose { at: self.at, heading: self.heading };
        let near_m = Mover::Vehicle(*vehicle).body_m() + ROOM_M;
        let near = around.robots.iter().filter(|r| (r.at - pose.at).norm() < near_m + 2.0 * r.half_m);
        let gap = |r: &RobotNear, pose| gap_m(vehicle, pose, r.at, r.half_m);
        near.into_iter().all(|r| gap(r, pose) >= ROOM_M.min(gap(r, here)))
    }

    /// Notes that something keeps the vehicle from going on, and whether that drives.
    fn note_blocked(&mut self, vehicle: &Vehicle, around: &WalkerSurroundings<'_>) {
        let near_m = Mover::Vehicle(*vehicle).body_m() + 2.0 * BEFORE_M;
        let near = around.robots.iter().filter(|r| (r.at - self.at).norm() < near_m + 2.0 * r.half_m);
        self.blocked = true;
        self.blocked_by_moving = near.into_iter().any(|r| r.velocity.norm() > STANDS_MPS);
    }

    /// The speed at which the vehicle can brake gently for each bend and for the end of the route, metres per second.
    fn bends_mps(&self, brake_mps2: &f64) -> f64 {
        let stops = |mps: f64, metres: f64| (mps * mps + 2.0 * GENTLY * brake_mps2 * metres).sqrt();
        let (mut from, mut metres, mut most) = (self.at, 0.0, f64::INFINITY);
        let mut course: Option<Vector> = None;
        for point in &self.route {
            let leg = point - from;
            let length = leg.norm();
            if length <= 1e-6 {
                continue;
            }
            if let Some(before) = course {
                let bend = wrap_angle(leg.y.atan2(leg.x) - before.y.atan2(before.x)).abs();
                let sharp = ((bend - BENDS.0) / (BENDS.1 - BENDS.0)).clamp(0.0, 1.0);
                if sharp > 0.0 {
                    most = most.min(stops(BEND_MPS / sharp, metres));
                }
            }
            (course, from, metres) = (Some(leg), *point, metres + length);
            if stops(0.0, metres) > most {
                return most;
            }
        }
        most.min(stops(0.0, metres))
    }

    /// How far the way ahead is free, metres; nothing if it is free as far as the vehicle needs to stop.
    fn looks_ahead(&self, vehicle: &Vehicle, foresight: f64, around: &WalkerSurroundings<'_>) -> Option<f64> {
        let brake = vehicle.figures().brake_mps2;
        let look_m = self.speed_mps * (REACTS_S + self.speed_mps / (2.0 * brake)) + 2.0 * BEFORE_M;
        let body_m = Mover::Vehicle(*vehicle).body_m();
        let reach_m = |r: &&RobotNear| look_m + body_m + 2.0 * r.half_m + r.velocity.norm() * GOES_ON_S;
        let near: Vec<&RobotNear> =
            around.robots.iter().filter(|r| (r.at - self.at).norm() < reach_m(r)).collect();
        if near.is_empty() {
            return None;
        }
        let here = Pose { at: self.at, heading: self.heading };
        let (mut from, mut metres) = (self.at, 0.0);
        for point in &self.route {
            let leg = point - from;
            let length = leg.norm();
            let heading = self.facing(leg.y.atan2(leg.x));
            let steps = (length / LOOK_M).ceil().max(1.0) as u32;
            for i in 1..=steps {
                let ahead_m = metres + length * f64::from(i) / f64::from(steps);
                if ahead_m > look_m {
                    return None;
                }
                let pose = Pose { at: from + leg * (f64::from(i) / f64::from(steps)), heading };
                let seconds = (ahead_m / self.speed_mps.max(0.5)).min(GOES_ON_S).min(foresight);
                let hits = |r: &&RobotNear| {
                    let now_m = gap_m(vehicle, here, r.at, r.half_m);
                    let then = r.at + r.velocity * seconds;
                    let gap = gap_m(vehicle, pose, r.at, r.half_m).min(gap_m(vehicle, pose, then, r.half_m));
                    gap < ROOM_M.min(now_m - 1e-9)
                };
                if near.iter().any(hits) {
                    return Some(ahead_m - LOOK_M);
                }
            }
            (from, metres) = (*point, metres + length);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::thesis;
    use giveway_floor::warehouse::walkway::Walkways;
    use giveway_people::human::VehicleFigures;

    const DT: f64 = 0.05;

    fn truck() -> Vehicle {
        Vehicle::new(VehicleFigures::of_size(2.0, 0.8)).expect("it is a vehicle")
    }

    /// A vehicle on a wide floor that drives east, with `robots` around it, for some seconds; gives its legs, the top
    /// speed that it had, and the least gap to any robot.
    fn drives(metres: f64, robots: &[RobotNear], seconds: f64) -> (Legs, f64, f64) {
        let walkways = Walkways::of(&thesis());
        let mut legs = Legs::new(Point::origin(), 0.2, 0.0);
        legs.vehicle = Some(truck());
        legs.route = [Point::new(metres, 0.0)].into();
        let mut moved: Vec<RobotNear> = robots.to_vec();
        let (mut top, mut least) = (0.0_f64, f64::INFINITY);
        for _ in 0..(seconds / DT) as usize {
            moved.iter_mut().for_each(|r| r.at += r.velocity * DT);
            let around = WalkerSurroundings { walkways: &walkways, robots: &moved, people: &[] };
            legs.walk(DT, 3.0, 1.5, &around);
            top = top.max(legs.speed_mps);
            let pose = Pose { at: legs.at, heading: legs.heading };
            let gaps = moved.iter().map(|r| gap_m(&truck(), pose, r.at, r.half_m));
            least = gaps.fold(least, f64::min);
        }
        (legs, top, least)
    }

    fn robot(x: f64, y: f64, velocity: (f64, f64)) -> RobotNear {
        RobotNear { at: Point::new(x, y), velocity: Vector::new(velocity.0, velocity.1), half_m: 0.45 }
    }

    #[test]
    fn a_vehicle_gathers_speed_as_it_can_and_comes_to_rest_at_the_end() {
        let (legs, top, _) = drives(20.0, &[], 20.0);
        assert!((legs.at.x - 20.0).abs() < 0.1 && legs.speed_mps == 0.0, "{:?}", legs.at);
        assert!(top > 2.5 && top <= 3.0, "{top}");
    }

    #[test]
    fn a_driver_stops_before_a_robot_that_stands_in_the_way_and_says_so() {
        let (legs, top, least) = drives(20.0, &[robot(12.0, 0.3, (0.0, 0.0))], 20.0);
        assert!(top > 2.0 && legs.speed_mps == 0.0 && legs.blocked, "{top} m/s");
        assert!((ROOM_M..1.5).contains(&least), "{least} m");
    }

    #[test]
    fn a_driver_lets_a_robot_pass_that_crosses_the_way() {
        let (legs, _, least) = drives(20.0, &[robot(9.0, -6.0, (0.0, 1.2))], 25.0);
        assert!(legs.at.x > 19.0, "it goes on: {:?}", legs.at);
        assert!(least >= ROOM_M - 1e-9, "{least} m");
    }

    #[test]
    fn a_vehicle_drives_back_where_it_came_from_without_turning_round() {
        let (mut legs, ..) = drives(6.0, &[], 8.0);
        let walkways = Walkways::of(&thesis());
        legs.route = [Point::new(1.0, 0.0)].into();
        for _ in 0..200 {
            legs.walk(DT, 2.0, 1.5, &WalkerSurroundings { walkways: &walkways, robots: &[], people: &[] });
        }
        assert!((legs.at.x - 1.0).abs() < 0.1 && legs.heading.abs() < 0.01, "{:?}", legs.at);
    }

    #[test]
    fn the_discs_that_others_see_cover_the_vehicle_and_reach_no_farther() {
        let pose = Pose { at: Point::new(3.0, 4.0), heading: 0.7 };
        let mover = Mover::Vehicle(truck());
        let discs = parts(&mover, pose);
        for corner in truck().outline(pose) {
            let nearest = discs.iter().map(|d| (d - corner).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest < BODY_M * 1.5, "{nearest} m from a disc to a corner");
        }
        for disc in &discs {
            assert!(gap_m(&truck(), pose, *disc, 0.0) <= -BODY_M + 1e-9, "a disc is within the outline");
        }
        assert_eq!(parts(&Mover::OnFoot, pose), [pose.at]);
    }
}
