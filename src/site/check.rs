//! What cannot be in a site or scenario file is refused, with what may be there.
//!
//! Main type: [`SiteError`]; main function [`check`]. Refuses: to correct a number silently.

/// A site or scenario file that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SiteError {
    /// It is not JSON of the right shape.
    #[error("line {line}, column {column}: {message}")]
    Syntax {
        /// Where.
        line: usize,
        /// Where in the line.
        column: usize,
        /// What.
        message: String,
    },
    /// A number in it cannot be.
    #[error("`{key}` is {found}, but must be {wanted}")]
    Number {
        /// Which.
        key: String,
        /// What it is.
        found: String,
        /// What it may be.
        wanted: &'static str,
    },
    /// What it says cannot be.
    #[error("`{key}`: {message}")]
    Wrong {
        /// Where.
        key: &'static str,
        /// What, and what to do.
        message: String,
    },
}

impl SiteError {
    /// What the parser says, and where.
    pub fn syntax(e: &serde_json::Error) -> SiteError {
        SiteError::Syntax { line: e.line(), column: e.column(), message: e.to_string() }
    }
}

/// Refuses a number outside of a range; `key` says where it is, and `wanted` what it may be.
///
/// # Errors
/// What it is, and what it may be.
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
