//! What is noticed of a robot that a person should know: claims that do not hold, and what the robot complains of.
//!
//! Main type: [`Notice`]. Refuses: to punish; who reads it decides what trust is left.

use std::fmt;

/// Something noticed of a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Notice {
    /// It says that it finished an action, and its loads say otherwise.
    FalseFinished {
        /// The action's type.
        action: String,
        /// What it carries, in words.
        carries: String,
    },
    /// It ended an order without a word about the order's action.
    SilentAction {
        /// The action's type.
        action: String,
    },
    /// An action failed.
    ActionFailed {
        /// The action's type.
        action: String,
        /// The robot's words.
        words: String,
    },
    /// It says that its order is cancelled, and drives on or has nodes left.
    FalseCancel,
    /// It did not cancel its order within the time for that.
    NoCancel,
    /// It says that it is paused, and moves.
    FalsePause,
    /// It was told ten times to pause and did not.
    NoPause {
        /// The robot's words, if it had some.
        words: Option<String>,
    },
    /// It says that it is at a node of its order that it cannot be at.
    FalseProgress {
        /// What it says.
        said: String,
    },
    /// It refuses an order.
    Rejected {
        /// The robot's words.
        words: String,
    },
    /// It did not take an order that was sent as often as allowed.
    NotTaken,
    /// A state under its topic names another robot.
    OtherName {
        /// The name in the header.
        named: String,
    },
}

impl Notice {
    /// Whether the robot claimed what is not so.
    pub fn is_lie(&self) -> bool {
        match self {
            Notice::FalseFinished { .. }
            | Notice::SilentAction { .. }
            | Notice::FalseCancel
            | Notice::FalsePause
            | Notice::FalseProgress { .. }
            | Notice::OtherName { .. } => true,
            Notice::ActionFailed { .. }
            | Notice::NoCancel
            | Notice::NoPause { .. }
            | Notice::Rejected { .. }
            | Notice::NotTaken => false,
        }
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Notice::FalseFinished { action, carries } => {
                write!(f, "says that {action} is finished, and carries {carries}")
            }
            Notice::SilentAction { action } => write!(f, "ended its order without a word about {action}"),
            Notice::ActionFailed { action, words } => write!(f, "{action} failed: {words}"),
            Notice::FalseCancel => f.write_str("says that its order is cancelled, and goes on"),
            Notice::NoCancel => f.write_str("does not cancel its order"),
            Notice::FalsePause => f.write_str("says that it is paused, and moves"),
            Notice::NoPause { words: Some(words) } => write!(f, "does not pause: {words}"),
            Notice::NoPause { words: None } => f.write_str("does not pause"),
            Notice::FalseProgress { said } => write!(f, "says that it is where it cannot be: {said}"),
            Notice::Rejected { words } => write!(f, "refuses an order: {words}"),
            Notice::NotTaken => f.write_str("does not take the order that it is sent"),
            Notice::OtherName { named } => write!(f, "sends states in the name of {named}"),
        }
    }
}
