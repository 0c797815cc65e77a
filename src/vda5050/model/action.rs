//! Actions, of an order or at once, and how far they are.
//!
//! Main types: [`Action`], [`ActionState`]. Refuses: to know what an action does.

use serde_json::Value;

/// Something that a robot is to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Action {
    /// What to do, by the standard's or the vendor's word: `pick`, `startPause`, ….
    pub kind: String,
    /// The action's id, unique for ever.
    pub id: String,
    /// What may happen at the same time.
    pub blocking: BlockingType,
    /// How to do it.
    pub parameters: Vec<Parameter>,
    /// Whether the robot may wait for a decision after it failed, 3.0.
    pub retriable: bool,
}

/// A parameter of an action.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub key: String,
    /// Its value.
    pub value: Value,
}

/// What may happen beside an action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockingType {
    /// The robot may drive, and do other actions.
    None,
    /// The robot may do other actions, and must not drive.
    Soft,
    /// The robot may drive, and do no other action; written as [`BlockingType::Hard`] before 3.0.
    Single,
    /// The robot does nothing else.
    Hard,
}

/// How far an action is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ActionState {
    /// The action's id.
    pub id: String,
    /// The action's kind, if the robot says it.
    pub kind: Option<String>,
    /// How far it is.
    pub status: ActionStatus,
    /// The robot's words about its result.
    pub result: Option<String>,
}

/// How far an action is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActionStatus {
    /// It waits for its turn.
    Waiting,
    /// It is being prepared.
    Initializing,
    /// It is being done.
    Running,
    /// It was interrupted by a pause.
    Paused,
    /// It failed, and may be tried again, 3.0.
    Retriable,
    /// The robot says that it is done.
    Finished,
    /// It failed.
    Failed,
}

impl ActionStatus {
    /// Whether nothing more will happen with the action.
    pub fn is_over(self) -> bool {
        matches!(self, ActionStatus::Finished | ActionStatus::Failed)
    }
}
