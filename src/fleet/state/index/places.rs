//! Which robot and which rack is, or will be, where: by node.
//!
//! Main type: [`Places`]. Refuses: to know why a robot goes anywhere.

use crate::state::job::Job;
use crate::state::job_kind::JobKind;
use giveway_floor::id::{Dense, IdVec, JobId, NodeId, RackId, RobotId};
use giveway_floor::warehouse::{NodeKind, Warehouse};
use smallvec::SmallVec;
use std::collections::{BTreeMap, BTreeSet};

/// Robots that a node is promised to, each list ascending.
#[derive(Clone, Debug, Default, PartialEq)]
struct Claims {
    /// Robots whose route ends here.
    ends: SmallVec<[RobotId; 2]>,
    /// Robots whose task ends here.
    bound: SmallVec<[RobotId; 2]>,
}

/// What a robot claims.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Claim {
    end: Option<NodeId>,
    bound: Option<NodeId>,
    fetches: Option<RackId>,
}

/// Robots and racks by node.
#[derive(Clone, Debug, PartialEq)]
pub struct Places {
    claims: IdVec<NodeId, Claims>,
    robots: BTreeMap<RobotId, Claim>,
    /// Chargers, parking places and storage nodes that no robot claims.
    free: [BTreeSet<NodeId>; 3],
    /// The index in `free` of the set for a node's kind, if it has one.
    kinds: IdVec<NodeId, Option<u8>>,
    stored: IdVec<NodeId, Option<RackId>>,
    racks: IdVec<RackId, Option<NodeId>>,
    fetchers: IdVec<RackId, u32>,
    /// Where jobs that are not over want racks: how many jobs per node and rack.
    relocations: BTreeMap<(NodeId, RackId), u32>,
    relocating: BTreeMap<JobId, (NodeId, RackId)>,
}

fn place(kind: NodeKind) -> Option<u8> {
    match kind {
        NodeKind::Charger => Some(0),
        NodeKind::Parking => Some(1),
        NodeKind::Storage => Some(2),
        _ => None,
    }
}

impl Places {
    pub(crate) fn new(warehouse: &Warehouse) -> Places {
        let kinds: IdVec<NodeId, Option<u8>> = warehouse.nodes.iter().map(|n| place(n.kind)).collect();
        let of = |i: u8| kinds.pairs().filter(|(_, k)| **k == Some(i)).map(|(n, _)| n).collect();
        Places {
            claims: IdVec::filled(Claims::default(), warehouse.nodes.len()),
            robots: BTreeMap::new(),
            free: [of(0), of(1), of(2)],
            kinds,
            stored: IdVec::filled(None, warehouse.nodes.len()),
            racks: IdVec::filled(None, warehouse.racks.len()),
            fetchers: IdVec::filled(0, warehouse.racks.len()),
            relocations: BTreeMap::new(),
            relocating: BTreeMap::new(),
        }
    }

    /// The robot that stands on a node, or will be there in the end.
    pub fn resident(&self, node: NodeId) -> Option<RobotId> {
        self.claims.get(node)?.ends.first().copied()
    }

    /// Whether another robot stands on a node, or is sent to it.
    pub fn is_promised(&self, node: NodeId, but: RobotId) -> bool {
        let claims = &self.claims[node];
        claims.ends.iter().chain(&claims.bound).any(|r| *r != but)
    }

    /// Robots whose tasks end on a node.
    pub fn bound_for(&self, node: NodeId) -> &[RobotId] {
        &self.claims[node].bound
    }

    /// The rack that stands on a node.
    pub fn rack_on(&self, node: NodeId) -> Option<RackId> {
        self.stored[node]
    }

    /// Whether some job wants a rack on a node.
    pub fn is_wanted(&self, node: NodeId) -> bool {
        let wanted = self.relocations.range((node, RackId(0))..=(node, RackId(u32::MAX)));
        wanted.take(1).count() > 0
    }

    /// Whether some job wants another rack on a node.
    pub fn is_wanted_for_another(&self, node: NodeId, but: RackId) -> bool {
        let wanted = self.relocations.range((node, RackId(0))..=(node, RackId(u32::MAX)));
        wanted.take(2).any(|((_, rack), _)| *rack != but)
    }

    /// Chargers, parking places or storage nodes that no other robot claims, in no order.
    pub fn free_for(&self, robot: RobotId, kind: NodeKind) -> impl Iterator<Item = NodeId> + '_ {
        let wanted = place(kind);
        let free = wanted.into_iter().flat_map(|i| self.free[usize::from(i)].iter().copied());
        let own = self.robots.get(&robot).copied().unwrap_or_default();
        let bound = own.bound.filter(|b| own.end != Some(*b));
        let own = own.end.into_iter().chain(bound);
        free.chain(own.filter(move |n| self.kinds[*n] == wanted && !self.is_promised(*n, robot)))
    }

    /// Whether a robot is on its way to lift a rack.
    pub(crate) fn is_fetched(&self, rack: RackId) -> bool {
        self.fetchers[rack] > 0
    }

    /// Notes where a robot's route and its task end.
    pub(crate) fn claim(&mut self, robot: RobotId, end: Option<NodeId>, bound: Option<NodeId>) {
        let before = self.robots.entry(robot).or_default();
        let old = *before;
        (before.end, before.bound) = (end, bound);
        if old.end != end {
            change(&mut self.claims, old.end, end, robot, |c| &mut c.ends);
        }
        if old.bound != bound {
            change(&mut self.claims, old.bound, bound, robot, |c| &mut c.bound);
        }
        for node in [old.end, old.bound, end, bound].into_iter().flatten() {
            let Some(kind) = self.kinds[node] else { continue };
            let claims = &self.claims[node];
            if claims.ends.is_empty() && claims.bound.is_empty() {
                self.free[usize::from(kind)].insert(node);
            } else {
                self.free[usize::from(kind)].remove(&node);
            }
        }
    }

    /// Notes which rack a robot is on its way to. Returns the rack before, if it is another.
    pub(crate) fn fetches(&mut self, robot: RobotId, rack: Option<RackId>) -> Option<RackId> {
        let claim = self.robots.entry(robot).or_default();
        let before = std::mem::replace(&mut claim.fetches, rack);
        if before == rack {
            return None;
        }
        before.into_iter().for_each(|k| self.fetchers[k] -= 1);
        rack.into_iter().for_each(|k| self.fetchers[k] += 1);
        before
    }

    /// Notes where a rack stands; nothing while it is on a robot.
    pub(crate) fn store(&mut self, rack: RackId, node: Option<NodeId>) {
        let before = std::mem::replace(&mut self.racks[rack], node);
        if let Some(n) = before.filter(|n| self.stored[*n] == Some(rack)) {
            self.stored[n] = None;
        }
        if let Some(n) = node {
            self.stored[n] = Some(rack);
        }
    }

    /// Notes where a job wants its rack; nothing once the job is over.
    pub(crate) fn relocates(&mut self, id: JobId, job: Option<&Job>) {
        if let Some(key) = self.relocating.remove(&id) {
            let count = self.relocations.get_mut(&key).expect("it was counted");
            *count -= 1;
            if *count == 0 {
                self.relocations.remove(&key);
            }
        }
        if let Some(JobKind::Relocate { node, rack }) = job.map(|j| j.request.kind) {
            self.relocating.insert(id, (node, rack));
            *self.relocations.entry((node, rack)).or_default() += 1;
        }
    }
}

/// Moves a robot from one node's list to another's.
fn change(
    claims: &mut IdVec<NodeId, Claims>,
    from: Option<NodeId>,
    to: Option<NodeId>,
    robot: RobotId,
    list: fn(&mut Claims) -> &mut SmallVec<[RobotId; 2]>,
) {
    if let Some(node) = from {
        list(&mut claims[node]).retain(|r| *r != robot);
    }
    if let Some(node) = to {
        let list = list(&mut claims[node]);
        let at = list.partition_point(|r| r.ix() < robot.ix());
        list.insert(at, robot);
    }
}
