//! What happens to workers and their assignments, and where robots meet them.
//!
//! Main types: [`WorkerFact`], [`AssignmentFact`], [`EncounterFact`]. Refuses: poses, which are seen again after a
//! restart.

use crate::state::worker::{AssignmentRequest, AssignmentState, Encounter, LastPlace, Reaction};
use giveway_floor::id::{AssignmentId, RobotId, WorkerId};
use giveway_floor::time::Time;

/// Something that happened to a worker.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[repr(isize)]
pub enum WorkerFact {
    /// A worker is known from now on, or, where the name is empty, no longer. Workers are numbered in order of joining;
    /// when there are as many numbers as there may be, those of workers who have gone are given again.
    Registered {
        /// The number.
        worker: WorkerId,
        /// The name; empty where the place is free.
        name: String,
        /// When it happened.
        at: Time,
    } = 16,
    /// A worker is on the floor.
    Noted {
        /// The worker.
        worker: WorkerId,
        /// Where the worker is, as far as is known.
        place: LastPlace,
    } = 17,
    /// Somebody vouches for where a lost worker is.
    Narrowed {
        /// The worker.
        worker: WorkerId,
        /// Where the worker is, as far as is known.
        place: LastPlace,
        /// Who says so.
        by: String,
        /// When it happened.
        at: Time,
    } = 18,
    /// A worker has left the floor, or somebody vouches that nobody is where one was lost.
    Cleared {
        /// The worker.
        worker: WorkerId,
        /// Who says so; nobody where the headset signed off at a door.
        by: Option<String>,
        /// When it happened.
        at: Time,
    } = 19,
}

/// Something that happened to an assignment.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[repr(isize)]
pub enum AssignmentFact {
    /// A worker is to do something. Assignments are numbered in order of acceptance.
    Assigned {
        /// The new number.
        assignment: AssignmentId,
        /// The worker; nobody where the nearest one who is free is to get it.
        worker: Option<WorkerId>,
        /// What.
        request: AssignmentRequest,
        /// When it happened.
        at: Time,
    } = 20,
    /// An assignment that nobody had was given to a worker.
    Given {
        /// The assignment.
        assignment: AssignmentId,
        /// The worker.
        worker: WorkerId,
        /// When it happened.
        at: Time,
    } = 21,
    /// An assignment came to another state.
    Advanced {
        /// The assignment.
        assignment: AssignmentId,
        /// The new state.
        state: AssignmentState,
        /// When it happened.
        at: Time,
    } = 22,
}

/// Something that happened between a worker and a robot, or because a worker left the path. It is for the record:
/// nothing is promised by it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[repr(isize)]
pub enum EncounterFact {
    /// A robot met a worker.
    Met(Encounter) = 36,
    /// A worker left the path.
    Deviated {
        /// The worker.
        worker: WorkerId,
        /// When it happened.
        at: Time,
    } = 37,
    /// A robot had to stop or to change its route because of a worker.
    Interrupted {
        /// The robot.
        robot: RobotId,
        /// The worker because of whom.
        worker: WorkerId,
        /// What happened to it.
        reaction: Reaction,
        /// When it happened.
        at: Time,
    } = 38,
}
