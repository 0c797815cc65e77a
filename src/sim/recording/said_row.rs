//! Requests of stations in recordings.
//!
//! Main type: [`Says`]. Refuses: to drop any request.

use giveway_cell::LineChange;
use giveway_fleet::StationOrder;
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Says {
    Done,
    Short,
    Pause,
    Resume,
    Release,
    /// Number of additional pieces picked of this line.
    Picked(usize, u32),
    /// This line is short.
    Missing(usize),
    /// Pieces of the line that was not confirmed when its rack left, as in `Picked`; `Missing` and `Undo` follow.
    LastPicked(u32),
    LastMissing,
    LastUndo,
    /// Takes back what was reported of this line.
    Undo(usize),
    /// Gives this line to the arm, or back to the hand; then the same for the line that was not confirmed.
    ToArm(usize),
    ToHand(usize),
    LastToArm,
    LastToHand,
}

impl From<StationOrder> for Says {
    fn from(order: StationOrder) -> Says {
        match order {
            StationOrder::Done => Says::Done,
            StationOrder::Short => Says::Short,
            StationOrder::Pause => Says::Pause,
            StationOrder::Resume => Says::Resume,
            StationOrder::Release => Says::Release,
            StationOrder::Line(line, LineChange::Done(pieces)) => Says::Picked(line, pieces),
            StationOrder::Line(line, LineChange::Short) => Says::Missing(line),
            StationOrder::Line(line, LineChange::Undo) => Says::Undo(line),
            StationOrder::Last(LineChange::Done(pieces)) => Says::LastPicked(pieces),
            StationOrder::Last(LineChange::Short) => Says::LastMissing,
            StationOrder::Last(LineChange::Undo) => Says::LastUndo,
            StationOrder::Line(line, LineChange::ToArm) => Says::ToArm(line),
            StationOrder::Line(line, LineChange::ToHand) => Says::ToHand(line),
            StationOrder::Last(LineChange::ToArm) => Says::LastToArm,
            StationOrder::Last(LineChange::ToHand) => Says::LastToHand,
        }
    }
}

impl From<Says> for StationOrder {
    fn from(says: Says) -> StationOrder {
        match says {
            Says::Done => StationOrder::Done,
            Says::Short => StationOrder::Short,
            Says::Pause => StationOrder::Pause,
            Says::Resume => StationOrder::Resume,
            Says::Release => StationOrder::Release,
            Says::Picked(line, pieces) => StationOrder::Line(line, LineChange::Done(pieces)),
            Says::Missing(line) => StationOrder::Line(line, LineChange::Short),
            Says::Undo(line) => StationOrder::Line(line, LineChange::Undo),
            Says::LastPicked(pieces) => StationOrder::Last(LineChange::Done(pieces)),
            Says::LastMissing => StationOrder::Last(LineChange::Short),
            Says::LastUndo => StationOrder::Last(LineChange::Undo),
            Says::ToArm(line) => StationOrder::Line(line, LineChange::ToArm),
            Says::ToHand(line) => StationOrder::Line(line, LineChange::ToHand),
            Says::LastToArm => StationOrder::Last(LineChange::ToArm),
            Says::LastToHand => StationOrder::Last(LineChange::ToHand),
        }
    }
}
