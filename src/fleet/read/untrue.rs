//! Whether the cause that is shown for a robot's waiting is true of the floor.
//!
//! Main function: [`untrue`]. Refuses: to believe how the cause was found; it compares the cause with what was
//! promised, reported and ordered.

use crate::Fleet;
use crate::state::fact::Task;
use crate::state::fault::Fault;
use crate::state::ledger::Service;
use crate::state::why::Why;
use giveway_floor::id::{NodeId, RobotId, StationId};
use giveway_floor::time::Time;

/// The cause that is shown for a robot's waiting, if it is not true: a closed area that was opened, a turn that is the
/// robot's own, a station said to be full that is not. Each cause is compared with what was promised, reported and
/// ordered.
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
        // The hand may be out again, and the report of that under way: only the station can be checked.
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
        Why::Refused => fleet.link_state(robot).is_some_and(|link| link.refuses.is_some()),
        Why::Paused => record.paused.is_some(),
        Why::Maintenance => matches!(record.service, Service::Maintenance { .. }),
        Why::Leaving => matches!(record.service, Service::Leaving { .. }),
        Why::Gone => record.is_gone(),
        Why::Stopped => ledger.stopped.is_some(),
        Why::Evacuation => ledger.evacuation.is_some(),
    };
    (!is_so).then_some(why)
}

/// Whether a robot that carries a rack is kept out of its station for the reason given: picking is paused there, a
/// robot stands in each place, or the named robot has a place there or carries a rack there.
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
