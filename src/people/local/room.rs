//! Whether a robot has room beside people within a corridor, and how far aside it would have to drive.
//!
//! Main types: [`PassingRoom`], [`LineSide`]. The room must hold the robot's width and the planner's safe distance,
//! between a person's forecast position and the edge of the corridor. Refuses: to decide whether passing pays.

use super::drive::DriveLimits;
use super::outline::RobotOutline;
use super::planner::MARGIN_M;
use super::spaces::{AHEAD_STEP_S, NearPerson, Spaces};
use giveway_floor::geometry::{Point, Segment, Vector};
use giveway_floor::warehouse::{Corridor, Footprint};

/// A side of a line, in its direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LineSide {
    /// The left side.
    Left,
    /// The right side.
    Right,
}

/// Room beyond the planner's requirement, metres: people sway, and a robot at the edge of a corridor cannot turn.
const SPARE_M: f64 = 0.2;
/// Length of the swing aside at each end, metres: its detour is that of a triangle of this length.
const SWING_M: f64 = 3.0;

/// A corridor along a line, as one robot would pass people in it.
#[derive(Clone, Copy, Debug)]
pub struct PassingRoom {
    line: Segment,
    corridor: Corridor,
    circle_m: f64,
    apart_m: f64,
    speed_mps: f64,
}

impl PassingRoom {
    /// Room for a robot with this footprint that drives along the line at the speed of `limits`; the corridor is seen
    /// in driving direction.
    pub fn new(footprint: &Footprint, limits: DriveLimits, line: Segment, corridor: Corridor) -> PassingRoom {
        let circle_m = RobotOutline::of(footprint).circle_m();
        let spaces = Spaces { circle_m, limits };
        // Level with a person the robot drives neither towards nor away.
        let ahead = Vector::new(limits.speed_mps, 0.0);
        let apart_m = spaces.need_m(ahead, Vector::zeros(), Vector::y()) + SPARE_M;
        PassingRoom { line, corridor, circle_m, apart_m, speed_mps: limits.speed_mps }
    }

    /// Room that the robot needs between a person's middle and the edge of the corridor: the safe distance, and half
    /// the robot, metres.
    pub fn needed_m(&self) -> f64 {
        self.apart_m + self.circle_m + MARGIN_M
    }

    /// Whether there is room on one side of all people for the rest of the line after `from_m`: at no moment until the
    /// robot is past them, the probability that a person is in the way there exceeds `doubt`.
    pub fn is_free(&self, side: LineSide, from_m: f64, people: &[NearPerson<'_>], doubt: f64) -> bool {
        let moments = |p: &NearPerson<'_>| {
            let along_m = self.along_m(p.at);
            let until_m = (along_m + self.apart_m).min(self.line.length()) - from_m;
            let until = (until_m.max(0.0) / (self.speed_mps * AHEAD_STEP_S)).ceil() as usize;
            until.min(p.ahead.len())
        };
        people.iter().all(|p| {
            let now = f64::from(u8::from(self.blocks(side, from_m, p.at, 0.0) > 0.5));
            let later = p.ahead.iter().take(moments(p)).map(|mixture| {
                let parts = mixture.parts.iter();
                parts
                    .map(|part| {
                        let across = self.left();
                        let spread_m = across.dot(&(part.cov * across)).max(0.0).sqrt();
                        part.weight * self.blocks(side, from_m, part.mean, spread_m)
                    })
                    .sum::<f64>()
            });
            now <= doubt && later.into_iter().all(|p| p <= doubt)
        })
    }

    /// The side with room on which the robot deviates less.
    pub fn side(&self, from_m: f64, people: &[NearPerson<'_>], doubt: f64) -> Option<LineSide> {
        let free = [LineSide::Left, LineSide::Right];
        let free = free.into_iter().filter(|s| self.is_free(*s, from_m, people, doubt));
        free.min_by(|a, b| self.aside_m(*a, from_m, people).total_cmp(&self.aside_m(*b, from_m, people)))
    }

    /// How far aside the robot drives to pass all people ahead of it on one side, metres.
    pub fn aside_m(&self, side: LineSide, from_m: f64, people: &[NearPerson<'_>]) -> f64 {
        let ahead = people.iter().filter(|p| self.is_near(side, from_m, p.at));
        ahead.map(|p| self.across_m(side, p.at) + self.apart_m).fold(0.0, f64::max)
    }

    /// The way round the people ahead of a robot at a place: how far to the left of the line it is, negative to the
    /// right, and the point past them. Nothing if nobody is in the way, or there is no room.
    pub fn round(&self, at: Point, people: &[NearPerson<'_>], doubt: f64) -> Option<(f64, Point)> {
        let (from_m, left_m) = (self.along_m(at), self.across_m(LineSide::Left, at));
        // A robot already on one side of the people stays there.
        let own = if left_m > 0.0 { LineSide::Left } else { LineSide::Right };
        let is_free = || self.is_free(own, from_m, people, doubt);
        let stays = (left_m.abs() > self.circle_m && is_free()).then_some(own);
        let side = stays.or_else(|| self.side(from_m, people, doubt))?;
        let ahead = people.iter().filter(|p| self.is_near(side, from_m, p.at)).map(|p| self.along_m(p.at));
        let until_m = ahead.fold(f64::NEG_INFINITY, f64::max) + self.apart_m;
        let aside_m = self.aside_m(side, from_m, people);
        let left_m = if side == LineSide::Left { aside_m } else { -aside_m };
        let ahead_m = until_m.min(self.line.length());
        let past = self.line.a + self.ahead() * ahead_m + self.left() * left_m;
        (aside_m > 0.0 && ahead_m > from_m).then_some((left_m, past))
    }

    /// How much longer the way aside is than the line, metres.
    pub fn detour_m(&self, side: LineSide, from_m: f64, people: &[NearPerson<'_>]) -> f64 {
        2.0 * (self.aside_m(side, from_m, people).hypot(SWING_M) - SWING_M)
    }

    /// Distance of a place along the line, metres.
    pub fn along_m(&self, at: Point) -> f64 {
        (at - self.line.a).dot(&self.ahead())
    }

    /// Distance of a place from the line towards a side, metres; negative on the other side.
    pub fn across_m(&self, side: LineSide, at: Point) -> f64 {
        let left = (at - self.line.a).dot(&self.left());
        if side == LineSide::Left { left } else { -left }
    }

    /// The probability that a person around this place is in the way on a side.
    fn blocks(&self, side: LineSide, from_m: f64, at: Point, spread_m: f64) -> f64 {
        if !self.is_along(from_m, at) {
            return 0.0;
        }
        let edge_m = self.edge_m(side);
        let across = self.across_m(side, at);
        let below = |x: f64| match spread_m > 1e-6 {
            true => 0.5 * (1.0 + libm::erf((x - across) / (spread_m * std::f64::consts::SQRT_2))),
            false => f64::from(u8::from(across < x)),
        };
        // A person far enough beyond the corridor leaves all of it free.
        below(self.beyond_m(side)) - below(edge_m - self.needed_m())
    }

    /// Whether the robot must keep away from this place on the rest of its way on a side.
    fn is_near(&self, side: LineSide, from_m: f64, at: Point) -> bool {
        self.is_along(from_m, at) && self.across_m(side, at) < self.beyond_m(side)
    }

    fn edge_m(&self, side: LineSide) -> f64 {
        if side == LineSide::Left { self.corridor.left_m } else { self.corridor.right_m }
    }

    /// A person farther off the line than this leaves all of a side free, metres.
    fn beyond_m(&self, side: LineSide) -> f64 {
        self.edge_m(side) + self.apart_m - self.circle_m
    }

    /// Whether the robot passes a place on the rest of its way.
    fn is_along(&self, from_m: f64, at: Point) -> bool {
        (from_m - self.circle_m..=self.line.length() + self.apart_m).contains(&self.along_m(at))
    }

    fn ahead(&self) -> Vector {
        (self.line.b - self.line.a).try_normalize(1e-12).unwrap_or(Vector::x())
    }

    fn left(&self) -> Vector {
        let ahead = self.ahead();
        Vector::new(-ahead.y, ahead.x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::human::{Mixture, Part};
    use nalgebra::Matrix2;

    const LIMITS: DriveLimits = DriveLimits {
        speed_mps: 0.5,
        accel_mps2: 0.8,
        brake_mps2: 0.8,
        turn_rps: 1.2,
        turn_accel_rps2: 2.5,
        react_s: 0.3,
        period_s: 0.1,
    };

    fn room(left_m: f64, right_m: f64) -> PassingRoom {
        let line = Segment { a: Point::origin(), b: Point::new(10.0, 0.0) };
        let robot = Footprint::Circle { radius_m: 0.4 };
        PassingRoom::new(&robot, LIMITS, line, Corridor { left_m, right_m })
    }

    fn walks(at: (f64, f64), velocity: (f64, f64)) -> (Point, Vector, Vec<Mixture>) {
        let (at, velocity) = (Point::new(at.0, at.1), Vector::new(velocity.0, velocity.1));
        let part = |k: usize| {
            let mean = at + velocity * (AHEAD_STEP_S * (k + 1) as f64);
            Part { weight: 1.0, mean, cov: Matrix2::identity() * 0.01 }
        };
        let ahead = (0..super::super::AHEAD_STEPS).map(|k| Mixture { parts: vec![part(k)] }).collect();
        (at, velocity, ahead)
    }

    fn side(room: PassingRoom, at: (f64, f64), velocity: (f64, f64)) -> Option<LineSide> {
        let (at, velocity, ahead) = walks(at, velocity);
        room.side(0.0, &[NearPerson { at, velocity, ahead: &ahead }], 0.25)
    }

    #[test]
    fn room_is_the_width_of_the_robot_and_the_safe_distance() {
        let needed = room(3.0, 3.0).needed_m();
        // Twice the robot's circle, half an arm span, the least distance, the error of a measured speed, and spare
        // room.
        let expected = 0.8 + 0.89 + 0.5 + 0.1 * (0.3 + 0.5 / 0.8) + SPARE_M + MARGIN_M;
        assert!((needed - expected).abs() < 1e-9, "{needed} and {expected}");
        assert_eq!(side(room(needed + 0.3, 0.0), (5.0, 0.0), (0.0, 0.0)), Some(LineSide::Left));
        assert_eq!(side(room(needed - 0.3, 0.0), (5.0, 0.0), (0.0, 0.0)), None);
    }

    #[test]
    fn somebody_beside_the_line_is_passed_on_the_other_side_with_the_shorter_swing() {
        let wide = room(3.5, 3.5);
        assert_eq!(side(wide, (5.0, 0.8), (0.0, 0.0)), Some(LineSide::Right));
        assert_eq!(side(wide, (5.0, -0.8), (0.0, 0.0)), Some(LineSide::Left));
        let person = NearPerson { at: Point::new(5.0, 0.8), velocity: Vector::zeros(), ahead: &[] };
        assert!((wide.aside_m(LineSide::Right, 0.0, &[person]) - (wide.apart_m - 0.8)).abs() < 1e-9);
        assert_eq!(wide.aside_m(LineSide::Right, 8.0, &[person]), 0.0, "the robot is past");
        let far = NearPerson { at: Point::new(5.0, -7.0), ..person };
        let (both, past) = wide.round(Point::origin(), &[person, far], 0.25).expect("there is room");
        assert!(
            (both + wide.apart_m - 0.8).abs() < 1e-9,
            "somebody far beyond the corridor is nothing to it"
        );
        assert!((past - Point::new(5.0 + wide.apart_m, both)).norm() < 1e-9, "{past}");
        assert_eq!(wide.round(Point::origin(), &[far], 0.25), None, "nobody is in the way");
    }

    #[test]
    fn there_is_no_room_where_somebody_is_about_to_be() {
        let one = room(0.4, 3.0);
        assert_eq!(side(one, (6.0, 0.5), (0.0, 0.0)), Some(LineSide::Right));
        assert_eq!(side(one, (6.0, 0.5), (0.0, -0.8)), None, "turns into the free side");
        assert_eq!(side(room(3.0, 3.0), (6.0, -3.0), (0.0, 1.0)), None, "walks across");
        assert!(side(one, (-3.0, -1.0), (-1.0, 0.0)).is_some(), "behind the robot");
    }

    #[test]
    fn between_two_people_there_is_room_only_if_one_side_is_free_of_both() {
        let wide = room(3.5, 3.5);
        let at = |x: f64, y: f64| NearPerson { at: Point::new(x, y), velocity: Vector::zeros(), ahead: &[] };
        assert_eq!(wide.side(0.0, &[at(3.0, 1.5), at(7.0, -1.5)], 0.25), None);
        assert_eq!(wide.side(0.0, &[at(3.0, 1.5), at(7.0, 1.0)], 0.25), Some(LineSide::Right));
    }
}
