//! What is noticed of a robot that a person should know: claims that do not hold, and what the robot complains of.
//!
//! Main type: [`Notice`]. Refuses: to punish; who reads it decides what trust is left.

use giveway_floor::text::Sentence;
use giveway_floor::text::sentence::links;

/// Something noticed of a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Notice {
    /// It says that it finished an action, and its loads say otherwise.
    FalseFinished {
        /// The action's type.
        action: String,
        /// Whether it carries something.
        carries: bool,
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

impl Notice {
    /// What was noticed, for people; the robot is the subject.
    pub fn said(&self) -> Sentence {
        match self {
            Notice::FalseFinished { action, carries: true } => links::noticed_finished_and_full(action),
            Notice::FalseFinished { action, carries: false } => links::noticed_finished_and_empty(action),
            Notice::SilentAction { action } => links::noticed_silent_action(action),
            Notice::ActionFailed { action, words } => links::noticed_action_failed(action, words),
            Notice::FalseCancel => links::noticed_false_cancel(),
            Notice::NoCancel => links::noticed_no_cancel(),
            Notice::FalsePause => links::noticed_false_pause(),
            Notice::NoPause { words: Some(words) } => links::noticed_no_pause_since(words),
            Notice::NoPause { words: None } => links::noticed_no_pause(),
            Notice::FalseProgress { said } => links::noticed_false_progress(said),
            Notice::Rejected { words } => links::noticed_rejected(words),
            Notice::NotTaken => links::noticed_not_taken(),
            Notice::OtherName { named } => links::noticed_other_name(named),
        }
    }
}
