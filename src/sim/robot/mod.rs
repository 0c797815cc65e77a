//! A simulated robot: drives along granted waypoints with inertia, turns in place, lifts, waits, breaks down.
//!
//! Main type: [`RobotBody`]. Between two calls it integrates in steps of at most 20 ms. It never drives beyond its
//! orders, and it can always stop before their end. Refuses: to know where others are.

mod beside;
pub(crate) mod beside_log;
mod guard;
mod passing;

use crate::robot::beside::BesideLine;
use crate::robot::guard::Guard;
use crate::walker::BODY_M;
use giveway_fleet::{
    Act, Capabilities, Command, Fault, OFF_ROUTE_M, ObeyedLimits, RobotKind, Telemetry, Waypoint,
};
use giveway_floor::geometry::{Point, Pose, Segment, Vector, turn_between, wrap_angle};
use giveway_floor::id::{NodeId, RackId, RobotId};
use giveway_floor::route::Kinematics;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::{Corridor, Footprint, Warehouse};
use giveway_people::human::Mover;
use std::collections::VecDeque;

/// Longest step of integration, seconds.
const TICK_S: f64 = 0.02;
/// A robot closer than this to a place has arrived, metres.
const THERE_M: f64 = 1e-4;
/// Headings closer than this count as equal, radians.
const STRAIGHT: f64 = 0.1;
/// Battery drain while standing, as a share of the drain while driving.
const STANDING_DRAIN: f64 = 0.2;
/// Time until a worker exchanges a flat battery, and the charge of the new one.
const EXCHANGE: Span = Span::from_secs(900);
const EXCHANGED: f64 = 0.5;
/// Charge gained per second at a charger: a quarter in ten minutes.
const CHARGE_PER_S: f64 = 0.25 / 600.0;

/// A waypoint with its place.
#[derive(Clone, Copy, Debug)]
struct Target {
    serial: u64,
    node: NodeId,
    at: Point,
    act: Option<Act>,
    limit_mps: f64,
    /// The corridor of the lane that leads there, if the robot may leave its line now.
    corridor: Option<Corridor>,
}

/// One robot.
#[derive(Debug)]
pub(crate) struct RobotBody {
    pub id: RobotId,
    pub pose: Pose,
    pub speed_mps: f64,
    /// The visit whose centre the robot reached last; then its node, or the node where people put the robot since.
    pub reached: u64,
    pub node: NodeId,
    /// Where that visit was: people may have pushed the robot elsewhere since.
    stood_at: Point,
    /// The node of that visit.
    pub stood_on: NodeId,
    pub rack: Option<RackId>,
    /// The robot's fault, and until when it lasts.
    pub fault: Option<(Fault, Time)>,
    /// The last speed limit that the robot got, metres per second.
    pub limit_mps: Option<f64>,
    /// How many revocations the robot has obeyed.
    recalls: u64,
    /// Whether the robot forgot its waypoints between two nodes, and people have not moved it since.
    is_halfway: bool,
    battery: f64,
    /// Hours of driving on a full charge.
    driving_h: f64,
    /// Since when the battery has been flat.
    flat_since: Option<Time>,
    acted: Option<u64>,
    /// The action at the current place, and until when it lasts.
    acting: Option<(u64, Act, Option<Time>)>,
    path: VecDeque<Target>,
    kinematics: Kinematics,
    capabilities: Capabilities,
    /// The robot's footprints, without and with a rack.
    footprints: [Footprint; 2],
    /// The robot's own scanner, which may stop it; see `guard`.
    guard: Guard,
    /// Whether the guard of the robot's station stops it because a hand is inside.
    pub hand_guard: bool,
    /// The robot's state beside the line.
    pub beside: BesideLine,
}

impl RobotBody {
    /// A robot standing on a node.
    pub fn new(
        id: RobotId,
        node: NodeId,
        at: Point,
        battery: f64,
        (kind, footprints): (&RobotKind, [Footprint; 2]),
    ) -> RobotBody {
        RobotBody {
            id,
            pose: Pose { at, heading: 0.0 },
            speed_mps: 0.0,
            reached: 0,
            node,
            stood_at: at,
            stood_on: node,
            rack: None,
            fault: None,
            limit_mps: None,
            recalls: 0,
            is_halfway: false,
            battery,
            driving_h: kind.charging.driving_h,
            flat_since: None,
            acted: None,
            acting: None,
            path: VecDeque::new(),
            kinematics: kind.kinematics,
            capabilities: kind.capabilities,
            footprints,
            guard: Guard::default(),
            hand_guard: false,
            beside: BesideLine::new(
                kind.free_navigation,
                [false, true].map(|loaded| kind.drive_limits(loaded, f64::INFINITY)),
            ),
        }
    }

    /// The robot's footprint with its present load.
    pub fn footprint(&self) -> &Footprint {
        &self.footprints[usize::from(self.rack.is_some())]
    }

    /// Whether the robot's outline touches a person, or the outline of the person's vehicle.
    pub fn touches(&self, mover: &Mover, person: Pose) -> bool {
        let robot = self.footprint().at(self.pose);
        match mover {
            Mover::OnFoot => robot.distance_to(person.at) <= BODY_M,
            Mover::Vehicle(vehicle) => {
                let corners = vehicle.outline(Pose { at: Point::origin(), ..person }).to_vec();
                robot.overlaps(&Footprint::Polygon { corners, turns: false }.at(person), 0.0)
            }
        }
    }

    /// Puts the robot in the ledger's state after a restart of the simulation.
    pub fn resume(&mut self, reached: u64, acted: Option<u64>, recalls: u64, rack: Option<RackId>) {
        (self.reached, self.acted, self.recalls, self.rack) = (reached, acted, recalls, rack);
    }

    /// Takes over the heading, charge and faults of another body.
    pub fn stay_as(&mut self, before: &RobotBody) {
        self.pose.heading = before.pose.heading;
        (self.battery, self.flat_since, self.fault) = (before.battery, before.flat_since, before.fault);
    }

    /// People switch the robot off, push it elsewhere and switch it on: it has forgotten its waypoints. `node` is the
    /// nearest node there.
    pub fn put(&mut self, at: Point, node: NodeId) {
        (self.pose.at, self.node, self.speed_mps) = (at, node, 0.0);
        (self.acting, self.is_halfway) = (None, false);
        self.path.clear();
        self.beside.end();
    }

    /// Whether the robot has this fault.
    pub fn has(&self, fault: Fault) -> bool {
        self.fault.is_some_and(|(f, _)| f == fault)
    }

    fn is_immobile(&self) -> bool {
        self.fault.is_some_and(|(fault, _)| fault.is_immobile())
    }

    /// A person drives the robot: it forgets its waypoints.
    pub fn take_over(&mut self, until: Time) {
        self.fault = Some((Fault::Manual, until));
        (self.acting, self.is_halfway) = (None, false);
        self.path.clear();
        self.beside.end();
        self.speed_mps = 0.0;
    }

    /// Whether the robot drives and has a place to reach.
    pub fn is_on_its_way(&self) -> bool {
        self.speed_mps > 0.0 && self.acting.is_none() && !self.path.is_empty() && !self.returns()
    }

    /// Whether the robot stands, does no action and could be pushed.
    pub fn can_be_pushed(&self) -> bool {
        let free = self.fault.is_none_or(|(fault, _)| fault == Fault::Manual);
        self.speed_mps == 0.0 && self.acting.is_none() && free
    }

    /// Whether the robot stands without a rack, whatever the fleet knows of that.
    pub fn can_be_taken(&self) -> bool {
        self.speed_mps == 0.0 && self.rack.is_none()
    }

    /// Whether the robot was pushed elsewhere and has not been told yet where it is.
    pub fn is_astray(&self) -> bool {
        self.path.is_empty() && !self.is_near(self.stood_at)
    }

    fn is_near(&self, at: Point) -> bool {
        (at - self.pose.at).norm() <= OFF_ROUTE_M
    }

    /// Whether the robot stands on the straight line from the last node it reached to another place.
    fn is_on_the_way_to(&self, next: Point) -> bool {
        Segment { a: self.stood_at, b: next }.distance_to(self.pose.at) <= OFF_ROUTE_M
    }

    /// The lanes of the robot's orders, from where it is.
    fn way(&self) -> impl Iterator<Item = Segment> + '_ {
        let from = std::iter::once(self.pose.at).chain(self.path.iter().map(|t| t.at));
        from.zip(self.path.iter().map(|t| t.at)).map(|(a, b)| Segment { a, b })
    }

    /// The lanes of the robot's orders, from where it is, and those on which its next order may send it.
    pub fn ways_soon(&self, warehouse: &Warehouse) -> Vec<Segment> {
        let end = self.path.back().map_or(self.pose.at, |t| t.at);
        let at = |node: NodeId| warehouse.nodes[node].at;
        let onward = |node: NodeId| {
            warehouse
                .ways(node)
                .map(move |(_, way)| Segment { a: at(node), b: at(way.to) })
                .collect::<Vec<_>>()
        };
        let next = warehouse.nodes_within(end, OFF_ROUTE_M).into_iter().flat_map(onward);
        self.way().chain(next).collect()
    }

    /// Whether the robot stops when told to.
    pub fn obeys_stops(&self) -> bool {
        self.capabilities.limits != ObeyedLimits::Nothing
    }

    /// Serial number of the last waypoint the robot knows.
    pub fn known(&self) -> u64 {
        self.path.back().map_or(self.reached, |t| t.serial)
    }

    /// Whether the robot drives back to the node that it reached last.
    fn returns(&self) -> bool {
        self.path.front().is_some_and(|t| t.serial == self.reached)
    }

    /// Takes an order.
    pub fn obey(&mut self, order: &Command, warehouse: &Warehouse) {
        match order {
            Command::Drive { waypoints, recalls, .. } if *recalls >= self.recalls => {
                self.recalls = *recalls;
                self.learn(waypoints, warehouse);
            }
            Command::Drive { .. } => {}
            Command::Limit(limit) => match self.capabilities.limits {
                ObeyedLimits::Speeds => self.limit_mps = *limit,
                ObeyedLimits::Stops => self.limit_mps = limit.filter(|mps| *mps == 0.0),
                ObeyedLimits::Nothing => {}
            },
            Command::Revoke { .. } if !self.capabilities.revocation => {}
            Command::Revoke { reached, number } => self.forget(*reached, *number),
        }
    }

    /// A robot that stands on a node or on the way to the next one forgets all its waypoints.
    fn forget(&mut self, reached: u64, number: u64) {
        let next = self.path.front().map_or(self.stood_at, |t| t.at);
        let stands = self.speed_mps == 0.0 && self.acting.is_none() && self.is_on_the_way_to(next);
        if self.is_immobile() || !stands || reached != self.reached || number != self.recalls + 1 {
            return;
        }
        self.is_halfway |= !self.path.is_empty();
        self.recalls = number;
        self.path.clear();
        self.beside.end();
    }

    /// An order that ends with the last reached visit brings a robot that has forgotten its waypoints back there; any
    /// other order turns it round again, once it stands. Gives whether the robot takes on the order.
    fn turn(&mut self, waypoints: &[Waypoint], warehouse: &Warehouse) -> bool {
        let ends_here = waypoints.last().is_some_and(|w| w.serial == self.reached);
        if ends_here
            && self.capabilities.drives_back
            && self.is_halfway
            && self.path.is_empty()
            && self.speed_mps == 0.0
        {
            let (serial, node, at) = (self.reached, self.node, warehouse.nodes[self.node].at);
            self.path.push_back(Target {
                serial,
                node,
                at,
                act: None,
                limit_mps: f64::INFINITY,
                corridor: None,
            });
        } else if !ends_here && self.returns() {
            if self.speed_mps > 0.0 {
                return false;
            }
            self.path.clear();
        }
        true
    }

    /// An order that begins after all known waypoints is for the place where people put the robot, if it stands there.
    fn take_up(&mut self, first: &Waypoint, warehouse: &Warehouse) {
        let at = warehouse.nodes[first.node].at;
        if first.serial > self.known() && self.path.is_empty() && self.speed_mps == 0.0 && self.is_near(at) {
            (self.reached, self.node) = (first.serial, first.node);
            (self.stood_at, self.stood_on) = (at, first.node);
            self.acting = None;
        }
    }

    /// Skips known waypoints, and begins an action for the place where the robot stands. A robot that was pushed
    /// elsewhere meanwhile takes no waypoint whose lane it does not stand on, and does no action meant for another
    /// place.
    fn learn(&mut self, waypoints: &[Waypoint], warehouse: &Warehouse) {
        if !self.turn(waypoints, warehouse) {
            return;
        }
        waypoints.iter().take(1).for_each(|first| self.take_up(first, warehouse));
        // The robot is sent on: the pick has ended, whatever was planned.
        if let Some((serial, Act::Pick(_), _)) = self.acting
            && waypoints.iter().any(|w| w.serial > serial)
        {
            (self.acted, self.acting) = (Some(serial), None);
        }
        for w in waypoints {
            if w.serial == self.reached {
                let begins = self.acted < Some(w.serial) && self.acting.is_none();
                if let Some(act) = w.act.filter(|_| begins && self.is_near(self.stood_at)) {
                    self.acting = Some((w.serial, act, None));
                }
            } else if w.serial == self.known() + 1 {
                let from = self.path.back().map_or(self.node, |t| t.node);
                let arc = warehouse.out(from).find(|(_, a)| a.to == w.node);
                let limit_mps = arc.map_or(f64::INFINITY, |(_, a)| a.speed_limit_mps);
                let at = warehouse.nodes[w.node].at;
                if self.path.is_empty() && !self.is_on_the_way_to(at) {
                    return;
                }
                let corridor = self.corridor_of(w, from, warehouse);
                let (serial, node, act) = (w.serial, w.node, w.act);
                self.path.push_back(Target { serial, node, at, act, limit_mps, corridor });
            } else if w.passes.is_some() {
                self.may_leave_line(w, warehouse);
            }
        }
    }

    /// Sets the charge of the battery, as a share of 1.
    pub fn set_battery(&mut self, charge: f64) {
        self.battery = charge;
    }

    /// Whether the picker has taken everything wanted from the robot's rack.
    pub fn is_picked(&self, serial: u64) -> bool {
        self.acting.is_none() && self.acted >= Some(serial)
    }

    /// The robot's report.
    pub fn report(&self, now: Time) -> Telemetry {
        Telemetry {
            robot: self.id,
            // The robot makes one report at a time.
            seq: now.0.unsigned_abs(),
            seen: now,
            pose: self.pose,
            speed_mps: self.speed_mps,
            reached: self.reached,
            known: self.known(),
            acted: self.acted,
            rack: self.rack,
            battery: self.battery,
            fault: self.fault.map(|(fault, _)| fault),
            limit_mps: self.limit_mps,
            recalls: self.recalls,
        }
    }

    /// Lets the robot's scanner look for people: a person in front stops it, whatever the fleet commands.
    pub fn scan(&mut self, now: Time, half_m: f64, people: &[Point]) {
        let ahead = self.path.front().map(|t| t.at - self.pose.at).and_then(|d| d.try_normalize(THERE_M));
        let along = Vector::new(self.pose.heading.cos(), self.pose.heading.sin());
        let ahead = if self.beside.steers() { Some(along) } else { ahead };
        let ahead = (ahead, self.beside.steers());
        self.guard.look(now, self.pose.at, ahead, self.speed_mps, self.accel(), half_m, people);
    }

    /// Whether the robot's own scanner keeps it from driving.
    pub fn is_guarded(&self) -> bool {
        self.guard.stops()
    }

    /// The robot's velocity, metres per second in the map's frame.
    pub fn velocity(&self) -> Vector {
        let ahead = self.path.front().map(|t| t.at - self.pose.at).and_then(|d| d.try_normalize(THERE_M));
        let along = Vector::new(self.pose.heading.cos(), self.pose.heading.sin());
        let ahead = ahead.filter(|_| !self.beside.steers());
        ahead.unwrap_or(along) * self.speed_mps
    }

    /// Advances the robot from `from` to `to`. `charging` says whether it stands on a charger.
    pub fn advance(&mut self, from: Time, to: Time, charging: bool) {
        let seconds = (to - from).as_secs_f64();
        let ticks = (seconds / TICK_S - 1e-9).ceil().max(1.0);
        let dt = seconds / ticks;
        for i in 0..ticks as i64 {
            let now = from + Span::from_secs_f64(dt * (i + 1) as f64);
            self.tick(now, dt);
        }
        self.drain(to, seconds, charging);
    }

    fn drain(&mut self, now: Time, seconds: f64, charging: bool) {
        let standing = self.speed_mps == 0.0;
        let change = match (standing, charging) {
            (true, true) => seconds * CHARGE_PER_S,
            (true, false) => -seconds * STANDING_DRAIN / (self.driving_h * 3600.0),
            (false, _) => -seconds / (self.driving_h * 3600.0),
        };
        self.battery = (self.battery + change).clamp(0.0, 1.0);
        match self.flat_since {
            None if self.battery <= 0.0 => self.flat_since = Some(now),
            Some(since) if now - since >= EXCHANGE => (self.battery, self.flat_since) = (EXCHANGED, None),
            Some(_) => self.battery = 0.0,
            None => {}
        }
    }

    fn tick(&mut self, now: Time, dt: f64) {
        if self.tick_beside(now, dt) {
            return;
        }
        let is_obstructed = self.has(Fault::Obstructed) && !self.returns();
        if self.is_immobile() || is_obstructed || self.flat_since.is_some() {
            return self.coast(dt);
        }
        if self.acting.is_some() {
            return self.act(now);
        }
        // The robot does not turn either.
        if self.hand_guard {
            return self.coast(dt);
        }
        let Some(next) = self.path.front().copied() else { return };
        let way = Segment { a: self.pose.at, b: next.at };
        if way.length() < THERE_M {
            return self.reach(next);
        }
        let off = wrap_angle(way.heading() - self.pose.heading);
        if self.speed_mps == 0.0 && off.abs() > 1e-6 {
            let turn = (self.kinematics.turn_radps * dt).min(off.abs());
            self.pose.heading = wrap_angle(self.pose.heading + turn * off.signum());
            return;
        }
        match self.limit_mps {
            _ if self.guard.stops() => self.coast(dt),
            Some(0.0) => self.coast(dt),
            limit => self.drive(dt, next.limit_mps.min(limit.unwrap_or(f64::INFINITY))),
        }
    }

    /// Whether the robot would move now if no guard held it.
    pub fn would_move(&self) -> bool {
        let is_told = self.limit_mps != Some(0.0) && self.acting.is_none();
        is_told && !self.is_immobile() && self.flat_since.is_none() && !self.path.is_empty()
    }

    /// Brings a robot that is broken or told to stop to rest on its way.
    fn coast(&mut self, dt: f64) {
        let stop = self.speed_mps;
        self.go(dt, (stop - self.accel() * dt).max(0.0));
    }

    fn accel(&self) -> f64 {
        self.kinematics.accel_mps2(self.rack.is_some())
    }

    /// Accelerates as far as top speed, lane and the next place to stop allow.
    fn drive(&mut self, dt: f64, limit: f64) {
        let a = self.accel();
        let d = self.distance_to_stop();
        let brake = -a * dt + ((a * dt).powi(2) + 2.0 * a * d).sqrt();
        let top = self.kinematics.top_mps(self.rack.is_some()).min(limit).max(self.speed_mps - a * dt);
        let speed = (self.speed_mps + a * dt).min(top).min(brake);
        self.go(dt, speed.max(0.02));
    }

    /// Moves along the path, changing speed evenly, and passes waypoints on the way.
    fn go(&mut self, dt: f64, speed: f64) {
        let mut left = (self.speed_mps + speed) / 2.0 * dt;
        self.speed_mps = speed;
        while left > 0.0 {
            let Some(next) = self.path.front().copied() else { break };
            let way = Segment { a: self.pose.at, b: next.at };
            let length = way.length();
            if length > left + THERE_M {
                self.pose.at += (way.b - way.a) * (left / length);
                return;
            }
            left -= length;
            let stops = self.must_stop(0);
            self.reach(next);
            if stops {
                break;
            }
        }
        if self.path.is_empty() || self.acting.is_some() {
            self.speed_mps = 0.0;
        }
    }

    fn reach(&mut self, target: Target) {
        if self.must_stop(0) {
            self.speed_mps = 0.0;
        }
        let returns = self.returns();
        self.path.pop_front();
        self.is_halfway = false;
        if returns {
            // The robot has left the place of the obstacle.
            self.fault = self.fault.filter(|(fault, _)| *fault != Fault::Obstructed);
        }
        (self.reached, self.node, self.pose.at) = (target.serial, target.node, target.at);
        (self.stood_at, self.stood_on) = (target.at, target.node);
        self.acting = target.act.map(|act| (target.serial, act, None));
    }

    /// Whether the robot must come to rest at waypoint `i` of its path.
    fn must_stop(&self, i: usize) -> bool {
        let here = &self.path[i];
        let Some(next) = self.path.get(i + 1) else { return true };
        let before = if i == 0 { self.pose.at } else { self.path[i - 1].at };
        let (to, on) = (Segment { a: before, b: here.at }, Segment { a: here.at, b: next.at });
        let heading = if to.length() < THERE_M { self.pose.heading } else { to.heading() };
        here.act.is_some() || on.length() < THERE_M || turn_between(heading, on.heading()) > STRAIGHT
    }

    fn distance_to_stop(&self) -> f64 {
        let mut d = 0.0;
        let mut from = self.pose.at;
        for (i, t) in self.path.iter().enumerate() {
            d += (t.at - from).norm();
            from = t.at;
            if self.must_stop(i) {
                break;
            }
        }
        d
    }

    fn act(&mut self, now: Time) {
        let (serial, act, until) = self.acting.expect("called while acting");
        let span = match act {
            Act::Lift(_) | Act::Set(_) => self.kinematics.lift,
            Act::Pick(span) => span,
            Act::Arrive => Span::ZERO,
        };
        let until = until.unwrap_or(now + span);
        if now < until {
            self.acting = Some((serial, act, Some(until)));
            return;
        }
        match act {
            Act::Lift(rack) => self.rack = Some(rack),
            Act::Set(_) => self.rack = None,
            Act::Pick(_) | Act::Arrive => {}
        }
        self.acted = Some(serial);
        self.acting = None;
    }
}

#[cfg(test)]
mod tests;
