//! How people, closed areas and displaced robots restrict robots in this step: the result of evaluating people, which
//! the search, the grants and dispatch read.
//!
//! Main type: [`Restrictions`]. Refuses: to say what a robot does about it.

use crate::state::closed_areas::Areas;
use crate::state::cut_off::CutOff;
use crate::state::regions::{KindConditions, KindRegions};
use giveway_floor::geometry::Point;
use giveway_floor::id::{IdVec, NodeId, RobotId, WorkerId};
use giveway_floor::route::Condition;
use giveway_floor::time::Time;
use giveway_floor::warehouse::Warehouse;
use giveway_people::human::Whereabouts;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Where robots may not go, or only at a price, from now on.
#[derive(Clone, Debug)]
pub struct Restrictions {
    /// For each node, the conditions that bind robots of each kind there, and when.
    pub conditions: KindConditions,
    /// Announced closures.
    pub areas: Areas,
    /// Nodes that count as closed, with when that began: a person or a displaced robot has been standing there for
    /// long, or a robot found the node obstructed.
    pub closing: BTreeMap<NodeId, Time>,
    /// What closed areas and robots that cannot drive cut off.
    pub cut_off: Arc<CutOff>,
    /// Where each worker is, if on the floor.
    pub workers: IdVec<WorkerId, Option<Whereabouts>>,
    /// Nodes on the ways of workers to the doors while the building is evacuated.
    pub ways_out: BTreeSet<NodeId>,
    /// Robots that may move while the building is evacuated.
    pub clears_ways_out: BTreeSet<RobotId>,
    /// Workers who stand to let a robot pass.
    pub let_pass: BTreeSet<WorkerId>,
    /// Where else workers may be, if their sources do not agree.
    pub others: Vec<(WorkerId, Whereabouts)>,
}

/// Nodes that one part of a step closes for robots of every kind.
#[derive(Debug, Default)]
pub struct ClosedNodes {
    /// The conditions that bind robots on these nodes.
    pub conditions: Vec<(NodeId, Condition)>,
    /// Nodes that count as closed, with when that began.
    pub since: Vec<(NodeId, Time)>,
}

/// The ways out of the building while it is evacuated.
#[derive(Debug, Default)]
pub struct ClearedWays {
    /// The closing of the nodes on the ways out.
    pub closing: ClosedNodes,
    /// The nodes on the ways out.
    pub nodes: BTreeSet<NodeId>,
    /// Robots that may move while the building is evacuated.
    pub clears: BTreeSet<RobotId>,
}

/// What the parts of a step find, each by itself, that restricts robots.
pub struct FoundRestrictions<'a> {
    /// The conditions for robots that workers cause, node by node.
    pub conditions: &'a KindConditions,
    /// Where each worker is, if on the floor.
    pub workers: IdVec<WorkerId, Option<Whereabouts>>,
    /// Where else workers may be.
    pub others: Vec<(WorkerId, Whereabouts)>,
    /// Workers who stand to let a robot pass.
    pub let_pass: BTreeSet<WorkerId>,
    /// Where people have been standing for long.
    pub stood_on: ClosedNodes,
    /// Where displaced robots stand.
    pub displaced: ClosedNodes,
    /// Where robots could not pass.
    pub obstructed: ClosedNodes,
    /// The ways out.
    pub ways_out: ClearedWays,
    /// What closed areas and robots that cannot drive cut off, if that has changed.
    pub cut_off: Option<CutOff>,
}

impl Restrictions {
    /// Takes in what the parts of a step found, in place of what they found in the step before. Announced closures
    /// last, and are in the conditions already.
    pub fn merge(&mut self, found: FoundRestrictions<'_>) {
        self.conditions.include(found.conditions);
        (self.workers, self.others, self.let_pass) = (found.workers, found.others, found.let_pass);
        let ClearedWays { closing, nodes, clears } = found.ways_out;
        (self.ways_out, self.clears_ways_out) = (nodes, clears);
        self.closing.clear();
        for part in [found.stood_on, found.displaced, found.obstructed, closing] {
            self.close(part);
        }
        if let Some(anew) = found.cut_off {
            self.cut_off = anew.into();
        }
        debug_assert!(
            self.ways_out.iter().all(|node| self.closing.contains_key(node)),
            "ways out are closed"
        );
    }

    /// Closes nodes for the rest of the step.
    pub fn close(&mut self, part: ClosedNodes) {
        let ends = |condition: &Condition| condition.window.start() < condition.window.end();
        debug_assert!(part.conditions.iter().all(|(_, c)| ends(c)), "what is closed is closed for some time");
        part.conditions.into_iter().for_each(|(node, condition)| self.conditions.add(node, condition));
        self.closing.extend(part.since);
    }

    /// No restrictions.
    pub fn none(warehouse: &Warehouse, regions: &KindRegions) -> Restrictions {
        Restrictions {
            conditions: KindConditions::none(warehouse, regions),
            areas: Areas::default(),
            closing: BTreeMap::new(),
            cut_off: Arc::default(),
            workers: IdVec::new(),
            ways_out: BTreeSet::new(),
            clears_ways_out: BTreeSet::new(),
            let_pass: BTreeSet::new(),
            others: Vec::new(),
        }
    }

    /// Begins again with conditions for other robot kinds. Announced closures are announced to these when restrictions
    /// are next renewed.
    pub fn refit(&mut self, warehouse: &Warehouse, regions: &KindRegions) {
        self.conditions = KindConditions::none(warehouse, regions);
        self.areas.announce_anew();
    }

    /// Where a worker is, if on the floor.
    pub fn whereabouts(&self, worker: WorkerId) -> Option<&Whereabouts> {
        self.workers.get(worker)?.as_ref()
    }

    /// Of all places where a worker may be, the one nearest to a point; nothing if the worker is not on the floor.
    pub fn nearest_place(&self, worker: WorkerId, to: Point) -> Option<Point> {
        let others = self.others.iter().filter(|(w, _)| *w == worker).map(|(_, place)| place.at);
        let all = self.whereabouts(worker).map(|w| w.at).into_iter().chain(others);
        all.min_by(|a, b| (a - to).norm().total_cmp(&(b - to).norm()))
    }

    /// Since when, or from when on, a node is closed, if it is or will be soon.
    pub fn closes(&self, node: NodeId) -> Option<Time> {
        self.closing.get(&node).copied().or_else(|| self.areas.begins(node))
    }

    /// Whether a node is closed, or will be soon.
    pub fn is_closing(&self, node: NodeId) -> bool {
        self.closes(node).is_some()
    }

    /// Nodes that are closed, will be soon, or count as closed.
    pub fn closing_nodes(&self) -> BTreeSet<NodeId> {
        self.areas.nodes().chain(self.closing.keys().copied()).collect()
    }
}
