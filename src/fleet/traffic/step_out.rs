//! Out first, then on: a robot that finds no route for its task, and stands where it may not stay for ever, drives to
//! the nearest place where it may. It plans its task from there.
//!
//! Robots that stand close together after a repair each need a route that ends where others stand. The outermost can
//! always leave to some place to stay; then the next one can. Refuses: to move robots that stand where they may stay,
//! since these are in no robot's way.

use crate::fleet::state::core::Core;
use crate::fleet::traffic::stages::commit;
use crate::fleet::traffic::state::Traffic;
use crate::id::RobotId;
use crate::route::Stage;
use crate::time::Time;

/// So many places are tried at a time, the nearest ones first.
const PLACES: usize = 4;

impl Traffic {
    /// Sends a robot out of the way to a place where it may stay, if there is a route to one. Whether it goes.
    pub(in crate::fleet) fn step_out(&mut self, core: &mut Core, robot: RobotId, now: Time) -> bool {
        let floor = core.floor();
        let (from, _) = floor.grant_end(robot);
        if floor.warehouse().kind(from.node).is_lasting() || floor.next_stop_is_granted(robot) {
            return false;
        }
        let loaded = floor.ledger.rack_on(robot).is_some();
        for place in floor.stays_near(robot, PLACES) {
            let stage = Stage { loaded, ..Stage::to_stay(place) };
            if let Ok(mut route) = self.search(core, robot, &[stage], now) {
                // Nothing of its task is done there.
                route.stops.clear();
                commit(core, robot, route);
                return true;
            }
        }
        false
    }
}
