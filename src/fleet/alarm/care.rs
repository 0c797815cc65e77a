//! What people do about an alarm: they acknowledge it, shelve it until a time, and write down what they found.
//!
//! Main types: [`Acknowledgement`], [`Shelving`], [`AlarmNote`]. Refuses: shelving without an end, and more notes than
//! [`MOST_NOTES`].

use giveway_floor::time::{Span, Time};

/// How many notes an alarm has at most.
pub const MOST_NOTES: usize = 20;
/// How long an alarm is shelved at most: a shift, so that the next one decides anew.
pub const LONGEST_SHELVING: Span = Span::from_secs(12 * 3600);
/// How many kinds and subjects are shelved at once at most.
pub const MOST_SHELVED: usize = 500;

/// Who has acknowledged an alarm, and when.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Acknowledgement {
    /// The person.
    pub by: String,
    /// When the person acknowledged the alarm.
    pub at: Time,
}

/// The shelving of an alarm: the alarm stays active, and calls no one until the shelving ends or the alarm gets worse.
/// It holds for the subject: if the alarm is cleared and raised again meanwhile, the new one is shelved as well.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shelving {
    /// The person who shelved the alarm.
    pub by: String,
    /// When the alarm was shelved.
    pub at: Time,
    /// When the shelving ends.
    pub until: Time,
    /// Why the alarm was shelved.
    pub reason: String,
}

/// What a person wrote down about an alarm.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlarmNote {
    /// The person.
    pub by: String,
    /// When the note was written.
    pub at: Time,
    /// The text of the note.
    pub text: String,
}

/// Why something cannot be done about an alarm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CareRefusal {
    /// No alarm of this number is active.
    NotActive,
    /// The alarm has as many notes as it may have.
    TooManyNotes,
    /// As many alarms are shelved as may be.
    TooManyShelved,
    /// Nothing may keep this alarm from calling: the server can promise nothing, or the building is evacuated.
    AlwaysCalls,
}
