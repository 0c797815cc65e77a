//! What the map says about storage, computed once.
//!
//! Main type: [`Storage`]. Refuses: to know what stands where.

use giveway_floor::geometry::Point;
use giveway_floor::id::{IdVec, NodeId};
use giveway_floor::warehouse::{NodeKind, Warehouse};

/// What the map says about storage.
#[derive(Clone, Debug)]
pub struct Storage {
    pub nodes: Vec<NodeId>,
    /// For each node, the distance to the nearest station along the axes, metres.
    pub to_station_m: IdVec<NodeId, f64>,
}

impl Storage {
    pub fn new(warehouse: &Warehouse) -> Storage {
        let nearest = |p: Point| {
            let at = warehouse.stations.iter().map(|s| along_axes(warehouse.nodes[s.node].at, p));
            at.fold(f64::INFINITY, f64::min)
        };
        Storage {
            nodes: warehouse.nodes_where(|k| k == NodeKind::Storage),
            to_station_m: warehouse.nodes.iter().map(|n| nearest(n.at)).collect(),
        }
    }
}

/// Distance along the map's axes, metres: a cheap estimate of the way on a grid of aisles.
pub(crate) fn along_axes(a: Point, b: Point) -> f64 {
    (a.x - b.x).abs() + (a.y - b.y).abs()
}
