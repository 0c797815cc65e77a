//! The picking station as a work cell: what is to be picked from the rack that stands there, and how far that has come.
//!
//! Main types: [`OrderLine`], [`Lines`], [`LineState`]. Refuses: to know where robots drive, and to confirm by guessing.

mod lines;

pub use lines::{LineChange, LineRefusal, LineState, Lines, Outcome, Progress};

use crate::warehouse::SlotName;

/// Who may pick a line.
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

/// So many pieces from a slot into a tote.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct OrderLine {
    /// From where in the rack.
    pub slot: SlotName,
    /// How many pieces, at least one.
    pub quantity: u32,
    /// The name of the tote.
    pub tote: String,
    /// What it is, in the customer's words.
    pub item: Option<String>,
    /// Who may pick it.
    pub by: PickedBy,
}
