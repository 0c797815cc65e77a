//! What happens to the floor as a whole: areas are closed, people leave the building, stations pause,
//! kinds of robots come and go.
//!
//! Main types: [`AreaFact`], [`FloorFact`]. Refuses: single robots, jobs and workers.

use crate::state::kind::RobotKind;
use crate::state::recurring::RecurringClosure;
use crate::state::worker::Closure;
use giveway_floor::id::{AssignmentId, ClosureId, JobId, RobotId, SeriesId, StationId};
use giveway_floor::time::Time;

/// Something that happened to an area that robots keep out of.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[repr(isize)]
pub enum AreaFact {
    /// Robots keep out of an area. Closures are numbered in order of marking.
    Closed {
        /// The new number.
        closure: ClosureId,
        /// Where, when and why the area is closed.
        area: Closure,
    } = 23,
    /// The closure has ended; robots may route through the area again.
    Reopened {
        /// The closure.
        closure: ClosureId,
        /// Time of the fact.
        at: Time,
    } = 24,
    /// An area is closed again and again. Recurring closures are numbered in order of marking.
    Recurs {
        /// The new number.
        series: SeriesId,
        /// Where, when and why the area is closed.
        closure: RecurringClosure,
    } = 25,
    /// An occurrence of a recurring closure was announced or skipped, and another one is next.
    Scheduled {
        /// The recurring closure.
        series: SeriesId,
        /// When the next occurrence begins that has not been announced; nothing if there is none.
        next: Option<Time>,
    } = 26,
    /// A closure no longer recurs.
    SeriesEnded {
        /// The recurring closure.
        series: SeriesId,
        /// Time of the fact.
        at: Time,
    } = 27,
}

/// Something that happened to the whole floor, or to a station.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[repr(isize)]
pub enum FloorFact {
    /// All people are to leave the building.
    Evacuated {
        /// Time of the fact.
        at: Time,
    } = 28,
    /// People may come back, and robots go on.
    EvacuationEnded {
        /// Time of the fact.
        at: Time,
    } = 29,
    /// One robot, or the whole fleet, is to stand.
    Halted {
        /// The robot; nothing for the whole fleet.
        robot: Option<RobotId>,
        /// Time of the fact.
        at: Time,
    } = 30,
    /// The robot, or the whole fleet, may go on.
    Released {
        /// The robot; nothing for the whole fleet.
        robot: Option<RobotId>,
        /// Time of the fact.
        at: Time,
    } = 31,
    /// Picking at a station is paused until further notice.
    StationPaused {
        /// The station.
        station: StationId,
        /// Time of the fact.
        at: Time,
    } = 32,
    /// Picking at a station goes on.
    StationResumed {
        /// The station.
        station: StationId,
        /// Time of the fact.
        at: Time,
    } = 33,
    /// Customers' keys are forgotten: their jobs and assignments are over and were accepted long ago.
    KeysExpired {
        /// The jobs that had such keys.
        jobs: Vec<JobId>,
        /// The assignments that had such keys.
        assignments: Vec<AssignmentId>,
    } = 39,
    /// Robots of this kind may join from now on. It replaces the added kind of the same name, which no robot has.
    KindPut {
        /// The kind.
        kind: Box<RobotKind>,
        /// Time of the fact.
        at: Time,
    } = 47,
    /// Robots of this kind can no longer join, and no robot has this kind.
    KindRemoved {
        /// The name of the kind.
        name: String,
        /// Time of the fact.
        at: Time,
    } = 48,
}
