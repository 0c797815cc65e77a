//! Checks of the values in a site or scenario file; an error tells which values are allowed.
//!
//! Main type: [`SiteError`]; main function [`check`]. Refuses: to correct a number silently.

/// A site or scenario file that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SiteError {
    /// The file is not JSON of the right shape.
    #[error("line {line}, column {column}: {message}")]
    Syntax {
        /// Line of the fault.
        line: usize,
        /// Column of the fault.
        column: usize,
        /// The parser's message.
        message: String,
    },
    /// A number in the file is out of range.
    #[error("`{key}` is {found}, but must be {wanted}")]
    Number {
        /// Key of the number.
        key: String,
        /// The number in the file.
        found: String,
        /// The allowed range, in words.
        wanted: &'static str,
    },
    /// A value in the file is impossible.
    #[error("`{key}`: {message}")]
    Wrong {
        /// Key of the value.
        key: &'static str,
        /// The fault and its remedy.
        message: String,
    },
}

impl SiteError {
    /// The parser's error with its position.
    pub fn syntax(e: &serde_json::Error) -> SiteError {
        SiteError::Syntax { line: e.line(), column: e.column(), message: e.to_string() }
    }
}

/// Refuses a number outside of a range; `key` is its place in the file, and `wanted` the range in words.
///
/// # Errors
/// The number, and the allowed range.
pub fn check(
    key: &str,
    found: f64,
    range: std::ops::RangeInclusive<f64>,
    wanted: &'static str,
) -> Result<(), SiteError> {
    if range.contains(&found) {
        Ok(())
    } else {
        Err(SiteError::Number { key: key.to_owned(), found: found.to_string(), wanted })
    }
}
