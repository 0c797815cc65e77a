//! Where the robots of a scenario stand when it begins.
//!
//! Refuses: to let two of them share a place.

use giveway_floor::id::{BodyId, NodeId};
use giveway_floor::warehouse::{NodeKind, Warehouse};

/// Starting places of robots: chargers first, then parking places, then nodes beneath racks, spread over the floor.
pub fn starting_places(warehouse: &Warehouse, robots: usize, body: impl Fn(usize) -> BodyId) -> Vec<NodeId> {
    let mut places = warehouse.nodes_where(|k| k == NodeKind::Charger);
    places.extend(warehouse.nodes_where(|k| k == NodeKind::Parking));
    let storage = warehouse.nodes_where(|k| k == NodeKind::Storage);
    let wanted = robots.saturating_sub(places.len());
    let step = (storage.len() / wanted.max(1)).max(1);
    places.extend(storage.iter().copied().step_by(step));
    let mut found = Vec::new();
    for robot in 0..robots {
        let first = places.iter().position(|n| warehouse.may_be_at(body(robot), *n));
        found.extend(first.map(|at| places.remove(at)));
    }
    found
}
