//! What is wrong with a message, for operators.
//!
//! Main types: [`Oddity`] (the message was read all the same), [`Unreadable`] (it was not). Places are written as paths
//! from the message, such as `nodeStates[3].nodePosition.x`. Refuses: to rank oddities, and to repeat long texts.

use super::{LONGEST_LIST, LONGEST_TEXT, MOST_BYTES, MOST_PARTS};
use std::fmt;

/// Something in a message that is not as the standard wants it, and what was made of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Oddity {
    /// A field that every message of its kind must have is missing.
    Missing {
        /// Where.
        place: String,
        /// What was taken instead.
        taken_as: String,
    },
    /// An enumeration has a word that no version knows.
    UnknownWord {
        /// Where.
        place: String,
        /// The word.
        word: String,
        /// What it was taken for.
        taken_as: String,
    },
    /// A key or a word is spelled as in no version, and could be understood.
    Spelling {
        /// Where.
        place: String,
        /// What is there.
        found: String,
        /// The official spelling.
        official: &'static str,
    },
    /// A value has another form, such as a number written as a text, and could be understood.
    Converted {
        /// Where.
        place: String,
        /// Which form it has.
        found: &'static str,
        /// Which form it should have.
        wanted: &'static str,
    },
    /// A value has a form that could not be understood, and was ignored.
    WrongForm {
        /// Where.
        place: String,
        /// Which form it has.
        found: &'static str,
        /// Which form it should have.
        wanted: &'static str,
    },
    /// A number is not finite or cannot be meant, and was ignored.
    BadNumber {
        /// Where.
        place: String,
        /// The number.
        number: String,
    },
    /// A text is too long and was cut.
    LongText {
        /// Where.
        place: String,
        /// How long it was, characters.
        length: usize,
    },
    /// A list is too long and was cut.
    LongList {
        /// Where.
        place: String,
        /// How many elements it had.
        length: usize,
    },
    /// Something could not be read, and the rest of the message does not depend on it.
    LeftOut {
        /// Where.
        place: String,
        /// Why.
        why: Unreadable,
    },
    /// The payload is not UTF-8: every stretch that is not was replaced by a mark.
    NotUtf8,
    /// There are too many oddities to tell.
    Further {
        /// How many are not told.
        count: usize,
    },
}

impl fmt::Display for Oddity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Oddity::Missing { place, taken_as } => {
                write!(f, "{place} is missing and was taken as {taken_as}")
            }
            Oddity::UnknownWord { place, word, taken_as } => {
                write!(f, "{place} is {word:?}, a word that no version knows, and was taken as {taken_as}")
            }
            Oddity::Spelling { place, found, official } => {
                write!(f, "{place}: {found:?} was understood as {official:?}")
            }
            Oddity::Converted { place, found, wanted } => {
                write!(f, "{place} is {found} instead of {wanted}, and was understood")
            }
            Oddity::WrongForm { place, found, wanted } => {
                write!(f, "{place} is {found} instead of {wanted}, and was ignored")
            }
            Oddity::BadNumber { place, number } => {
                write!(f, "{place} is {number}, which cannot be meant, and was ignored")
            }
            Oddity::LongText { place, length } => {
                write!(f, "{place} has {length} characters, of which the first {LONGEST_TEXT} were kept")
            }
            Oddity::LongList { place, length } => {
                write!(f, "{place} has {length} elements, of which the first {LONGEST_LIST} were kept")
            }
            Oddity::LeftOut { place, why } => write!(f, "{place} was left out: {why}"),
            Oddity::NotUtf8 => write!(f, "the payload is not UTF-8, and some of its characters are lost"),
            Oddity::Further { count } => write!(f, "{count} further oddities"),
        }
    }
}

/// Why a message could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unreadable {
    /// The payload is empty, as when a retained message is deleted.
    #[error("the payload is empty")]
    Empty,
    /// The payload is too long.
    #[error("the payload has {length} bytes, but at most {MOST_BYTES} are read")]
    TooLong {
        /// How long it is, bytes.
        length: usize,
    },
    /// The payload has too many objects and lists.
    #[error("the payload has more than {MOST_PARTS} objects and lists")]
    TooManyParts,
    /// The payload is no JSON, or is nested too deep.
    #[error("the payload is no JSON that can be read: {reason}")]
    NotJson {
        /// What the parser says.
        reason: String,
    },
    /// The payload is JSON, but not an object.
    #[error("the payload is {found} instead of an object")]
    NotAnObject {
        /// What it is.
        found: &'static str,
    },
    /// Something is missing, or has a wrong form, and a guess would do harm.
    #[error("{place} is missing or cannot be understood, and must not be guessed")]
    Missing {
        /// Where.
        place: String,
    },
}
