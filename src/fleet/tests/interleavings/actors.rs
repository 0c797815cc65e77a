//! Robots and a worker that move in steps: half a lane in a second.
//!
//! Main types: [`StepRobot`], [`FootWorker`]. A robot obeys orders as `sim/robot/` does, but is always on a node, or a
//! number of eighths of a lane from it. It is never pushed and never breaks down.

use crate::{Act, Command, Guidance, GuidanceState, Telemetry, Waypoint};
use giveway_floor::geometry::{Point, Pose, axis_distance};
use giveway_floor::id::{NodeId, RackId, RobotId, WorkerId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::Warehouse;
use giveway_people::human::{Quality, Sighting, SourceId};
use std::collections::VecDeque;

/// Half the side of a robot, metres.
pub(super) const HALF_M: f64 = 0.45;
/// Half the width of a person, metres.
const PERSON_M: f64 = 0.25;
/// A robot's scanner stops it before a person within this distance beyond its side, metres.
const SCAN_M: f64 = 0.5;
/// How far before that person, beyond its side, the robot has come to stand, metres.
const STOPS_M: f64 = 0.35;
/// How far a person walks in a second, metres.
const STRIDE_M: f64 = 1.5;

/// A robot on a node, or on the lane to the next.
#[derive(Clone, Debug)]
pub(super) struct StepRobot {
    pub id: RobotId,
    /// Serial number of the visit that the robot reached last, and its node.
    pub reached: u64,
    pub node: NodeId,
    /// The lane's end node, if the robot is on a lane, and how many eighths of the lane it has driven.
    pub lane: Option<(NodeId, u8)>,
    /// Waypoints that the robot knows and has not reached; if it is to drive back, the visit that it reached last.
    pub path: VecDeque<Waypoint>,
    pub acted: Option<u64>,
    /// What the robot is to do where it stands.
    pub acting: Option<(u64, Act)>,
    pub rack: Option<RackId>,
    pub limit_mps: Option<f64>,
    recalls: u64,
    /// Whether the robot forgot its waypoints between two nodes.
    pub has_forgotten: bool,
    /// Whether the robot drove in this second and would go on, and where it was before.
    speed_mps: f64,
    pub was_at: Point,
    heading: f64,
}

impl StepRobot {
    pub fn new(id: RobotId, node: NodeId, at: Point) -> StepRobot {
        StepRobot {
            id,
            reached: 0,
            node,
            lane: None,
            path: VecDeque::new(),
            acted: None,
            acting: None,
            rack: None,
            limit_mps: None,
            recalls: 0,
            has_forgotten: false,
            speed_mps: 0.0,
            was_at: at,
            heading: 0.0,
        }
    }

    pub fn at(&self, w: &Warehouse) -> Point {
        self.place(w, self.lane)
    }

    fn place(&self, w: &Warehouse, lane: Option<(NodeId, u8)>) -> Point {
        let here = w.nodes[self.node].at;
        lane.map_or(here, |(next, eighths)| here + (w.nodes[next].at - here) * (f64::from(eighths) / 8.0))
    }

    fn known(&self) -> u64 {
        self.path.back().map_or(self.reached, |w| w.serial)
    }

    /// Whether the robot drives back to the node that it reached last.
    fn returns(&self) -> bool {
        self.path.front().is_some_and(|w| w.serial == self.reached)
    }

    /// Takes an order.
    pub fn obey(&mut self, order: &Command) {
        match order {
            Command::Drive { waypoints, recalls, .. } if *recalls >= self.recalls => {
                self.recalls = *recalls;
                self.learn(waypoints);
            }
            Command::Drive { .. } => {}
            Command::Limit(limit) => self.limit_mps = *limit,
            Command::Revoke { reached, number } => {
                let stands = self.speed_mps == 0.0 && self.acting.is_none();
                if stands && *reached == self.reached && *number == self.recalls + 1 {
                    self.has_forgotten |= !self.path.is_empty();
                    self.recalls = *number;
                    self.path.clear();
                }
            }
        }
    }

    /// Takes on the waypoints that the robot does not know yet, as [`Command::Drive`] says.
    fn learn(&mut self, waypoints: &[Waypoint]) {
        let ends_here = waypoints.last().is_some_and(|w| w.serial == self.reached);
        if ends_here && self.has_forgotten && self.path.is_empty() && self.speed_mps == 0.0 {
            self.path.push_back(Waypoint { serial: self.reached, node: self.node, act: None, passes: None });
        } else if !ends_here && self.returns() {
            if self.speed_mps > 0.0 {
                return;
            }
            self.path.clear();
        }
        if let Some((serial, Act::Pick(_))) = self.acting
            && waypoints.iter().any(|w| w.serial > serial)
        {
            (self.acted, self.acting) = (Some(serial), None);
        }
        for w in waypoints {
            if w.serial == self.reached {
                let begins = self.acted < Some(w.serial) && self.acting.is_none() && self.lane.is_none();
                self.acting = w.act.filter(|_| begins).map(|act| (w.serial, act)).or(self.acting);
            } else if w.serial == self.known() + 1 {
                if self.path.is_empty() && self.lane.is_some_and(|(next, _)| next != w.node) {
                    return;
                }
                self.path.push_back(*w);
            }
        }
    }

    /// Where on its lane the robot is after the next second in which it drives, if it may drive: half a lane on, or
    /// less if a person is before it.
    fn next_place(&self, w: &Warehouse, person: Option<Point>) -> Option<(NodeId, u8)> {
        let next = self.path.front().filter(|_| self.acting.is_none() && self.limit_mps != Some(0.0))?;
        let (lane, driven) = self.lane.unwrap_or((next.node, 0));
        let after = |step: u8| {
            let eighths = if self.returns() { driven.saturating_sub(step) } else { (driven + step).min(8) };
            (lane, eighths)
        };
        let here = self.at(w);
        let free = |to: &(NodeId, u8)| person.is_none_or(|p| !scans(here, self.place(w, Some(*to)), p));
        [4, 2, 1].map(after).into_iter().find(free)
    }

    /// Whether a second in which the robot acts would change anything.
    pub fn is_able(&self, w: &Warehouse, person: Option<Point>) -> bool {
        self.acting.is_some() || self.next_place(w, person).is_some()
    }

    /// One second in which the robot does what it may.
    pub fn live(&mut self, w: &Warehouse, person: Option<Point>) {
        self.rest(w);
        if let Some((serial, act)) = self.acting.take() {
            match act {
                Act::Lift(rack) => self.rack = Some(rack),
                Act::Set(_) => self.rack = None,
                Act::Pick(_) | Act::Arrive => {}
            }
            self.acted = Some(serial);
            return;
        }
        let Some((lane, eighths)) = self.next_place(w, person) else { return };
        let next = self.path[0];
        if (eighths == 8 && !self.returns()) || (eighths == 0 && self.returns()) {
            (self.reached, self.node, self.lane, self.has_forgotten) = (next.serial, next.node, None, false);
            self.path.pop_front();
            self.acting = next.act.map(|act| (next.serial, act));
        } else {
            self.lane = Some((lane, eighths));
        }
        let way = self.at(w) - self.was_at;
        if way.norm() > 1e-9 {
            self.heading = way.y.atan2(way.x);
        }
        let goes_on = !self.path.is_empty() && self.acting.is_none();
        self.speed_mps = if goes_on { way.norm() } else { 0.0 };
    }

    /// One second in which the robot is late.
    pub fn rest(&mut self, w: &Warehouse) {
        (self.was_at, self.speed_mps) = (self.at(w), 0.0);
    }

    /// What the robot reports in the middle of the second, or at its end; `before` is its state before the second.
    pub fn report(&self, w: &Warehouse, before: Option<&StepRobot>, now: Time) -> Telemetry {
        let (said, at) = match before {
            Some(before) => (before, nalgebra::center(&self.was_at, &self.at(w))),
            None => (self, self.at(w)),
        };
        let moves = (self.at(w) - self.was_at).norm();
        Telemetry {
            robot: self.id,
            seq: now.0.unsigned_abs(),
            seen: now,
            pose: Pose { at, heading: self.heading },
            speed_mps: if before.is_some() { moves } else { self.speed_mps },
            reached: said.reached,
            known: said.known(),
            acted: said.acted,
            rack: said.rack,
            battery: 1.0,
            fault: None,
            limit_mps: self.limit_mps,
            recalls: self.recalls,
        }
    }
}

/// Whether a scanner sees a person in front of a robot, or too near to where it would come to stand.
fn scans(here: Point, to: Point, person: Point) -> bool {
    let Some(ahead) = (to - here).try_normalize(1e-9) else { return false };
    let (d, reach) = (person - here, HALF_M + PERSON_M);
    let (along, step) = (d.dot(&ahead), (to - here).norm());
    let field = (reach + SCAN_M).max(step + reach + STOPS_M);
    along > 0.0 && along < field && d.perp(&ahead).abs() < reach + 0.05
}

/// What a worker does for a second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FootMove {
    /// Stands.
    Stays,
    /// Walks on along the path that was shown, unless told to stop.
    Follows,
    /// Walks towards a place.
    Towards(Point),
}

/// A worker who is seen at his or her true place.
#[derive(Clone, Debug)]
pub(super) struct FootWorker {
    pub worker: WorkerId,
    pub at: Point,
    pub was_at: Point,
    /// What the worker was told last.
    pub told: Guidance,
    /// The rest of the path that was shown last.
    path: Vec<Point>,
    seq: u64,
}

impl FootWorker {
    pub fn new(worker: WorkerId, at: Point) -> FootWorker {
        FootWorker { worker, at, was_at: at, told: Guidance::default(), path: Vec::new(), seq: 0 }
    }

    pub fn hear(&mut self, told: Guidance) {
        self.path = if told.state == GuidanceState::Stop { Vec::new() } else { told.path.clone() };
        self.told = told;
    }

    /// One second, in which robots drive from one place to another: the worker walks into no robot.
    pub fn live(&mut self, does: FootMove, robots: &[(Point, Point)]) {
        self.was_at = self.at;
        let mut left = STRIDE_M;
        if does == FootMove::Follows {
            while let Some(next) = self.path.first().copied().filter(|_| left > 1e-9) {
                let stride = self.step(next, left, robots);
                left -= stride;
                if (next - self.at).norm() > 1e-9 {
                    return;
                }
                self.path.remove(0);
            }
        } else if let FootMove::Towards(there) = does {
            self.step(there, left, robots);
        }
    }

    /// Walks towards a place, as far as robots leave room; returns how far that was, metres.
    fn step(&mut self, there: Point, most_m: f64, robots: &[(Point, Point)]) -> f64 {
        let way = there - self.at;
        let stride = way.norm().min(most_m);
        if stride < 1e-9 {
            return 0.0;
        }
        let to = self.at + way * (stride / way.norm());
        let near = |p: Point, q: Point| axis_distance(p, q) < HALF_M + PERSON_M + 0.05;
        let hits = |r: Point| near(r, to) && (r - to).norm() < (r - self.at).norm();
        if robots.iter().any(|(from, until)| hits(*from) || hits(*until)) {
            return 0.0;
        }
        self.at = to;
        stride
    }

    /// How the worker is seen in the middle of the second, or at its end.
    pub fn sighting(&mut self, halfway: bool, now: Time) -> Sighting {
        self.seq += 1;
        Sighting {
            mirror: None,
            worker: self.worker,
            seen: now,
            epoch: 0,
            at_marks: true,
            source: SourceId::Headset,
            seq: self.seq,
            at: if halfway { nalgebra::center(&self.was_at, &self.at) } else { self.at },
            heading: None,
            accuracy_m: 0.02,
            quality: Quality::Tracked,
        }
    }
}
