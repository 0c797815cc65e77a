//! What the planner sees of a part of the floor: which robots hold each node and when, and what people and closures
//! restrict.
//!
//! Main type: [`NodeOccupancy`]. Computed on demand for an area. Refuses: areas of more than [`MOST_NODES`] nodes,
//! which no person could read, and lanes, whose holds are those of the nodes at their ends.

use crate::Fleet;
use crate::read::area::Area;
use crate::read::safety_regions::RegionStay;
use giveway_floor::id::NodeId;
use giveway_floor::route::Condition;
use giveway_floor::time::{Span, Time, Window};
use giveway_floor::timeline::Held;

/// How many nodes a query may have at most.
pub const MOST_NODES: usize = 200;

/// Holds that ended less than this ago are still shown.
const BACK: Span = Span::from_secs(5);

/// The occupancy of one node, from a moment ago on.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeOccupancy {
    /// The node.
    pub node: NodeId,
    /// The holds on it and on anything in conflict with it, in order.
    pub holds: Vec<Held>,
    /// The conditions that people and closures cause there.
    pub conditions: Vec<Condition>,
    /// The safety regions in which the node is, and when.
    pub regions: Vec<RegionStay>,
}

impl Fleet {
    /// The occupancy of all nodes in an area, from the top left on, for this long ahead.
    ///
    /// # Errors
    /// The number of nodes, if there are too many.
    pub fn occupancy(&self, area: Area, ahead: Span, now: Time) -> Result<Vec<NodeOccupancy>, usize> {
        let nodes = &self.writer.warehouse().nodes;
        let mut found: Vec<NodeId> =
            nodes.pairs().filter(|(_, n)| area.contains(n.at)).map(|(id, _)| id).collect();
        if found.len() > MOST_NODES {
            return Err(found.len());
        }
        let place = |n: &NodeId| nodes[*n].at;
        found.sort_by(|a, b| place(b).y.total_cmp(&place(a).y).then(place(a).x.total_cmp(&place(b).x)));
        let window = Window::new(now - BACK, now + ahead);
        let mut stays = self.region_stays(area, window, now);
        let occupancy = |node| {
            let regions = stays.remove(&node).unwrap_or_default();
            NodeOccupancy { regions, ..self.node_occupancy(node, window) }
        };
        Ok(found.into_iter().map(occupancy).collect())
    }

    fn node_occupancy(&self, node: NodeId, window: Window) -> NodeOccupancy {
        let resource = self.writer.warehouse().node_resource(node);
        let holds = self.writer.ledger().timeline().holds(resource, window);
        let mut conditions: Vec<Condition> = Vec::new();
        for condition in self.writer.restrictions.conditions.all().flat_map(|set| set.of(node)) {
            if condition.window.overlaps(window) && !conditions.contains(condition) {
                conditions.push(*condition);
            }
        }
        NodeOccupancy { node, holds, conditions, regions: Vec::new() }
    }
}
