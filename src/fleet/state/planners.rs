//! One planner for each robot kind: how long a lane takes depends on the robot that drives it.
//!
//! Main type: [`Planners`]. Estimates for one kind are never used for another. Refuses: to plan.

use crate::state::kind::RobotKind;
use giveway_floor::route::{Planner, Rules};
use giveway_floor::warehouse::Warehouse;
use std::sync::Arc;

/// The planners, each with the name of its kind.
#[derive(Clone, Debug)]
pub struct Planners(Vec<(String, Planner)>);

impl Planners {
    /// A planner for each kind in a building.
    pub fn new(warehouse: &Arc<Warehouse>, kinds: &[RobotKind]) -> Planners {
        let planner = |k: &RobotKind| {
            Planner::for_body(warehouse.clone(), warehouse.body_of(&k.name), Rules::Drive(k.kinematics))
        };
        Planners(kinds.iter().map(|k| (k.name.clone(), planner(k))).collect())
    }

    /// The planner of a kind.
    pub fn of_mut(&mut self, kind: &RobotKind) -> &mut Planner {
        let found = self.0.iter_mut().find(|(name, _)| *name == kind.name);
        &mut found.expect("there is a planner for each kind").1
    }
}
