//! Announced closures as the search sees them: looked at when one is announced, begins, ends or is taken back, and in
//! no other step.
//!
//! Main type: [`Areas`]. Refuses: to know of people, whose conditions are rebuilt in every step.

use crate::state::recurring::LOOKS;
use crate::state::regions::KindConditions;
use crate::state::worker::Closure;
use giveway_floor::geometry::Point;
use giveway_floor::id::{ClosureId, NodeId};
use giveway_floor::route::{Cause, Condition, Effect};
use giveway_floor::time::{Span, Time, Window};
use giveway_floor::warehouse::{NodeKind, Warehouse};
use giveway_people::aware::nodes_in;
use std::collections::BTreeMap;

/// What closes within this time counts as closed when a job, a place for a rack or a place to rest is chosen.
pub(crate) const SOON: Span = Span::from_secs(180);

/// How long a closure that is over stays in the list.
const KEPT: Span = Span::from_secs(24 * 3600);

/// How long an occurrence that is over stays in the list: there are many, and the recurring closure stays.
const KEPT_OCCURRENCE: Span = Span::from_secs(3600);

/// The search is told of a closure this long before it begins: no route takes longer, and closures months ahead would
/// only be in its way.
const AHEAD: Span = Span::from_secs(24 * 3600);

/// An area with its nodes.
#[derive(Clone, Debug)]
struct ClosedArea {
    nodes: Vec<NodeId>,
    window: Window,
}

/// Closures that are in force or begin within a day.
#[derive(Clone, Debug, Default)]
pub struct Areas {
    open: BTreeMap<ClosureId, ClosedArea>,
    /// Nodes that are closed, or will be soon, with when that begins.
    closing: BTreeMap<NodeId, Time>,
    /// The closure of each of these nodes; if there are several, the first.
    by: BTreeMap<NodeId, ClosureId>,
    /// Storage nodes beside closed ones whose racks have no other way out, with when the last way is closed.
    cut_off: BTreeMap<NodeId, Time>,
    /// How many closures had been announced and taken back when they were last looked at; nothing if they are to be
    /// announced to all robots again.
    changes: Option<u64>,
    next: Option<Time>,
    /// When recurring closures were last looked at, and how many changes there had been.
    recurring: Option<(Time, u64)>,
    /// When the first closure will have been over for so long that it is forgotten.
    forget: Option<Time>,
}

impl Areas {
    /// Looks at the closures if some were announced or taken back, or one begins or ends now. `changes` counts closures
    /// that were announced and taken back. To be called while there are no passing conditions.
    pub fn update(
        &mut self,
        closures: &BTreeMap<ClosureId, Closure>,
        changes: u64,
        conditions: &mut KindConditions,
        warehouse: &Warehouse,
        now: Time,
    ) {
        if self.changes == Some(changes) && self.next.is_none_or(|t| now < t) {
            return;
        }
        self.changes = Some(changes);
        let over = |id: &ClosureId, a: &ClosedArea| a.window.end() <= now || !closures.contains_key(id);
        for (id, area) in self.open.extract_if(.., |id, a| over(id, a)) {
            area.nodes.iter().for_each(|n| conditions.lift(*n, Cause::Closure(id)));
        }
        let ahead = Window::new(now, now + AHEAD);
        for (id, closure) in closures.iter().filter(|(_, c)| c.binds.robots() && c.window.overlaps(ahead)) {
            let window = closure.window;
            self.open.entry(*id).or_insert_with(|| {
                let nodes = nodes_of(closure, warehouse);
                let condition = Condition { window, effect: Effect::Closed, cause: Cause::Closure(*id) };
                nodes.iter().for_each(|n| conditions.announce(*n, condition));
                ClosedArea { nodes, window }
            });
        }
        self.note_closing(warehouse, now);
        self.next = closures.values().filter_map(|c| next_change(c.window, now)).min();
        self.forget = closures.values().map(forgotten_at).min();
    }

    /// Forgets what was announced, so that it is announced again when the closures are next looked at.
    pub fn announce_anew(&mut self) {
        self.open.clear();
        self.changes = None;
    }

    /// Whether recurring closures are to be looked at now. After a yes, the answer is no for a while.
    pub fn looks_at_recurring(&mut self, changes: u64, now: Time) -> bool {
        let looks = self.recurring.is_none_or(|(at, before)| before != changes || now >= at + LOOKS);
        if looks {
            self.recurring = Some((now, changes));
        }
        looks
    }

    /// Closures that have been over for so long that they are to be forgotten.
    pub fn forgotten(&self, closures: &BTreeMap<ClosureId, Closure>, now: Time) -> Vec<ClosureId> {
        if self.forget.is_none_or(|t| now < t) {
            return Vec::new();
        }
        closures.iter().filter(|(_, c)| forgotten_at(c) <= now).map(|(id, _)| *id).collect()
    }

    /// Since when, or from when on, a node is closed by hand or cut off by that, if it is or will be soon.
    pub fn begins(&self, node: NodeId) -> Option<Time> {
        self.closing.get(&node).or_else(|| self.cut_off.get(&node)).copied()
    }

    /// Since when, or from when on, a node is itself closed by hand, not merely cut off.
    pub fn begins_here(&self, node: NodeId) -> Option<Time> {
        self.closing.get(&node).copied()
    }

    /// Nodes that are closed by hand, or will be soon, with the closure of each.
    pub fn closed_by(&self) -> &BTreeMap<NodeId, ClosureId> {
        &self.by
    }

    /// Nodes that are closed by hand, or will be soon, and nodes that are cut off by these.
    pub fn nodes(&self) -> impl Iterator<Item = NodeId> + '_ {
        self.closing.keys().chain(self.cut_off.keys()).copied()
    }

    /// Whether nothing is closed by hand, now or soon.
    pub fn is_empty(&self) -> bool {
        self.closing.is_empty()
    }

    fn note_closing(&mut self, warehouse: &Warehouse, now: Time) {
        let soon = Window::new(now, now + SOON);
        self.closing.clear();
        self.by.clear();
        for (id, area) in self.open.iter().filter(|(_, a)| a.window.overlaps(soon)) {
            let start = area.window.start();
            for node in &area.nodes {
                self.by.entry(*node).or_insert(*id);
                self.closing.entry(*node).and_modify(|t| *t = start.min(*t)).or_insert(start);
            }
        }
        let begins = |n: NodeId| self.closing.get(&n).copied();
        self.cut_off = self.closing.keys().flat_map(|n| storage_behind(warehouse, *n, begins)).collect();
    }
}

/// When a closure is forgotten.
fn forgotten_at(closure: &Closure) -> Time {
    closure.window.end() + if closure.series.is_some() { KEPT_OCCURRENCE } else { KEPT }
}

/// When the search is told of a closure, the closure begins to count, or it ends, whichever is next.
fn next_change(window: Window, now: Time) -> Option<Time> {
    let told = window.start() - AHEAD + Span(1);
    let counts = window.start() - SOON + Span(1);
    [told, counts, window.end()].into_iter().find(|t| now < *t)
}

/// Storage nodes beside a closed node whose racks have no other way out, with when the last way is closed.
pub(crate) fn storage_behind<'a>(
    warehouse: &'a Warehouse,
    closed: NodeId,
    begins: impl Fn(NodeId) -> Option<Time> + 'a,
) -> impl Iterator<Item = (NodeId, Time)> + 'a {
    let beside = warehouse.ways(closed).map(|(_, w)| w.to);
    beside.filter_map(move |n| {
        if warehouse.kind(n) != NodeKind::Storage || begins(n).is_some() {
            return None;
        }
        let out = warehouse.ways(n).filter(|(_, w)| w.users.allows(true)).map(|(_, w)| w.to);
        let out = out.filter(|to| warehouse.kind(*to) != NodeKind::Storage);
        let begins: Option<Vec<Time>> = out.map(&begins).collect();
        Some((n, begins?.into_iter().max()?))
    })
}

/// The nodes of a closed area, each once.
pub(crate) fn nodes_of(area: &Closure, warehouse: &Warehouse) -> Vec<NodeId> {
    let outline: Vec<Point> = area.outline.iter().map(|s| Point::from(*s)).collect();
    let mut nodes = if area.nodes.is_empty() { nodes_in(warehouse, &outline) } else { area.nodes.clone() };
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}
