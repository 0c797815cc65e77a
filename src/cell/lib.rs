//! The picking station as a work cell: what must be picked from the rack that stands there, and what has been picked.
//!
//! Main module: [`arm`] (a robot arm beside the picker). Main types: [`OrderLine`], [`Lines`], [`LineState`],
//! [`PickPace`], [`PickPhase`], [`CellHands`] (hands, from slot to tote). Refuses: to know where robots drive, and to
//! confirm by guessing.

mod aim;
pub mod arm;
mod belief;
mod cell_hands;
mod check;
mod eyes;
mod face;
mod flow;
mod follow;
mod hands;
mod lines;
mod pace;
mod phase;
mod share;
mod soon;

pub use belief::ReachPlace;
pub use cell_hands::{CellHands, CellHandsEvent, CellHandsScene, SeenReach};
pub use check::{LineProblem, MOST_LINES, MOST_PIECES, problem};
pub use face::{FacePlace, PickFace};
pub use flow::Flow;
pub use follow::HeldPiece;
pub use hands::{HandPoints, HandsSeen};
pub use lines::{LineChange, LineOutcome, LineProgress, LineRefusal, LineState, Lines};
pub use pace::{PickPace, Remaining, VisitSeen};
pub use phase::PickPhase;

use giveway_floor::warehouse::SlotName;

/// Who may pick a line: a person, the robot arm, or either.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PickedBy {
    /// A person.
    Hand,
    /// The robot arm.
    Arm,
    /// Either.
    #[default]
    Either,
}

impl PickedBy {
    /// All values.
    pub const ALL: [PickedBy; 3] = [PickedBy::Hand, PickedBy::Arm, PickedBy::Either];

    /// The word for the value on the wire.
    pub fn word(self) -> &'static str {
        match self {
            PickedBy::Hand => "hand",
            PickedBy::Arm => "arm",
            PickedBy::Either => "either",
        }
    }

    /// The value with this word; nothing for an unknown word.
    pub fn named(word: &str) -> Option<PickedBy> {
        PickedBy::ALL.into_iter().find(|by| by.word() == word)
    }
}

/// A number of pieces to pick from a slot into a tote.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct OrderLine {
    /// The slot in the rack.
    pub slot: SlotName,
    /// Number of pieces, at least one.
    pub quantity: u32,
    /// The name of the tote.
    pub tote: String,
    /// The item in the customer's words.
    pub item: Option<String>,
    /// Whether a person, the arm, or either may pick the line.
    pub by: PickedBy,
}
