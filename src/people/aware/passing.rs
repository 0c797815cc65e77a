//! Whether a robot would still move when a person comes near.
//!
//! Main types: [`DriveAhead`] (a robot on its granted way), [`Walk`] (a person on the expected way), main functions:
//! [`moves_within`], [`leaves_after`]. A robot that stands when a person comes is no trouble; one that is overtaken, or
//! has not yet stopped, meets the person. Refuses: to take caution away; the caller may use it only to brake.

use giveway_floor::geometry::{Point, turn_between};

/// Step length for following robot and person, seconds …
const STEP_S: f64 = 0.1;
/// … and number of steps.
const STEPS: usize = 50;
/// Step length for whether a person leaves a place, seconds …
const LEAVE_STEP_S: f64 = 0.25;
/// … and number of steps.
const LEAVE_STEPS: usize = 60;
/// A robot slower than this stands, metres per second.
const STANDS_MPS: f64 = 0.05;
/// Bends sharper than this are turned on the spot, radians.
const BEND: f64 = 0.1;

/// A robot that drives on as fast as it may, and rests at the end of its path.
#[derive(Clone, Debug)]
pub struct DriveAhead {
    /// Path from the robot's position, in driving order.
    pub way: Vec<Point>,
    /// Present speed, metres per second.
    pub speed_mps: f64,
    /// Greatest speed, metres per second.
    pub top_mps: f64,
    /// Acceleration, metres per second squared.
    pub accel_mps2: f64,
    /// Heading, radians.
    pub heading: f64,
    /// Turning rate, radians per second.
    pub turn_radps: f64,
}

/// A person who sets off after a wait, and walks.
#[derive(Clone, Debug)]
pub struct Walk {
    /// Path from the person's position, in walking order.
    pub way: Vec<Point>,
    /// Walking speed, metres per second.
    pub speed_mps: f64,
    /// Time until the first step, seconds.
    pub waits_s: f64,
}

/// A position on a path, with the rest of the path.
struct Along<'a> {
    at: Point,
    ahead: &'a [Point],
}

impl Along<'_> {
    fn on(way: &[Point]) -> Along<'_> {
        let (at, ahead) = way.split_first().expect("somebody is somewhere");
        Along { at: *at, ahead }
    }

    /// Advances by `metres`, at most to the next corner. Gives whether the corner was reached.
    fn reach_corner(&mut self, metres: f64) -> bool {
        let Some((corner, rest)) = self.ahead.split_first() else { return false };
        let leg = corner - self.at;
        let length = leg.norm();
        if length > metres + 1e-9 {
            self.at += leg * (metres / length);
            return false;
        }
        (self.at, self.ahead) = (*corner, rest);
        true
    }

    fn go(&mut self, mut metres: f64) {
        while let Some(corner) = self.ahead.first() {
            let length = (corner - self.at).norm();
            if !self.reach_corner(metres) {
                return;
            }
            metres -= length;
        }
    }

    /// Direction of the rest of the path, radians.
    fn heading(&self) -> Option<f64> {
        let leg = self.ahead.iter().map(|p| p - self.at).find(|leg| leg.norm() > 1e-6)?;
        Some(leg.y.atan2(leg.x))
    }

    /// Metres to the next bend, or to the end.
    fn straight_m(&self) -> f64 {
        let Some(heading) = self.heading() else { return 0.0 };
        let (mut from, mut length) = (self.at, 0.0);
        for p in self.ahead {
            let leg = p - from;
            if leg.norm() > 1e-6 && turn_between(leg.y.atan2(leg.x), heading).abs() > BEND {
                break;
            }
            length += leg.norm();
            from = *p;
        }
        length
    }
}

/// After how many seconds a person has left a place: from then on the person stays farther from it than `radius_m`,
/// within the next 15 seconds. Nothing for a person who is still that near at the end of them.
pub fn leaves_after(walk: &Walk, place: Point, radius_m: f64) -> Option<f64> {
    let mut person = Along::on(&walk.way);
    let mut left_s = Some(0.0);
    for step in 0..=LEAVE_STEPS {
        let now_s = step as f64 * LEAVE_STEP_S;
        let is_near = (person.at - place).norm() <= radius_m;
        left_s = if is_near { None } else { left_s.or(Some(now_s)) };
        if now_s + LEAVE_STEP_S > walk.waits_s {
            person.go(walk.speed_mps * LEAVE_STEP_S);
        }
    }
    left_s
}

/// Whether the robot still moves while it is nearer to the person than `radius_m`, centre to centre, within the next
/// seconds.
pub fn moves_within(drive: &DriveAhead, walk: &Walk, radius_m: f64) -> bool {
    let (mut robot, mut person) = (Along::on(&drive.way), Along::on(&walk.way));
    let (mut v, mut heading, mut turning_s) = (drive.speed_mps, drive.heading, 0.0);
    for step in 1..=STEPS {
        let Some(to) = robot.heading() else { return false };
        let turn = turn_between(heading, to);
        if turn > BEND {
            (v, heading, turning_s) = (0.0, to, turn / drive.turn_radps);
        }
        if turning_s > 0.0 {
            turning_s -= STEP_S;
        } else {
            let braking = (2.0 * drive.accel_mps2 * robot.straight_m()).sqrt();
            v = (v + drive.accel_mps2 * STEP_S).min(drive.top_mps).min(braking);
            robot.go(v * STEP_S);
        }
        if step as f64 * STEP_S > walk.waits_s {
            person.go(walk.speed_mps * STEP_S);
        }
        if v > STANDS_MPS && (robot.at - person.at).norm() < radius_m {
            return true;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive(way: &[(f64, f64)], speed_mps: f64) -> DriveAhead {
        let way = way.iter().map(|(x, y)| Point::new(*x, *y)).collect();
        DriveAhead { way, speed_mps, top_mps: 1.0, accel_mps2: 0.5, heading: 0.0, turn_radps: 1.5 }
    }

    fn walk(way: &[(f64, f64)], speed_mps: f64, waits_s: f64) -> Walk {
        Walk { way: way.iter().map(|(x, y)| Point::new(*x, *y)).collect(), speed_mps, waits_s }
    }

    #[test]
    fn who_walks_faster_than_a_robot_sets_off_catches_up_with_it() {
        let behind = walk(&[(-2.0, 0.0), (9.0, 0.0)], 1.4, 0.0);
        assert!(moves_within(&drive(&[(0.0, 0.0), (6.0, 0.0)], 0.0), &behind, 1.15));
        // A robot that already drives that fast gets away, until it has to stand at the end of a short path.
        let fast = DriveAhead { top_mps: 1.5, ..drive(&[(0.0, 0.0), (9.0, 0.0)], 1.4) };
        assert!(!moves_within(&fast, &behind, 1.15));
        let short = DriveAhead { way: vec![Point::origin(), Point::new(1.5, 0.0)], ..fast };
        assert!(moves_within(&short, &behind, 1.15));
    }

    #[test]
    fn a_robot_that_stands_in_time_meets_nobody() {
        let towards = walk(&[(6.0, 0.0), (0.0, 0.0)], 1.4, 0.0);
        assert!(moves_within(&drive(&[(0.0, 0.0), (4.0, 0.0)], 0.5), &towards, 1.15));
        assert!(!moves_within(&drive(&[(0.0, 0.0), (0.6, 0.0)], 0.5), &towards, 1.15));
        let later = walk(&[(6.0, 0.0), (0.0, 0.0)], 1.4, 4.0);
        assert!(!moves_within(&drive(&[(0.0, 0.0), (2.0, 0.0)], 0.5), &later, 1.15));
        assert!(!moves_within(&drive(&[(0.0, 0.0)], 0.0), &towards, 9.0), "it goes nowhere");
    }

    #[test]
    fn a_place_is_left_when_the_person_is_beyond_it_for_good() {
        let after = |w: &Walk, radius_m| leaves_after(w, Point::new(3.0, 0.0), radius_m);
        let past = walk(&[(0.0, 0.0), (9.0, 0.0)], 1.0, 0.0);
        let close =
            |s: Option<f64>, wanted: f64| (s.expect("it is left") - wanted).abs() <= LEAVE_STEP_S + 1e-9;
        assert!(close(after(&past, 2.0), 5.0));
        assert!(close(after(&Walk { waits_s: 4.0, ..past.clone() }, 2.0), 9.0));
        // There and back: the second time counts.
        assert!(close(after(&walk(&[(0.0, 0.0), (6.0, 0.0), (0.0, 0.0)], 1.0, 0.0), 2.0), 11.0));
        assert_eq!(after(&walk(&[(0.0, 0.0), (3.0, 0.0)], 1.0, 0.0), 2.0), None, "the person stays there");
        assert_eq!(after(&Walk { speed_mps: 0.1, ..past }, 2.0), None, "too slow to tell");
        assert_eq!(after(&walk(&[(0.0, 9.0)], 0.0, 0.0), 2.0), Some(0.0), "never there");
    }

    #[test]
    fn turning_on_the_spot_takes_time_in_which_somebody_comes() {
        let comes = walk(&[(0.0, -4.0), (0.0, 4.0)], 1.4, 0.0);
        let across = drive(&[(0.0, 0.0), (3.0, 0.0)], 0.0);
        assert!(!moves_within(&across, &comes, 1.0));
        let turned = DriveAhead { heading: std::f64::consts::PI, ..across };
        assert!(moves_within(&turned, &comes, 1.0));
    }
}
