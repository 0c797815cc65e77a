//! The contents of a map in numbers.
//!
//! Main types: [`MapSummary`]. Refuses: judging the numbers; [`super::room_for`] does that.

use super::{NodeKind, Warehouse};
use crate::id::Dense;
use crate::id::ResourceId;
use serde::Serialize;
use std::fmt;

/// Counts of everything in a map.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapSummary {
    /// Name of the map.
    pub name: String,
    /// Number of nodes of every kind.
    pub nodes: usize,
    /// Number of lanes, each counted once for both directions.
    pub lanes: usize,
    /// Number of lanes that may be driven one way only.
    pub one_way_lanes: usize,
    /// Number of resources that need a timeline of their own.
    pub timeline_resources: usize,
    /// Number of pairs of resources that two robots cannot hold at once, beyond lanes and their ends.
    pub conflicts: usize,
    /// Number of places for racks.
    pub storage: usize,
    /// Number of racks.
    pub racks: usize,
    /// Number of picking stations.
    pub stations: usize,
    /// Number of waiting places before stations.
    pub queue_places: usize,
    /// Number of charging places.
    pub chargers: usize,
    /// Number of parking places.
    pub parking: usize,
    /// Number of places where a robot may stay for ever: storage, chargers and parking together.
    pub lasting_places: usize,
    /// Number of doors for people.
    pub exits: usize,
    /// Extent along x, metres.
    pub width_m: f64,
    /// Extent along y, metres.
    pub height_m: f64,
}

/// Counts everything in a map.
pub fn summary(w: &Warehouse) -> MapSummary {
    let count = |keep: fn(NodeKind) -> bool| w.nodes_where(keep).len();
    let (low, high) = w.bounds();
    let one_sided = (0..w.resource_count()).map(|r| w.conflicts(ResourceId::at(r)).len()).sum::<usize>();
    MapSummary {
        name: w.name.clone(),
        nodes: w.nodes.len(),
        lanes: w.lanes.len(),
        one_way_lanes: w.lanes.iter().filter(|l| !l.both).count(),
        timeline_resources: w.timeline_count(),
        conflicts: one_sided / 2,
        storage: count(|kind| kind == NodeKind::Storage),
        racks: w.racks.len(),
        stations: w.stations.len(),
        queue_places: w.stations.iter().map(|s| s.queue.len()).sum(),
        chargers: count(|kind| kind == NodeKind::Charger),
        parking: count(|kind| kind == NodeKind::Parking),
        lasting_places: count(NodeKind::is_lasting),
        exits: count(|kind| kind == NodeKind::Exit),
        width_m: high.x - low.x,
        height_m: high.y - low.y,
    }
}

impl fmt::Display for MapSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "map                 {}", self.name)?;
        writeln!(f, "extent              {:.1} × {:.1} m", self.width_m, self.height_m)?;
        let counts = [
            ("nodes", self.nodes),
            ("lanes", self.lanes),
            ("  one way", self.one_way_lanes),
            ("timeline resources", self.timeline_resources),
            ("conflicts", self.conflicts),
            ("storage places", self.storage),
            ("racks", self.racks),
            ("stations", self.stations),
            ("  queue places", self.queue_places),
            ("chargers", self.chargers),
            ("parking places", self.parking),
            ("places to stay", self.lasting_places),
            ("exits", self.exits),
        ];
        for (i, (name, count)) in counts.iter().enumerate() {
            let gap = if i == 0 { "" } else { "\n" };
            write!(f, "{gap}{name:<20}{count}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warehouse::sketch;

    #[test]
    fn a_summary_counts_what_the_drawing_shows() {
        let w = sketch("RSC.P\n.....\n1...X").build().expect("the drawing is well-formed");
        let s = summary(&w);
        assert_eq!((s.nodes, s.storage, s.racks, s.stations), (15, 2, 1, 1));
        assert_eq!((s.chargers, s.parking, s.lasting_places, s.exits), (1, 1, 4, 1));
        assert_eq!((s.timeline_resources, s.conflicts, s.width_m, s.height_m), (15, 0, 4.0, 2.0));
        assert!(s.to_string().contains("places to stay      4"));
    }
}
