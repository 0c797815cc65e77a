//! Meetings of robots and people, measured where both truly are (DESIGN section 8).
//!
//! Main types: [`Meter`], [`Meeting`], [`Figures`]. Refuses: what the fleet believes.

use super::walker::RobotNear;
use crate::geometry::Point;
use crate::id::RobotId;
use crate::time::{Span, Time};
use std::collections::{BTreeMap, BTreeSet};

/// A robot faster than this moves, metres per second.
const MOVES_MPS: f64 = 0.05;
/// A meeting is over when the robot is so much farther away than where it began, metres.
const HYSTERESIS_M: f64 = 0.3;
/// The same two do not meet again for so long.
const REARM: Span = Span::from_secs(2);

/// A moving robot came near a worker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// Which robot.
    pub robot: RobotId,
    /// Number of the worker.
    pub worker: usize,
    /// When.
    pub began: Time,
    /// Least distance between the centres while it lasted, metres.
    pub closest_m: f64,
    /// Speed of the robot when it began, metres per second.
    pub robot_mps: f64,
    /// Speed of the worker then.
    pub worker_mps: f64,
}

/// How two stand to each other.
#[derive(Clone, Copy, Debug)]
enum Near {
    /// Inside, but the worker came to a standing robot: nobody was met.
    Quiet,
    /// Inside, and this meeting is on.
    Meets(usize),
    /// Outside again since then.
    Out(Time),
}

/// What a run came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figures {
    /// All meetings, by when they began.
    pub meetings: Vec<Meeting>,
    /// Time of workers on the floor.
    pub worker_time: Span,
    /// How often a robot's square and a worker's body touched.
    pub contacts: u64,
}

/// Watches robots and workers.
#[derive(Debug)]
pub struct Meter {
    radius_m: f64,
    near: BTreeMap<(RobotId, usize), Near>,
    touching: BTreeSet<(RobotId, usize)>,
    /// Robots that drove on into a worker, with the worker: a broken law.
    pub run_over: Vec<(RobotId, usize)>,
    /// What was measured.
    pub figures: Figures,
}

/// A worker as the meter sees it.
#[derive(Clone, Copy, Debug)]
pub struct Person {
    /// Its number.
    pub worker: usize,
    /// Where it is.
    pub at: Point,
    /// How fast it walks, metres per second.
    pub speed_mps: f64,
}

impl Meter {
    /// A meter for meetings within this radius, metres.
    pub fn new(radius_m: f64) -> Meter {
        Meter {
            radius_m,
            near: BTreeMap::new(),
            touching: BTreeSet::new(),
            run_over: Vec::new(),
            figures: Figures::default(),
        }
    }

    /// Counts the time of those on the floor.
    pub fn pass_time(&mut self, people: usize, span: Span) {
        self.figures.worker_time += span * people as i64;
    }

    /// Looks at a robot and a worker.
    pub fn look(&mut self, now: Time, id: RobotId, robot: &RobotNear, person: &Person) {
        let d = person.at - robot.at;
        let (distance, speed) = (d.norm(), robot.velocity.norm());
        let key = (id, person.worker);
        let inside = distance < self.radius_m;
        let before = self.near.get(&key).copied();
        let meets = inside && speed > MOVES_MPS;
        let now_near = match before {
            Some(Near::Meets(i)) if distance <= self.radius_m + HYSTERESIS_M => {
                let closest = &mut self.figures.meetings[i].closest_m;
                *closest = closest.min(distance);
                return;
            }
            Some(Near::Meets(_)) => Some(Near::Out(now)),
            Some(Near::Out(since)) if now - since < REARM => return,
            Some(Near::Quiet) if inside => return,
            _ if meets => {
                let (robot_mps, worker_mps) = (speed, person.speed_mps);
                let began = Meeting {
                    robot: id,
                    worker: person.worker,
                    began: now,
                    closest_m: distance,
                    robot_mps,
                    worker_mps,
                };
                self.figures.meetings.push(began);
                Some(Near::Meets(self.figures.meetings.len() - 1))
            }
            _ if inside => Some(Near::Quiet),
            _ => None,
        };
        match now_near {
            Some(near) => self.near.insert(key, near),
            None => self.near.remove(&key),
        };
    }

    /// Notes whether a robot and a worker touch. A robot that moves then must be braking.
    pub fn touch(&mut self, id: RobotId, worker: usize, touch: bool, speed_mps: f64, brakes: bool) {
        let key = (id, worker);
        if !touch {
            self.touching.remove(&key);
        } else if self.touching.insert(key) {
            self.figures.contacts += 1;
            if speed_mps > 0.1 && !brakes {
                self.run_over.push(key);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector;

    /// Meetings of a robot on the x axis with a worker at the origin; the robot's `(second, x)` are joined by
    /// straight pieces.
    fn meetings(track: &[(f64, f64)]) -> Vec<Meeting> {
        let mut meter = Meter::new(1.5);
        for piece in track.windows(2) {
            let ((from, x), (to, y)) = (piece[0], piece[1]);
            let speed = (y - x) / (to - from);
            let ticks = ((to - from) * 50.0).round() as i64;
            for i in 0..ticks {
                let s = from + i as f64 / 50.0;
                let at = Point::new(x + speed * (s - from), 0.0);
                let robot = RobotNear { at, velocity: Vector::new(speed, 0.0) };
                let person = Person { worker: 0, at: Point::origin(), speed_mps: 0.7 };
                meter.look(Time::from_secs_f64(s), RobotId(0), &robot, &person);
            }
        }
        meter.figures.meetings
    }

    #[test]
    fn one_pass_is_one_meeting_with_its_closest_distance_and_both_speeds() {
        let met = meetings(&[(0.0, -5.0), (10.0, 5.0)]);
        assert_eq!(met.len(), 1);
        let m = met[0];
        assert!((m.began.as_secs_f64() - 3.5).abs() < 0.05 && m.closest_m < 0.02, "{m:?}");
        assert!((m.robot_mps - 1.0).abs() < 1e-9 && m.worker_mps == 0.7, "{m:?}");
    }

    #[test]
    fn going_out_by_less_than_the_hysteresis_is_still_the_same_meeting() {
        assert_eq!(meetings(&[(0.0, 3.0), (2.0, 1.2), (6.0, 1.7), (12.0, 1.0)]).len(), 1);
        assert_eq!(meetings(&[(0.0, 3.0), (2.0, 1.2), (6.0, 2.0), (12.0, 1.0)]).len(), 2);
    }

    #[test]
    fn back_within_two_seconds_is_no_new_meeting() {
        let back_after =
            |s: f64| meetings(&[(0.0, 3.0), (2.0, 1.2), (3.0, 2.2), (3.0 + s, 0.9), (12.0, 0.8)]).len();
        // It is out from 2.6 s on, and comes in again on the way back.
        assert_eq!(back_after(8.0), 2);
        let quick = meetings(&[(0.0, 3.0), (2.0, 1.2), (3.0, 2.2), (3.5, 1.2), (4.0, 2.5), (9.0, 2.5)]);
        assert_eq!(quick.len(), 1, "{quick:?}");
    }

    #[test]
    fn a_robot_that_stands_is_met_only_when_it_drives_nearer() {
        let mut meter = Meter::new(1.5);
        let mut look = |s: f64, speed: f64| {
            let robot = RobotNear { at: Point::new(1.0, 0.0), velocity: Vector::new(speed, 0.0) };
            let person = Person { worker: 0, at: Point::origin(), speed_mps: 1.0 };
            meter.look(Time::from_secs_f64(s), RobotId(0), &robot, &person);
            meter.figures.meetings.len()
        };
        assert_eq!(look(0.0, 0.0), 0);
        assert_eq!(look(1.0, 0.5), 0, "it drives away");
        assert_eq!(look(2.0, -0.5), 1);
    }

    #[test]
    fn a_contact_is_counted_once_and_breaks_the_law_only_where_the_robot_drives_on() {
        let mut meter = Meter::new(1.5);
        meter.touch(RobotId(0), 0, true, 0.5, true);
        meter.touch(RobotId(0), 0, true, 0.5, false);
        assert_eq!((meter.figures.contacts, meter.run_over.len()), (1, 0));
        meter.touch(RobotId(0), 0, false, 0.5, false);
        meter.touch(RobotId(0), 0, true, 0.5, false);
        assert_eq!((meter.figures.contacts, meter.run_over.len()), (2, 1));
    }
}
