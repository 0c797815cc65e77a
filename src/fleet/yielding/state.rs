//! What is remembered about giving way: of each robot, of the published procedure, of encounters that have begun.
//!
//! Main types: [`Yielding`], [`Procedure`]. Refuses: to decide.

use crate::state::fact::Task;
use crate::state::yielding::YieldingState;
use giveway_floor::geometry::Point;
use giveway_floor::id::{RobotId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_people::aware::Meter;
use std::collections::{BTreeMap, BTreeSet};

/// What is remembered about giving way, from step to step. Lost at a restart, and found out again.
#[derive(Clone, Debug, Default)]
pub struct Yielding {
    /// What is remembered of each robot.
    pub state: YieldingState,
    /// The published procedure, if the fleet is to use it.
    pub procedure: Procedure,
    /// Encounters that have begun.
    pub meter: Meter,
    /// What each open encounter has cost the robot's task so far.
    pub costs: BTreeMap<(WorkerId, RobotId), EncounterCost>,
}

/// When the task that a robot had when an encounter began is planned to end: at that time, and when last looked at.
#[derive(Clone, Copy, Debug)]
pub struct EncounterCost {
    /// The task.
    pub task: Task,
    /// When the task was to end as the encounter began.
    pub planned: Time,
    /// When the task is to end now, or ended.
    pub expected: Time,
}

impl EncounterCost {
    /// How much later the task ends than was planned.
    pub fn delay(&self) -> Span {
        (self.expected - self.planned).max(Span::ZERO)
    }
}

/// The published procedure in progress.
#[derive(Clone, Debug, Default)]
pub struct Procedure {
    /// The worker for whom robots stand, and since when.
    pub(super) running: Option<(WorkerId, Time)>,
    /// Workers who left their path while the procedure ran, and for whom it is to run next.
    pub(super) queue: BTreeSet<WorkerId>,
    /// The path that was expected of each worker who was told to stop.
    pub(super) stopped: BTreeMap<WorkerId, Vec<Point>>,
    /// Robots that are still to be replanned after the procedure.
    pub(super) again: BTreeSet<RobotId>,
    /// When the procedure last ended: what the worker was told then binds robots from the next step on.
    pub(super) ended: Option<Time>,
}

impl Procedure {
    /// Whether the procedure keeps a robot from further grants.
    pub fn holds(&self, robot: RobotId) -> bool {
        self.running.is_some() || self.again.contains(&robot)
    }
}
