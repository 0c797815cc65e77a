//! Why a robot does not go on, and which party it waits for, if any.
//!
//! Main type: [`RobotWaits`]. Reasons that a person has to end come first, since they hold whatever else is true.
//! Refuses: to walk a chain: one robot, one reason.

use crate::state::cut_off::Barrier;
use crate::state::fact::{Act, Task};
use crate::state::fault::Fault;
use crate::state::floor::Floor;
use crate::state::ledger::Service;
use crate::state::wait_graph::{Edge, Party};
use crate::state::why::Why;
use crate::traffic::state::{Traffic, Withheld};
use crate::yielding::state::Yielding;
use giveway_floor::id::{ClosureId, IdVec, RobotId, StationId};
use giveway_floor::route::Cause;
use giveway_floor::time::Time;
use giveway_floor::warehouse::NodeKind;

/// What the reasons of robots are derived from, in one step.
pub(super) struct RobotWaits<'a> {
    floor: Floor<'a>,
    yielding: &'a Yielding,
    traffic: &'a Traffic,
    /// How many robots are bound for each station.
    bound: IdVec<StationId, usize>,
    /// Robots at stations, in their queues and on their way there, foremost first.
    turns: Vec<StationTurn>,
    now: Time,
}

impl<'a> RobotWaits<'a> {
    pub fn new(floor: Floor<'a>, yielding: &'a Yielding, traffic: &'a Traffic, now: Time) -> RobotWaits<'a> {
        let (bound, turns) = (floor.bound_for_stations(), floor.turns_at_stations());
        RobotWaits { floor, yielding, traffic, bound, turns, now }
    }

    /// Why a robot does not go on, if it does not.
    pub fn why(&self, robot: RobotId) -> Option<Why> {
        self.halted(robot)
            .or_else(|| self.disturbed(robot))
            .or_else(|| self.without_route(robot))
            .or_else(|| self.giving_way(robot))
            .or_else(|| self.at_hands(robot))
            .or_else(|| self.withheld(robot))
    }

    /// Reasons that a person, or the robot itself, has to end.
    fn halted(&self, robot: RobotId) -> Option<Why> {
        let record = &self.floor.ledger.robots[robot];
        // What a person has to undo must be shown, whatever else is wrong.
        if record.paused.is_some() {
            return Some(Why::Paused);
        }
        let (scene, now) = (self.floor.scene, self.now);
        let fault = scene.robot(robot).and_then(|t| t.fault);
        match fault.filter(|_| scene.is_heard(robot, now)) {
            Some(Fault::EmergencyStop) => return Some(Why::EmergencyStop),
            Some(Fault::Manual) => return Some(Why::Manual),
            _ => {}
        }
        if let Some(displacement) = self.floor.displacement(robot) {
            return Some(Why::Displaced(displacement));
        }
        if record.failed {
            return Some(Why::Failed);
        }
        if self.floor.ledger.stopped.is_some() {
            return Some(Why::Stopped);
        }
        if self.floor.stands_by(robot) {
            return Some(Why::Evacuation);
        }
        let why =
            if scene.is_refused(robot) && scene.is_heard(robot, now) { Why::Refused } else { Why::Silent };
        scene.fit(robot, now).is_none().then_some(why)
    }

    /// What the robot met; also maintenance and leaving, which concern robots without a task.
    fn disturbed(&self, robot: RobotId) -> Option<Why> {
        if let Some(node) = self.floor.obstructed_at(robot, self.now) {
            return Some(Why::Obstructed(node));
        }
        let record = &self.floor.ledger.robots[robot];
        if self.floor.scene.robot(robot).is_some_and(|t| t.fault == Some(Fault::Unplugged)) {
            return Some(Why::Unplugged);
        }
        match record.service {
            Service::Maintenance { .. } if record.task == Task::Idle => return Some(Why::Maintenance),
            Service::Leaving { .. } if record.task == Task::Idle => return Some(Why::Leaving),
            Service::Gone { .. } => return Some(Why::Gone),
            _ => {}
        }
        let back = self.traffic.drives_back_to(self.floor, robot);
        self.floor.drives_into(robot, back).map(Why::BlockedBy)
    }

    /// The reason of a robot that has a task and no route for it, nor one to a place where it can wait.
    fn without_route(&self, robot: RobotId) -> Option<Why> {
        if !self.floor.lacks_route(robot) || !self.floor.rests(robot) {
            return None;
        }
        let needs = &self.traffic.needs;
        let is_full = |_: &StationId| !needs.has_its_turn(self.floor, robot, &self.bound, self.now);
        let full = self.floor.station_of(robot).filter(is_full);
        let in_vain = || needs.failed_before(robot).then(|| self.no_route(robot));
        full.and_then(|station| self.outside(robot, station)).or_else(in_vain)
    }

    /// What keeps a robot from setting off to its station: the station is paused, or full, or other robots have its
    /// places or come before this one.
    fn outside(&self, robot: RobotId, station: StationId) -> Option<Why> {
        if self.floor.ledger.paused_stations.contains_key(&station) {
            return Some(Why::StationPaused(station));
        }
        let places = self.floor.warehouse().stations[station].queue.len() + 1;
        if self.turns_at(station, robot).filter(|t| t.place.is_some()).count() >= places {
            return Some(Why::QueueFull(station));
        }
        // As long as a place is left, the robots before this one are to set off.
        let before = || self.traffic.needs.ahead(self.floor, robot, self.now).next();
        let has_place = || self.turns_at(station, robot).map(|t| t.robot).next();
        let first = if self.bound[station] < places { before() } else { has_place() };
        first.map(|first| Why::NotItsTurn(station, first))
    }

    /// The other robots that have places at a station, foremost first.
    fn turns_at(&self, station: StationId, robot: RobotId) -> impl Iterator<Item = &StationTurn> {
        let first = self.turns.partition_point(|t| t.station < station);
        self.turns[first..].iter().take_while(move |t| t.station == station).filter(move |t| t.robot != robot)
    }

    /// Whether a robot that is on the floor cannot go on from where it stands.
    fn stands_for_good(&self, other: RobotId) -> bool {
        let record = &self.floor.ledger.robots[other];
        !record.is_gone() && (record.failed || self.floor.scene.displaced(other).is_some())
    }

    /// Whether a closure is not over yet; the ledger keeps closures that are over for a while.
    fn is_closed(&self, closure: ClosureId) -> bool {
        self.floor.ledger.closures.get(&closure).is_some_and(|c| self.now < c.window.end())
    }

    /// Why a robot's searches fail: because of a closed area, of something that stands in the way, of a robot that
    /// cannot drive, or of other robots that can.
    fn no_route(&self, robot: RobotId) -> Why {
        let cut = self.traffic.needs.waiting.get(&robot).and_then(|need| need.cut);
        match cut {
            Some(Barrier::Obstruction(node)) if self.traffic.obstructed_until(node).is_some() => {
                return Why::WayObstructed(node);
            }
            // What was true when the search failed may have ended since, even in this step.
            Some(Barrier::Closure(closure)) if self.is_closed(closure) => return Why::Closed(closure),
            Some(Barrier::Robot(other)) if self.stands_for_good(other) => return Why::BlockedBy(other),
            _ => {}
        }
        let broken = self.in_the_way(robot).filter(|r| self.stands_for_good(*r));
        broken.map_or(Why::NoRoute, Why::BlockedBy)
    }

    /// The reason of a robot that was told to stand for a worker.
    fn giving_way(&self, robot: RobotId) -> Option<Why> {
        let yielding = self.yielding.state.of(robot);
        if !yielding.is_told_to_stand() {
            return None;
        }
        let chain = self.floor.ledger.chain(robot);
        let may_drive = chain.first() + 1 < chain.granted();
        // The worker to whom it first gave way may have left: what counts is the worker for whom it stands now.
        let stands = yielding.stands.filter(|_| may_drive || yielding.to.is_some());
        stands.map(|s| Why::GivesWay(s.worker))
    }

    /// The reason of a robot that was told to stand because of a hand at a station, if its way still leads there.
    fn at_hands(&self, robot: RobotId) -> Option<Why> {
        let chain = self.floor.ledger.chain(robot);
        let may_drive = chain.first() + 1 < chain.granted();
        let stations = &self.floor.warehouse().stations;
        let leads_there = |s: &StationId| chain.visits().any(|v| v.node == stations[*s].node);
        let station = self.floor.visits.at_hands(robot).filter(|_| may_drive);
        station.filter(leads_there).map(Why::HandInOpening)
    }

    /// The reason of a robot that is at the end of what it was granted, and gets no more.
    fn withheld(&self, robot: RobotId) -> Option<Why> {
        let chain = self.floor.ledger.chain(robot);
        let at_end = chain.first() + 1 == chain.granted();
        match self.traffic.withheld(robot).filter(|_| at_end)? {
            Withheld::Condition(Cause::Worker(w), _) => Some(Why::GivesWay(w)),
            Withheld::Condition(Cause::Closure(c), _) => Some(Why::Closed(c)),
            // The other robot may have been taken up since, even in this step.
            Withheld::Condition(Cause::Robot(other), _) => {
                self.stands_for_good(other).then_some(Why::BlockedBy(other))
            }
            Withheld::Condition(Cause::Obstruction(node), _) => Some(Why::WayObstructed(node)),
            Withheld::Condition(Cause::Evacuation, _) => Some(Why::Evacuation),
            // The turn may have changed since it was asked for: grants to robots after this one move chains.
            Withheld::Turn(..) => {
                let turn = self.floor.ledger.timeline().waits_for(robot, chain.granted());
                turn.map(|(resource, holder)| Why::WaitsFor(resource, holder))
            }
            Withheld::End | Withheld::Stop | Withheld::Early => None,
        }
    }

    /// What a robot waits for, for this reason.
    pub fn edge(&self, robot: RobotId, why: Option<Why>) -> Edge {
        let Some(why) = why else {
            let idles = self.floor.ledger.robots[robot].task == Task::Idle;
            return if idles && self.floor.rests(robot) { Edge::Still } else { Edge::Moves };
        };
        let acts = self.floor.act_here(robot).is_some();
        match why {
            Why::Failed
            | Why::EmergencyStop
            | Why::Manual
            | Why::Unplugged
            | Why::Displaced(_)
            | Why::Silent
            | Why::Refused
            | Why::Paused
            | Why::Maintenance
            | Why::Leaving
            | Why::Gone
            | Why::Stopped
            | Why::Evacuation => Edge::Operator,
            _ if acts => Edge::Moves,
            Why::WaitsFor(_, other) | Why::BlockedBy(other) | Why::NotItsTurn(_, other) => {
                Edge::On(Party::Robot(other))
            }
            Why::GivesWay(worker) => Edge::On(Party::Worker(worker)),
            Why::Closed(closure) => {
                let area = self.floor.ledger.closures.get(&closure);
                let end = area.map(|area| area.window.end()).filter(|end| !end.is_forever());
                end.map_or(Edge::Operator, Edge::Until)
            }
            Why::Obstructed(node) | Why::WayObstructed(node) => {
                self.traffic.obstructed_until(node).map_or(Edge::Moves, Edge::Until)
            }
            Why::QueueFull(station) => {
                let first = self.turns_at(station, robot).next();
                first.map_or(Edge::Moves, |t| Edge::On(Party::Robot(t.robot)))
            }
            Why::StationPaused(_) => Edge::Operator,
            // The hand comes out by itself.
            Why::HandInOpening(_) => Edge::Moves,
            Why::NoRoute => self.in_the_way(robot).map_or(Edge::NoWay, |r| Edge::On(Party::Robot(r))),
        }
    }

    /// The robot that holds the goal of a robot without a route, or that an earlier search found in its way.
    fn in_the_way(&self, robot: RobotId) -> Option<RobotId> {
        let found = self.traffic.needs.waiting.get(&robot)?.behind;
        let other = self.floor.keeper_of_goal(robot).or(found)?;
        (other != robot && !self.floor.ledger.robots[other].is_gone()).then_some(other)
    }
}

/// A robot that has a place at a station. The order is that in which robots come to be served.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct StationTurn {
    station: StationId,
    /// Whether the robot is not there yet; robots that are come first.
    comes: bool,
    /// The place where the robot stands, from the front.
    place: Option<usize>,
    /// When the robot is planned to be at the station.
    arrives: Time,
    robot: RobotId,
}

impl Floor<'_> {
    /// Robots at stations, in their queues and on their way there: by station, foremost first.
    fn turns_at_stations(&self) -> Vec<StationTurn> {
        let mut turns = Vec::new();
        for robot in self.ledger.present() {
            let here = self.ledger.node_of(robot);
            let there = match self.warehouse().kind(here) {
                NodeKind::Station(s) => Some((s, 0)),
                NodeKind::Queue(s) => {
                    let queue = &self.warehouse().stations[s].queue;
                    Some((s, 1 + queue.iter().position(|n| *n == here).unwrap_or(queue.len())))
                }
                _ => None,
            };
            let drives = || !self.lacks_route(robot) && !self.ledger.robots[robot].failed;
            let station = match there {
                Some((station, _)) => Some(station),
                None => self.station_of(robot).filter(|_| drives()),
            };
            let place = there.map(|(_, place)| place);
            let arrives = self.planned_at_station(robot).unwrap_or(Time::MAX);
            turns.extend(station.map(|station| StationTurn {
                station,
                comes: place.is_none(),
                place,
                arrives,
                robot,
            }));
        }
        turns.sort_unstable();
        turns
    }

    /// When a robot is planned to be at its station.
    fn planned_at_station(&self, robot: RobotId) -> Option<Time> {
        let stop = self.ledger.robots[robot].stops.iter().find(|s| matches!(s.act, Act::Pick(_)))?;
        self.ledger.chain(robot).get(stop.serial).map(|v| v.arrive)
    }
}
