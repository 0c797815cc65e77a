//! How visits are entered in the timelines: what they hold, and which robots that excludes.
//!
//! Main type: [`Context`] (what writing visits needs); main functions: [`claims`], [`for_each_hold`]. Refuses: to ask
//! whether a place is free.

use super::line::{Hold, Layer, Line};
use super::{Timeline, Visit};
use crate::id::{BodyId, IdVec, LineId, RobotId};
use crate::time::{Span, Window};
use crate::warehouse::{NodeKind, Warehouse};

impl Timeline {
    /// What writing and erasing the visits of a holder needs.
    pub(super) fn context<'a>(&self, warehouse: &'a Warehouse, holder: RobotId) -> Context<'a> {
        debug_assert!(
            self.chain(holder).is_none_or(|c| !c.absent || c.visits.len() == 1),
            "{holder:?} has left the floor and plans nothing"
        );
        let (clearance, without_conflicts) = (self.clearance, self.without_conflicts);
        Context { warehouse, body: self.body(holder), clearance, without_conflicts }
    }

    pub(super) fn write(
        lines: &mut IdVec<LineId, Line>,
        context: Context<'_>,
        holder: RobotId,
        serial: u64,
        visit: &Visit,
    ) {
        for_each_hold(context, holder, serial, visit, |line, hold| lines[line].insert(hold));
    }

    pub(super) fn erase(
        lines: &mut IdVec<LineId, Line>,
        context: Context<'_>,
        holder: RobotId,
        serial: u64,
        visit: &Visit,
    ) {
        for (line, _) in claims(context, visit) {
            lines[line].remove(holder, serial);
            for &c in context.warehouse.lines_in_conflict(line) {
                lines[c].remove(holder, serial);
            }
        }
    }
}

/// Gives each hold of a visit with its timeline: the visit's own timelines, and those in conflict with them.
pub(super) fn for_each_hold(
    context: Context<'_>,
    holder: RobotId,
    serial: u64,
    visit: &Visit,
    mut put: impl FnMut(LineId, Hold),
) {
    if context.without_conflicts && !is_station(context.warehouse, visit) {
        return;
    }
    for (line, window) in claims(context, visit) {
        let hold = |layer| Hold { start: window.start(), end: window.end(), holder, serial, layer };
        put(line, hold(Layer::Physical));
        for &c in context.warehouse.lines_in_conflict(line) {
            put(c, hold(Layer::Conflict));
        }
    }
}

pub(super) fn is_station(warehouse: &Warehouse, visit: &Visit) -> bool {
    matches!(warehouse.nodes[visit.node].kind, NodeKind::Station(_))
}

/// What writing and erasing the visits of one holder needs.
#[derive(Clone, Copy)]
pub(super) struct Context<'a> {
    warehouse: &'a Warehouse,
    body: BodyId,
    clearance: Span,
    without_conflicts: bool,
}

/// What a visit holds: its node and, where needed, its lane, on the timelines for the holder's footprint.
pub(super) fn claims(c: Context<'_>, v: &Visit) -> impl Iterator<Item = (LineId, Window)> + use<> {
    let line = |r| c.warehouse.line(c.body, v.loaded, r);
    let node = (line(c.warehouse.node_resource(v.node)), v.window());
    let until = (v.arrive + c.clearance).max(v.enter + Span(1));
    let lane = v.lane.map(|l| (line(l), Window::new(v.enter, until)));
    std::iter::once(node).chain(lane)
}
