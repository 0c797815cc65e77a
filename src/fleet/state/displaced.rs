//! Robots that stand where nothing is held for them.
//!
//! Main types: [`Displacement`] (why a robot cannot go on from where it stands), [`Displaced`] (where that is, and
//! which nodes it blocks). Refuses: to find out; `traffic/displaced.rs` does.

use giveway_floor::geometry::{Point, Spot};
use giveway_floor::id::{NodeId, RackId, RobotId};

/// How far off its route a robot may stand, metres. Robots that find their way by natural features know where they are
/// to about 0.05 m (one standard deviation) and stop to a few centimetres: 0.2 m is more than three times that. It is
/// less than half of the shortest lane of the maps here (0.75 m), so that a place is near one node only.
pub const OFF_ROUTE_M: f64 = 0.2;
/// Why a robot cannot go on from where it stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Displacement {
    /// The robot stands between nodes, off everything that it holds.
    OffNode {
        /// Where the robot stands.
        at: Spot,
        /// The nearest node.
        nearest: NodeId,
        /// How far the robot is from that node, millimetres.
        off_mm: i64,
    },
    /// The robot stands on a node that it does not hold and still knows waypoints of its old route.
    KnowsWaypoints(NodeId),
    /// The robot stands where another robot may drive already.
    GrantedTo(NodeId, RobotId),
    /// The robot carries a rack and stands where another one is stored.
    RackThere(NodeId, RackId),
    /// No lane leads on from the node for a robot with its load.
    NoWayOut(NodeId),
    /// A person drives the robot, off everything that it holds.
    ByHand,
    /// The rack on the robot is not the one that is promised to be there.
    Load {
        /// The rack that the robot reports.
        carries: Option<RackId>,
        /// The rack that was on the robot by all that is known.
        expected: Option<RackId>,
    },
}

/// A robot that cannot go on from where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Displaced {
    /// Why the robot cannot go on.
    pub why: Displacement,
    /// Where the robot stands.
    pub at: Point,
    /// Whether the robot is off everything that it holds.
    pub is_off: bool,
    /// Nodes that other robots cannot pass because of the robot.
    pub nodes: Vec<NodeId>,
}
