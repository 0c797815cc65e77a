//! Which assignment is next if some places are closed to people: a worker who has work in a closed area goes on with
//! other work, or waits outside.
//!
//! Refuses: to lead workers.

use crate::people::state::HumanState;
use crate::state::fact::AssignmentFact;
use crate::state::floor::Floor;
use crate::state::worker::{AssignmentState, GuidanceReason};
use crate::state::writer::Writer;
use giveway_floor::geometry::Point;
use giveway_floor::id::{AssignmentId, ClosureId, WorkerId};
use giveway_floor::time::{Span, Time};

impl HumanState {
    /// The assignment on which a worker is, or the next one, if its place does not close before the worker would be
    /// done.
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

    /// What a worker is told who has no way because all assignments are in closed areas.
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

    /// Has an assignment that a worker has begun wait again, if it is not over, for example because its place is
    /// closed.
    pub(super) fn lay_aside(writer: &mut Writer, assignment: Option<AssignmentId>, now: Time) {
        let Some(id) = assignment else { return };
        let begun = writer.ledger().assignments.get(&id).is_some_and(|a| a.state != AssignmentState::Waiting);
        if begun {
            let state = AssignmentState::Waiting;
            writer.record(AssignmentFact::Advanced { assignment: id, state, at: now });
        }
    }
}
