//! A simulated robot's own protection: it stops before people, whatever the fleet commands.
//!
//! Main type: [`Guard`]. The field is the robot's square, pushed forward by its stopping distance, at least half a
//! metre (ISO 3691-4 asks for 0.5 m of clearance; scanners switch longer fields at higher speeds). Like a scanner's
//! field it allows for the robot's own motion only, not for people's. A robot beside its line turns as it drives, so
//! its field also extends sideways. Refuses: to slow down for comfort, and to look back: driving away from people is
//! allowed.

use crate::walker::BODY_M;
use giveway_floor::geometry::{Point, Vector};
use giveway_floor::time::{Span, Time};

/// Time from a person in the field to brakes that hold, seconds.
const REACTION_S: f64 = 0.1;
/// Least length of the field in front of the square, metres.
const LEAST_M: f64 = 0.5;
/// Room beyond the stopping distance and beside the square, metres.
const MARGIN_M: f64 = 0.05;
/// The robot drives on when the field has been clear for this long.
const RESTART: Span = Span::from_secs(1);

/// Whether a robot's scanner holds it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Guard {
    /// While the robot is stopped: when a person was last in the field, and the field's length when it stopped.
    stopped: Option<(Time, f64)>,
}

/// Length of the field in front of the square at this speed, metres.
fn length_m(speed_mps: f64, brake_mps2: f64) -> f64 {
    LEAST_M.max(speed_mps * speed_mps / (2.0 * brake_mps2) + speed_mps * REACTION_S + MARGIN_M)
}

impl Guard {
    /// Looks at the people around a robot that is at `at` and drives or would drive `ahead`; also sideways if it
    /// `turns`.
    #[allow(clippy::too_many_arguments)]
    pub fn look(
        &mut self,
        now: Time,
        at: Point,
        (ahead, turns): (Option<Vector>, bool),
        speed_mps: f64,
        brake_mps2: f64,
        half_m: f64,
        people: &[Point],
    ) {
        let Some(way) = ahead else {
            self.stopped = None;
            return;
        };
        let mut length = length_m(speed_mps, brake_mps2);
        if let Some((_, then)) = self.stopped.filter(|_| speed_mps > 0.0) {
            length = length.max(then);
        }
        // The square is aligned to the map's axes: its extent along the way, and across it.
        let reach = half_m * (way.x.abs() + way.y.abs()) + BODY_M;
        let stops_m = speed_mps * speed_mps / (2.0 * brake_mps2) + speed_mps * REACTION_S + MARGIN_M;
        let somebody = people.iter().any(|p| {
            let d = p - at;
            let along = d.dot(&way);
            let is_ahead = along > 0.0 && along < reach + length && d.perp(&way).abs() < reach + MARGIN_M;
            let is_aside = turns && along > -BODY_M && d.norm() < half_m + BODY_M + stops_m;
            is_ahead || is_aside
        });
        self.stopped = match self.stopped {
            _ if somebody => Some((now, length)),
            Some((last, then)) if now - last < RESTART => Some((last, then)),
            _ => None,
        };
    }

    /// Whether the robot brakes, or stands.
    pub fn stops(&self) -> bool {
        self.stopped.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF_M: f64 = 0.45;

    /// A robot drives east at 1.5 m/s and brakes with 0.5 m/s² while stopped; gives where it comes to rest.
    fn comes_to_rest(person: Point) -> Option<f64> {
        let (mut guard, mut x, mut speed) = (Guard::default(), 0.0, 1.5f64);
        for tick in 0..2000 {
            let east = Some(Vector::new(1.0, 0.0));
            guard.look(Time(tick * 20_000), Point::new(x, 0.0), (east, false), speed, 0.5, HALF_M, &[person]);
            speed = if guard.stops() { (speed - 0.5 * 0.02).max(0.0) } else { 1.5 };
            x += speed * 0.02;
            if speed == 0.0 {
                return Some(x);
            }
        }
        None
    }

    #[test]
    fn a_robot_at_full_speed_stops_before_it_touches_anybody() {
        for y in [0.0, 0.4, 0.69] {
            let rest = comes_to_rest(Point::new(8.0, y)).expect("it stops");
            let gap = 8.0 - rest - HALF_M - BODY_M;
            assert!((0.0..0.3).contains(&gap), "{gap} m at {y}");
        }
    }

    #[test]
    fn people_beside_the_way_do_not_stop_it() {
        assert_eq!(comes_to_rest(Point::new(8.0, 0.8)), None);
    }

    #[test]
    fn a_robot_that_turns_also_stops_for_somebody_close_beside_it() {
        let stops = |turns: bool, x: f64, y: f64| {
            let (mut guard, east) = (Guard::default(), Some(Vector::new(1.0, 0.0)));
            guard.look(Time::ZERO, Point::origin(), (east, turns), 0.5, 0.5, HALF_M, &[Point::new(x, y)]);
            guard.stops()
        };
        assert!(stops(true, 0.0, 0.9) && !stops(false, 0.0, 0.9), "beside it");
        assert!(!stops(true, 0.0, 1.2) && !stops(true, -0.5, 0.6), "too far aside, and behind it");
    }

    #[test]
    fn it_may_drive_away_from_a_person_and_restarts_a_second_after_the_field_is_clear() {
        let mut guard = Guard::default();
        let mut look = |s: f64, x: f64, way: f64| {
            let (now, way) = (Time::from_secs_f64(s), Some(Vector::new(way, 0.0)));
            guard.look(now, Point::origin(), (way, false), 0.0, 1.0, HALF_M, &[Point::new(x, 0.0)]);
            guard.stops()
        };
        assert!(look(0.0, 1.0, 1.0));
        assert!(look(0.5, 2.0, 1.0), "it waits for a second");
        assert!(!look(1.5, 2.0, 1.0));
        assert!(!look(2.0, 0.8, -1.0), "it drives away");
    }
}
