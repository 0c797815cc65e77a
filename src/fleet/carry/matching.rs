//! Which node, station and rack of the old map is which one of the new map: the one of the same name.
//!
//! Main type: [`Matching`]. Refuses: to match two things because they are at the same place.

use giveway_floor::id::{Dense, IdVec, NodeId, RackId, StationId};
use giveway_floor::warehouse::Warehouse;
use std::collections::BTreeMap;

/// For each thing of the old map, the one of the same name on the new map, if there is one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Matching {
    /// Nodes.
    pub nodes: IdVec<NodeId, Option<NodeId>>,
    /// Stations.
    pub stations: IdVec<StationId, Option<StationId>>,
    /// Racks.
    pub racks: IdVec<RackId, Option<RackId>>,
}

impl Matching {
    /// Matches two maps.
    pub fn new(old: &Warehouse, new: &Warehouse) -> Matching {
        Matching {
            nodes: by_name(&old.nodes, &new.nodes, |n| &n.name),
            stations: by_name(&old.stations, &new.stations, |s| &s.name),
            racks: by_name(&old.racks, &new.racks, |r| &r.name),
        }
    }

    /// Whether everything of the old map has the same id on the new one.
    pub fn keeps_ids(&self) -> bool {
        self.nodes.pairs().all(|(old, new)| *new == Some(old))
            && self.stations.pairs().all(|(old, new)| *new == Some(old))
            && self.racks.pairs().all(|(old, new)| *new == Some(old))
    }
}

fn by_name<I: Dense, T>(
    old: &IdVec<I, T>,
    new: &IdVec<I, T>,
    name: impl Fn(&T) -> &str,
) -> IdVec<I, Option<I>> {
    let named: BTreeMap<&str, I> = new.pairs().map(|(id, thing)| (name(thing), id)).collect();
    old.iter().map(|thing| named.get(name(thing)).copied()).collect()
}

/// Ids of the new map that match nothing of the old map.
pub(super) fn added<I: Dense + Ord>(matched: &IdVec<I, Option<I>>, new: usize) -> Vec<I> {
    let known: std::collections::BTreeSet<I> = matched.iter().copied().flatten().collect();
    (0..new).map(I::at).filter(|id| !known.contains(id)).collect()
}
