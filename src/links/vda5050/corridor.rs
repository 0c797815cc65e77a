//! Corridors: how far a robot may leave the line of a lane, as the edges of its orders say it.
//!
//! Main function: `corridor`. The map's corridor bounds the robot's outline, and the fleet keeps all of it free of
//! other robots while the lane is granted. Refuses: corridors for robots of 2.0, which does not know them, and
//! corridors that a robot would leave on the line itself.

use super::session::RobotSession;
use giveway_floor::id::NodeId;
use giveway_vda5050::{Corridor, Version};

impl RobotSession {
    /// The corridor of the lane from a node to the next, with left and right as the robot drives; nothing if it keeps
    /// to the line. From 3.0 on the robot asks before it leaves the line.
    pub(super) fn corridor(&self, from: NodeId, to: NodeId) -> Option<Corridor> {
        if !self.settings.free_navigation || self.version == Version::V2_0 {
            return None;
        }
        let (_, arc) = self.map.out(from).find(|(_, arc)| arc.to == to)?;
        let lane = &self.map.lanes[arc.lane];
        let corridor = lane.corridor?;
        let driven = if lane.a == from { corridor } else { corridor.reversed() };
        let half_m = self.factsheet.as_ref().and_then(|sheet| sheet.width_m).unwrap_or(0.0) / 2.0;
        let has_room = driven.left_m.min(driven.right_m) >= half_m;
        has_room.then_some(Corridor {
            left_m: driven.left_m,
            right_m: driven.right_m,
            of_contour: true,
            release_required: self.version >= Version::V3_0,
        })
    }
}
