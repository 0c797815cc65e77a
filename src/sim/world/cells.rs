//! People at work cells beside the robots that stand there.
//!
//! Refuses: to let a robot know of them; its brakes and the station's guard are not simulated.

use super::World;
use crate::fleet::{CellWarning, Fleet, Input};
use crate::id::{Dense, RobotId, StationId};
use crate::sim::picker::{Pickers, Standing};
use crate::time::Time;
use crate::warehouse::NodeKind;
use std::collections::BTreeMap;

/// A robot this near to where racks stand at a station is in the way of hands there, metres.
const AT_STATION_M: f64 = 0.9;
/// A robot that is not faster does not move, metres per second.
const STANDS_MPS: f64 = 1e-6;

impl World {
    /// People at work cells live until now; what they say, and how their hands are seen.
    pub(super) fn pick_lines(&mut self, from: Time, to: Time, fleet: &Fleet) -> Vec<Input> {
        if self.pickers.is_none() {
            return Vec::new();
        }
        let standing = self.standing();
        let pickers = self.pickers.as_mut().expect("just seen");
        let inputs = pickers.advance((from, to), &standing, fleet);
        let inside: Vec<StationId> = pickers.hands_inside(to).collect();
        for station in inside {
            let at = self.warehouse.nodes[self.warehouse.stations[station].node].at;
            let moves = |r: &&super::SimRobot| {
                !r.off && r.body.speed_mps > STANDS_MPS && (r.body.pose.at - at).norm() < AT_STATION_M
            };
            self.moved_at_hands.extend(self.robots.iter().find(moves).map(|r| (r.body.id, station)));
        }
        inputs
    }

    /// The robots that truly stand at stations with racks.
    fn standing(&self) -> BTreeMap<StationId, Standing> {
        let stands = |r: &super::SimRobot| {
            let NodeKind::Station(station) = self.warehouse.nodes[r.body.node].kind else { return None };
            let is_there = !r.off && r.body.speed_mps <= STANDS_MPS && !r.body.is_astray();
            let is_at_node =
                r.body.stood_on == r.body.node && self.warehouse.stations[station].node == r.body.node;
            let rack = r.body.rack.filter(|_| is_there && is_at_node)?;
            Some((station, Standing { robot: r.body.id, rack }))
        };
        self.robots.iter().filter_map(stands).collect()
    }

    /// Hands over warnings to people at work cells.
    pub fn warn(&mut self, now: Time, warnings: &[CellWarning]) {
        if let Some(pickers) = &mut self.pickers {
            warnings.iter().for_each(|warning| pickers.warn(now, warning));
        }
    }

    /// Who picks at work cells, if somebody does.
    pub fn pickers(&self) -> Option<&Pickers> {
        self.pickers.as_ref()
    }

    /// Robots that moved at a station while a hand was inside: for the laws.
    pub fn moved_at_hands(&self) -> &[(RobotId, StationId)] {
        &self.moved_at_hands
    }
}

/// Whether the visit for which a robot is picked from has lines.
pub(super) fn has_lines(fleet: &Fleet, robot: RobotId) -> bool {
    let ledger = fleet.ledger();
    let Some(record) = ledger.robots.get(RobotId::at(robot.ix())) else { return false };
    record.task.job().and_then(|job| ledger.jobs.get(&job)).is_some_and(|job| job.lines_now().is_some())
}
