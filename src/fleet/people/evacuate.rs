//! Evacuation: each worker is led to the nearest door that can be reached.
//!
//! Refuses: to be an alarm system; it shows ways to people who wear a device, and keeps robots off them.

use crate::people::routing::REDIRECT;
use crate::people::state::{HumanState, WalkMode};
use crate::state::floor::Floor;
use crate::state::writer::Writer;
use giveway_floor::geometry::Point;
use giveway_floor::id::WorkerId;
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::NodeKind;
use giveway_floor::warehouse::walkway::EdgeSet;
use giveway_people::human::Mover;
use giveway_people::human::Whereabouts;

/// A person this near to a door is out, metres.
const OUT_M: f64 = 1.0;

impl HumanState {
    /// Leads a worker to the nearest door while the building is evacuated. Returns whether it is.
    pub(super) fn lead_to_exit(
        &mut self,
        writer: &mut Writer,
        worker: WorkerId,
        at: Point,
        now: Time,
    ) -> bool {
        if writer.ledger().evacuation.is_none() {
            return false;
        }
        let person = &mut self.people[worker];
        person.lets_pass = None;
        let current = person.plan.as_ref().map(|p| p.assignment);
        let works = current.flatten().is_some();
        if works {
            Self::lay_aside(writer, current.flatten(), now);
        }
        let person = &mut self.people[worker];
        let is_led = current.is_some() && !works && !matches!(person.mode, WalkMode::Stopped { .. });
        if !works && person.minded.is_some_and(|t| now - t < REDIRECT) {
            return true;
        }
        person.minded = Some(now);
        let floor = writer.floor();
        if self.is_out(floor, at) {
            let person = &mut self.people[worker];
            (person.plan, person.mode, person.way_out) = (None, WalkMode::Idle, Vec::new());
            return true;
        }
        // Robots that can drive leave the shortest way. A way through a closed area is better than none.
        let mover = self.mover(worker);
        let cut = self.edges_closed_for_good(floor, mover, now);
        let way = self.way_to_exit(floor, at, &cut);
        let way = way.or_else(|| self.way_to_exit(floor, at, &self.edges_too_narrow(mover)));
        // A driver whose vehicle cannot leave gets off and walks.
        let way = way.or_else(|| self.way_to_exit(floor, at, &self.walkways.no_edges()));
        self.people[worker].way_out = way.clone().unwrap_or_default();
        if is_led {
            return true;
        }
        let person = &mut self.people[worker];
        match way {
            Some(points) => {
                person.give(points, None, Span::ZERO, now);
                person.mode = WalkMode::Redirected;
            }
            None => (person.plan, person.mode) = (None, WalkMode::Stopped { since: now }),
        }
        true
    }

    /// Walkways in closed areas, and walkways on which robots stand that cannot drive.
    fn edges_closed_for_good(&self, floor: Floor<'_>, mover: Mover, now: Time) -> EdgeSet {
        let mut cut = self.edges_too_narrow(mover);
        self.barred.cut_shut(&self.walkways, &mut cut, now);
        for robot in floor.ledger.present().filter(|r| floor.ledger.robots[*r].failed) {
            let at = floor.place_of(robot);
            for e in self.walkways.edges_within(at, floor.beside_m(robot, mover.half_width_m())) {
                cut.insert(e);
            }
        }
        cut
    }

    /// The shortest way to a door.
    fn way_to_exit(&self, floor: Floor<'_>, at: Point, cut: &EdgeSet) -> Option<Vec<Point>> {
        let ways = self.exits(floor).into_iter().filter_map(|exit| self.walkways.path(at, exit, cut));
        ways.min_by(|a, b| a.length_m.total_cmp(&b.length_m)).map(|way| way.points)
    }

    fn exits(&self, floor: Floor<'_>) -> Vec<Point> {
        let exits = floor.warehouse().nodes_where(|k| k == NodeKind::Exit).into_iter();
        exits.filter_map(|n| self.walkways.on_floor(floor.warehouse().nodes[n].at)).collect()
    }

    /// Whether a person is at a door.
    pub(crate) fn is_out(&self, floor: Floor<'_>, at: Point) -> bool {
        self.exits(floor).into_iter().any(|exit| (exit - at).norm() <= OUT_M)
    }

    /// The ways of all workers to the doors while the building is evacuated: the ways that they are shown, and the
    /// shortest ones, which robots clear although a worker is led round them for the moment.
    pub(crate) fn ways_out(&self, floor: Floor<'_>, now: Time) -> Vec<Vec<Point>> {
        let present = self.present(now).into_iter().filter(|(_, place)| !self.is_out(floor, place.at));
        let shown = |(worker, place): (WorkerId, Whereabouts)| {
            let person = &self.people[worker];
            [person.rest_of_path(place.at), Some(person.way_out.clone())].into_iter().flatten()
        };
        present.flat_map(shown).collect()
    }
}
