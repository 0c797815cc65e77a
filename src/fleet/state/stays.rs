//! Where racks are put and where robots rest: near where a rack is probably wanted next, near where a robot is.
//!
//! Main function: `best_storage`. Queries alone: dispatch uses them, and so does traffic if no route leads to a place.
//! Refuses: places that are taken or promised.

use crate::state::floor::Floor;
use crate::state::storage::along_axes;
use giveway_floor::id::{NodeId, RackId, RobotId};
use giveway_floor::warehouse::NodeKind;

/// Cost of putting a rack where no robot can fetch it for a while, metres: more than any way.
const CLOSED_M: f64 = 1e6;

impl Floor<'_> {
    /// The storage node for a rack that comes from `from`. Its cost is the way there now, plus the way from there to a
    /// station as often as the rack is wanted, minus what the place is worth to other racks. `choice` counts down the
    /// list, for a robot that found no way to the first node. The robot's own node is among the candidates; nodes that
    /// are closed by hand, or will be soon, and nodes that a broken robot cuts off come last.
    pub(crate) fn best_storage(&self, robot: RobotId, rack: RackId, from: NodeId, choice: usize) -> NodeId {
        let heat = self.ledger.wishes.heat(rack);
        let at = |n: NodeId| self.warehouse().nodes[n].at;
        let shut = |n: NodeId| self.is_closing(n) || self.is_cut_off_from(robot, n);
        let closed = |n: NodeId| if shut(n) { CLOSED_M } else { 0.0 };
        let cost =
            |n: NodeId| along_axes(at(from), at(n)) + (heat - 1.0) * self.storage.to_station_m[n] + closed(n);
        let free = self.storage.nodes.iter().copied().filter(|n| self.may_be_at(robot, *n));
        let free = free.filter(|n| !self.is_taken_storage(*n, rack, robot));
        let mut ranked: Vec<(i64, NodeId)> = free.map(|n| ((cost(n) * 1000.0) as i64, n)).collect();
        let wanted = choice.min(ranked.len().saturating_sub(1)).min(16);
        match ranked.is_empty() {
            true => self.ledger.robots[robot].task.destination().unwrap_or(self.ledger.node_of(robot)),
            false => ranked.select_nth_unstable(wanted).1.1,
        }
    }

    /// A free charger or parking place near a robot, for it to go to.
    pub(crate) fn free_place(&self, robot: RobotId, kind: NodeKind) -> Option<NodeId> {
        self.nearest_free(robot, kind, |_| true)
    }

    /// The nearest places, `most` at most, that fit and where a robot can stay with what it carries: storage without a
    /// rack if it carries one, otherwise parking, chargers and storage.
    pub(crate) fn stays_near(
        &self,
        robot: RobotId,
        most: usize,
        fits: impl Fn(NodeId) -> bool,
    ) -> Vec<NodeId> {
        let here = self.warehouse().nodes[self.ledger.node_of(robot)].at;
        let far = |n: NodeId| (along_axes(here, self.warehouse().nodes[n].at) * 1000.0) as i64;
        let rack = self.ledger.rack_on(robot);
        let kinds: &[NodeKind] = match rack {
            Some(_) => &[NodeKind::Storage],
            None => &[NodeKind::Parking, NodeKind::Charger, NodeKind::Storage],
        };
        let free = kinds.iter().flat_map(|kind| self.ledger.index().places.free_for(robot, *kind));
        let is_open = |n: NodeId| !self.is_closing(n) && !self.is_cut_off_from(robot, n);
        let free = free.filter(|n| is_open(*n) && self.may_be_at(robot, *n));
        let room = |n: &NodeId| rack.is_none_or(|k| !self.is_taken_storage(*n, k, robot));
        let mut near: Vec<(i64, NodeId)> = free.filter(room).map(|n| (far(n), n)).collect();
        near.sort_unstable();
        near.into_iter().map(|(_, n)| n).filter(|n| fits(*n)).take(most).collect()
    }

    fn nearest_free(&self, robot: RobotId, kind: NodeKind, fits: impl Fn(NodeId) -> bool) -> Option<NodeId> {
        let here = self.warehouse().nodes[self.ledger.node_of(robot)].at;
        let free = self.ledger.index().places.free_for(robot, kind).filter(|n| !self.is_closing(*n));
        let free = free.filter(|n| !self.is_cut_off_from(robot, *n));
        let free = free.filter(|n| self.may_be_at(robot, *n) && fits(*n));
        free.min_by_key(|n| ((along_axes(here, self.warehouse().nodes[*n].at) * 1000.0) as i64, *n))
    }

    /// A place where an unloaded robot can stay: parking, else a charger, else beneath a rack that no robot is sent to.
    pub(crate) fn any_stay(&self, robot: RobotId) -> Option<NodeId> {
        self.free_place(robot, NodeKind::Parking)
            .or_else(|| self.free_place(robot, NodeKind::Charger))
            .or_else(|| self.free_place(robot, NodeKind::Storage))
    }

    /// A place where an unloaded robot can stay and is in the way of no rack: parking, else storage without a rack.
    pub(crate) fn place_without_rack(&self, robot: RobotId) -> Option<NodeId> {
        let parking = self.free_place(robot, NodeKind::Parking);
        parking.or_else(|| self.storage_without_rack(robot))
    }

    /// A storage node without a rack where an unloaded robot can stay.
    pub(crate) fn storage_without_rack(&self, robot: RobotId) -> Option<NodeId> {
        let places = &self.ledger.index().places;
        let empty = |n: NodeId| places.rack_on(n).is_none() && !places.is_wanted(n);
        self.nearest_free(robot, NodeKind::Storage, empty)
    }

    /// Whether closed areas and robots that cannot drive are on all ways of a robot to a place where it can stay.
    pub(crate) fn is_cut_off_from(&self, robot: RobotId, node: NodeId) -> bool {
        let (here, loaded) = (self.ledger.node_of(robot), self.ledger.rack_on(robot).is_some());
        !self.restrictions.cut_off.reaches(self.warehouse(), (here, node), loaded)
    }

    /// Whether a storage node cannot be promised to `rack` on `robot`.
    pub(crate) fn is_taken_storage(&self, node: NodeId, rack: RackId, robot: RobotId) -> bool {
        let places = &self.ledger.index().places;
        places.rack_on(node).is_some_and(|k| k != rack)
            || places.is_promised(node, robot)
            || places.is_wanted_for_another(node, rack)
    }
}
