//! Assignments without a worker: the nearest free worker gets the oldest one.
//!
//! Main function: [`HumanState::hand_out`]. Refuses: to give an assignment to a worker whose place is not known, and to
//! take one back from a worker because another has come nearer.

use crate::people::state::HumanState;
use crate::state::fact::AssignmentFact;
use crate::state::floor::Floor;
use crate::state::writer::Writer;
use giveway_floor::geometry::Point;
use giveway_floor::id::WorkerId;
use giveway_floor::time::Time;
use giveway_people::human::{Mover, Presence};

/// How many ways are measured in a step at most; the rest is left to the next step.
const WAYS_MAX: usize = 64;

impl HumanState {
    /// Gives waiting assignments, the oldest first, to the workers with the shortest ways to them. If two ways are
    /// equal, the worker with the lower number gets the assignment.
    pub(super) fn hand_out(&self, writer: &mut Writer, now: Time) {
        let waiting: Vec<_> = writer.ledger().index().unassigned().take(WAYS_MAX).collect();
        if waiting.is_empty() || writer.ledger().evacuation.is_some() {
            return;
        }
        let mut free = self.free_workers(writer.floor(), now);
        let mut ways = 0;
        for assignment in waiting {
            ways += free.len();
            if free.is_empty() || (ways > WAYS_MAX && ways > free.len()) {
                return;
            }
            let place = writer.ledger().assignments[&assignment].request.place;
            let goal = writer.warehouse().nodes[place].at;
            let ways_there = free
                .iter()
                .enumerate()
                .filter_map(|(i, (worker, at))| Some((self.far(*worker, *at, goal)?, i)));
            // Workers are in order, and the first of equal ways is taken.
            let Some((_, nearest)) = ways_there.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
            let (worker, _) = free.remove(nearest);
            writer.record(AssignmentFact::Given { assignment, worker, at: now });
        }
    }

    /// The length of the way on foot, metres. A worker who seems to be where no one can stand starts from the nearest
    /// walkway.
    fn far(&self, worker: WorkerId, at: Point, goal: Point) -> Option<f64> {
        let mover = self.mover(worker);
        // A vehicle does not get everywhere where people do.
        let goal = match mover {
            Mover::OnFoot => goal,
            Mover::Vehicle(_) => self.walkways.stand_near(goal, mover.clearance_m())?,
        };
        let way = self.walkways.path(at, goal, &self.edges_too_narrow(mover)).map(|way| way.length_m);
        let length = |points: Vec<Point>| points.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
        way.or_else(|| self.way_from_beside((mover, at), goal).map(length))
    }

    /// Workers who are seen and have nothing to do, with where they are.
    fn free_workers(&self, floor: Floor<'_>, now: Time) -> Vec<(WorkerId, Point)> {
        let idle = |w: &WorkerId| floor.next_assignment(*w).is_none();
        let seen = |w: WorkerId| {
            let place = self.people[w].track.whereabouts(now)?;
            (place.presence == Presence::Tracked).then_some((w, place.at))
        };
        self.people.ids().filter(idle).filter_map(seen).collect()
    }
}
