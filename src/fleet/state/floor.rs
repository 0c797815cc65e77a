//! What every room may ask of: what was promised, what is seen, and the settings. Nothing can be changed through it.
//!
//! Main type: [`Floor`]. Each room adds the questions that it answers. Refuses: to know of people, routes to come, or
//! anything else that a room keeps to itself.

use super::kind::RobotKind;
use super::ledger::Ledger;
use super::scene::Scene;
use crate::fleet::Settings;
use crate::id::RobotId;
use crate::route::Kinematics;
use crate::warehouse::Warehouse;
use std::sync::Arc;

/// The floor as it is now.
#[derive(Clone, Copy)]
pub(in crate::fleet) struct Floor<'a> {
    /// What was promised.
    pub ledger: &'a Ledger,
    /// What is seen.
    pub scene: &'a Scene,
    /// The settings.
    pub settings: &'a Settings,
}

impl<'a> Floor<'a> {
    /// The building.
    pub fn warehouse(&self) -> &'a Arc<Warehouse> {
        self.ledger.warehouse()
    }

    /// The kind of a robot.
    pub fn kind(&self, robot: RobotId) -> &'a RobotKind {
        self.settings.kind(&self.ledger.robots[robot].kind)
    }

    /// How a robot moves.
    pub fn kinematics(&self, robot: RobotId) -> &'a Kinematics {
        &self.kind(robot).kinematics
    }
}
