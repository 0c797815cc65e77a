//! What robots are reached by: links by name, and the state of each robot at its link.
//!
//! Main type: [`LinkState`]. What goes through a link is data: orders out, reports in, and this state. Refuses: to know
//! how anything travels.

use crate::state::kind::ObeyedLimits;

/// The name of the link to simulated robots, and to all robots from before links had names.
pub const USUAL_LINK: &str = "sim";

/// The state of a robot at its link, as far as the link knows. Unless a link says otherwise, its robots are connected,
/// hold any number of visits and take orders.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkState {
    /// Whether messages get through. A robot that is not connected is silent at once.
    pub connected: bool,
    /// How many visits the robot can be told beyond the last one that it reached; nothing for any number.
    pub capacity: Option<usize>,
    /// Why the robot takes no orders, in the link's words; nothing if it takes them. It obeys speed limits all the
    /// same, and drives on to where it was granted.
    pub refuses: Option<String>,
    /// The most that the robot was seen to obey of speed limits. What its kind obeys counts if that is less.
    pub limits: ObeyedLimits,
    /// The serial number of a stop at which the robot could not do what it was to do: it stands there until a person
    /// has looked after it. A rack that it did not lift is left to other robots.
    pub failed_stop: Option<u64>,
}

impl Default for LinkState {
    fn default() -> LinkState {
        LinkState {
            connected: true,
            capacity: None,
            refuses: None,
            limits: ObeyedLimits::Speeds,
            failed_stop: None,
        }
    }
}
