//! Sentences for people, each with a code and named places, so that a program can show them in other languages.
//!
//! Main types: [`Sentence`], [`SentenceArg`]. The files beside this one list all sentences by subject, once each:
//! `waits_for(place, robot) = "waits for {place}, held by {robot}"` makes the constructor `waits_for`, the English text
//! and the entry in [`SENTENCES`]. `web/src/language/said/` has each code in every other language of the dashboard; a
//! test here compares both. Refuses: a sentence that is made elsewhere, except for text without a code in recordings
//! and databases of earlier versions.

pub mod alarms;
mod arg;
pub mod bookmarks;
pub mod feed;
pub mod guidance;
pub mod links;
pub mod reasons;
pub mod refusals;
pub mod remedies;
pub mod requests;
mod wire;

pub use arg::SentenceArg;
pub use wire::SentenceArgs;

use std::fmt;

/// A sentence for people: a code, the values of its places, and its English text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sentence {
    code: Option<&'static str>,
    args: SentenceArgs,
    text: String,
}

impl Sentence {
    /// Called only by the constructors: the English text is made from the same code and arguments.
    fn new(code: &'static str, args: Vec<(&'static str, SentenceArg)>, text: String) -> Sentence {
        let args = SentenceArgs(args.into_iter().map(|(name, arg)| (name.into(), arg)).collect());
        Sentence { code: Some(code), args, text }
    }

    /// A text from before sentences had codes; it stays English.
    pub fn without_code(text: impl Into<String>) -> Sentence {
        Sentence { text: text.into(), ..Sentence::default() }
    }

    /// The code of the sentence; nothing for texts from before sentences had codes.
    pub fn code(&self) -> Option<&'static str> {
        self.code
    }

    /// The English text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Code, arguments and English text.
    pub fn into_parts(self) -> (Option<&'static str>, SentenceArgs, String) {
        (self.code, self.args, self.text)
    }

    /// A sentence from the parts of one.
    pub fn from_parts(code: Option<&'static str>, args: SentenceArgs, text: String) -> Sentence {
        Sentence { code, args, text }
    }

    /// The sentence as a database stores it in a text column; [`Sentence::read`] reads it.
    pub fn kept(&self) -> String {
        match self.code {
            Some(_) => serde_json::to_string(self).expect("sentences are plain"),
            None => self.text.clone(),
        }
    }

    /// Reads what [`Sentence::kept`] wrote, or a text from before sentences had codes.
    pub fn read(kept: &str) -> Sentence {
        let sentence = if kept.starts_with('{') { serde_json::from_str(kept).ok() } else { None };
        sentence.unwrap_or_else(|| Sentence::without_code(kept))
    }
}

impl fmt::Display for Sentence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// An entry in the list of sentences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SentenceEntry {
    /// Code of the sentence.
    pub code: &'static str,
    /// Names of its places, in the order of the constructor.
    pub places: &'static [&'static str],
    /// English text of the sentence, with the places in braces.
    pub english: &'static str,
}

/// All sentences, by subject.
pub const SENTENCES: [&[SentenceEntry]; 9] = [
    reasons::ENTRIES,
    alarms::ENTRIES,
    remedies::ENTRIES,
    bookmarks::ENTRIES,
    refusals::ENTRIES,
    requests::ENTRIES,
    feed::ENTRIES,
    guidance::ENTRIES,
    links::ENTRIES,
];

/// Lists sentences, each as `code(place, place) = "English text with {place}";`, and makes a constructor of each. A
/// place that the list does not name does not compile.
macro_rules! sentences {
    ($($code:ident($($place:ident),*) = $english:literal;)+) => {
        /// The sentences of this file.
        pub const ENTRIES: &[super::SentenceEntry] = &[$(
            super::SentenceEntry {
                code: stringify!($code),
                places: &[$(stringify!($place)),*],
                english: $english,
            },
        )+];

        $(
            #[doc = $english]
            pub fn $code($($place: impl Into<super::SentenceArg>),*) -> super::Sentence {
                $(let $place: super::SentenceArg = $place.into();)*
                let text = format!($english);
                super::Sentence::new(stringify!($code), vec![$((stringify!($place), $place)),*], text)
            }
        )+
    };
}
use sentences;

#[cfg(test)]
mod tests;
