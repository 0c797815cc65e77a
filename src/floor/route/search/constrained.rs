//! The search near people: closed times are not free windows, no move happens while an end of a lane may not be entered
//! or left, driving may be slower, and being there may cost.
//!
//! A place that will be closed by hand may still be the end of a route for a while ([`COME_OUT`]).
//!
//! Main function: `Search::enter_constrained`. Refuses: to be called where no condition holds; that would cost time.

use super::{FREE, Hop, Label, Labels, Open, Search};
use crate::id::{LineId, NodeId};
use crate::route::RouteQuery;
use crate::route::conditions::{Cause, Condition, Effect, no_entry_until};
use crate::route::motion::{MotionState, Pace, drive_span};
use crate::time::{Span, Time, Window};
use crate::timeline::{FreeWindow, Overlay};
use crate::warehouse::Warehouse;
use smallvec::{SmallVec, smallvec};

/// The free windows of a node that end after `t`, without the times in which it is closed.
pub(super) fn open_windows(
    warehouse: &Warehouse,
    timeline: &Overlay<'_>,
    ask: &RouteQuery<'_>,
    (node, line): (NodeId, LineId),
    t: Time,
) -> SmallVec<[FreeWindow; 4]> {
    let at = warehouse.nodes[node].at;
    let conditions = ask.conditions.binding(node, at, ask.exemptions);
    let mut closed: SmallVec<[Window; 4]> =
        conditions.filter(|c| c.effect == Effect::Closed).map(|c| c.window).collect();
    closed.sort_unstable_by_key(|w| w.start());
    let mut open = SmallVec::new();
    for free in timeline.free_windows(line, t) {
        let (mut start, mut part) = (free.start, 0);
        let index = |part: u32| free.index | part << PARTS_AT;
        for w in closed.iter().filter(|w| w.start() < free.end && w.end() > free.start) {
            if w.start() > start && w.start() > t {
                open.push(FreeWindow { start, end: w.start(), index: index(part) });
            }
            start = start.max(w.end());
            part += 1;
        }
        if start < free.end {
            open.push(FreeWindow { start, end: free.end, index: index(part) });
        }
    }
    open
}

/// Bit of a window's index from which on the parts of a free window are numbered.
const PARTS_AT: u32 = 20;

/// Time that a robot must have to come out of an area that will be closed, if its route ends there. Routes are planned
/// one errand at a time, so the route out is not known yet.
pub const COME_OUT: Span = Span::from_secs(60);

/// Parts of the last goal's endless window that a closure ends, by index, with the latest arrival.
pub(super) type Brief = SmallVec<[(u32, i64); 1]>;

/// Where a robot may end although a closure will begin there: no other robot comes, and it has time to leave.
pub(super) fn brief_stays(
    warehouse: &Warehouse,
    pace: &Pace,
    timeline: &Overlay<'_>,
    ask: &RouteQuery<'_>,
    line: LineId,
) -> Brief {
    let last = ask.stages[ask.stages.len() - 1];
    if !ask.conditions.is_touched(last.goal) {
        return Brief::new();
    }
    let whole = timeline.free_windows(line, ask.ready).last();
    let Some(whole) = whole.filter(|g| g.end.is_forever()) else { return Brief::new() };
    let conditions = ask.conditions.binding(last.goal, warehouse.nodes[last.goal].at, ask.exemptions);
    let by_hand = |c: &&Condition| c.effect == Effect::Closed && matches!(c.cause, Cause::Closure(_));
    let begins: SmallVec<[Time; 2]> = conditions.filter(by_hand).map(|c| c.window.start()).collect();
    let way_out = pace.fastest_out(last.goal, last.loaded) + pace.clearance();
    let parts = open_windows(warehouse, timeline, ask, (last.goal, line), ask.ready).into_iter();
    let parts = parts.filter(|g| g.index & ((1 << PARTS_AT) - 1) == whole.index && begins.contains(&g.end));
    parts.map(|g| (g.index, (g.end - last.stay - way_out - COME_OUT).0)).collect()
}

impl Search<'_> {
    /// Whether a robot may end here until a closure begins.
    pub(super) fn is_brief_stay(&self, label: &Label) -> bool {
        self.brief.iter().any(|(part, latest)| *part == label.free.index && label.lo <= *latest)
    }

    /// As `Search::enter_gaps`, for lanes with conditions at either end.
    pub(super) fn enter_constrained(
        &self,
        labels: &mut Labels,
        open: &mut Open,
        index: u32,
        label: &Label,
        hop: &Hop,
    ) {
        let node = hop.way.to;
        let latest = hop.depart.1.min(label.free.end.0);
        let from = Time(hop.depart.0 - hop.lead);
        let loaded = self.needs_room(node, label.stage);
        let line = self.line(loaded, self.warehouse.node_resource(node));
        let windows = open_windows(self.warehouse, self.timeline, self.ask, (node, line), from);
        let lane = self.line(loaded, self.warehouse.lane_resource(hop.way.lane));
        let lanes: SmallVec<[FreeWindow; 4]> = if hop.way.lane_is_free {
            smallvec![FREE]
        } else {
            self.timeline.free_windows(lane, from).collect()
        };
        for free in windows.into_iter().filter(|g| g.start.0 <= latest) {
            for &lane_free in lanes.iter().filter(|g| g.start.0 <= latest) {
                for &(to, span) in &hop.ends {
                    let begin = free.start.max(lane_free.start).0 + hop.lead;
                    let Some((constraint, price)) = self.careful(label, hop, (to, span), begin) else {
                        continue;
                    };
                    let mut costly = *label;
                    costly.price += price.0;
                    self.enter(labels, open, index, &costly, &constraint, node, free, lane_free);
                }
            }
        }
    }

    /// A hop that ends in one motion, adjusted to the conditions, with its cost beyond time.
    fn careful(
        &self,
        label: &Label,
        hop: &Hop,
        (to, span): (MotionState, i64),
        begin: i64,
    ) -> Option<(Hop, Span)> {
        let ends = [label.node, hop.way.to];
        let depart = Time(hop.depart.0.max(begin));
        let drive = Window::new(depart, depart + Span(span));
        let span = Span(span).max(self.slow(&ends, label, hop, drive, to));
        let no_entry =
            ends.iter().flat_map(|n| self.binding(*n)).filter(|c| c.effect == Effect::NoEntryOrExit);
        let (first, last) = no_entry_until(no_entry.map(|c| c.window), depart, span);
        let depart = (first.0, hop.depart.1.min(last.0));
        let constraint = Hop { ends: smallvec![(to, span.0)], depart, ..hop.clone() };
        (depart.0 <= depart.1).then(|| (constraint, self.price(hop.way.to, first + span)))
    }

    fn binding(&self, node: NodeId) -> impl Iterator<Item = &Condition> + Clone {
        self.ask.conditions.binding(node, self.warehouse.nodes[node].at, self.ask.exemptions)
    }

    /// Duration of the lane if either end is slow when it is driven; zero if neither is.
    fn slow(&self, ends: &[NodeId; 2], label: &Label, hop: &Hop, drive: Window, to: MotionState) -> Span {
        let loaded = self.ask.stages[usize::from(label.stage)].loaded;
        let limits = ends.iter().flat_map(|n| self.binding(*n)).filter_map(|c| match c.effect {
            Effect::Slow(limits) if c.window.overlaps(drive) => Some(limits[usize::from(loaded)]),
            _ => None,
        });
        let arc = &self.warehouse.arcs[hop.arc];
        let limit = limits.min_by(f64::total_cmp).map(|l| l.min(arc.speed_limit_mps));
        limit.map_or(Span::ZERO, |l| drive_span(self.pace.rules(), arc.length_m, l, loaded, label.motion, to))
    }

    /// The cost of being at a node at about that time.
    fn price(&self, node: NodeId, t: Time) -> Span {
        let stay = Window::new(t, t + Span::from_secs(1));
        let prices = self.binding(node).filter(|c| c.window.overlaps(stay)).filter_map(|c| match c.effect {
            Effect::SoftCost(p) => Some(p),
            _ => None,
        });
        prices.max().unwrap_or(Span::ZERO)
    }
}
