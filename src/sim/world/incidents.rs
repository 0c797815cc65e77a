//! Faults at a chosen moment of a chosen robot or worker, for experiments and tests; faults by a scenario's rates are
//! drawn in `world/mod.rs`.
//!
//! Refuses: to choose.

use super::World;
use giveway_fleet::{Fault, RackAt};
use giveway_floor::geometry::Point;
use giveway_floor::id::{Dense, NodeId, RackId, RobotId, WorkerId};
use giveway_floor::time::{Span, Time};

impl World {
    /// Breaks a robot until `until`, for tests.
    pub fn fail(&mut self, robot: RobotId, until: Time) {
        self.afflict(robot, Fault::Broken, until);
    }

    /// Gives a robot a fault until `until`.
    pub fn afflict(&mut self, robot: RobotId, fault: Fault, until: Time) {
        let body = &mut self.robots[robot.ix()].body;
        match fault {
            Fault::Manual => body.take_over(until),
            _ => body.fault = Some((fault, until)),
        }
    }

    /// Empties the battery of a robot, for tests.
    pub fn drain(&mut self, robot: RobotId) {
        self.set_battery(robot, 0.0);
    }

    /// Sets the charge of a robot's battery, as a share of 1.
    pub fn set_battery(&mut self, robot: RobotId, charge: f64) {
        self.robots[robot.ix()].body.set_battery(charge);
    }

    /// Mutes a robot's radio until `until`: it reports nothing, but hears.
    pub fn mute(&mut self, robot: RobotId, until: Time) {
        self.robots[robot.ix()].mute_until = Some(until);
    }

    /// People push a standing robot to a place between nodes. Gives whether that was possible.
    pub fn push_away(&mut self, robot: RobotId) -> bool {
        if !self.robots[robot.ix()].body.can_be_pushed() {
            return false;
        }
        // So that people push the robot onto a node later.
        self.pushes = true;
        let before = self.pushed;
        self.push(robot.ix(), false, (self.now, self.now));
        self.pushed > before
    }

    /// Silences the headset of a worker until `until`. Gives whether there is one.
    pub fn silence(&mut self, worker: WorkerId, until: Time) -> bool {
        self.crew.as_mut().is_some_and(|crew| crew.silence(worker, until))
    }

    /// Puts a robot at a place, for tests.
    ///
    /// # Panics
    /// On a map without nodes, which no validated one is.
    pub fn put(&mut self, robot: RobotId, at: Point) {
        let off = |n: &NodeId| (self.warehouse.nodes[*n].at - at).norm();
        let nearest = self.warehouse.nodes.ids().min_by(|a, b| off(a).total_cmp(&off(b))).expect("some node");
        let robot = &mut self.robots[robot.ix()];
        robot.body.put(at, nearest);
        robot.push_on = Some(self.now + Span::from_secs_f64(self.faults.repair_s));
        self.pushed += 1;
    }

    /// Changes or removes the rack on a robot, for tests.
    pub fn load(&mut self, robot: RobotId, rack: Option<RackId>) {
        let robot = &mut self.robots[robot.ix()];
        (robot.body.rack, robot.had) = (rack, rack);
    }

    /// People take the rack off a robot and set it down, for tests.
    pub fn take_rack(&mut self, (rack, robot): (RackId, RobotId), node: NodeId) {
        self.racks[rack] = RackAt::Stored(node);
        self.load(robot, None);
    }
}
