//! The values of the places of a sentence.
//!
//! Main type: [`SentenceArg`]. Refuses: units and formats of numbers, which depend on the language.

use super::Sentence;
use std::fmt;

/// The value of one place of a sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SentenceArg {
    /// A name, or words that are not translated.
    Text(String),
    /// A whole number.
    Number(i64),
    /// A number with this many digits behind the point: 62 with 2 of them is 0.62.
    Decimal(i64, u8),
    /// A sentence within the sentence.
    Sentence(Box<Sentence>),
    /// Several values, with commas between names and semicolons between sentences.
    List(Vec<SentenceArg>),
}

impl SentenceArg {
    /// A number, rounded to this many digits behind the point.
    pub fn rounded(number: f64, digits: u8) -> SentenceArg {
        SentenceArg::Decimal((number * ten_to(digits)).round() as i64, digits)
    }

    /// A number with at most this many digits behind the point.
    pub fn up_to(number: f64, digits: u8) -> SentenceArg {
        let (mut n, mut digits) = ((number * ten_to(digits)).round() as i64, digits);
        while digits > 0 && n % 10 == 0 {
            (n, digits) = (n / 10, digits - 1);
        }
        SentenceArg::Decimal(n, digits)
    }

    /// An empty value: for a place at the end of a sentence that has no such end.
    pub fn nothing() -> SentenceArg {
        SentenceArg::Text(String::new())
    }
}

/// The power of ten by which a decimal is divided.
pub(super) fn ten_to(digits: u8) -> f64 {
    10f64.powi(i32::from(digits))
}

impl fmt::Display for SentenceArg {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SentenceArg::Text(text) => f.write_str(text),
            SentenceArg::Number(n) => write!(f, "{n}"),
            SentenceArg::Decimal(n, digits) => {
                write!(f, "{:.*}", usize::from(*digits), *n as f64 / ten_to(*digits))
            }
            SentenceArg::Sentence(sentence) => f.write_str(sentence.text()),
            SentenceArg::List(all) => {
                let texts: Vec<String> = all.iter().map(ToString::to_string).collect();
                let has_sentences = all.iter().any(|arg| matches!(arg, SentenceArg::Sentence(_)));
                f.write_str(&texts.join(if has_sentences { "; " } else { ", " }))
            }
        }
    }
}

impl From<&str> for SentenceArg {
    fn from(text: &str) -> SentenceArg {
        SentenceArg::Text(text.to_owned())
    }
}

impl From<String> for SentenceArg {
    fn from(text: String) -> SentenceArg {
        SentenceArg::Text(text)
    }
}

impl From<&String> for SentenceArg {
    fn from(text: &String) -> SentenceArg {
        SentenceArg::Text(text.clone())
    }
}

impl From<Sentence> for SentenceArg {
    fn from(sentence: Sentence) -> SentenceArg {
        SentenceArg::Sentence(Box::new(sentence))
    }
}

impl<T: Into<SentenceArg>> From<Vec<T>> for SentenceArg {
    fn from(all: Vec<T>) -> SentenceArg {
        SentenceArg::List(all.into_iter().map(Into::into).collect())
    }
}

/// A missing value leaves its place empty.
impl<T: Into<SentenceArg>> From<Option<T>> for SentenceArg {
    fn from(arg: Option<T>) -> SentenceArg {
        arg.map_or_else(SentenceArg::nothing, Into::into)
    }
}

macro_rules! from_whole_numbers {
    ($($number:ty),+) => {
        $(
            impl From<$number> for SentenceArg {
                fn from(number: $number) -> SentenceArg {
                    SentenceArg::Number(i64::try_from(number).unwrap_or(i64::MAX))
                }
            }
        )+
    };
}
from_whole_numbers!(i64, u64, u32, i32, usize, u8);
