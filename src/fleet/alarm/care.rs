//! What people do about an alarm: they take note of it, put it aside until a time, and write down what they found.
//!
//! Main types: [`Acknowledgement`], [`Shelving`], [`AlarmNote`]. Refuses: shelving without an end, and more notes than
//! [`MOST_NOTES`].

use giveway_floor::time::{Span, Time};

/// So many notes an alarm has at most.
pub const MOST_NOTES: usize = 20;
/// An alarm is put aside for so long at most: a shift, so that the next one decides anew.
pub const LONGEST_SHELVING: Span = Span::from_secs(12 * 3600);
/// So many kinds and subjects are put aside at once.
pub const MOST_SHELVED: usize = 500;

/// Who has taken note of an alarm, and when.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Acknowledgement {
    /// Who.
    pub by: String,
    /// When.
    pub at: Time,
}

/// An alarm that was put aside: it stays active, and calls nobody until this ends or it gets worse. It holds for the
/// subject: if the alarm is cleared and raised again meanwhile, that one is put aside as well.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shelving {
    /// Who.
    pub by: String,
    /// When.
    pub at: Time,
    /// Until when.
    pub until: Time,
    /// Why.
    pub reason: String,
}

/// What somebody wrote down about an alarm.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlarmNote {
    /// Who.
    pub by: String,
    /// When.
    pub at: Time,
    /// What.
    pub text: String,
}

/// Why something cannot be done about an alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CareRefusal {
    /// None of this number is active.
    NotActive,
    /// It has as many notes as it may have.
    TooManyNotes,
    /// As many alarms as may be are put aside.
    TooManyShelved,
    /// Nothing may keep this one from calling: the server can promise nothing, or the building is evacuated.
    AlwaysCalls,
}
