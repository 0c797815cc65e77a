//! How people affect the search: nodes that are closed, without entry or exit, slow, or with a soft cost for a while.
//!
//! Main types: [`Conditions`], [`Condition`], [`Effect`]. This is the only way in which people enter planning. Refuses:
//! to know why a condition holds, beyond its cause.

use crate::geometry::Point;
use crate::id::{ClosureId, Dense, IdVec, NodeId, RobotId, WorkerId};
use crate::time::{Span, Time, Window};
use crate::warehouse::Warehouse;
use smallvec::SmallVec;
use std::collections::BTreeMap;

/// What causes a condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// A worker is on the node, or probably will be.
    Worker(WorkerId),
    /// The area is closed, or will be.
    Closure(ClosureId),
    /// A displaced robot stands on the node.
    Robot(RobotId),
    /// Something stands on this node, as a robot that could not get there reported.
    Obstruction(NodeId),
    /// The node is on a person's way to a door while the building is evacuated.
    Evacuation,
}

/// The effect of a condition on a node during a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effect {
    /// No robot may be there.
    Closed,
    /// No robot may come or go; a robot that stands there stays.
    NoEntryOrExit,
    /// Being on the node costs as much as this much delay.
    SoftCost(Span),
    /// Robots drive no faster than this, without and with a rack, metres per second.
    Slow([f64; 2]),
}

/// One condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// When the condition holds.
    pub window: Window,
    /// Effect of the condition.
    pub effect: Effect,
    /// Cause of the condition.
    pub cause: Cause,
}

/// Permission for a robot to leave. A robot already too near to a worker may go wherever it comes no nearer. A robot
/// already in a closed area may continue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exemption {
    /// The worker, the closed area, the evacuation or the displaced robot that the robot may leave.
    pub from: Cause,
    /// Where the worker or the displaced robot is.
    pub at: Point,
    /// Distance of the robot from there, metres.
    pub distance_m: f64,
}

/// Approach that still counts as coming no nearer, metres.
const NEARER_M: f64 = 0.15;

/// All conditions at one moment. Conditions of announced closures last from step to step; those of people end with the
/// step.
#[derive(Clone, Debug, Default)]
pub struct Conditions {
    /// Conditions of each node, lasting ones first.
    nodes: IdVec<NodeId, SmallVec<[Condition; 2]>>,
    /// Number of lasting conditions of a node.
    lasting: BTreeMap<NodeId, usize>,
    /// Nodes with passing conditions.
    touched: Vec<NodeId>,
    /// A bit for each node that has conditions: the search asks for most nodes in vain, and this stays in the cache.
    marks: Vec<u64>,
}

/// No conditions at all: a floor without people.
pub static NO_PEOPLE: Conditions =
    Conditions { nodes: IdVec::new(), lasting: BTreeMap::new(), touched: Vec::new(), marks: Vec::new() };

impl Conditions {
    /// No conditions yet, for a building.
    pub fn none(warehouse: &Warehouse) -> Conditions {
        let count = warehouse.nodes.len();
        let nodes = IdVec::filled(SmallVec::new(), count);
        let marks = vec![0; count.div_ceil(64)];
        Conditions { nodes, lasting: BTreeMap::new(), touched: Vec::new(), marks }
    }

    /// Removes all passing conditions.
    pub fn clear(&mut self) {
        for node in std::mem::take(&mut self.touched) {
            let lasting = self.lasting.get(&node).copied().unwrap_or(0);
            self.nodes[node].truncate(lasting);
            self.mark(node, lasting > 0);
        }
    }

    /// Adds a condition that lasts until it is lifted, in order of causes. Call this while there are no passing
    /// conditions.
    pub fn announce(&mut self, node: NodeId, condition: Condition) {
        debug_assert!(self.touched.is_empty(), "lasting conditions stand before all passing ones");
        let list = &mut self.nodes[node];
        let at = list.partition_point(|c| c.cause <= condition.cause);
        list.insert(at, condition);
        *self.lasting.entry(node).or_default() += 1;
        self.mark(node, true);
    }

    /// Removes the lasting conditions of a cause from a node. Call this while there are no passing conditions.
    pub fn lift(&mut self, node: NodeId, cause: Cause) {
        debug_assert!(self.touched.is_empty(), "lasting conditions stand before all passing ones");
        let list = &mut self.nodes[node];
        list.retain(|c| c.cause != cause);
        let left = list.len();
        if left > 0 {
            self.lasting.insert(node, left);
        } else {
            self.lasting.remove(&node);
        }
        self.mark(node, left > 0);
    }

    fn mark(&mut self, node: NodeId, is_touched: bool) {
        let (word, bit) = (&mut self.marks[node.ix() / 64], 1 << (node.ix() % 64));
        *word = if is_touched { *word | bit } else { *word & !bit };
    }

    /// Adds a condition that ends with the step. One of the same cause and effect that meets it is widened instead.
    pub fn add(&mut self, node: NodeId, condition: Condition) {
        let lasting = self.lasting.get(&node).copied().unwrap_or(0);
        if self.nodes[node].len() == lasting {
            self.touched.push(node);
            self.mark(node, true);
        }
        let list = &mut self.nodes[node];
        let same = |c: &&mut Condition| {
            let meets =
                c.window.start() <= condition.window.end() && condition.window.start() <= c.window.end();
            c.cause == condition.cause && c.effect == condition.effect && meets
        };
        match list[lasting..].iter_mut().find(same) {
            Some(c) => {
                let (a, b) = (c.window, condition.window);
                c.window = Window::new(a.start().min(b.start()), a.end().max(b.end()));
            }
            None => list.push(condition),
        }
    }

    /// Adds all passing conditions of another set, which has no lasting ones.
    pub fn include(&mut self, other: &Conditions) {
        debug_assert!(other.lasting.is_empty(), "lasting conditions are announced");
        for node in other.passing() {
            other.of(node).iter().for_each(|c| self.add(node, *c));
        }
    }

    /// Removes the passing conditions of a cause.
    pub fn withdraw(&mut self, cause: Cause) {
        for node in &self.touched {
            self.nodes[*node].retain(|c| c.cause != cause);
        }
    }

    /// The conditions of a node.
    pub fn of(&self, node: NodeId) -> &[Condition] {
        if self.is_touched(node) { &self.nodes[node] } else { &[] }
    }

    /// Whether a node has conditions.
    pub fn is_touched(&self, node: NodeId) -> bool {
        self.marks.get(node.ix() / 64).is_some_and(|w| w >> (node.ix() % 64) & 1 != 0)
    }

    /// Nodes with passing conditions.
    pub fn passing(&self) -> impl Iterator<Item = NodeId> {
        self.touched.iter().copied()
    }

    /// Nodes with conditions.
    pub fn nodes(&self) -> impl Iterator<Item = NodeId> {
        let passing = self.touched.iter().copied().filter(|n| !self.lasting.contains_key(n));
        self.lasting.keys().copied().chain(passing)
    }

    /// Whether there are passing conditions.
    pub fn has_passing(&self) -> bool {
        !self.touched.is_empty()
    }

    /// Whether there are no conditions at all.
    pub fn is_empty(&self) -> bool {
        self.touched.is_empty() && self.lasting.is_empty()
    }

    /// The conditions of a node that bind a robot with these exemptions.
    pub fn binding<'a>(
        &'a self,
        node: NodeId,
        at: Point,
        exemptions: &'a [Exemption],
    ) -> impl Iterator<Item = &'a Condition> + Clone {
        self.of(node).iter().filter(move |c| !exemptions.iter().any(|a| a.excuses(c, at)))
    }
}

impl Exemption {
    /// Whether the exemption frees the robot from a condition on a place.
    fn excuses(&self, condition: &Condition, at: Point) -> bool {
        let from_me = condition.cause == self.from;
        let hard = matches!(condition.effect, Effect::Closed | Effect::NoEntryOrExit);
        let farther = || (at - self.at).norm() >= self.distance_m - NEARER_M;
        from_me && hard && (matches!(self.from, Cause::Closure(_) | Cause::Evacuation) || farther())
    }
}

/// The earliest `t` from `from` on at which a move of `span` meets none of the windows, and until when it may be
/// delayed from there.
pub(super) fn no_entry_until(
    windows: impl Iterator<Item = Window> + Clone,
    mut from: Time,
    span: Span,
) -> (Time, Time) {
    // Each window pushes at most once, so the loop ends after as many rounds as there are windows.
    loop {
        let hit = windows.clone().find(|w| w.start() < from + span && from < w.end());
        match hit {
            Some(w) => from = w.end(),
            None => break,
        }
    }
    let latest = windows.filter(|w| w.start() >= from + span).map(|w| w.start() - span).min();
    (from, latest.unwrap_or(Time::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn window(a: i64, b: i64) -> Window {
        Window::new(Time(a), Time(b))
    }

    #[test]
    fn a_move_waits_for_the_end_of_every_window_that_it_would_meet() {
        let windows = [window(10, 20), window(22, 30), window(100, 110)];
        assert_eq!(no_entry_until(windows.iter().copied(), Time(0), Span(5)), (Time(0), Time(5)));
        assert_eq!(no_entry_until(windows.iter().copied(), Time(6), Span(5)), (Time(30), Time(95)));
        assert_eq!(no_entry_until(windows.iter().copied(), Time(105), Span(5)), (Time(110), Time::MAX));
    }

    #[test]
    fn what_is_announced_lasts_until_it_is_lifted_and_what_people_mean_passes() {
        let warehouse = crate::warehouse::lab();
        let mut conditions = Conditions::none(&warehouse);
        let [a, b] = [NodeId(0), NodeId(9)];
        let of = |cause| Condition { window: window(0, 9), effect: Effect::Closed, cause };
        let (one, two) = (of(Cause::Closure(ClosureId(1))), of(Cause::Closure(ClosureId(2))));
        let person = of(Cause::Worker(WorkerId(0)));
        conditions.announce(a, one);
        conditions.announce(a, two);
        conditions.add(a, person);
        conditions.add(b, person);
        assert_eq!(conditions.of(a), [one, two, person], "announced ones first");
        assert_eq!(conditions.nodes().collect::<Vec<_>>(), [a, b]);
        conditions.clear();
        assert_eq!((conditions.of(a), conditions.of(b)), ([one, two].as_slice(), [].as_slice()));
        assert!(conditions.is_touched(a) && !conditions.is_touched(b) && !conditions.has_passing());
        conditions.lift(a, one.cause);
        assert_eq!(conditions.of(a), [two]);
        conditions.lift(a, two.cause);
        assert!(conditions.is_empty() && !conditions.is_touched(a));
    }

    #[test]
    fn who_goes_away_is_bound_only_where_it_would_come_nearer() {
        let at = |x: f64| Point::new(x, 0.0);
        let cause = Cause::Worker(WorkerId(3));
        let exemption = Exemption { from: cause, at: at(0.0), distance_m: 2.0 };
        let closed = Condition { window: window(0, 9), effect: Effect::Closed, cause };
        assert!(exemption.excuses(&closed, at(2.0)) && exemption.excuses(&closed, at(5.0)));
        assert!(!exemption.excuses(&closed, at(1.0)));
        let other = Condition { cause: Cause::Worker(WorkerId(4)), ..closed };
        assert!(!exemption.excuses(&other, at(5.0)));
    }
}
