//! What a robot says is wrong.
//!
//! Main type: [`RobotError`]. Refuses: to rank errors: what refers to what is for the reader.

/// Something that is wrong, in a robot's words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotError {
    /// The type, by the standard's or the vendor's word.
    pub kind: String,
    /// How bad it is.
    pub level: ErrorLevel,
    /// What it is about.
    pub references: Vec<ErrorReference>,
    /// A description.
    pub description: Option<String>,
    /// What to do.
    pub hint: Option<String>,
}

/// What an error is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ErrorReference {
    /// Of what: `orderId`, `actionId`, `nodeId`, ….
    pub key: String,
    /// Which one.
    pub value: String,
}

/// How bad an error is. Levels are ordered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ErrorLevel {
    /// The robot goes on.
    Warning,
    /// The robot goes on for now, and needs somebody soon; 3.0.
    Urgent,
    /// The order is stuck, a new one can be done; 3.0.
    Critical,
    /// The robot needs a person.
    Fatal,
}

impl RobotError {
    /// What the error refers to under a key, if it does.
    pub fn refers_to(&self, key: &str) -> Option<&str> {
        self.references.iter().find(|r| r.key.eq_ignore_ascii_case(key)).map(|r| r.value.as_str())
    }
}
