//! How far robots' nodes are from a person on foot; nobody can walk through racks.
//!
//! Main type: [`Afoot`]. Separation distances state how far a person walks while a robot comes to rest, so a robot
//! behind a block of racks is as far as the way round it. Refuses: to shorten region 1, which is as the crow flies.

use giveway_floor::geometry::Point;
use giveway_floor::id::{IdVec, NodeId, WalkNodeId};
use giveway_floor::warehouse::Warehouse;
use giveway_floor::warehouse::walkway::Walkways;
use std::sync::Arc;

/// A robot on a node can be touched from walkways up to this distance, metres: from the middle of the next aisle.
const BESIDE_M: f64 = 1.3;

/// Robots' nodes and the walkways beside them.
#[derive(Clone, Debug)]
pub struct Afoot {
    walkways: Arc<Walkways>,
    beside: IdVec<NodeId, Vec<(WalkNodeId, f64)>>,
}

impl Afoot {
    /// The nodes and walkways of a building.
    pub fn new(warehouse: &Warehouse, walkways: Arc<Walkways>) -> Afoot {
        let nodes = walkways.nodes();
        let beside = |at: Point| -> Vec<(WalkNodeId, f64)> {
            walkways.around(at, BESIDE_M).map(|n| (n, (nodes[n].at - at).norm())).collect()
        };
        let beside = warehouse.nodes.iter().map(|n| beside(n.at)).collect();
        Afoot { walkways, beside }
    }

    /// The nodes within `radius_m` of a person on foot, with their distances in metres. For nodes far from any walkway,
    /// the distance is as the crow flies.
    pub fn nodes_within(&self, warehouse: &Warehouse, from: Point, radius_m: f64) -> Vec<(NodeId, f64)> {
        let on_foot = self.walkways.within(from, radius_m);
        let near = warehouse.nodes_within(from, radius_m).into_iter();
        near.filter_map(|node| {
            let crow = (warehouse.nodes[node].at - from).norm();
            let beside = &self.beside[node];
            let walks = beside.iter().filter_map(|(n, off)| Some(on_foot.get(n)? + off));
            let distance = match walks.min_by(f64::total_cmp) {
                Some(walk) => walk.max(crow),
                None if beside.is_empty() || on_foot.is_empty() => crow,
                None => return None,
            };
            (distance <= radius_m).then_some((node, distance))
        })
        .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use giveway_floor::warehouse::thesis;

    #[test]
    fn a_robot_in_the_next_aisle_is_far_and_one_in_the_same_aisle_is_near() {
        let w = thesis();
        let walkways = Arc::new(Walkways::of(&w));
        let afoot = Afoot::new(&w, walkways);
        let from = Point::new(3.0, 3.0);
        let near = afoot.nodes_within(&w, from, 5.0);
        let distance = |x: f64, y: f64| {
            near.iter().find(|(n, _)| (w.nodes[*n].at - Point::new(x, y)).norm() < 0.1).map(|(_, d)| *d)
        };
        assert!((distance(3.0, 5.0).unwrap() - 2.0).abs() < 0.3, "{:?}", distance(3.0, 5.0));
        assert!(distance(4.0, 3.0).unwrap() < 1.6, "beside the aisle: {:?}", distance(4.0, 3.0));
        assert_eq!(distance(6.0, 4.0), None, "behind the racks");
    }
}
