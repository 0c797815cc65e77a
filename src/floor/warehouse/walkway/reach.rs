//! Walking distances to everything near.
//!
//! Main function: [`Walkways::within`]. Refuses: to look farther than asked.

use super::Walkways;
use crate::geometry::Point;
use crate::id::{Dense, WalkNodeId};
use std::collections::BTreeMap;

/// Whole millimetres, so that the queue has a total order.
fn mm(metres: f64) -> i64 {
    crate::geometry::to_mm(metres)
}

impl Walkways {
    /// All nodes that can be reached from `p` on foot within `length_m`, by id, with the length of the path in metres.
    pub fn within(&self, p: Point, length_m: f64) -> BTreeMap<WalkNodeId, f64> {
        let mut found = BTreeMap::new();
        let starts = self.doorsteps(p, &self.no_edges());
        let mut queue: std::collections::BTreeSet<(i64, u32)> =
            starts.into_iter().map(|(n, away)| (mm(away), n.0)).collect();
        while let Some((so_far, n)) = queue.pop_first() {
            let n = WalkNodeId::at(n as usize);
            if so_far > mm(length_m) {
                break;
            }
            if found.contains_key(&n) {
                continue;
            }
            found.insert(n, so_far as f64 / 1000.0);
            for &(e, next) in self.links(n).iter().filter(|(_, next)| !found.contains_key(next)) {
                queue.insert((so_far + mm(self.edges()[e].length_m), next.0));
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warehouse::thesis;

    #[test]
    fn what_is_near_behind_a_block_of_racks_is_far_on_foot() {
        let walkways = Walkways::of(&thesis());
        let from = Point::new(3.0, 4.0);
        let near = walkways.within(from, 20.0);
        let beyond = walkways.nearest(Point::new(6.0, 4.0)).map(|(n, _)| n).unwrap();
        assert!(near[&beyond] > 8.0, "{}", near[&beyond]);
        assert!(!walkways.within(from, 5.0).contains_key(&beyond));
        for (n, length) in &near {
            let crow = (walkways.nodes()[*n].at - from).norm();
            assert!(*length > crow - 0.01);
        }
    }
}
