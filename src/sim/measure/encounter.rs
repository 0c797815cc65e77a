//! Encounters of robots and people, measured where both truly are, and whether they touch.
//!
//! Main types: [`EncounterMeter`], [`EncounterFigures`], [`Ring`]. [`aware::Meter`] is the one definition of an
//! encounter. Which radius counts as near is a matter of opinion, so everything is also measured within each of
//! [`RINGS_M`]. Refuses: what the fleet believes.

use crate::walker::RobotNear;
use giveway_floor::geometry::Point;
use giveway_floor::id::{Dense, RobotId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_people::aware::{self, Near};
use std::collections::BTreeSet;

/// Pairs farther apart than the radius plus this are ignored, metres.
const BEYOND_M: f64 = 1.0;
/// Radii within which encounters are counted besides the scenario's own, metres.
pub const RINGS_M: [f64; 6] = [1.0, 1.2, 1.5, 2.0, 2.5, 3.0];

/// Encounters within one distance of workers.
#[derive(Clone, Debug, PartialEq)]
pub struct Ring {
    /// The distance between the centres of robot and worker, metres.
    pub radius_m: f64,
    /// Moving robots that came within it, or drove nearer after they stood within it.
    pub entries: u64,
    /// How long robots within the radius drove towards a worker, summed over all pairs.
    pub towards: Span,
    /// Highest speed at which a robot within the radius drove towards a worker, metres per second.
    pub fastest_mps: f64,
    /// Least distance between the centres in each of the entries, metres, in no particular order.
    pub closest_m: Vec<f64>,
}

/// Figures of encounters in one run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EncounterFigures {
    /// Moving robots that came into region 1 of a worker.
    pub encounters: u64,
    /// Least distance between the centres in any of these encounters, metres.
    pub closest_m: Option<f64>,
    /// Time of workers on the floor.
    pub worker_time: Span,
    /// How often a robot's square and a worker's body touched.
    pub contacts: u64,
    /// Metres that all robots drove while workers were on the floor.
    pub driven_m: f64,
    /// Encounters within each of [`RINGS_M`].
    pub rings: Vec<Ring>,
}

/// Measures encounters of robots and workers.
#[derive(Debug)]
pub struct EncounterMeter {
    radius_m: f64,
    inner: aware::Meter,
    rings: [aware::Meter; RINGS_M.len()],
    near: Vec<Near>,
    /// Duration of the current interval.
    passed: Span,
    touching: BTreeSet<(RobotId, usize)>,
    /// Robots that drove on into a worker, with the worker: a violation.
    pub run_over: Vec<(RobotId, usize)>,
    /// The figures so far.
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
    /// A meter for encounters within this radius, metres.
    pub fn new(radius_m: f64) -> EncounterMeter {
        EncounterMeter {
            radius_m,
            inner: aware::Meter::default(),
            rings: Default::default(),
            near: Vec::new(),
            passed: Span::ZERO,
            touching: BTreeSet::new(),
            run_over: Vec::new(),
            figures: EncounterFigures {
                rings: RINGS_M.map(Ring::empty).into(),
                ..EncounterFigures::default()
            },
        }
    }

    /// Counts the time of people on the floor, and what robots drive meanwhile. Call it before looking at the pairs.
    pub fn pass_time(&mut self, people: usize, robots: &[RobotNear], span: Span) {
        self.passed = span;
        self.figures.worker_time += span * people as i64;
        if people > 0 {
            let speeds: f64 = robots.iter().map(|r| r.velocity.norm()).sum();
            self.figures.driven_m += speeds * span.as_secs_f64();
        }
    }

    /// Adds a pair of robot and worker; [`EncounterMeter::count_pairs`] counts after all pairs.
    pub fn look(&mut self, robot: RobotId, seen: &RobotNear, person: &MeteredPerson) {
        let way = person.at - seen.at;
        let distance_m = way.norm();
        let widest_m = RINGS_M[RINGS_M.len() - 1].max(self.radius_m);
        if distance_m > widest_m + BEYOND_M {
            return;
        }
        let towards_mps = if distance_m > 0.0 { seen.velocity.dot(&way) / distance_m } else { 0.0 };
        for ring in self.figures.rings.iter_mut().filter(|ring| distance_m <= ring.radius_m) {
            if towards_mps > aware::MOVES_MPS {
                ring.towards += self.passed;
                ring.fastest_mps = ring.fastest_mps.max(towards_mps);
            }
        }
        self.near.push(Near {
            worker: WorkerId::at(person.worker),
            robot,
            at: person.at,
            robot_at: seen.at,
            radius_m: self.radius_m,
            distance_m,
            robot_mps: seen.velocity.norm(),
            worker_mps: person.speed_mps,
        });
    }

    /// Counts encounters once all pairs are added.
    pub fn count_pairs(&mut self, now: Time) {
        let ended = self.inner.observe(now, &self.near);
        for ((ring, meter), radius_m) in self.figures.rings.iter_mut().zip(&mut self.rings).zip(RINGS_M) {
            self.near.iter_mut().for_each(|n| n.radius_m = radius_m);
            ring.closest_m.extend(meter.observe(now, &self.near).iter().map(|m| m.closest_m));
            ring.entries = meter.begun();
        }
        self.near.clear();
        let figures = &mut self.figures;
        figures.encounters = self.inner.begun();
        let closest = self.inner.open().chain(&ended).map(|m| m.closest_m);
        figures.closest_m = closest.chain(figures.closest_m).reduce(f64::min);
    }

    /// The figures so far, including open encounters.
    pub fn so_far(&self) -> EncounterFigures {
        let mut figures = self.figures.clone();
        for (ring, meter) in figures.rings.iter_mut().zip(&self.rings) {
            ring.closest_m.extend(meter.open().map(|m| m.closest_m));
            assert_eq!(ring.entries as usize, ring.closest_m.len(), "each entry has its closest distance");
        }
        figures
    }

    /// Records whether a robot and a worker touch. A robot that moves then must be braking.
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

impl Ring {
    fn empty(radius_m: f64) -> Ring {
        Ring { radius_m, entries: 0, towards: Span::ZERO, fastest_mps: 0.0, closest_m: Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::geometry::Vector;

    #[test]
    fn wider_rings_have_more_entries_longer_approaches_and_the_same_closest_distance() {
        let mut meter = EncounterMeter::new(1.5);
        let step = Span::from_millis(20);
        for i in 0..500 {
            let at = Point::new(-5.0 + i as f64 / 50.0, 1.1);
            let robot = RobotNear { at, velocity: Vector::new(1.0, 0.0), half_m: 0.45 };
            meter.pass_time(1, &[robot], step);
            let person = MeteredPerson { worker: 0, at: Point::origin(), speed_mps: 0.7 };
            meter.look(RobotId(0), &robot, &person);
            meter.count_pairs(Time::ZERO + step * i);
        }
        let figures = meter.so_far();
        let entries: Vec<u64> = figures.rings.iter().map(|r| r.entries).collect();
        assert_eq!(entries, [0, 1, 1, 1, 1, 1]);
        assert!((figures.driven_m - 10.0).abs() < 1e-9, "{} m", figures.driven_m);
        for ring in &figures.rings[1..] {
            // Towards the person until they are level, at the rate at which the distance falls.
            let half_chord_m = (ring.radius_m.powi(2) - 1.1_f64.powi(2)).sqrt();
            let until_slow_m = half_chord_m - 0.05 * 1.1;
            assert!((ring.towards.as_secs_f64() - until_slow_m).abs() < 0.05, "{ring:?}");
            assert!((ring.fastest_mps - half_chord_m / ring.radius_m).abs() < 0.02, "{ring:?}");
            assert!((ring.closest_m[0] - 1.1).abs() < 1e-9, "{ring:?}");
        }
    }

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
