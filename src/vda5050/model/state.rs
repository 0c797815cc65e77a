//! What a robot says of itself.
//!
//! Main types: [`State`], [`Visualization`], [`ConnectionState`]. Refuses: to believe it.

use super::action::ActionState;
use super::error::RobotError;
use super::zone::StoredZoneSet;

/// The state of a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// The order that the robot has or had last; empty if it never had one.
    pub order: String,
    /// The last update of it that the robot took.
    pub update: u32,
    /// The last node that it reached, or where it stands.
    pub last_node: String,
    /// That node's number in the order.
    pub last_sequence: u32,
    /// Nodes that are still to be reached.
    pub nodes: Vec<NodeLeft>,
    /// Edges that are still to be driven: their ids, numbers, and whether they are released.
    pub edges: Vec<NodeLeft>,
    /// Actions of the order; before 3.0 instant ones as well.
    pub actions: Vec<ActionState>,
    /// Instant actions, 3.0.
    pub instant_actions: Vec<ActionState>,
    /// Where the robot is, if it knows.
    pub position: Option<Position>,
    /// How fast it drives, if it says.
    pub velocity: Option<Velocity>,
    /// Whether it drives, as it says.
    pub driving: bool,
    /// Whether it is paused, if it says.
    pub paused: Option<bool>,
    /// Whether it will soon brake for lack of released nodes.
    pub wants_base: bool,
    /// What it carries; nothing if it cannot tell.
    pub loads: Option<Vec<Load>>,
    /// Its battery.
    pub power: Power,
    /// Who drives it.
    pub mode: OperatingMode,
    /// What is wrong.
    pub errors: Vec<RobotError>,
    /// Its emergency stop.
    pub e_stop: EStop,
    /// Whether something is in its protective field.
    pub field_violation: bool,
    /// What it asks for, 3.0: zones to enter, corridors to use.
    pub requests: Vec<Request>,
    /// The zone sets that it has stored, 3.0.
    pub zone_sets: Vec<StoredZoneSet>,
}

/// A node or an edge that is still to be driven.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeLeft {
    /// Its id.
    pub id: String,
    /// Its number in the order.
    pub sequence: u32,
    /// Whether it is released.
    pub released: bool,
}

/// Where a robot is.
#[derive(Clone, Debug, PartialEq)]
pub struct Position {
    /// Metres, in the map's frame.
    pub x: f64,
    /// Metres, in the map's frame.
    pub y: f64,
    /// Heading, radians.
    pub theta: f64,
    /// The robot's name of the map.
    pub map: String,
    /// Whether the robot knows where it is.
    pub localized: bool,
}

/// How fast a robot drives, in its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Velocity {
    /// Ahead, metres per second.
    pub vx: f64,
    /// To the left, metres per second.
    pub vy: f64,
    /// Turning, radians per second.
    pub omega: f64,
}

/// Something on a robot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Load {
    /// Its id, if the robot knows it.
    pub id: Option<String>,
    /// Its type, if the robot knows it.
    pub kind: Option<String>,
}

/// A robot's battery.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Power {
    /// Charge, from 0 to 1, if the robot says it; written as 0 if not.
    pub charge: Option<f64>,
    /// Whether it gets current.
    pub charging: bool,
}

/// Who drives a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OperatingMode {
    /// It starts, 3.0.
    Startup,
    /// The master drives it.
    Automatic,
    /// The master drives it, a person sets its speed.
    SemiAutomatic,
    /// A person has interfered: it keeps orders and obeys cancels alone, 3.0.
    Intervened,
    /// A person drives it.
    Manual,
    /// It is being serviced.
    Service,
    /// It is being taught.
    TeachIn,
}

/// A robot's emergency stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EStop {
    /// It is not pressed.
    None,
    /// It ends by itself, before 3.0.
    AutoAck,
    /// It must be released at the robot.
    Manual,
    /// It was pressed elsewhere.
    Remote,
}

/// Something that a robot asks for, 3.0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Request {
    /// The request's id.
    pub id: String,
    /// What it is about.
    pub subject: RequestSubject,
    /// How far it is.
    pub status: RequestStatus,
}

/// What a robot's request is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RequestSubject {
    /// A zone.
    Zone {
        /// The zone's id.
        zone: String,
        /// The id of the zone set that has the zone.
        zone_set: String,
        /// Whether the robot asks for another way through the zone, not for access.
        replanning: bool,
    },
    /// Leaving the line of an edge within its corridor.
    Corridor {
        /// The edge's id.
        edge: String,
        /// The edge's number in the order.
        sequence: u32,
    },
}

/// How far a request of a robot is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RequestStatus {
    /// It waits for an answer.
    Requested,
    /// It was granted.
    Granted,
    /// The grant was taken back, and the robot says so.
    Revoked,
    /// The grant has ended.
    Expired,
}

/// Where a robot is: a part of its state, said more often.
#[derive(Clone, Debug, PartialEq)]
pub struct Visualization {
    /// The header id of the robot's last state before it, 3.0.
    pub state_header: Option<u32>,
    /// Where the robot is, if it knows.
    pub position: Option<Position>,
    /// How fast it drives, if it says.
    pub velocity: Option<Velocity>,
}

/// Whether a robot is connected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConnectionState {
    /// It is.
    Online,
    /// It has taken its leave.
    Offline,
    /// The broker has lost it.
    Broken,
    /// It sleeps and can be woken, 3.0.
    Hibernating,
}

impl OperatingMode {
    /// Whether the robot takes orders.
    pub fn takes_orders(self) -> bool {
        matches!(self, OperatingMode::Automatic | OperatingMode::SemiAutomatic)
    }
}
