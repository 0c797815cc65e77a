//! What is kept in mind about giving way: of each robot, of the published procedure, of encounters that have begun.
//!
//! Main types: [`Yielding`], [`Procedure`]. Refuses: to decide.

use crate::state::fact::Task;
use crate::state::yielding::YieldingState;
use giveway_floor::geometry::Point;
use giveway_floor::id::{RobotId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_people::aware::Meter;
use std::collections::{BTreeMap, BTreeSet};

/// What is kept in mind about giving way, from step to step. Lost at a restart, and found out again.
#[derive(Clone, Debug, Default)]
pub struct Yielding {
    /// For each robot.
    pub state: YieldingState,
    /// The published reaction, where that is what the fleet is to use.
    pub procedure: Procedure,
    /// Encounters that have begun.
    pub meter: Meter,
    /// What each of them has cost the robot's task so far.
    pub costs: BTreeMap<(WorkerId, RobotId), EncounterCost>,
}

/// When the task that a robot had when an encounter began was planned to end: then, and when it was looked at last.
#[derive(Clone, Copy, Debug)]
pub struct EncounterCost {
    /// The task.
    pub task: Task,
    /// When it was to end as the encounter began.
    pub planned: Time,
    /// When it is to end now, or ended.
    pub expected: Time,
}

impl EncounterCost {
    /// How much later the task ends than was planned.
    pub fn delay(&self) -> Span {
        (self.expected - self.planned).max(Span::ZERO)
    }
}

/// The procedure in progress.
#[derive(Clone, Debug, Default)]
pub struct Procedure {
    /// The worker for whom robots stand, and since when.
    pub(super) running: Option<(WorkerId, Time)>,
    /// Workers who left their path meanwhile.
    pub(super) queue: BTreeSet<WorkerId>,
    /// The path that was expected of each worker who was told to stop.
    pub(super) stopped: BTreeMap<WorkerId, Vec<Point>>,
    /// Robots that are planned anew after it.
    pub(super) again: BTreeSet<RobotId>,
    /// When it ended last: what the worker was told then binds robots from the next step on.
    pub(super) ended: Option<Time>,
}

impl Procedure {
    /// Whether a robot gets no further grants.
    pub fn holds(&self, robot: RobotId) -> bool {
        self.running.is_some() || self.again.contains(&robot)
    }
}
