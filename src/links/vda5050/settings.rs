//! What is set for the robots of a kind at their link.
//!
//! Main type: [`RobotLinkSettings`]. Refuses: to read files; a site does.

use super::frame::MapFrame;
use giveway_vda5050::{BlockingType, Parameter};

/// What is set for the robots of a kind at their link.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotLinkSettings {
    /// The robots' maps that are this floor, with their frames.
    pub maps: Vec<MapFrame>,
    /// How many nodes are announced beyond the base.
    pub horizon_nodes: usize,
    /// The longest base, metres: it bounds how far a robot drives on that hears no pause.
    pub longest_base_m: f64,
    /// How a rack is lifted.
    pub lift: ActionForm,
    /// How a rack is set down.
    pub set: ActionForm,
    /// Which key instant actions have.
    pub instant_key: InstantKey,
    /// Whether an order may be sent again that the robot has not taken.
    pub repeat: RepeatRule,
    /// How far from a node an order may begin, metres.
    pub deviation_m: f64,
}

/// An action in the words of a kind of robot.
#[derive(Clone, Debug, PartialEq)]
pub struct ActionForm {
    /// The action's type.
    pub kind: String,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
    /// What may happen beside it.
    pub blocking: BlockingType,
}

/// The key under which a robot reads instant actions: the published 2.0 has another one than its later corrections.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstantKey {
    /// `actions`, as all later texts have it.
    Actions,
    /// `instantActions`, as 2.0 was published.
    InstantActions,
    /// Both: each robot that was measured is content with it.
    Both,
}

/// Whether an order may be sent again that the robot has not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RepeatRule {
    /// At most three times, each after a state that shows that the order was not taken.
    Safe,
    /// Never: the order counts as lost, and another one takes its place.
    Never,
}

impl Default for RobotLinkSettings {
    fn default() -> RobotLinkSettings {
        let form = |kind: &str| ActionForm {
            kind: kind.to_owned(),
            parameters: Vec::new(),
            blocking: BlockingType::Hard,
        };
        RobotLinkSettings {
            maps: Vec::new(),
            horizon_nodes: 0,
            longest_base_m: 4.0,
            lift: form("pick"),
            set: form("drop"),
            instant_key: InstantKey::Both,
            repeat: RepeatRule::Safe,
            deviation_m: 0.5,
        }
    }
}
