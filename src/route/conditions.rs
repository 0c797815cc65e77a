//! What people mean for the search: nodes that are closed, kept still, slow or dear for a while.
//!
//! Main types: [`Conditions`], [`Condition`], [`Effect`]. This is the only way in which people enter planning.
//! Refuses: to know why a condition holds, beyond whose it is.

use crate::geometry::Point;
use crate::id::{ClosureId, Dense, IdVec, NodeId, WorkerId};
use crate::time::{Span, Time, Window};
use crate::warehouse::Warehouse;
use smallvec::SmallVec;

/// Whose condition it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// A worker is there, or probably will be.
    Worker(WorkerId),
    /// Somebody marked the area.
    Closure(ClosureId),
}

/// What holds on a node during a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effect {
    /// No robot may be there.
    Closed,
    /// No robot may come or go; who stands there stays.
    Still,
    /// Being there is as bad as being this much later.
    Price(Span),
    /// Robots drive no faster than this, without and with a rack, metres per second.
    Slow([f64; 2]),
}

/// One condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// When.
    pub window: Window,
    /// What.
    pub effect: Effect,
    /// Whose.
    pub cause: Cause,
}

/// A robot that is too near to a worker already: it may go wherever it does not come nearer. Or one that is in a closed
/// area already: it may go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Away {
    /// From whom, or from where.
    pub from: Cause,
    /// Where the worker is.
    pub at: Point,
    /// How far the robot is, metres.
    pub distance_m: f64,
}

/// Coming nearer by this much does not count, metres.
const NEARER_M: f64 = 0.15;

/// All conditions at one moment.
#[derive(Clone, Debug, Default)]
pub struct Conditions {
    nodes: IdVec<NodeId, SmallVec<[Condition; 2]>>,
    touched: Vec<NodeId>,
    /// A bit for each node that is touched: the search asks for most nodes in vain, and this stays in the cache.
    marks: Vec<u64>,
}

/// No conditions at all: a floor without people.
pub static NO_PEOPLE: Conditions = Conditions { nodes: IdVec::new(), touched: Vec::new(), marks: Vec::new() };

impl Conditions {
    /// None yet, for a building.
    pub fn none(warehouse: &Warehouse) -> Conditions {
        let count = warehouse.nodes.len();
        let nodes = IdVec::filled(SmallVec::new(), count);
        Conditions { nodes, touched: Vec::new(), marks: vec![0; count.div_ceil(64)] }
    }

    /// Takes all back.
    pub fn clear(&mut self) {
        for node in self.touched.drain(..) {
            self.nodes[node].clear();
        }
        self.marks.fill(0);
    }

    /// Adds one. One of the same cause and effect that meets it is widened instead.
    pub fn add(&mut self, node: NodeId, condition: Condition) {
        let list = &mut self.nodes[node];
        if list.is_empty() {
            self.touched.push(node);
            self.marks[node.ix() / 64] |= 1 << (node.ix() % 64);
        }
        let same = |c: &&mut Condition| {
            let meets =
                c.window.start() <= condition.window.end() && condition.window.start() <= c.window.end();
            c.cause == condition.cause && c.effect == condition.effect && meets
        };
        match list.iter_mut().find(same) {
            Some(c) => {
                let (a, b) = (c.window, condition.window);
                c.window = Window::new(a.start().min(b.start()), a.end().max(b.end()));
            }
            None => list.push(condition),
        }
    }

    /// Those of a node.
    pub fn of(&self, node: NodeId) -> &[Condition] {
        if self.is_touched(node) { &self.nodes[node] } else { &[] }
    }

    /// Whether a node has any.
    pub fn is_touched(&self, node: NodeId) -> bool {
        self.marks.get(node.ix() / 64).is_some_and(|w| w >> (node.ix() % 64) & 1 != 0)
    }

    /// Nodes with conditions.
    pub fn nodes(&self) -> impl Iterator<Item = NodeId> {
        self.touched.iter().copied()
    }

    /// Whether there are none at all.
    pub fn is_empty(&self) -> bool {
        self.touched.is_empty()
    }

    /// Those of a node that count for somebody who is on the way `away`.
    pub fn binding<'a>(
        &'a self,
        node: NodeId,
        at: Point,
        away: &'a [Away],
    ) -> impl Iterator<Item = &'a Condition> + Clone {
        self.of(node).iter().filter(move |c| !away.iter().any(|a| a.excuses(c, at)))
    }
}

impl Away {
    /// Whether a condition on a place does not bind who goes away.
    fn excuses(&self, condition: &Condition, at: Point) -> bool {
        let from_me = condition.cause == self.from;
        let hard = matches!(condition.effect, Effect::Closed | Effect::Still);
        let farther = || (at - self.at).norm() >= self.distance_m - NEARER_M;
        from_me && hard && (matches!(self.from, Cause::Closure(_)) || farther())
    }
}

/// The earliest `t` from `from` on at which a move of `span` meets none of the windows, and until when it may
/// be put off then.
pub(super) fn still_until(
    windows: impl Iterator<Item = Window> + Clone,
    mut from: Time,
    span: Span,
) -> (Time, Time) {
    // Each window pushes at most once: after as many rounds as windows nothing moves any more.
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
        assert_eq!(still_until(windows.iter().copied(), Time(0), Span(5)), (Time(0), Time(5)));
        assert_eq!(still_until(windows.iter().copied(), Time(6), Span(5)), (Time(30), Time(95)));
        assert_eq!(still_until(windows.iter().copied(), Time(105), Span(5)), (Time(110), Time::MAX));
    }

    #[test]
    fn who_goes_away_is_bound_only_where_it_would_come_nearer() {
        let at = |x: f64| Point::new(x, 0.0);
        let cause = Cause::Worker(WorkerId(3));
        let away = Away { from: cause, at: at(0.0), distance_m: 2.0 };
        let closed = Condition { window: window(0, 9), effect: Effect::Closed, cause };
        assert!(away.excuses(&closed, at(2.0)) && away.excuses(&closed, at(5.0)));
        assert!(!away.excuses(&closed, at(1.0)));
        let other = Condition { cause: Cause::Worker(WorkerId(4)), ..closed };
        assert!(!away.excuses(&other, at(5.0)));
    }
}
