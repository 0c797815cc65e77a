//! Where robots and racks are on the new map, and where robots bring the racks that are on them.
//!
//! Main type: `Placed`. Refuses: to move anything that stands, and to put two robots or two racks where one has room.

use super::Move;
use super::matching::added;
use crate::state::fact::Task;
use crate::state::ledger::{Robot, stand};
use crate::state::storage::along_axes;
use crate::{JobKind, RackAt};
use giveway_floor::geometry::Spot;
use giveway_floor::id::{IdVec, NodeId, RackId, RobotId};
use giveway_floor::timeline::{ChainParts, Visit};
use giveway_floor::warehouse::NodeKind;
use std::collections::{BTreeMap, BTreeSet};

/// Robots and racks on the new map.
pub(super) struct Placed {
    pub robots: IdVec<RobotId, Robot>,
    pub chains: Vec<ChainParts>,
    pub racks: IdVec<RackId, RackAt>,
}

/// A robot with a rack.
struct Load {
    robot: RobotId,
    rack: RackId,
    /// Where the robot stands.
    at: NodeId,
    /// The storage node that the rack was bound for, if it is still one.
    bound: Option<NodeId>,
    store: Option<NodeId>,
}

impl Move<'_> {
    /// Where everything is on the new map. If the report has obstacles, the result is incomplete and must not be used.
    pub(super) fn place(&mut self) -> Placed {
        let stands = self.stands();
        let racks = self.stored();
        let mut loads = self.loads(&stands);
        self.shut_in(&loads);
        let mut taken: BTreeSet<NodeId> = racks.iter().flatten().filter_map(stored_on).collect();
        for load in &mut loads {
            load.store = load.bound.filter(|n| taken.insert(*n));
        }
        let racks = self.new_racks(racks, &loads, &mut taken);
        let wanted = self.wanted();
        for load in loads.iter_mut().filter(|l| l.store.is_none()) {
            load.store = self.best_free(load, &taken, &wanted, &stands);
            match load.store {
                Some(node) => _ = taken.insert(node),
                None => self.no_room(load),
            }
        }
        let stores: BTreeMap<RobotId, Task> = loads.iter().filter_map(task).collect();
        Placed { robots: self.robots(&stores), chains: self.chains(&stands), racks }
    }

    /// Where each robot on the floor stands.
    fn stands(&mut self) -> BTreeMap<RobotId, NodeId> {
        let ledger = self.ledger;
        let mut stands = BTreeMap::new();
        let mut by_node: BTreeMap<NodeId, RobotId> = BTreeMap::new();
        for robot in ledger.present() {
            let record = &ledger.robots[robot];
            let node = ledger.node_of(robot);
            let Some(here) = self.ids.nodes[node] else {
                let name = &self.old.nodes[node].name;
                let what = format!("{} stands on {name}, which the new map does not have", record.name);
                self.report.refuse(self.spot(node), what, SEND_ELSEWHERE);
                continue;
            };
            for other in self.too_near(robot, here, &by_node) {
                let place = |r: RobotId| &self.old.nodes[ledger.node_of(r)].name;
                let other_name = &ledger.robots[other].name;
                let what = format!(
                    "{} on {} and {other_name} on {} are too close to one another on the new map",
                    record.name,
                    place(robot),
                    place(other)
                );
                self.report.refuse(self.spot(node), what, SEND_ELSEWHERE);
            }
            by_node.insert(here, robot);
            stands.insert(robot, here);
        }
        stands
    }

    /// Robots that have no room beside a robot on a node.
    fn too_near(&self, robot: RobotId, here: NodeId, by_node: &BTreeMap<NodeId, RobotId>) -> Vec<RobotId> {
        let line = |robot: RobotId, node: NodeId| {
            let body = self.new.body_of(&self.ledger.robots[robot].kind);
            let loaded = self.ledger.rack_on(robot).is_some();
            self.new.line(body, loaded, self.new.node_resource(node))
        };
        let blocked = self.new.lines_in_conflict(line(robot, here));
        let near = self.new.conflicts(self.new.node_resource(here)).iter();
        let near = near.filter_map(|r| self.new.resource(*r).ok()).chain([here]);
        let others = near.filter_map(|n| Some((n, *by_node.get(&n)?)));
        let touch = |(n, other): &(NodeId, RobotId)| *n == here || blocked.contains(&line(*other, *n));
        others.filter(touch).map(|(_, other)| other).collect()
    }

    /// Where racks of the old map are on the new one; nothing for racks that are new.
    fn stored(&mut self) -> IdVec<RackId, Option<RackAt>> {
        let mut racks = IdVec::filled(None, self.new.racks.len());
        for (rack, at) in self.ledger.racks.pairs() {
            let name = &self.old.racks[rack].name;
            match (self.ids.racks[rack], *at) {
                (Some(new), RackAt::On(robot)) => racks[new] = Some(RackAt::On(robot)),
                (Some(new), RackAt::Stored(node)) => racks[new] = self.stored_at(name, node),
                (None, RackAt::On(robot)) => {
                    let at = self.spot(self.ledger.node_of(robot));
                    let robot = &self.ledger.robots[robot].name;
                    let what = format!("{robot} carries rack {name}, which the new map does not have");
                    self.report.refuse(
                        at,
                        what,
                        "with the old map, wait until the robot has set it down, then try again",
                    );
                }
                (None, RackAt::Stored(node)) => {
                    let at = self.spot(node);
                    let node = &self.old.nodes[node].name;
                    let what = format!("rack {name}, which stands on {node}, is gone from the map");
                    let remedy = "put it back into the map, or take it off the floor and accept its loss";
                    self.report.lose(at, what, remedy);
                }
            }
        }
        racks
    }

    /// Puts a rack on the node of the same name, which has to be a storage node.
    fn stored_at(&mut self, rack: &str, node: NodeId) -> Option<RackAt> {
        let name = &self.old.nodes[node].name;
        let why = match self.ids.nodes[node] {
            None => "which the new map does not have",
            Some(new) if self.new.nodes[new].kind != NodeKind::Storage => {
                "which is not a storage node on the new map"
            }
            Some(new) => return Some(RackAt::Stored(new)),
        };
        self.report.refuse(
            self.spot(node),
            format!("rack {rack} stands on {name}, {why}"),
            "with the old map, relocate the rack to a node that is a storage node on both maps, then try again",
        );
        None
    }

    /// Robots that carry racks.
    fn loads(&self, stands: &BTreeMap<RobotId, NodeId>) -> Vec<Load> {
        let mut loads = Vec::new();
        for (rack, at) in self.ledger.racks.pairs() {
            let (RackAt::On(robot), Some(rack)) = (*at, self.ids.racks[rack]) else { continue };
            let Some(at) = stands.get(&robot).copied() else { continue };
            let bound = match self.ledger.robots[robot].task {
                Task::Deliver { store, .. } | Task::Store { store, .. } => self.ids.nodes[store],
                Task::Idle | Task::Fetch { .. } | Task::Move { .. } => None,
            };
            let bound = bound.filter(|n| self.new.nodes[*n].kind == NodeKind::Storage);
            loads.push(Load { robot, rack, at, bound, store: None });
        }
        loads
    }

    /// Refuses robots that cannot leave with their racks: only unloaded robots come to their node on the new map.
    fn shut_in(&mut self, loads: &[Load]) {
        for load in loads {
            let leaves = self.new.out(load.at).any(|(_, arc)| arc.users.allows(true));
            if !leaves && self.new.nodes[load.at].kind != NodeKind::Storage {
                let (robot, node) = (&self.ledger.robots[load.robot].name, &self.new.nodes[load.at].name);
                let what = format!(
                    "{robot} stands on {node} with a rack, and on the new map no lane for loaded robots leads from \
                     there"
                );
                self.report.refuse(self.spot(self.ledger.node_of(load.robot)), what, SEND_ELSEWHERE);
            }
        }
    }

    /// Puts racks that are new on the map at home or, if something is there, on the nearest free node.
    fn new_racks(
        &mut self,
        mut racks: IdVec<RackId, Option<RackAt>>,
        loads: &[Load],
        taken: &mut BTreeSet<NodeId>,
    ) -> IdVec<RackId, RackAt> {
        let under_load: BTreeSet<NodeId> = loads.iter().map(|l| l.at).collect();
        for rack in added(&self.ids.racks, self.new.racks.len()) {
            let (name, home) = (&self.new.racks[rack].name, self.new.racks[rack].home);
            let is_free = |n: &NodeId| !taken.contains(n) && !under_load.contains(n);
            let at = |n: NodeId| self.new.nodes[n].at;
            let storage = self.new.nodes_where(|k| k == NodeKind::Storage);
            let far = |n: &NodeId| ((along_axes(at(home), at(*n)) * 1000.0) as i64, *n);
            let Some(node) = storage.into_iter().filter(is_free).min_by_key(far) else {
                let what = format!("the new map has no free storage node for its new rack {name}");
                let at = Some(Spot::from(at(home)));
                self.report.refuse(at, what, "add a storage node to the map, or leave the rack out");
                continue;
            };
            if node != home {
                let (node, home) = (&self.new.nodes[node].name, &self.new.nodes[home].name);
                let note = format!("put the new rack {name} onto {node}: its home {home} is taken");
                self.report.notes.push(note);
            }
            taken.insert(node);
            racks[rack] = Some(RackAt::Stored(node));
        }
        let nowhere = RackAt::Stored(NodeId(u32::MAX));
        racks.iter().map(|at| at.unwrap_or(nowhere)).collect()
    }

    /// Storage nodes that jobs ask for, each with the rack that is to come there.
    fn wanted(&self) -> BTreeSet<(NodeId, RackId)> {
        let kinds = self.ledger.jobs.values().map(|job| job.request.kind);
        let goals = kinds.filter_map(|kind| match kind {
            JobKind::Relocate { rack, node } => Some((self.ids.nodes[node]?, self.ids.racks[rack]?)),
            _ => None,
        });
        goals.collect()
    }

    /// The nearest free storage node; if there is one, a node that no job wants for another rack, and on which no other
    /// robot stands.
    fn best_free(
        &self,
        load: &Load,
        taken: &BTreeSet<NodeId>,
        wanted: &BTreeSet<(NodeId, RackId)>,
        stands: &BTreeMap<RobotId, NodeId>,
    ) -> Option<NodeId> {
        let at = |n: NodeId| self.new.nodes[n].at;
        let others: BTreeSet<NodeId> =
            stands.iter().filter(|(r, _)| **r != load.robot).map(|(_, n)| *n).collect();
        let for_another = |n: NodeId| {
            let racks = wanted.range((n, RackId(0))..=(n, RackId(u32::MAX)));
            racks.into_iter().any(|(_, rack)| *rack != load.rack)
        };
        let far = |n: NodeId| (along_axes(at(load.at), at(n)) * 1000.0) as i64;
        let storage = self.new.nodes_where(|k| k == NodeKind::Storage);
        let free = storage.into_iter().filter(|n| !taken.contains(n));
        free.min_by_key(|n| (others.contains(n) || for_another(*n), far(*n), *n))
    }

    fn no_room(&mut self, load: &Load) {
        let (robot, rack) = (&self.ledger.robots[load.robot].name, &self.new.racks[load.rack].name);
        let what = format!("{robot} carries rack {rack}, and the new map has no free storage node for it");
        let at = self.spot(self.ledger.node_of(load.robot));
        self.report.refuse(at, what, "add a storage node to the map");
    }

    /// Makes each robot idle, or has it bring away the rack that it carries.
    fn robots(&self, stores: &BTreeMap<RobotId, Task>) -> IdVec<RobotId, Robot> {
        let robot = |(id, old): (RobotId, &Robot)| {
            let task = stores.get(&id).copied().unwrap_or(Task::Idle);
            Robot { task, stops: Vec::new(), interrupted: task != Task::Idle, ..old.clone() }
        };
        self.ledger.robots.pairs().map(robot).collect()
    }

    /// One visit without end for each robot. Its serial number is higher than any of the old route, so that a late
    /// report about the old route cannot be mistaken for one about the new. It does not matter where a robot that has
    /// left once stood: it holds nothing there.
    fn chains(&self, stands: &BTreeMap<RobotId, NodeId>) -> Vec<ChainParts> {
        let left_from = |robot: RobotId| self.ids.nodes[self.ledger.node_of(robot)].unwrap_or(NodeId(0));
        let chain = |robot: RobotId| {
            let old = self.ledger.chain(robot);
            let first = old.end();
            let node = stands.get(&robot).copied().unwrap_or_else(|| left_from(robot));
            let loaded = self.ledger.rack_on(robot).is_some();
            let visits = vec![Visit { loaded, ..stand(node, self.at) }];
            let (holder, granted, absent) = (robot, first + 1, old.is_absent());
            ChainParts { holder, first, granted, visits, absent }
        };
        self.ledger.robots.ids().map(chain).collect()
    }
}

const SEND_ELSEWHERE: &str = "with the old map, send the robot to a node that both maps have, then try again";

fn stored_on(at: &RackAt) -> Option<NodeId> {
    match *at {
        RackAt::Stored(node) => Some(node),
        RackAt::On(_) => None,
    }
}

fn task(load: &Load) -> Option<(RobotId, Task)> {
    Some((load.robot, Task::Store { job: None, rack: load.rack, store: load.store? }))
}
