//! Tests in which robots drive whole corridors, planned tick by tick.

use super::*;
use crate::human::{Mixture, Part};
use giveway_floor::geometry::{Point, Pose, Segment, Vector};
use giveway_floor::warehouse::{Corridor, Footprint, Hull};
use nalgebra::Matrix2;

const LIMITS: DriveLimits = DriveLimits {
    speed_mps: 1.0,
    accel_mps2: 0.8,
    brake_mps2: 0.8,
    turn_rps: 1.2,
    turn_accel_rps2: 2.5,
    react_s: 0.3,
    period_s: 0.1,
};

/// Random-looking numbers, the same every time.
struct Lcg(u64);

impl Lcg {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
}

fn truck() -> Footprint {
    let corners = [(-0.4, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.4, 0.3)];
    Footprint::Polygon { corners: corners.map(|(x, y)| Point::new(x, y)).to_vec(), turns: true }
}

/// The forecast of a person who goes on as now.
fn straight_on(at: Point, velocity: Vector) -> Vec<Mixture> {
    let part = |k: usize| {
        let t = AHEAD_STEP_S * (k + 1) as f64;
        Part { weight: 1.0, mean: at + velocity * t, cov: Matrix2::identity() * (0.05 + 0.1 * t).powi(2) }
    };
    (0..AHEAD_STEPS).map(|k| Mixture { parts: vec![part(k)] }).collect()
}

/// A corridor along a slanted line, a robot at its start, and a person who walks.
struct Trial {
    lane: Segment,
    corridor: Corridor,
    footprint: Footprint,
    person: Point,
    velocity: Vector,
}

/// Result of a trip: all poses, and when the robot arrived.
struct LocalTrip {
    poses: Vec<Pose>,
    people: Vec<Point>,
    arrived: bool,
}

impl Trial {
    fn floor(&self) -> Hull {
        self.footprint.free(self.lane, self.corridor)
    }

    fn drive(&self, method: LocalMethod, ticks: usize) -> LocalTrip {
        let planner = LocalPlanner::new(&self.footprint, LIMITS, self.lane, self.corridor, method);
        let pose = Pose { at: self.lane.a, heading: self.lane.heading() };
        let mut state = DriveState { pose, twist: Twist::default() };
        let (mut person, mut trip) =
            (self.person, LocalTrip { poses: vec![pose], people: vec![self.person], arrived: false });
        for _ in 0..ticks {
            let ahead = straight_on(person, self.velocity);
            let near = NearPerson { at: person, velocity: self.velocity, ahead: &ahead };
            let twist = planner.choose(&state, self.lane.b, &[near]);
            assert_eq!(
                twist,
                planner.choose(&state, self.lane.b, &[near]),
                "the same question, the same answer"
            );
            assert!((0.0..=LIMITS.speed_mps).contains(&twist.speed_mps), "{twist:?}");
            let change = twist.speed_mps - state.twist.speed_mps;
            assert!((-0.08 - 1e-9..=0.08 + 1e-9).contains(&change), "motor and brakes: {change}");
            state = DriveState { pose: twist.moved(state.pose, LIMITS.period_s), twist };
            person += self.velocity * LIMITS.period_s;
            trip.poses.push(state.pose);
            trip.people.push(person);
            if (state.pose.at - self.lane.b).norm() < 0.06 {
                trip.arrived = true;
                break;
            }
        }
        trip
    }
}

fn east(length_m: f64, side_m: f64, person: (f64, f64), velocity: (f64, f64)) -> Trial {
    Trial {
        lane: Segment { a: Point::origin(), b: Point::new(length_m, 0.0) },
        corridor: Corridor { left_m: side_m, right_m: side_m },
        footprint: truck(),
        person: Point::new(person.0, person.1),
        velocity: Vector::new(velocity.0, velocity.1),
    }
}

fn methods() -> [LocalMethod; 3] {
    [
        LocalMethod::Line,
        LocalMethod::Traditional(TraditionalWeights::default()),
        LocalMethod::Improved(ImprovedWeights::default()),
    ]
}

#[test]
fn no_outline_ever_leaves_its_corridor_whoever_walks_there() {
    let mut dice = Lcg(5);
    for k in 0..12 {
        let angle = dice.between(-3.1, 3.1);
        let a = Point::new(dice.between(-5.0, 5.0), dice.between(-5.0, 5.0));
        let along = Vector::new(angle.cos(), angle.sin());
        let length = dice.between(4.0, 9.0);
        let heading = dice.between(-3.1, 3.1);
        let walking = dice.between(0.0, 1.5);
        let across = Vector::new(-along.y, along.x);
        let footprints = [truck(), Footprint::Circle { radius_m: 0.4 }, Footprint::Square { side_m: 0.7 }];
        let trial = Trial {
            lane: Segment { a, b: a + along * length },
            corridor: Corridor { left_m: dice.between(0.0, 2.5), right_m: dice.between(0.0, 2.5) },
            footprint: footprints[k % 3].clone(),
            person: a + along * dice.between(0.0, length) + across * dice.between(-3.0, 3.0),
            velocity: Vector::new(heading.cos(), heading.sin()) * walking,
        };
        let floor = trial.floor();
        for method in methods() {
            let trip = trial.drive(method, 100);
            let inside = |p: &&Pose| floor.holds(&trial.footprint.at(**p), 1e-9);
            let outside = trip.poses.iter().find(|p| !inside(p));
            assert_eq!(outside, None, "{method:?} in scene {k}");
        }
    }
}

#[test]
fn with_nobody_there_all_drive_straight_to_the_goal_as_fast_as_they_can() {
    for method in methods() {
        let trip = east(6.0, 2.0, (-30.0, 20.0), (0.0, 0.0)).drive(method, 100);
        assert!(trip.arrived, "{method:?}");
        assert!(trip.poses.len() < 85, "{method:?}: {} ticks", trip.poses.len());
        assert!(trip.poses.iter().all(|p| p.at.y.abs() < 0.05), "{method:?}");
    }
}

#[test]
fn on_a_lane_as_narrow_as_the_robot_it_waits_before_whoever_stands_in_it() {
    for method in [methods()[0], methods()[2]] {
        let trip = east(8.0, 0.3, (5.0, 0.0), (0.0, 0.0)).drive(method, 300);
        let last = trip.poses.last().unwrap().at;
        assert!(!trip.arrived && last.x > 1.5 && last.x < 5.0 - 1.5, "{method:?}: {last}");
    }
}

#[test]
fn behind_a_worker_who_crosses_the_improved_one_passes_and_arrives_no_later_than_who_keeps_to_the_line() {
    for side in [1.0, -1.0] {
        let trial = east(8.0, 2.5, (4.0, -3.2 * side), (0.0, 0.8 * side));
        let [line, _, improved] = methods().map(|m| trial.drive(m, 400));
        assert!(line.arrived && improved.arrived);
        assert!(
            improved.poses.len() <= line.poses.len() + 10,
            "{} {}",
            improved.poses.len(),
            line.poses.len()
        );
        let passing = improved.poses.iter().zip(&improved.people).find(|(p, w)| p.at.x >= w.x).unwrap();
        assert!((passing.1.y - passing.0.at.y) * side > 1.2, "behind the worker: {passing:?}");
    }
}

#[test]
fn the_traditional_window_goes_round_who_stands_beside_the_line_and_neither_comes_nearer_than_it_may() {
    let trial = east(10.0, 3.0, (5.0, 1.0), (0.0, 0.0));
    let [line, traditional, improved] = methods().map(|m| trial.drive(m, 400));
    assert!(!line.arrived, "on the line there is no way past");
    assert!(traditional.arrived);
    for (trip, least_m) in [(traditional, 1.0), (improved, 1.8)] {
        let nearest = trip.poses.iter().map(|p| (p.at - trial.person).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest > least_m, "{nearest}");
    }
}
