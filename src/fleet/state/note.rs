//! What happened, for the record alone: nothing is promised by it, and the ledger does not change.
//!
//! Main types: [`FloorNote`], [`ReplanCause`], [`EventDetails`]. Places are points of the floor, so that what was
//! written stays true where the map is changed later. Refuses: to be an input to any decision.

use giveway_floor::geometry::Spot;
use giveway_floor::id::{ClosureId, RobotId, WorkerId};
use giveway_floor::time::Time;

/// Something for the record.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum FloorNote {
    /// A robot on its way to the same end has another way there, or another end for the same task.
    Replanned {
        /// The robot.
        robot: RobotId,
        /// Because of whom or what.
        cause: ReplanCause,
        /// The nodes that were ahead of it, in order; the first of them where there were many.
        was: Vec<Spot>,
        /// The nodes that are ahead of it since, likewise.
        now: Vec<Spot>,
        /// When.
        at: Time,
    },
    /// A worker is most probably going somewhere else than before.
    Goal {
        /// The worker.
        worker: WorkerId,
        /// Where to.
        place: Spot,
        /// How probable that is, percent.
        percent: u8,
        /// When.
        at: Time,
    },
}

/// Because of whom or what a robot got another way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ReplanCause {
    /// A worker is or will be on the way.
    Worker(WorkerId),
    /// An area is closed, or will be.
    Closure(ClosureId),
    /// A robot cannot drive, or was pushed onto the way.
    Robot(RobotId),
    /// Something stands on the way that the fleet does not know.
    Obstruction,
}

impl ReplanCause {
    /// The word for it on the wire.
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
    /// Of a robot that was replanned.
    Replanned {
        /// Because of whom or what.
        cause: ReplanCause,
        /// The nodes that were ahead of it.
        was: Vec<Spot>,
        /// The nodes that are ahead of it since.
        now: Vec<Spot>,
    },
    /// Of a worker's goal.
    Goal {
        /// Where.
        place: Spot,
        /// How probable, percent.
        percent: u8,
    },
}
