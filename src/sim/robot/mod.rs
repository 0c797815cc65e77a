//! A simulated robot: drives along granted waypoints with inertia, turns in place, lifts, waits, breaks down.
//!
//! Main type: [`RobotBody`]. Between two calls it integrates in steps of at most 20 ms. It never drives beyond what it
//! was told, and it can always stop before the end of it. Refuses: to know where others are.

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
use std::collections::VecDeque;

/// Longest step of integration, seconds.
const TICK_S: f64 = 0.02;
/// Closer than this is there, metres.
const THERE_M: f64 = 1e-4;
/// Headings closer than this are the same, radians.
const STRAIGHT: f64 = 0.1;
/// Share of the drain while standing.
const STANDING_DRAIN: f64 = 0.2;
/// Somebody exchanges a flat battery after this long, for one with this charge.
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
    /// The visit whose centre it reached last; the node of that, or where people put it since.
    pub reached: u64,
    pub node: NodeId,
    /// Where that visit was: it may have been pushed elsewhere since.
    stood_at: Point,
    /// The node of that visit.
    pub stood_on: NodeId,
    pub rack: Option<RackId>,
    /// What is wrong with it, and until when.
    pub fault: Option<(Fault, Time)>,
    /// The limit of its speed that it was told last.
    pub limit_mps: Option<f64>,
    /// How many revocations it has obeyed.
    recalls: u64,
    /// Whether it forgot its waypoints between two nodes, and people have not moved it since.
    is_halfway: bool,
    battery: f64,
    /// Hours of driving on a full charge.
    driving_h: f64,
    /// Since when its battery has been flat.
    flat_since: Option<Time>,
    acted: Option<u64>,
    /// What it is to do where it stands, and until when it is at it.
    acting: Option<(u64, Act, Option<Time>)>,
    path: VecDeque<Target>,
    kinematics: Kinematics,
    capabilities: Capabilities,
    /// What it takes of the floor, without and with a rack.
    footprints: [Footprint; 2],
    /// Its own scanner stopped it; see `guard`.
    guard: Guard,
    /// The guard of the station where it is stops it: a hand is inside.
    pub hand_guard: bool,
    /// What it does beside the line.
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

    /// What it takes of the floor, with the rack that it has.
    pub fn footprint(&self) -> &Footprint {
        &self.footprints[usize::from(self.rack.is_some())]
    }

    /// Whether its outline touches a person.
    pub fn touches(&self, person: Point) -> bool {
        self.footprint().at(self.pose).distance_to(person) <= BODY_M
    }

    /// Puts it where the ledger has it: a restarted simulation.
    pub fn resume(&mut self, reached: u64, acted: Option<u64>, recalls: u64, rack: Option<RackId>) {
        (self.reached, self.acted, self.recalls, self.rack) = (reached, acted, recalls, rack);
    }

    /// It is turned, charged and broken as another one was.
    pub fn stay_as(&mut self, before: &RobotBody) {
        self.pose.heading = before.pose.heading;
        (self.battery, self.flat_since, self.fault) = (before.battery, before.flat_since, before.fault);
    }

    /// People switch it off, push it elsewhere and switch it on: it has forgotten its waypoints. `node` is the one to
    /// which it is nearest there.
    pub fn put(&mut self, at: Point, node: NodeId) {
        (self.pose.at, self.node, self.speed_mps) = (at, node, 0.0);
        (self.acting, self.is_halfway) = (None, false);
        self.path.clear();
        self.beside.end();
    }

    /// Whether it has this fault.
    pub fn has(&self, fault: Fault) -> bool {
        self.fault.is_some_and(|(f, _)| f == fault)
    }

    fn is_immobile(&self) -> bool {
        self.fault.is_some_and(|(fault, _)| fault.is_immobile())
    }

    /// A person drives it: it forgets its waypoints.
    pub fn take_over(&mut self, until: Time) {
        self.fault = Some((Fault::Manual, until));
        (self.acting, self.is_halfway) = (None, false);
        self.path.clear();
        self.beside.end();
        self.speed_mps = 0.0;
    }

    /// Whether it is on its way, with somewhere to come to.
    pub fn is_on_its_way(&self) -> bool {
        self.speed_mps > 0.0 && self.acting.is_none() && !self.path.is_empty() && !self.returns()
    }

    /// Whether it stands, carries nothing out and could be pushed.
    pub fn can_be_pushed(&self) -> bool {
        let free = self.fault.is_none_or(|(fault, _)| fault == Fault::Manual);
        self.speed_mps == 0.0 && self.acting.is_none() && free
    }

    /// Whether it stands without a rack, whatever the fleet knows of that.
    pub fn can_be_taken(&self) -> bool {
        self.speed_mps == 0.0 && self.rack.is_none()
    }

    /// Whether it was pushed elsewhere and has not been told yet where it is.
    pub fn is_astray(&self) -> bool {
        self.path.is_empty() && !self.is_near(self.stood_at)
    }

    fn is_near(&self, at: Point) -> bool {
        (at - self.pose.at).norm() <= OFF_ROUTE_M
    }

    /// Whether it stands on the straight way from what it reached last to another place.
    fn is_on_the_way_to(&self, next: Point) -> bool {
        Segment { a: self.stood_at, b: next }.distance_to(self.pose.at) <= OFF_ROUTE_M
    }

    /// The lanes that it was told to drive along, from where it is.
    pub fn way(&self) -> impl Iterator<Item = Segment> + '_ {
        let from = std::iter::once(self.pose.at).chain(self.path.iter().map(|t| t.at));
        from.zip(self.path.iter().map(|t| t.at)).map(|(a, b)| Segment { a, b })
    }

    /// Whether it stands when it is told to.
    pub fn obeys_stops(&self) -> bool {
        self.capabilities.limits != ObeyedLimits::Nothing
    }

    /// Serial number of the last waypoint it knows.
    pub fn known(&self) -> u64 {
        self.path.back().map_or(self.reached, |t| t.serial)
    }

    /// Whether it drives back to the node that it reached last.
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

    /// Where it stands, on a node or on the way to the next, it forgets all waypoints.
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

    /// An order that ends with the visit that it reached last brings a robot back there that has forgotten its
    /// waypoints; any other one turns it round again, once it stands. Whether it is to take on what the order says.
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

    /// An order that begins later than all it knows is for the place where it was put, if it stands there.
    fn take_up(&mut self, first: &Waypoint, warehouse: &Warehouse) {
        let at = warehouse.nodes[first.node].at;
        if first.serial > self.known() && self.path.is_empty() && self.speed_mps == 0.0 && self.is_near(at) {
            (self.reached, self.node) = (first.serial, first.node);
            (self.stood_at, self.stood_on) = (at, first.node);
            self.acting = None;
        }
    }

    /// Waypoints that it knows already are skipped, an act for the place where it stands is begun. It takes no
    /// waypoint on to which it does not stand on the way, and does nothing where it was not to do it: it was pushed
    /// elsewhere meanwhile.
    fn learn(&mut self, waypoints: &[Waypoint], warehouse: &Warehouse) {
        if !self.turn(waypoints, warehouse) {
            return;
        }
        waypoints.iter().take(1).for_each(|first| self.take_up(first, warehouse));
        // It is sent on: the pick has ended, whatever was planned.
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

    /// Its battery has so much charge from now on, of 1.
    pub fn set_battery(&mut self, charge: f64) {
        self.battery = charge;
    }

    /// Whether the picker has all that was wanted from the rack on it.
    pub fn is_picked(&self, serial: u64) -> bool {
        self.acting.is_none() && self.acted >= Some(serial)
    }

    /// What it says of itself.
    pub fn report(&self, now: Time) -> Telemetry {
        Telemetry {
            robot: self.id,
            // It makes one at a time.
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

    /// Its scanner looks for people: a person in front of it stops it, whatever the fleet says.
    pub fn scan(&mut self, now: Time, half_m: f64, people: &[Point]) {
        let ahead = self.path.front().map(|t| t.at - self.pose.at).and_then(|d| d.try_normalize(THERE_M));
        let along = Vector::new(self.pose.heading.cos(), self.pose.heading.sin());
        let ahead = if self.beside.steers() { Some(along) } else { ahead };
        let ahead = (ahead, self.beside.steers());
        self.guard.look(now, self.pose.at, ahead, self.speed_mps, self.accel(), half_m, people);
    }

    /// Whether its own scanner keeps it from driving.
    pub fn is_guarded(&self) -> bool {
        self.guard.stops()
    }

    /// How it moves, metres per second in the map's frame.
    pub fn velocity(&self) -> Vector {
        let ahead = self.path.front().map(|t| t.at - self.pose.at).and_then(|d| d.try_normalize(THERE_M));
        let along = Vector::new(self.pose.heading.cos(), self.pose.heading.sin());
        let ahead = ahead.filter(|_| !self.beside.steers());
        ahead.unwrap_or(along) * self.speed_mps
    }

    /// Lives from `from` to `to`. `charging` says whether the node it stands on is a charger.
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
        // It does not turn either.
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

    /// Whether it would move now if no guard held it.
    pub fn would_move(&self) -> bool {
        let is_told = self.limit_mps != Some(0.0) && self.acting.is_none();
        is_told && !self.is_immobile() && self.flat_since.is_none() && !self.path.is_empty()
    }

    /// Broken or told to stop: it comes to rest on the way it was on.
    fn coast(&mut self, dt: f64) {
        let stop = self.speed_mps;
        self.go(dt, (stop - self.accel() * dt).max(0.0));
    }

    fn accel(&self) -> f64 {
        self.kinematics.accel_mps2(self.rack.is_some())
    }

    /// Speeds up as far as top speed, lane and the next place to stop allow.
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
            // It has left what it stood before.
            self.fault = self.fault.filter(|(fault, _)| *fault != Fault::Obstructed);
        }
        (self.reached, self.node, self.pose.at) = (target.serial, target.node, target.at);
        (self.stood_at, self.stood_on) = (target.at, target.node);
        self.acting = target.act.map(|act| (target.serial, act, None));
    }

    /// Whether it must come to rest at the waypoint `i` of its path.
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
