//! What a cell and an arm say to one another beside joints: what the gripper is to do, and what it did.
//!
//! Main types: [`ArmSaid`] (comes in), [`ArmOrder`] (goes out). Either is repeated until the other side has it, so
//! that lost messages do no harm: a grip has a number and is done once. Refuses: grips while the arm moves.

use super::seam::{ArmReport, ArmTrajectory};
use giveway_floor::id::{JobId, StationId};
use giveway_floor::warehouse::SlotName;

/// What the gripper does where the arm stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GripAct {
    /// It takes a piece out of this slot.
    Take(SlotName),
    /// It puts the piece into this tote, by its number at the station.
    Put(usize),
    /// It lays aside, where the arm rests, a piece that nobody wants any more.
    LayAside,
}

/// A grip that is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArmGrip {
    /// Its number: what was done under it is not done again.
    pub number: u64,
    /// What.
    pub act: GripAct,
}

/// What came of a grip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gripped {
    /// It is done.
    Done,
    /// There was nothing to take.
    Empty,
}

/// What an arm says, about ten times a second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmSaid {
    /// Where it is.
    pub station: StationId,
    /// How it is.
    pub report: ArmReport,
    /// The last grip that it has ended, by its number, and what came of it.
    pub gripped: Option<(u64, Gripped)>,
}

/// What an arm is to do. It follows the trajectory, stands at its end unless something newer came, and grips there.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmOrder {
    /// Where it is.
    pub station: StationId,
    /// At most a second of motion.
    pub trajectory: ArmTrajectory,
    /// What the gripper does at its end.
    pub grip: Option<ArmGrip>,
    /// Whom it picks for: the job, and the number of its line. Nothing where the arm has no task.
    pub line: Option<(JobId, usize)>,
}
