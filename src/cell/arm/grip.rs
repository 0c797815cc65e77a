//! What a cell and an arm exchange beside joints: what the gripper should do, and what it did.
//!
//! Main types: [`ArmSaid`] (comes in), [`ArmOrder`] (goes out). Each is repeated until the other side has it, so that
//! lost messages do no harm: a grip has a number and is done once. Refuses: grips while the arm moves.

use super::seam::{ArmReport, ArmTrajectory};
use giveway_floor::id::{JobId, StationId};
use giveway_floor::warehouse::SlotName;

/// What the gripper does while the arm stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GripAct {
    /// Takes a piece out of this slot.
    Take(SlotName),
    /// Puts the piece into the tote with this number at the station.
    Put(usize),
    /// Lays aside, where the arm rests, a piece that is no longer wanted.
    LayAside,
}

/// A requested grip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArmGrip {
    /// Number of the grip: a grip that was done under a number is not done again.
    pub number: u64,
    /// What the gripper should do.
    pub act: GripAct,
}

/// The result of a grip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gripped {
    /// The grip is done.
    Done,
    /// There was nothing to take.
    Empty,
}

/// A report from an arm, about ten times a second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmSaid {
    /// The arm's station.
    pub station: StationId,
    /// The arm's joints and whether its stop holds it.
    pub report: ArmReport,
    /// Number and result of the last grip that the arm has finished.
    pub gripped: Option<(u64, Gripped)>,
}

/// An order to an arm: to follow the trajectory, stand at its end unless a newer order came, and grip there.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmOrder {
    /// The arm's station.
    pub station: StationId,
    /// At most a second of motion.
    pub trajectory: ArmTrajectory,
    /// What the gripper does at the end of the trajectory.
    pub grip: Option<ArmGrip>,
    /// The job, and the number of its line, for which the arm picks; nothing where the arm has no task.
    pub line: Option<(JobId, usize)>,
}
