//! Robots that do not stand on a node; a change of the map waits for them.
//!
//! Main type: [`Unsettled`]. Refuses: to say why a robot does not get to its node.

use crate::Fleet;
use crate::state::displaced::OFF_ROUTE_M;
use giveway_floor::geometry::Point;
use giveway_floor::id::RobotId;

/// A robot that drives, or stands beside the node that it reached last.
#[derive(Clone, Debug, PartialEq)]
pub struct Unsettled {
    /// The robot.
    pub robot: RobotId,
    /// The robot's name.
    pub name: String,
    /// Where the robot is.
    pub at: Point,
    /// Whether the robot is not on the node that it reached last.
    pub is_off: bool,
    /// Whether the robot stands still, off that node.
    pub stands_off: bool,
}

impl Fleet {
    /// Robots whose last report does not say that they stand on the node that they reached last, or that were granted
    /// something beyond it. A robot that was never heard of stands where the ledger has it.
    pub fn unsettled(&self) -> Vec<Unsettled> {
        let ledger = self.ledger();
        let found = ledger.present().filter_map(|robot| {
            let seen = self.telemetry(robot)?;
            let off_m = (seen.pose.at - self.warehouse().nodes[ledger.node_of(robot)].at).norm();
            let chain = ledger.chain(robot);
            let drives = !seen.stands() || chain.granted() > chain.first() + 1;
            let is_off = off_m > OFF_ROUTE_M;
            (drives || is_off).then_some(Unsettled {
                robot,
                name: ledger.robots[robot].name.clone(),
                at: seen.pose.at,
                is_off,
                stands_off: is_off && seen.stands(),
            })
        });
        found.collect()
    }
}
