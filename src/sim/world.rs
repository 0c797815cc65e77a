//! The simulated floor: all robots, their radios and the customers.
//!
//! Main type: [`World`]. Refuses: to let the fleet see anything but telemetry and orders.

use super::customers::{Customers, OrderLine};
use super::link::Link;
use super::random::Stream;
use super::robot::Body;
use super::scenario::{Faults, Scenario};
use crate::fleet::{Command, Fleet, Input, Telemetry};
use crate::id::{Dense, NodeId, RobotId};
use crate::route::Kinematics;
use crate::time::{Span, Time};
use crate::warehouse::{NodeKind, Warehouse};
use std::sync::Arc;

/// A robot with its radio.
#[derive(Debug)]
struct Robot {
    body: Body,
    orders: Link<Command>,
    reports: Link<Telemetry>,
    luck: Stream,
}

/// The simulated floor.
#[derive(Debug)]
pub struct World {
    warehouse: Arc<Warehouse>,
    kinematics: Kinematics,
    faults: Faults,
    seed: u64,
    robots: Vec<Robot>,
    customers: Customers,
    joining: Vec<(String, NodeId)>,
    now: Time,
}

impl World {
    /// A floor at `now`. Robots that the fleet knows stand where its ledger has them; missing ones join.
    pub fn new(
        warehouse: Arc<Warehouse>,
        scenario: &Scenario,
        lines: &[OrderLine],
        seed: u64,
        fleet: &Fleet,
        now: Time,
    ) -> World {
        let known = fleet.ledger().robots.len();
        let places = starting_places(&warehouse, scenario.robots);
        let joining = places.into_iter().enumerate().skip(known);
        let joining = joining.map(|(i, n)| (format!("robot-{}", i + 1), n)).collect();
        let customers = Customers::new(scenario.demand.clone(), lines, &warehouse, seed);
        let (kinematics, faults) = (scenario.kinematics, scenario.faults);
        let mut world =
            World { warehouse, kinematics, faults, seed, robots: vec![], customers, joining, now };
        world.meet(fleet);
        world
    }

    /// Moves everything to `now` and says what is seen and ordered.
    pub fn advance(&mut self, now: Time, fleet: &Fleet) -> Vec<Input> {
        self.meet(fleet);
        let mut inputs = self.customers.order(now, fleet);
        inputs.extend(self.joining.drain(..).map(|(name, node)| Input::Enlist { name, node }));
        let from = self.now;
        for robot in &mut self.robots {
            while let Some(order) = robot.orders.receive(from) {
                robot.body.obey(&order, &self.warehouse);
            }
            robot.break_down(&self.faults, from, now);
            let charging = self.warehouse.nodes[robot.body.node].kind == NodeKind::Charger;
            if now > from {
                robot.body.advance(from, now, charging);
            }
            robot.reports.send(now, robot.body.report(now));
            while let Some(report) = robot.reports.receive(now) {
                inputs.push(Input::Telemetry(report));
            }
        }
        self.now = now;
        inputs
    }

    /// Hands over orders to robots.
    pub fn command(&mut self, now: Time, commands: Vec<(RobotId, Command)>) {
        for (robot, command) in commands {
            if let Some(robot) = self.robots.get_mut(robot.ix()) {
                robot.orders.send(now, command);
            }
        }
    }

    /// Breaks a robot, for tests of what happens then.
    #[cfg(test)]
    pub fn fail(&mut self, robot: RobotId, until: Time) {
        self.robots[robot.ix()].body.failed_until = Some(until);
    }

    /// Bodies for robots that the fleet knows by now.
    fn meet(&mut self, fleet: &Fleet) {
        for i in self.robots.len()..fleet.ledger().robots.len() {
            let id = RobotId::at(i);
            let record = &fleet.ledger().robots[id];
            let node = fleet.ledger().node_of(id);
            let who = i as u64;
            let battery = 0.6 + 0.4 * Stream::new(self.seed, 4, who).unit();
            let mut body = Body::new(id, node, self.warehouse.nodes[node].at, battery, self.kinematics);
            body.resume(fleet.ledger().chain(id).first(), record.acted, fleet.ledger().rack_on(id));
            let delay = Span::from_millis(self.faults.message_delay_ms);
            let loss = self.faults.message_loss;
            self.robots.push(Robot {
                body,
                orders: Link::new(delay, loss, Stream::new(self.seed, 1, who)),
                reports: Link::new(delay, loss, Stream::new(self.seed, 2, who)),
                luck: Stream::new(self.seed, 5, who),
            });
        }
    }

    /// Where each robot truly is, how fast, and the serial number of the last visit that it knows: for the laws.
    pub fn truth(&self) -> impl Iterator<Item = (RobotId, Telemetry)> {
        self.robots.iter().map(|r| (r.body.id, r.body.report(self.now)))
    }
}

impl Robot {
    fn break_down(&mut self, faults: &Faults, from: Time, to: Time) {
        match self.body.failed_until {
            Some(until) if until <= to => self.body.failed_until = None,
            Some(_) => {}
            None => {
                let hours = (to - from).as_secs_f64() / 3600.0;
                let moving = self.body.speed_mps > 0.0;
                if moving && self.luck.happens(faults.failures_per_hour * hours) {
                    self.body.failed_until = Some(to + Span::from_secs_f64(faults.repair_s));
                }
            }
        }
    }
}

/// Where robots stand at first: chargers, parking places, then beneath racks, spread over the floor.
pub fn starting_places(warehouse: &Warehouse, robots: usize) -> Vec<NodeId> {
    let mut places = warehouse.nodes_where(|k| k == NodeKind::Charger);
    places.extend(warehouse.nodes_where(|k| k == NodeKind::Parking));
    let storage = warehouse.nodes_where(|k| k == NodeKind::Storage);
    let wanted = robots.saturating_sub(places.len());
    let step = (storage.len() / wanted.max(1)).max(1);
    places.extend(storage.iter().copied().step_by(step));
    places.truncate(robots);
    places
}
