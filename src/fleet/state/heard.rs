//! What the inputs of a step mean for rooms that come later in it.
//!
//! Main type: [`StepNews`]. Refuses: to be kept.

use crate::state::worker::LastPlace;
use giveway_floor::id::{RobotId, WorkerId};
use giveway_people::human::Sighting;

/// What was heard of one worker, in order.
#[derive(Clone, Copy, Debug)]
pub enum WorkerInput {
    /// A worker was seen.
    Seen(Sighting),
    /// What was believed of a worker is wrong.
    Cleared(WorkerId),
    /// A worker is near there.
    Narrowed(WorkerId, LastPlace),
    /// A worker will not be seen any more.
    SignedOff(WorkerId),
}

/// What inputs mean for other rooms.
#[derive(Debug, Default)]
pub struct StepNews {
    /// What was heard of workers.
    pub people: Vec<WorkerInput>,
    /// Robots from whose rack has been picked.
    pub picked: Vec<RobotId>,
    /// Robots that may go on earlier than planned.
    pub left_early: Vec<RobotId>,
}
