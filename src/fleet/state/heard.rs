//! What the inputs of a step mean for parts of the core that run later in it.
//!
//! Main type: [`StepNews`]. Refuses: to outlast the step.

use crate::state::worker::LastPlace;
use giveway_floor::id::{RobotId, WorkerId};
use giveway_people::human::Sighting;

/// What was heard of one worker, in order.
#[derive(Clone, Copy, Debug)]
pub enum WorkerInput {
    /// A worker was seen.
    Seen(Sighting),
    /// What was believed about a worker is wrong.
    Cleared(WorkerId),
    /// A worker is near this place.
    Narrowed(WorkerId, LastPlace),
    /// A worker will not be seen any more.
    SignedOff(WorkerId),
}

/// What inputs mean for other parts of the core.
#[derive(Debug, Default)]
pub struct StepNews {
    /// What was heard of workers.
    pub people: Vec<WorkerInput>,
    /// Robots whose rack has been picked from.
    pub picked: Vec<RobotId>,
    /// Robots that may go on earlier than planned.
    pub left_early: Vec<RobotId>,
}
