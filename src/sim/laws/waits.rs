//! The laws of waiting: none wait for one another for long, no person is kept in one spot by the fleet, and nothing
//! waits for what does not keep it.
//!
//! Main type: [`WaitLaws`]. They read the fleet's own wait-for graph, and compare it with the floor: a person is where
//! the simulation has the person. The published policies do not promise that nothing waits for long, and are measured
//! instead of held to it. Refuses: to excuse a person's wait because it was interrupted; it adds up in one spot.

use super::super::world::World;
use super::violation::{CIRCLE, KEPT, Violation};
use giveway_fleet::{ChainEnd, Edge, Fault, Fleet, Party, Service, Task, Why};
use giveway_floor::geometry::Point;
use giveway_floor::id::{NodeId, RobotId, StationId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_people::aware::HumanAwarePolicy;
use std::collections::BTreeMap;

/// A person within this is in the same spot, metres.
const SPOT_M: f64 = 0.75;

/// Circles of waiting and people in one spot, with since when.
#[derive(Debug, Default)]
pub(super) struct WaitLaws {
    circles: BTreeMap<Party, Time>,
    kept: BTreeMap<WorkerId, KeptPerson>,
    /// How often people were kept in one spot for [`KEPT`]; one who is kept on counts again.
    standstills: u64,
}

/// A person in one spot.
#[derive(Clone, Copy, Debug)]
struct KeptPerson {
    spot: Point,
    /// For how long of the time there the fleet was the reason.
    waited: Span,
    /// When that was looked at last.
    looked: Time,
}

impl WaitLaws {
    /// How often people were kept in one spot for a minute, by whatever policy.
    pub fn standstills(&self) -> u64 {
        self.standstills
    }

    /// Goes on counting where an earlier one ended.
    pub fn keep_count(&mut self, earlier: &WaitLaws) {
        self.standstills = earlier.standstills;
    }

    pub fn check(&mut self, now: Time, world: &World, fleet: &Fleet) -> Vec<Violation> {
        // Standstills of people are counted for every policy, and are a broken law for ours alone.
        let kept = self.look_at_people(now, world, fleet);
        let mut broken = Vec::new();
        if fleet.settings().policy == HumanAwarePolicy::Giveway {
            broken = kept;
            self.look_at_circles(now, fleet, &mut broken);
        }
        let robots = fleet.ledger().present();
        broken.extend(robots.filter_map(|r| Some(Violation::NotSo(r, untrue(fleet, r, now)?))));
        broken
    }

    fn look_at_circles(&mut self, now: Time, fleet: &Fleet, broken: &mut Vec<Violation>) {
        let standstills = fleet.standstills();
        let circle = |end: &ChainEnd| if let ChainEnd::Cycle(first) = end { Some(*first) } else { None };
        let there: BTreeMap<Party, &Vec<Party>> =
            standstills.iter().filter_map(|s| Some((circle(&s.end)?, &s.root))).collect();
        self.circles.retain(|first, _| there.contains_key(first));
        for (first, parties) in there {
            let since = self.circles.entry(first).or_insert(now);
            if now - *since > CIRCLE {
                *since = now;
                broken.push(Violation::Circle(parties.clone()));
            }
        }
    }

    fn look_at_people(&mut self, now: Time, world: &World, fleet: &Fleet) -> Vec<Violation> {
        let mut broken = Vec::new();
        for (worker, walker) in world.walkers().filter(|(_, w)| !w.is_gone()) {
            let at = walker.pose(now).at;
            let fresh = KeptPerson { spot: at, waited: Span::ZERO, looked: now };
            let kept = self.kept.entry(worker).or_insert(fresh);
            if (kept.spot - at).norm() > SPOT_M {
                *kept = fresh;
            }
            let wait = fleet.wait(Party::Worker(worker));
            let because = wait.edge;
            // What stands by a person's hand, or is broken, the fleet cannot move.
            if matches!(because, Edge::On(_) | Edge::NoWay | Edge::Until(_)) && !wait.is_for_an_operator() {
                kept.waited += now - kept.looked;
            }
            kept.looked = now;
            if kept.waited > KEPT {
                *kept = fresh;
                self.standstills += 1;
                broken.push(Violation::Kept(worker, because));
            }
        }
        broken
    }
}

/// What a robot waits for although it does not keep the robot: a closed area that was opened, a turn that is its own, a
/// station said to be full that is not. Each reason is compared with what was promised, reported and ordered.
pub fn untrue(fleet: &Fleet, robot: RobotId, now: Time) -> Option<Why> {
    let why = fleet.why(robot)?;
    let ledger = fleet.ledger();
    let record = &ledger.robots[robot];
    let has_fault = |fault| fleet.telemetry(robot).is_some_and(|t| t.fault == Some(fault));
    let is_on_its_way = |nodes: &dyn Fn(NodeId) -> bool| ledger.chain(robot).visits().any(|v| nodes(v.node));
    let is_so = match why {
        Why::WaitsFor(resource, holder) => {
            let turn = ledger.timeline().waits_for(robot, ledger.chain(robot).granted());
            turn == Some((resource, holder))
        }
        Why::GivesWay(worker) => fleet.knows_place_of(worker, now),
        Why::Closed(closure) => ledger.closures.get(&closure).is_some_and(|c| c.window.end() > now),
        Why::QueueFull(_) | Why::NotItsTurn(..) | Why::StationPaused(_) => is_outside(fleet, robot, why),
        // The hand may be out again, and the word of it on its way: the station is what can be checked.
        Why::HandInOpening(station) => is_on_its_way(&|n| is_place_of(fleet, station, n)),
        Why::NoRoute => record.task != Task::Idle && fleet.lacks_route(robot),
        Why::Failed => record.failed,
        Why::EmergencyStop => has_fault(Fault::EmergencyStop),
        Why::Manual => has_fault(Fault::Manual),
        Why::Obstructed(node) => is_on_its_way(&|n| n == node),
        Why::Unplugged => has_fault(Fault::Unplugged),
        Why::Displaced(displacement) => fleet.displacement(robot) == Some(displacement),
        Why::BlockedBy(other) => {
            let is_there = other != robot && !ledger.robots[other].is_gone();
            is_there && (ledger.robots[other].failed || fleet.displacement(other).is_some())
        }
        Why::WayObstructed(_) => fleet.has_obstructions(),
        Why::Silent => !fleet.is_fit(robot, now),
        Why::Paused => record.paused.is_some(),
        Why::Maintenance => matches!(record.service, Service::Maintenance { .. }),
        Why::Leaving => matches!(record.service, Service::Leaving { .. }),
        Why::Gone => record.is_gone(),
        Why::Stopped => ledger.stopped.is_some(),
        Why::Evacuation => ledger.evacuation.is_some(),
    };
    (!is_so).then_some(why)
}

/// Whether a robot that carries a rack is kept out of its station as it says: nobody picks there, a robot stands in
/// each place, or this one has a place, or carries a rack there that was lifted before.
fn is_outside(fleet: &Fleet, robot: RobotId, why: Why) -> bool {
    let ledger = fleet.ledger();
    let Some(station) = why.station() else { return false };
    let node = fleet.warehouse().stations[station].node;
    let goes_there =
        |r: RobotId| matches!(ledger.robots[r].task, Task::Deliver { station: to, .. } if to == node);
    let stands_there = |r: RobotId| is_place_of(fleet, station, ledger.node_of(r));
    let is_paused = ledger.paused_stations.contains_key(&station);
    let places = fleet.warehouse().stations[station].queue.len() + 1;
    let is_full = || ledger.present().filter(|r| *r != robot && stands_there(*r)).count() >= places;
    let is_so = match why {
        Why::QueueFull(_) => !is_paused && is_full(),
        Why::NotItsTurn(_, first) => {
            let comes = goes_there(first) || stands_there(first);
            first != robot && comes && !is_paused && !is_full()
        }
        _ => is_paused,
    };
    is_so && goes_there(robot) && fleet.lacks_route(robot)
}

/// Whether a node is the picking place of a station or in its queue.
fn is_place_of(fleet: &Fleet, station: StationId, node: NodeId) -> bool {
    let place = &fleet.warehouse().stations[station];
    place.node == node || place.queue.contains(&node)
}
