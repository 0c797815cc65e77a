//! Robots of other links: not simulated, but people at stations pick from them, and the racks that they move are where
//! the ledger has them.
//!
//! Main function: [`World::is_elsewhere`]. Refuses: to know where such a robot is; its own link reports that.

use super::World;
use giveway_fleet::{Act, Input, Ledger, RackAt, USUAL_LINK};
use giveway_floor::id::RobotId;
use giveway_floor::warehouse::NodeKind;

impl World {
    /// Whether a robot is reached by another link than the simulated ones.
    pub(super) fn is_elsewhere(ledger: &Ledger, robot: RobotId) -> bool {
        ledger.robots[robot].link != USUAL_LINK
    }

    /// Reports of pickers who have picked from a robot of another link for as long as was planned; repeated until their
    /// screen shows that it was received.
    pub(super) fn picks_elsewhere(&mut self, ledger: &Ledger) -> Vec<Input> {
        let now = self.now;
        let picked_from: Vec<RobotId> = ledger
            .present()
            .filter(|r| World::is_elsewhere(ledger, *r) && ledger.is_picked_from(*r))
            .collect();
        self.picked_elsewhere.retain(|robot, _| picked_from.contains(robot));
        let mut said = Vec::new();
        for robot in picked_from {
            let NodeKind::Station(station) = self.warehouse.nodes[ledger.node_of(robot)].kind else {
                continue;
            };
            let Some(stop) = ledger.robots[robot].stops.first() else { continue };
            let Act::Pick(lasts) = stop.act else { continue };
            let since = *self.picked_elsewhere.entry(robot).or_insert(now);
            if now - since >= lasts && !ledger.paused_stations.contains_key(&station) {
                said.push(self.customers.pick(station, robot, stop.serial));
            }
        }
        said
    }

    /// Racks on robots of other links, and those that such robots have set down, are where the ledger has them.
    pub(super) fn note_racks_elsewhere(&mut self, ledger: &Ledger) {
        let is_on = |at: &RackAt| matches!(at, RackAt::On(robot) if World::is_elsewhere(ledger, *robot));
        for (rack, at) in ledger.racks.pairs() {
            if is_on(at) || is_on(&self.racks[rack]) {
                self.racks[rack] = *at;
            }
        }
    }
}
