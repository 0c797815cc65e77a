//! Facts: what happened and must not be forgotten. The ledger is a fold over them.
//!
//! Main type: [`Fact`], nested by what it is about. Facts carry results (the chosen route, the time), never recipes: a
//! better planner cannot rewrite history. Refuses: observations (poses, battery), which are seen again after a restart.
//!
//! Each kind of fact has a number. Digests of recordings are made of these numbers, so a number stays with its kind
//! for ever, and a new kind gets the next one.

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

/// Something that happened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fact {
    /// To a robot.
    Robot(RobotFact),
    /// To routes.
    Route(RouteFact),
    /// To a job.
    Job(JobFact),
    /// To a worker.
    Worker(WorkerFact),
    /// To an assignment.
    Assignment(AssignmentFact),
    /// To a closed area.
    Area(AreaFact),
    /// To the floor as a whole.
    Floor(FloorFact),
    /// Between a worker and a robot; for the record.
    Encounter(EncounterFact),
    /// Something that explains the others; for the record.
    Noted(FloorNote),
}

/// A fact from what happened to its subject.
macro_rules! facts_about {
    ($($group:ident($of:ident)),*) => {
        $(impl From<$of> for Fact {
            fn from(of: $of) -> Fact {
                Fact::$group(of)
            }
        })*
    };
}

facts_about!(
    Robot(RobotFact),
    Route(RouteFact),
    Job(JobFact),
    Worker(WorkerFact),
    Assignment(AssignmentFact),
    Area(AreaFact),
    Floor(FloorFact),
    Encounter(EncounterFact),
    Noted(FloorNote)
);

impl Hash for Fact {
    /// Hashes the number of the kind and what it holds. The subject is left out, since numbers differ between subjects.
    fn hash<H: Hasher>(&self, to: &mut H) {
        match self {
            Fact::Robot(of) => of.hash(to),
            Fact::Route(of) => of.hash(to),
            Fact::Job(of) => of.hash(to),
            Fact::Worker(of) => of.hash(to),
            Fact::Assignment(of) => of.hash(to),
            Fact::Area(of) => of.hash(to),
            Fact::Floor(of) => of.hash(to),
            Fact::Encounter(of) => of.hash(to),
            Fact::Noted(of) => of.hash(to),
        }
    }
}

impl Fact {
    /// The one robot that the fact is about.
    pub fn robot(&self) -> Option<RobotId> {
        match self {
            Fact::Robot(of) => Some(of.robot()),
            Fact::Route(of) => of.robot(),
            _ => None,
        }
    }
}
