//! Counts encounters: a moving robot enters region 1 of a worker, or drives nearer after standing inside it.
//!
//! Main types: [`Meter`], [`Meeting`]. An encounter ends when the robot is out of the region by a hysteresis of 0.3 m;
//! the same pair meets again after 2 s at the earliest (DESIGN §8). The same meter measures what the fleet sees and
//! what a simulation knows. Refuses: to judge the cause.

use giveway_floor::geometry::Point;
use giveway_floor::id::{RobotId, WorkerId};
use giveway_floor::time::{Span, Time};
use std::collections::BTreeMap;

/// Additional distance at which a robot counts as out of the region, metres.
const HYSTERESIS_M: f64 = 0.3;
/// Time within which the same pair does not meet again.
const REARM: Span = Span::from_secs(2);
/// A robot slower than this does not move, metres per second.
pub const MOVES_MPS: f64 = 0.05;
/// A robot that comes nearer than this from one look to the next drives nearer, metres.
const NEARER_M: f64 = 0.003;

/// A robot near a worker, at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    /// The worker.
    pub worker: WorkerId,
    /// The robot.
    pub robot: RobotId,
    /// Position of the worker.
    pub at: Point,
    /// Position of the robot.
    pub robot_at: Point,
    /// Radius of region 1, metres.
    pub radius_m: f64,
    /// Distance between the centres, metres.
    pub distance_m: f64,
    /// Speed of the robot, metres per second.
    pub robot_mps: f64,
    /// Speed of the worker, metres per second.
    pub worker_mps: f64,
}

impl Near {
    /// Whether the robot is nearer to the worker's present place than it was from its position `before`.
    fn has_come_nearer_from(&self, before: Point) -> bool {
        (self.robot_at - self.at).norm() < (before - self.at).norm() - NEARER_M
    }
}

/// An encounter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// State of the pair at the beginning.
    pub start: Near,
    /// Time of the beginning.
    pub began: Time,
    /// Closest distance between the centres, metres.
    pub closest_m: f64,
}

impl Meeting {
    /// The worker and the robot that meet.
    pub fn pair(&self) -> (WorkerId, RobotId) {
        (self.start.worker, self.start.robot)
    }
}

/// Pairs that meet, or met recently.
#[derive(Clone, Debug, Default)]
pub struct Meter {
    open: BTreeMap<(WorkerId, RobotId), Meeting>,
    over: BTreeMap<(WorkerId, RobotId), Time>,
    /// For each pair that is near: whether it was inside at the last look, and where the robot was.
    near: BTreeMap<(WorkerId, RobotId), (bool, Point)>,
    begun: u64,
}

impl Meter {
    /// How many encounters have begun.
    pub fn begun(&self) -> u64 {
        self.begun
    }

    /// Encounters in progress.
    pub fn open(&self) -> impl Iterator<Item = &Meeting> {
        self.open.values()
    }

    /// Checks all pairs near each other; returns the encounters that have ended.
    pub fn observe(&mut self, now: Time, near: &[Near]) -> Vec<Meeting> {
        let mut still: BTreeMap<(WorkerId, RobotId), (bool, Point)> = BTreeMap::new();
        for n in near {
            let pair = (n.worker, n.robot);
            let before = self.near.get(&pair).copied();
            let was_inside = before.is_some_and(|(inside, _)| inside);
            let limit = if was_inside { n.radius_m + HYSTERESIS_M } else { n.radius_m };
            let inside = n.distance_m <= limit;
            still.insert(pair, (inside, n.robot_at));
            if !inside {
                continue;
            }
            let moves = n.robot_mps > MOVES_MPS;
            if let Some(meeting) = self.open.get_mut(&pair) {
                meeting.closest_m = meeting.closest_m.min(n.distance_m);
            } else if moves
                && (!was_inside || before.is_some_and(|(_, from)| n.has_come_nearer_from(from)))
                && self.over.get(&pair).is_none_or(|t| now - *t >= REARM)
            {
                let meeting = Meeting { start: *n, began: now, closest_m: n.distance_m };
                self.open.insert(pair, meeting);
                self.begun += 1;
            }
        }
        self.near = still;
        let is_out = |p: &&(WorkerId, RobotId)| !self.near.get(p).is_some_and(|(inside, _)| *inside);
        let ended: Vec<_> = self.open.keys().filter(is_out).copied().collect();
        self.over.retain(|_, t| now - *t < REARM);
        ended
            .into_iter()
            .map(|pair| {
                self.over.insert(pair, now);
                self.open.remove(&pair).expect("just found")
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(distance_m: f64, robot_mps: f64) -> Near {
        Near {
            worker: WorkerId(0),
            robot: RobotId(0),
            at: Point::origin(),
            robot_at: Point::new(distance_m, 0.0),
            radius_m: 1.2,
            distance_m,
            robot_mps,
            worker_mps: 1.0,
        }
    }

    /// Counts encounters for distances and robot speeds every half second; gives how many began and how many ended.
    fn count(track: &[(f64, f64)]) -> (u64, usize) {
        let mut meter = Meter::default();
        let mut ended = 0;
        for (i, (d, v)) in track.iter().enumerate() {
            ended += meter.observe(Time(i as i64 * 500_000), &[near(*d, *v)]).len();
        }
        (meter.begun(), ended)
    }

    #[test]
    fn a_robot_that_drives_into_region_1_and_out_again_meets_once() {
        assert_eq!(count(&[(2.0, 1.0), (1.1, 1.0), (0.9, 0.5), (1.4, 1.0), (1.6, 1.0)]), (1, 1));
    }

    #[test]
    fn trembling_at_the_border_is_one_encounter() {
        assert_eq!(count(&[(1.3, 1.0), (1.1, 1.0), (1.3, 1.0), (1.1, 1.0), (1.3, 1.0), (2.0, 1.0)]), (1, 1));
    }

    #[test]
    fn a_robot_that_stands_meets_nobody_even_if_it_leaves_then() {
        assert_eq!(count(&[(2.0, 0.0), (1.0, 0.0), (0.8, 0.0), (0.9, 0.5), (2.0, 1.0)]), (0, 0));
    }

    #[test]
    fn a_robot_that_stood_within_and_drives_nearer_meets() {
        assert_eq!(count(&[(2.0, 0.0), (1.0, 0.0), (1.0, 0.0), (0.9, 0.5), (2.0, 1.0)]), (1, 1));
    }

    #[test]
    fn a_worker_who_walks_nearer_to_a_robot_that_drives_off_is_not_met() {
        let mut meter = Meter::default();
        for (step, worker_m) in [0.0, 0.3, 0.6].into_iter().enumerate() {
            let (at, robot_at) = (Point::new(worker_m, 0.0), Point::new(1.0 + step as f64 * 0.1, 0.0));
            let robot_mps = if step == 0 { 0.0 } else { 0.2 };
            let distance_m = (at - robot_at).norm();
            meter.observe(
                Time(step as i64 * 500_000),
                &[Near { at, robot_at, ..near(distance_m, robot_mps) }],
            );
        }
        assert_eq!(meter.begun(), 0);
    }

    #[test]
    fn the_same_pair_meets_again_only_after_two_seconds() {
        let soon = [(1.0, 1.0), (2.0, 1.0), (1.0, 1.0), (2.0, 1.0)];
        assert_eq!(count(&soon).0, 1);
        let later = [(1.0, 1.0), (2.0, 1.0), (2.0, 1.0), (2.0, 1.0), (2.0, 1.0), (2.0, 1.0), (1.0, 1.0)];
        assert_eq!(count(&later).0, 2);
    }

    #[test]
    fn a_robot_that_vanishes_ends_its_encounter() {
        let mut meter = Meter::default();
        meter.observe(Time(0), &[near(1.0, 1.0)]);
        assert_eq!(meter.observe(Time(1_000_000), &[]).len(), 1);
    }

    #[test]
    fn it_knows_how_near_the_robot_was() {
        let mut meter = Meter::default();
        let mut ended = Vec::new();
        for (i, (d, v)) in [(1.1, 1.0), (0.7, 0.0), (0.7, 0.0), (2.0, 1.0)].iter().enumerate() {
            ended.extend(meter.observe(Time(i as i64 * 500_000), &[near(*d, *v)]));
        }
        assert_eq!((ended[0].pair(), ended[0].closest_m), ((WorkerId(0), RobotId(0)), 0.7));
    }
}
