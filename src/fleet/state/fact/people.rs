//! What happens to workers and their assignments, and where robots meet them.
//!
//! Main types: [`WorkerFact`], [`AssignmentFact`], [`EncounterFact`]. Refuses: poses, which are seen again after a
//! restart.

use crate::state::worker::{AssignmentRequest, AssignmentState, Encounter, LastPlace, Reaction};
use giveway_floor::id::{AssignmentId, RobotId, WorkerId};
use giveway_floor::time::Time;
use giveway_people::human::Mover;

/// Something that happened to a worker.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[repr(isize)]
pub enum WorkerFact {
    /// A worker is known from now on or, if the name is empty, no longer. Workers are numbered in order of joining;
    /// when all numbers are in use, those of workers who have gone are given again.
    Registered {
        /// The number.
        worker: WorkerId,
        /// The name; empty if the number is free again.
        name: String,
        /// Time of the fact.
        at: Time,
    } = 16,
    /// A worker is on the floor.
    Noted {
        /// The worker.
        worker: WorkerId,
        /// Where the worker is, as far as is known.
        place: LastPlace,
    } = 17,
    /// A person vouches for where a lost worker is.
    Narrowed {
        /// The worker.
        worker: WorkerId,
        /// Where the worker is, as far as is known.
        place: LastPlace,
        /// The person who says so.
        by: String,
        /// Time of the fact.
        at: Time,
    } = 18,
    /// A worker has left the floor, or a person vouches that no one is where a worker was lost.
    Cleared {
        /// The worker.
        worker: WorkerId,
        /// The person who says so; nothing if the headset signed off at a door.
        by: Option<String>,
        /// Time of the fact.
        at: Time,
    } = 19,
    /// A worker is on foot or in a vehicle from now on.
    Moves {
        /// The worker.
        worker: WorkerId,
        /// What the worker moves as.
        mover: Mover,
        /// Time of the fact.
        at: Time,
    } = 50,
}

/// Something that happened to an assignment.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[repr(isize)]
pub enum AssignmentFact {
    /// A worker is to do something. Assignments are numbered in order of acceptance.
    Assigned {
        /// The new number.
        assignment: AssignmentId,
        /// The worker; nothing if the nearest free worker is to get the assignment.
        worker: Option<WorkerId>,
        /// What the worker is to do.
        request: AssignmentRequest,
        /// Time of the fact.
        at: Time,
    } = 20,
    /// An assignment without a worker was given to one.
    Given {
        /// The assignment.
        assignment: AssignmentId,
        /// The worker.
        worker: WorkerId,
        /// Time of the fact.
        at: Time,
    } = 21,
    /// An assignment came to another state.
    Advanced {
        /// The assignment.
        assignment: AssignmentId,
        /// The new state.
        state: AssignmentState,
        /// Time of the fact.
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
        /// Time of the fact.
        at: Time,
    } = 37,
    /// A robot had to stop or to change its route because of a worker.
    Interrupted {
        /// The robot.
        robot: RobotId,
        /// The worker who was the reason.
        worker: WorkerId,
        /// How the robot reacted.
        reaction: Reaction,
        /// Time of the fact.
        at: Time,
    } = 38,
}
