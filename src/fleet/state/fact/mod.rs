//! Facts: what happened and must not be forgotten. The ledger is a fold over them.
//!
//! Main type: [`Fact`], nested by subject. Facts carry results (the chosen route, the time), never recipes: a
//! better planner cannot rewrite history. Refuses: observations (poses, battery), which are seen again after a restart.
//!
//! Each kind of fact has a number. Digests of recordings are made of these numbers, so a kind keeps its number for
//! ever, and a new kind gets the next one.

mod floor;
mod job;
mod people;
mod robot;
mod route;

pub use floor::{AreaFact, FloorFact};
pub use job::JobFact;
pub use people::{AssignmentFact, EncounterFact, WorkerFact};
pub use robot::{Purpose, RobotFact, Task};
pub use route::{Act, Booking, KeptRoute, Moved, RouteFact, Stop};

use crate::state::note::FloorNote;
use giveway_floor::id::RobotId;
use std::hash::{Hash, Hasher};

/// The one list of what facts are about: the type, the way in from each subject, and the hash follow from it.
macro_rules! facts_about {
    ($($(#[$doc:meta])* $group:ident($of:ident),)*) => {
        /// Something that happened.
        #[derive(Clone, Debug, PartialEq, Eq)]
        pub enum Fact {
            $($(#[$doc])* $group($of),)*
        }

        $(impl From<$of> for Fact {
            fn from(of: $of) -> Fact {
                Fact::$group(of)
            }
        })*

        impl Hash for Fact {
            /// Hashes the number of the kind and what it holds. The subject is left out, since numbers differ between
            /// subjects.
            fn hash<H: Hasher>(&self, to: &mut H) {
                match self {
                    $(Fact::$group(of) => of.hash(to),)*
                }
            }
        }
    };
}

facts_about! {
    /// Something that happened to a robot.
    Robot(RobotFact),
    /// Something that happened to routes.
    Route(RouteFact),
    /// Something that happened to a job.
    Job(JobFact),
    /// Something that happened to a worker.
    Worker(WorkerFact),
    /// Something that happened to an assignment.
    Assignment(AssignmentFact),
    /// Something that happened to a closed area.
    Area(AreaFact),
    /// Something that happened to the floor as a whole.
    Floor(FloorFact),
    /// Something that happened between a worker and a robot; for the record.
    Encounter(EncounterFact),
    /// Something that explains other facts; for the record.
    Noted(FloorNote),
}

impl Fact {
    /// The robot that the fact is about, if it is about a single one.
    pub fn robot(&self) -> Option<RobotId> {
        match self {
            Fact::Robot(of) => Some(of.robot()),
            Fact::Route(of) => of.robot(),
            _ => None,
        }
    }
}
