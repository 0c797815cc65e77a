//! What the inputs of a step mean for rooms that come later in it.
//!
//! Main type: [`Heard`]. Refuses: to be kept.

use crate::fleet::state::worker::LastPlace;
use crate::human::Sighting;
use crate::id::{RobotId, WorkerId};

/// What was heard of one worker, in order.
#[derive(Clone, Copy, Debug)]
pub(in crate::fleet) enum WorkerInput {
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
pub(in crate::fleet) struct Heard {
    /// What was heard of workers.
    pub people: Vec<WorkerInput>,
    /// Robots from whose rack has been picked.
    pub picked: Vec<RobotId>,
    /// Robots that may go on earlier than planned.
    pub left_early: Vec<RobotId>,
}
