//! Numbers in a scenario file that cannot be are refused, with what they may be.
//!
//! Main type: [`ScenarioError`]; main function [`check`]. Refuses: to correct a number silently.

/// A scenario file that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ScenarioError {
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

impl ScenarioError {
    /// What the parser says, and where.
    pub(super) fn syntax(e: &serde_json::Error) -> ScenarioError {
        ScenarioError::Syntax { line: e.line(), column: e.column(), message: e.to_string() }
    }
}

pub(crate) fn check(
    key: &str,
    found: f64,
    range: std::ops::RangeInclusive<f64>,
    wanted: &'static str,
) -> Result<(), ScenarioError> {
    if range.contains(&found) {
        Ok(())
    } else {
        Err(ScenarioError::Number { key: key.to_owned(), found: found.to_string(), wanted })
    }
}
