//! Workers and areas that are closed to people: ways lead round the areas, and workers inside are led out.
//!
//! Refuses: to close areas, and to move a worker, who may walk in all the same, which raises an alarm.

use crate::people::routing::REDIRECT;
use crate::people::state::{HumanState, WalkMode};
use crate::state::floor::Floor;
use crate::state::worker::GuidanceReason;
use crate::state::yielding::YieldingState;
use giveway_floor::geometry::Point;
use giveway_floor::id::{ClosureId, WorkerId};
use giveway_floor::time::{Span, Time};

/// How far away on foot a place outside a closed area is searched for at most, metres.
const OUT_M: f64 = 80.0;
/// A person who is still inside this long after an area was closed raises an alarm: people at work there need a while
/// to come out.
pub(crate) const COMES_OUT: Span = Span::from_secs(30);

impl HumanState {
    /// Updates what is closed to people, now and later.
    pub(super) fn note_closures(&mut self, floor: Floor<'_>) {
        let changes = floor.ledger.index().closure_changes();
        self.barred.update(&floor.ledger.closures, changes, floor.warehouse());
    }

    /// Leads a worker out of a closed area, and round closed areas that the way leads into.
    pub(super) fn mind_closures(
        &mut self,
        floor: Floor<'_>,
        yielding: &YieldingState,
        worker: WorkerId,
        at: Point,
        now: Time,
    ) {
        let person = &mut self.people[worker];
        let minded = person.minded.is_some_and(|t| now - t < REDIRECT);
        if minded || self.barred.is_empty(now) {
            return;
        }
        person.minded = Some(now);
        if let Some(inside) = self.barred.around(at, now).map(|a| a.id) {
            let leaves = person.by_closure == Some(GuidanceReason::LeavesClosure(inside));
            if !leaves || person.plan.is_none() {
                self.lead_out(floor, yielding, worker, (at, inside), now);
            }
            return;
        }
        let rest = person.rest_of_path(at);
        if rest.is_some_and(|way| self.barred.met(&way, now).is_some()) {
            self.route_on(floor, yielding, worker, at, now);
        }
    }

    /// Leads a worker the shortest way out of a closed area.
    fn lead_out(
        &mut self,
        floor: Floor<'_>,
        yielding: &YieldingState,
        worker: WorkerId,
        (at, inside): (Point, ClosureId),
        now: Time,
    ) {
        let mut places: Vec<(f64, Point)> = (self.walkways.within(at, OUT_M).into_iter())
            .map(|(n, length_m)| (length_m, self.walkways.nodes()[n].at))
            .filter(|(_, p)| self.barred.around(*p, now).is_none())
            .collect();
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mover = self.mover(worker);
        let cut = self.edges_robots_block(floor, yielding, mover, now);
        let free = self.edges_too_narrow(mover);
        let to = |p: Point, cut| self.walkways.path(at, p, cut).map(|way| way.points);
        let nearest = places.first().map(|(_, p)| *p);
        let past_robots = || places.iter().take(4).find_map(|(_, p)| to(*p, &cut));
        let way = past_robots().or_else(|| to(nearest?, &free));
        let person = &mut self.people[worker];
        match way {
            Some(points) => {
                person.give(points, None, Span::ZERO, now);
                person.mode = WalkMode::Redirected;
                person.by_closure = Some(GuidanceReason::LeavesClosure(inside));
            }
            None => person.mode = WalkMode::Stopped { since: now },
        }
    }
}
