//! Orders: nodes and edges, of which the first are released.
//!
//! Main type: [`Order`]. Refuses: to check what only the receiver can, such as where the robot is.

use super::action::Action;

/// Where a robot is to drive: a new order, or an update of one that it has.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    /// The order's id.
    pub id: String,
    /// The number of the update; 0 is the order itself.
    pub update: u32,
    /// The nodes, in order. Their sequence numbers are even.
    pub nodes: Vec<Node>,
    /// The edges between each two of them, with the odd numbers between.
    pub edges: Vec<Edge>,
}

/// A place on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// The node's id.
    pub id: String,
    /// The node's number in the order, past all updates.
    pub sequence: u32,
    /// Whether the robot may drive there.
    pub released: bool,
    /// Where the node is; nothing if the robot knows it by its id.
    pub position: Option<NodePosition>,
    /// What to do there.
    pub actions: Vec<Action>,
}

/// Where a node is.
#[derive(Clone, Debug, PartialEq)]
pub struct NodePosition {
    /// Metres, in the map's frame.
    pub x: f64,
    /// Metres, in the map's frame.
    pub y: f64,
    /// The heading on arrival, radians; nothing if the robot may choose.
    pub theta: Option<f64>,
    /// How far from the node counts as there, metres.
    pub deviation_m: Option<f64>,
    /// How far from the heading counts as there, radians.
    pub deviation_rad: Option<f64>,
    /// The robot's name of the map.
    pub map: String,
}

/// A way between two nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// The edge's id.
    pub id: String,
    /// The edge's number in the order.
    pub sequence: u32,
    /// Whether the robot may drive there.
    pub released: bool,
    /// The node where the edge begins. 3.0 does not write it.
    pub from: String,
    /// The node where the edge ends. 3.0 does not write it.
    pub to: String,
    /// The greatest speed, metres per second.
    pub max_speed_mps: Option<f64>,
    /// How far the robot may leave the line.
    pub corridor: Option<Corridor>,
    /// What to do on the way.
    pub actions: Vec<Action>,
}

/// How far a robot may leave the line of an edge. 2.0 does not know corridors and is not written one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corridor {
    /// To the left of the line, metres.
    pub left_m: f64,
    /// To the right of the line, metres.
    pub right_m: f64,
    /// Whether the outline must stay within, not only the centre.
    pub of_contour: bool,
    /// Whether the robot must ask before it leaves the line, 3.0.
    pub release_required: bool,
}
