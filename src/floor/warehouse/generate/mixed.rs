//! The hall of the thesis for robots of two kinds: large movers that carry shelves, and small shuttles that carry bins.
//!
//! Main function: [`mixed`]. The streets have a node every half metre, less than the width of a mover: movers keep two
//! nodes apart where shuttles queue on neighbours. Only shuttles pass beneath racks. Refuses: parameters.

use super::halls::thesis_draft;
use crate::geometry::Point;
use crate::warehouse::{Draft, DraftLane, DraftNode, Users, Warehouse};
use std::collections::{BTreeMap, BTreeSet};

/// The kind that passes beneath racks.
const SMALL: &str = "shuttle";
/// Interval of bins among the racks: shuttles carry bins; all other racks are shelves.
const BINS: usize = 3;

/// The hall of the thesis for shuttles and movers.
pub fn mixed() -> Warehouse {
    let mut draft = thesis_draft();
    draft.name = "mixed".into();
    for (i, rack) in draft.racks.iter_mut().enumerate() {
        let (load, weight_kg) = if i % BINS == 0 { ("bin", 40.0) } else { ("shelf", 400.0) };
        (rack.load, rack.weight_kg) = (Some(load.into()), weight_kg);
    }
    for lane in draft.lanes.iter_mut().filter(|l| l.users == Users::UNLOADED) {
        lane.kinds = Some(vec![SMALL.into()]);
    }
    halve_streets(&mut draft);
    draft.build().expect("the shipped map is well-formed, a test builds it")
}

/// Puts a node in the middle of each lane between nodes of open floor, unless a robot there would be in the way of a
/// robot that stands beside the street.
fn halve_streets(draft: &mut Draft) {
    let places: BTreeMap<String, Point> = draft.nodes.iter().map(|n| (n.name.clone(), n.at)).collect();
    let stations = draft.stations.iter().flat_map(|s| std::iter::once(&s.node).chain(&s.queue));
    let rest = draft.storage.iter().chain(&draft.chargers).chain(&draft.parking).chain(stations);
    let rest: BTreeSet<String> = rest.cloned().collect();
    let is_free = |p: Point| {
        let far = |at: &Point| crate::geometry::axis_distance(p, *at) >= draft.footprint_m;
        rest.iter().all(|name| far(&places[name]))
    };
    let (mut nodes, mut lanes) = (Vec::new(), Vec::new());
    for lane in &draft.lanes {
        let middle = nalgebra::center(&places[&lane.from], &places[&lane.to]);
        let is_street = !rest.contains(&lane.from) && !rest.contains(&lane.to);
        if !is_street || !is_free(middle) {
            lanes.push(lane.clone());
            continue;
        }
        let name = format!("{}~{}", lane.from, lane.to);
        nodes.push(DraftNode { name: name.clone(), at: middle });
        lanes.push(DraftLane { to: name.clone(), ..lane.clone() });
        lanes.push(DraftLane { from: name, ..lane.clone() });
    }
    draft.nodes.extend(nodes);
    draft.lanes = lanes;
}
