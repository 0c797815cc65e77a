//! Workers and areas that are closed to people: the way leads round, who is inside is led out, and who has work inside
//! goes on with other work or waits outside.
//!
//! Refuses: to close areas, and to move a worker, who may walk in all the same and is an alarm then.

use crate::fleet::people::routing::REDIRECT;
use crate::fleet::people::state::{HumanState, WalkMode};
use crate::fleet::state::core::Core;
use crate::fleet::state::fact::Fact;
use crate::fleet::state::floor::Floor;
use crate::fleet::state::worker::{AssignmentState, GuidanceReason};
use crate::fleet::state::yielding::YieldingState;
use crate::geometry::Point;
use crate::id::{AssignmentId, ClosureId, WorkerId};
use crate::time::{Span, Time};

/// A place outside of a closed area is looked for so far away on foot at most, metres.
const OUT_M: f64 = 80.0;
/// Somebody who is still inside so long after an area was closed is an alarm: whoever was at work there needs a while
/// to come out.
pub(in crate::fleet) const COMES_OUT: Span = Span::from_secs(30);

impl HumanState {
    /// What is closed to people now and later.
    pub(super) fn note_closures(&mut self, floor: Floor<'_>) {
        let changes = floor.ledger.index().closure_changes();
        self.barred.update(&floor.ledger.closures, changes, floor.warehouse());
    }

    /// Leads a worker out of a closed area, and round those that the way leads into.
    pub(super) fn mind_closures(
        &mut self,
        core: &Core,
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
                self.lead_out(core.floor(), yielding, worker, (at, inside), now);
            }
            return;
        }
        let rest = person.rest_of_path(at);
        if rest.is_some_and(|way| self.barred.met(&way, now).is_some()) {
            self.route_on(core, yielding, worker, at, now);
        }
    }

    /// The shortest way out of an area that is closed.
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
        let cut = self.edges_robots_block(floor, yielding, now);
        let free = self.walkways.no_edges();
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

    /// The assignment that a worker is at or is to begin, of those whose place is not closed before they would be done.
    pub(super) fn next_open_assignment(
        &self,
        floor: Floor<'_>,
        worker: WorkerId,
        at: Point,
        now: Time,
    ) -> Option<AssignmentId> {
        let all = || floor.ledger.index().assignments_of(worker);
        if self.barred.is_empty(now) {
            return all().next();
        }
        let current = self.people[worker].plan.as_ref().and_then(|p| p.assignment);
        let begun = |id: &AssignmentId| floor.ledger.assignments[id].state != AssignmentState::Waiting;
        let open = |id: &AssignmentId| self.shuts_assignment(floor, (worker, *id), at, now).is_none();
        let first = |of: &dyn Fn(&AssignmentId) -> bool| all().find(|id| of(id) && open(id));
        first(&|id| Some(*id) == current).or_else(|| first(&begun)).or_else(|| first(&|_| true))
    }

    /// The area that is closed around the place of an assignment before a worker would be done there.
    fn shuts_assignment(
        &self,
        floor: Floor<'_>,
        (worker, id): (WorkerId, AssignmentId),
        at: Point,
        now: Time,
    ) -> Option<ClosureId> {
        let request = &floor.ledger.assignments[&id].request;
        let node = floor.warehouse().nodes[request.place].at;
        let place = self.walkways.on_floor(node).unwrap_or(node);
        let person = &self.people[worker];
        let is_current = person.plan.as_ref().and_then(|p| p.assignment) == Some(id);
        let worked = person.there_since.filter(|_| is_current).map_or(Span::ZERO, |t| now - t);
        self.barred.shuts(at, place, (request.stay - worked).max(Span::ZERO), now)
    }

    /// What a worker without a way is told whose assignments are all in closed areas.
    pub(super) fn waits_for_closure(
        &self,
        floor: Floor<'_>,
        worker: WorkerId,
        at: Point,
        now: Time,
    ) -> Option<GuidanceReason> {
        if self.barred.is_empty(now) {
            return None;
        }
        let mut all = floor.ledger.index().assignments_of(worker);
        all.find_map(|id| self.shuts_assignment(floor, (worker, id), at, now))
            .map(GuidanceReason::PlaceClosed)
    }

    /// An assignment that a worker has begun waits again, if it is not over: its place is closed.
    pub(super) fn lay_aside(core: &mut Core, assignment: Option<AssignmentId>, now: Time) {
        let Some(id) = assignment else { return };
        let begun = core.ledger.assignments.get(&id).is_some_and(|a| a.state != AssignmentState::Waiting);
        if begun {
            let state = AssignmentState::Waiting;
            core.record(Fact::Advanced { assignment: id, state, at: now });
        }
    }
}
