//! The simulated floor: all robots, their radios and the customers.
//!
//! Main type: [`World`]. Refuses: to let the fleet see anything but telemetry and orders.

use super::announce::announce;
use super::crew::{Crew, Presence};
use super::customers::{Customers, OrderLine};
use super::encounter::{Figures, Meter, Person};
use super::link::Link;
use super::random::Stream;
use super::robot::Body;
use super::scenario::{Faults, Scenario};
use super::walker::{RobotNear, Walker};
use crate::fleet::{Closure, Command, Fleet, Guidance, Input, RackAt, Reply, Telemetry};
use crate::geometry::Point;
use crate::id::{Dense, IdVec, NodeId, RackId, RobotId, WorkerId};
use crate::route::Kinematics;
use crate::time::{Span, Time};
use crate::warehouse::{NodeKind, Warehouse};
use std::sync::Arc;

/// Robots and people live side by side in steps of this length at most.
const TICK: Span = Span::from_millis(20);

/// A robot with its radio.
#[derive(Debug)]
struct Robot {
    body: Body,
    /// The rack that was on it when it was looked at last.
    had: Option<RackId>,
    orders: Link<Command>,
    reports: Link<Telemetry>,
    luck: Stream,
}

/// The simulated floor.
#[derive(Debug)]
pub struct World {
    warehouse: Arc<Warehouse>,
    kinematics: Kinematics,
    driving_h: f64,
    faults: Faults,
    seed: u64,
    robots: Vec<Robot>,
    customers: Customers,
    crew: Option<Crew>,
    meter: Meter,
    joining: Vec<(String, NodeId)>,
    /// Where each rack truly is.
    racks: IdVec<RackId, RackAt>,
    /// Racks that were lifted where they did not stand, or set down onto another one.
    misplaced: Vec<(RobotId, RackId)>,
    closing: Vec<Closure>,
    now: Time,
}

impl World {
    /// A floor at `now`. Robots that the fleet knows stand where its ledger has them; missing ones join.
    ///
    /// # Panics
    /// If the map does not have a node that the scenario closes: see [`Scenario::areas`].
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
        let customers = Customers::new(scenario, lines, &warehouse, seed);
        let racks = fleet.ledger().racks.clone();
        let (kinematics, faults) = (scenario.kinematics, scenario.faults);
        // The bound on throughput is without people.
        let crew = if fleet.settings().ghosts { None } else { Crew::new(&warehouse, scenario, seed, now) };
        let meter = Meter::new(scenario.workers.encounter_m);
        let robots = vec![];
        let closing = scenario.areas(&warehouse, now).expect("whoever reads a scenario looks at its areas");
        let mut world = World {
            warehouse,
            kinematics,
            driving_h: scenario.charging.driving_h,
            racks,
            misplaced: Vec::new(),
            faults,
            seed,
            robots,
            customers,
            crew,
            meter,
            joining,
            closing,
            now,
        };
        world.meet(fleet);
        world
    }

    /// Moves everything to `now` and says what is seen and ordered.
    pub fn advance(&mut self, now: Time, fleet: &Fleet) -> Vec<Input> {
        self.meet(fleet);
        let mut inputs = self.customers.order(now, now - self.now, fleet);
        inputs.extend(self.joining.drain(..).map(|(name, node)| Input::Enlist { name, node }));
        inputs.extend(announce(std::mem::take(&mut self.closing), fleet));
        let from = self.now;
        for robot in &mut self.robots {
            while let Some(order) = robot.orders.receive(from) {
                robot.body.obey(&order, &self.warehouse);
            }
            robot.break_down(&self.faults, from, now);
        }
        self.live(from, now);
        self.note_racks();
        inputs.extend(self.picks(fleet));
        for robot in &mut self.robots {
            robot.reports.send(now, robot.body.report(now));
            while let Some(report) = robot.reports.receive(now) {
                inputs.push(Input::Telemetry(report));
            }
        }
        self.now = now;
        if let Some(crew) = &mut self.crew {
            inputs.extend(crew.say(now, fleet));
        }
        inputs
    }

    /// Customers want nothing new from now on.
    pub fn stop_customers(&mut self) {
        self.customers.stop();
    }

    /// Hands over answers to customers.
    pub fn answer(&mut self, now: Time, replies: &[Reply]) {
        replies.iter().for_each(|reply| self.customers.hear(reply, now));
    }

    /// Notes which racks were lifted and set down.
    fn note_racks(&mut self) {
        for robot in &mut self.robots {
            let (id, has) = (robot.body.id, robot.body.rack);
            let had = std::mem::replace(&mut robot.had, has);
            if had == has {
                continue;
            }
            let here = RackAt::Stored(robot.body.node);
            if let Some(rack) = had {
                let taken = self.racks.iter().any(|at| *at == here);
                self.racks[rack] = here;
                self.misplaced.extend(taken.then_some((id, rack)));
            }
            if let Some(rack) = has {
                let there = std::mem::replace(&mut self.racks[rack], RackAt::On(id)) == here;
                self.misplaced.extend((!there).then_some((id, rack)));
            }
        }
    }

    /// What pickers say who have all that was wanted. They say it until their screen shows that it was heard.
    fn picks(&mut self, fleet: &Fleet) -> Vec<Input> {
        let mut said = Vec::new();
        for robot in &self.robots {
            let NodeKind::Station(station) = self.warehouse.nodes[robot.body.node].kind else { continue };
            let id = robot.body.id;
            let serial = fleet.ledger().chain(id).first();
            let works = !fleet.ledger().paused_stations.contains_key(&station);
            if works && robot.body.is_picked(serial) && fleet.is_picked_from(id) {
                said.push(self.customers.pick(station, id, serial));
            }
        }
        said
    }

    /// Where each rack truly is.
    pub fn racks(&self) -> &IdVec<RackId, RackAt> {
        &self.racks
    }

    /// Racks that were lifted where they did not stand, or set down onto another one: for the laws.
    pub fn misplaced(&self) -> &[(RobotId, RackId)] {
        &self.misplaced
    }

    /// The node on which a robot truly stands or which it passed last.
    pub fn node_of(&self, robot: RobotId) -> Option<NodeId> {
        self.robots.get(robot.ix()).map(|r| r.body.node)
    }

    /// Robots and people move. Without people each robot goes alone, which is the same and quicker.
    fn live(&mut self, from: Time, to: Time) {
        if to <= from {
            return;
        }
        let ticks = if self.crew.is_some() { ((to - from).0 + TICK.0 - 1) / TICK.0 } else { 1 };
        let at = |i: i64| from + Span((to - from).0 * i / ticks);
        for i in 0..ticks {
            for robot in &mut self.robots {
                let charging = self.warehouse.nodes[robot.body.node].kind == NodeKind::Charger;
                robot.body.advance(at(i), at(i + 1), charging);
            }
            self.people(at(i), at(i + 1));
        }
    }

    /// People walk, robots look out for them, and both are measured.
    fn people(&mut self, from: Time, to: Time) {
        let Some(crew) = &mut self.crew else { return };
        let near = |r: &Robot| RobotNear { at: r.body.pose.at, velocity: r.body.velocity() };
        let robots: Vec<RobotNear> = self.robots.iter().map(near).collect();
        crew.tick(to, (to - from).as_secs_f64(), &robots);
        let people: Vec<Presence> = crew.present(to).collect();
        let places: Vec<Point> = people.iter().map(|p| p.pose.at).collect();
        let half_m = self.warehouse.footprint_m / 2.0;
        self.meter.pass_time(people.len(), to - from);
        for (robot, near) in self.robots.iter_mut().zip(&robots) {
            robot.body.scan(to, half_m, &places);
            let (id, speed, brakes) = (robot.body.id, robot.body.speed_mps, robot.body.is_guarded());
            for p in &people {
                let person = Person { worker: p.worker, at: p.pose.at, speed_mps: p.speed_mps };
                self.meter.look(id, near, &person);
                self.meter.touch(id, p.worker, near.gap(p.pose.at, half_m) <= 0.0, speed, brakes);
            }
        }
        self.meter.settle(to);
    }

    /// Hands over guidance to workers.
    pub fn tell(&mut self, now: Time, guidance: Vec<(WorkerId, Guidance)>) {
        if let Some(crew) = &mut self.crew {
            guidance.into_iter().for_each(|(worker, g)| crew.tell(now, worker, g));
        }
    }

    /// Meetings of robots and people so far, measured where both truly are.
    pub fn figures(&self) -> &Figures {
        &self.meter.figures
    }

    /// Robots that drove on into a worker, with the number of the worker: for the laws.
    pub fn run_over(&self) -> &[(RobotId, usize)] {
        &self.meter.run_over
    }

    /// Workers that have been on the floor, with the truth about them.
    pub fn walkers(&self) -> impl Iterator<Item = (WorkerId, &Walker)> {
        self.crew.iter().flat_map(|c| c.walkers())
    }

    /// Assignments that workers have truly completed.
    pub fn completed(&self) -> u64 {
        self.crew.as_ref().map_or(0, Crew::completed)
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

    /// Empties the battery of a robot, for tests of what happens then.
    #[cfg(test)]
    pub fn drain(&mut self, robot: RobotId) {
        self.robots[robot.ix()].body.empty_battery();
    }

    /// Bodies for robots that the fleet knows by now.
    fn meet(&mut self, fleet: &Fleet) {
        for i in self.robots.len()..fleet.ledger().robots.len() {
            let id = RobotId::at(i);
            let record = &fleet.ledger().robots[id];
            let node = fleet.ledger().node_of(id);
            let who = i as u64;
            let battery = 0.6 + 0.4 * Stream::new(self.seed, 4, who).unit();
            let at = self.warehouse.nodes[node].at;
            let mut body = Body::new(id, node, at, (battery, self.driving_h), self.kinematics);
            let (reached, rack) = (fleet.ledger().chain(id).first(), fleet.ledger().rack_on(id));
            body.resume(reached, record.acted, record.recalls, rack);
            let delay = Span::from_millis(self.faults.message_delay_ms);
            let loss = self.faults.message_loss;
            self.robots.push(Robot {
                had: body.rack,
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
