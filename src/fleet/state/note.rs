//! What happened, for the record alone: it promises nothing, and the ledger does not change.
//!
//! Main types: [`FloorNote`], [`ReplanCause`], [`EventDetails`]. Places are points of the floor, so that the record
//! stays true if the map is changed later. Refuses: to be an input to any decision.

use giveway_floor::geometry::Spot;
use giveway_floor::id::{ClosureId, RobotId, WorkerId};
use giveway_floor::time::Time;

/// Something for the record.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum FloorNote {
    /// A robot on its way to the same end got another route there, or another end for the same task.
    Replanned {
        /// The robot.
        robot: RobotId,
        /// Why the robot was replanned.
        cause: ReplanCause,
        /// The nodes that were ahead of the robot, in order; only the first of them if there were many.
        was: Vec<Spot>,
        /// The nodes that are ahead of the robot since, in order; only the first of them if there are many.
        now: Vec<Spot>,
        /// Time of the event.
        at: Time,
    },
    /// A worker is most probably going somewhere else than before.
    Goal {
        /// The worker.
        worker: WorkerId,
        /// Where the worker is going.
        place: Spot,
        /// How probable the goal is, percent.
        percent: u8,
        /// Time of the event.
        at: Time,
    },
}

/// Why a robot got another route.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ReplanCause {
    /// A worker is or will be on the way.
    Worker(WorkerId),
    /// An area is closed, or will be.
    Closure(ClosureId),
    /// A robot cannot drive, or was pushed onto the way.
    Robot(RobotId),
    /// Something that the fleet does not know stands on the way.
    Obstruction,
}

impl ReplanCause {
    /// The cause's word on the wire.
    pub fn word(self) -> &'static str {
        match self {
            ReplanCause::Worker(_) => "worker",
            ReplanCause::Closure(_) => "closure",
            ReplanCause::Robot(_) => "robot",
            ReplanCause::Obstruction => "obstruction",
        }
    }

    /// The number of the worker, the closure or the robot.
    pub fn number(self) -> Option<u64> {
        match self {
            ReplanCause::Worker(w) => Some(w.0.into()),
            ReplanCause::Closure(c) => Some(c.0),
            ReplanCause::Robot(r) => Some(r.0.into()),
            ReplanCause::Obstruction => None,
        }
    }

    /// The cause of this word and number.
    pub fn of(word: &str, number: Option<u64>) -> Option<ReplanCause> {
        let small = || u32::try_from(number?).ok();
        Some(match word {
            "worker" => ReplanCause::Worker(WorkerId(small()?)),
            "closure" => ReplanCause::Closure(ClosureId(number?)),
            "robot" => ReplanCause::Robot(RobotId(small()?)),
            "obstruction" => ReplanCause::Obstruction,
            _ => return None,
        })
    }
}

/// What an event tells besides a state. Places are points of the floor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EventDetails {
    /// A robot was replanned.
    Replanned {
        /// Why the robot was replanned.
        cause: ReplanCause,
        /// The nodes that were ahead of the robot.
        was: Vec<Spot>,
        /// The nodes that are ahead of the robot since.
        now: Vec<Spot>,
    },
    /// A worker has another goal.
    Goal {
        /// Where the goal is.
        place: Spot,
        /// How probable the goal is, percent.
        percent: u8,
    },
}
