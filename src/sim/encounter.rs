//! Encounters of robots and people, measured where both truly are, and whether they touch.
//!
//! Main types: [`EncounterMeter`], [`EncounterFigures`]. What an encounter is, is said once, in [`aware::Meter`].
//! Refuses: what the fleet believes.

use super::walker::RobotNear;
use crate::aware::{self, Near};
use crate::geometry::Point;
use crate::id::{Dense, RobotId, WorkerId};
use crate::time::{Span, Time};
use std::collections::BTreeSet;

/// Pairs farther apart than the radius by this are of no interest, metres.
const BEYOND_M: f64 = 1.0;

/// What a run came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EncounterFigures {
    /// Moving robots that came into region 1 of a worker.
    pub encounters: u64,
    /// Least distance between the centres in any of them, metres.
    pub closest_m: Option<f64>,
    /// Time of workers on the floor.
    pub worker_time: Span,
    /// How often a robot's square and a worker's body touched.
    pub contacts: u64,
}

/// Watches robots and workers.
#[derive(Debug)]
pub struct EncounterMeter {
    radius_m: f64,
    inner: aware::Meter,
    near: Vec<Near>,
    touching: BTreeSet<(RobotId, usize)>,
    /// Robots that drove on into a worker, with the worker: a broken law.
    pub run_over: Vec<(RobotId, usize)>,
    /// What was measured.
    pub figures: EncounterFigures,
}

/// A worker as the meter sees it.
#[derive(Clone, Copy, Debug)]
pub struct MeteredPerson {
    /// Its number.
    pub worker: usize,
    /// Where it is.
    pub at: Point,
    /// How fast it walks, metres per second.
    pub speed_mps: f64,
}

impl EncounterMeter {
    /// A meter for meetings within this radius, metres.
    pub fn new(radius_m: f64) -> EncounterMeter {
        EncounterMeter {
            radius_m,
            inner: aware::Meter::default(),
            near: Vec::new(),
            touching: BTreeSet::new(),
            run_over: Vec::new(),
            figures: EncounterFigures::default(),
        }
    }

    /// Counts the time of those on the floor.
    pub fn pass_time(&mut self, people: usize, span: Span) {
        self.figures.worker_time += span * people as i64;
    }

    /// Looks at a robot and a worker; [`EncounterMeter::count_pairs`] counts when all pairs were looked at.
    pub fn look(&mut self, robot: RobotId, seen: &RobotNear, person: &MeteredPerson) {
        let distance_m = (person.at - seen.at).norm();
        if distance_m > self.radius_m + BEYOND_M {
            return;
        }
        self.near.push(Near {
            worker: WorkerId::at(person.worker),
            robot,
            at: person.at,
            radius_m: self.radius_m,
            distance_m,
            robot_mps: seen.velocity.norm(),
            worker_mps: person.speed_mps,
        });
    }

    /// Counts what all pairs that were looked at mean.
    pub fn count_pairs(&mut self, now: Time) {
        let ended = self.inner.observe(now, &self.near);
        self.near.clear();
        let figures = &mut self.figures;
        figures.encounters = self.inner.begun();
        let closest = self.inner.open().chain(&ended).map(|m| m.closest_m);
        figures.closest_m = closest.chain(figures.closest_m).reduce(f64::min);
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

    #[test]
    fn one_pass_is_one_encounter_with_its_closest_distance() {
        let mut meter = EncounterMeter::new(1.5);
        for i in 0..500 {
            let at = Point::new(-5.0 + i as f64 / 50.0, 0.3);
            let robot = RobotNear { at, velocity: Vector::new(1.0, 0.0), half_m: 0.45 };
            let person = MeteredPerson { worker: 0, at: Point::origin(), speed_mps: 0.7 };
            meter.look(RobotId(0), &robot, &person);
            meter.count_pairs(Time(i * 20_000));
        }
        assert_eq!(meter.figures.encounters, 1);
        assert!((meter.figures.closest_m.unwrap() - 0.3).abs() < 1e-9);
    }

    #[test]
    fn a_contact_is_counted_once_and_breaks_the_law_only_where_the_robot_drives_on() {
        let mut meter = EncounterMeter::new(1.5);
        meter.touch(RobotId(0), 0, true, 0.5, true);
        meter.touch(RobotId(0), 0, true, 0.5, false);
        assert_eq!((meter.figures.contacts, meter.run_over.len()), (1, 0));
        meter.touch(RobotId(0), 0, false, 0.5, false);
        meter.touch(RobotId(0), 0, true, 0.5, false);
        assert_eq!((meter.figures.contacts, meter.run_over.len()), (2, 1));
    }
}
