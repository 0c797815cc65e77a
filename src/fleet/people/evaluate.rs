//! Second phase: what do people mean for robots? Beliefs become stops, regions and prices before anybody plans.
//!
//! Stops and slow-downs leave at once; everything else enters the search and the grants as conditions.
//! Refuses: to plan for robots, and to trust a sighting that cannot be true.

use crate::aware::{Effects, HumanAwarePolicy};
use crate::fleet::Fleet;
use crate::fleet::people::routing::REDIRECT;
use crate::fleet::people::state::Mode;
use crate::fleet::state::fact::Fact;
use crate::fleet::state::floor::Floor;
use crate::fleet::yielding::speed_limit::STROLL_MPS;
use crate::geometry::Point;
use crate::human::{Band, Conduct, Hypothesis, Presence, Sighting, Taken, Whereabouts};
use crate::id::{AssignmentId, Dense, RobotId, WorkerId};
use crate::time::{Span, Time};

/// Whoever follows a new path for this far is on the path again, metres.
const BACK_M: f64 = 1.0;
/// Somebody off the path walks anywhere within this of an alternative, metres: places off the map are absurd.
const MARGIN_M: f64 = 3.0;

impl Fleet {
    /// Takes a sighting in.
    pub(in crate::fleet) fn sight(&mut self, s: &Sighting, now: Time) {
        let is_on_map = self.floor().is_on_map();
        let person = self.crowd.person(s.worker);
        let taken = person.track.see(s, now, is_on_map);
        match taken {
            Taken::Ignored => return,
            Taken::Moved => person.fresh = true,
            Taken::Relocated => (person.fresh, person.relocated) = (true, true),
        }
        self.follow_motion(s, taken);
    }

    pub(in crate::fleet) fn evaluate_people(&mut self, now: Time) {
        self.crowd.conditions.clear();
        self.note_areas(now);
        if self.crowd.people.is_empty() {
            self.crowd.closing.clear();
            self.close_displaced(now);
            self.limit_robots(now);
            return self.revoke_grants_into_displaced(now);
        }
        for worker in (0..self.crowd.people.len()).map(WorkerId::at) {
            self.watch(worker, now);
        }
        self.infer(now);
        self.update_forecasts(now);
        self.follow_procedure(now);
        self.set_conditions(now);
        self.note_closing(now);
        self.close_displaced(now);
        self.limit_robots(now);
        self.revoke_grants(now);
        self.revoke_grants_into_displaced(now);
        self.meet(now);
        self.guide(now);
        for worker in (0..self.crowd.people.len()).map(WorkerId::at) {
            let person = &mut self.crowd.people[worker];
            (person.fresh, person.relocated) = (false, false);
        }
    }

    /// Where a worker is, if on the floor.
    pub(in crate::fleet) fn whereabouts(&self, worker: WorkerId, now: Time) -> Option<Whereabouts> {
        self.crowd.people.get(worker)?.track.whereabouts(now)
    }

    /// Everybody on the floor.
    pub(in crate::fleet) fn present(&self, now: Time) -> Vec<(WorkerId, Whereabouts)> {
        let people = self.crowd.people.pairs();
        people.filter_map(|(w, p)| Some((w, p.track.whereabouts(now)?))).collect()
    }

    /// Follows one worker: assignment, path, deviation.
    fn watch(&mut self, worker: WorkerId, now: Time) {
        let Some(place) = self.whereabouts(worker, now) else { return };
        self.take_up_work(worker, place.at, now);
        let person = &mut self.crowd.people[worker];
        if person.relocated {
            // Nobody walked: the path starts here anew.
            self.route_on(worker, place.at, now);
            return;
        }
        if !person.fresh {
            return;
        }
        let stands = place.velocity.norm() < STROLL_MPS;
        person.stands_since = stands.then(|| person.stands_since.unwrap_or(now));
        self.look_ahead(worker, &place, now);
        let person = &mut self.crowd.people[worker];
        let Some(plan) = person.plan.as_mut() else { return };
        let conduct = plan.follower.observe(place.at, place.sigma_m);
        // Nobody who works stands on a point, least of all beside a robot.
        let works = stands && plan.assignment.is_some() && plan.is_there(place.at);
        match (conduct, person.mode) {
            (Conduct::OnPath, _) if works => self.at_the_end(worker, place.at, now),
            (Conduct::Deviating, Mode::Deviating { .. }) => self.show_the_way_back(worker, place.at, now),
            // Told to stop off the path: the procedure tries again by itself.
            (Conduct::Deviating, Mode::Stopped { .. })
                if self.settings.policy != HumanAwarePolicy::Giveway => {}
            (Conduct::Deviating, _) => self.leaves_path(worker, place.at, now),
            (Conduct::Outside, _) => {}
            (Conduct::OnPath, Mode::Deviating { .. }) => {
                let start = plan.follower.path()[0];
                if (place.at - start).norm() > BACK_M {
                    person.mode = Mode::Following;
                }
            }
            (Conduct::OnPath, Mode::Redirected) if plan.follower.progress() == 0 => {}
            (Conduct::OnPath, Mode::Stopped { since }) if now - since < REDIRECT => {}
            (Conduct::OnPath, _) => person.mode = Mode::Following,
            (Conduct::Arrived, _) => self.at_the_end(worker, place.at, now),
        }
    }

    /// Areas that robots keep out of; forgets those that have been over for long.
    fn note_areas(&mut self, now: Time) {
        let (crowd, ledger) = (&mut self.crowd, &self.ledger);
        let (closures, changes) = (&ledger.closures, ledger.index.closure_changes());
        crowd.areas.update(closures, changes, &mut crowd.conditions, ledger.warehouse(), now);
        for closure in crowd.areas.forgotten(closures, now) {
            self.record(Fact::Reopened { closure, at: now });
        }
    }

    /// What people mean for the search.
    fn set_conditions(&mut self, now: Time) {
        let warehouse = self.warehouse().clone();
        let mut conditions = std::mem::take(&mut self.crowd.conditions);
        let effects =
            Effects { warehouse: &warehouse, regions: &self.crowd.regions, afoot: &self.crowd.afoot, now };
        for (worker, place) in self.present(now) {
            let person = &self.crowd.people[worker];
            if self.settings.policy == HumanAwarePolicy::Giveway || place.presence == Presence::Lost {
                let stands =
                    person.stands_since.filter(|_| self.settings.policy == HumanAwarePolicy::Giveway);
                let stood = stands.map_or(Span::ZERO, |t| now - t);
                effects.presence(&mut conditions, worker, &place, stood);
                let band = Band::around(place.velocity.norm());
                effects.forecast(&mut conditions, worker, &person.ways, band);
                if !self.crowd.coverage.is_trusted() {
                    effects.reachable(&mut conditions, worker, place.at);
                }
            } else if let Some(path) = person.rest_of_path(place.at) {
                let stay = person.plan.as_ref().map(|p| p.stay);
                let path = Hypothesis { probability: 1.0, path, stay };
                effects.plan(&mut conditions, worker, &path, Band::ANY);
            }
        }
        self.crowd.conditions = conditions;
    }
}

impl Floor<'_> {
    /// Tells whether anybody can be at a place at all.
    pub(in crate::fleet) fn is_on_map(&self) -> impl Fn(Point) -> bool + use<> {
        let (low, high) = self.warehouse().bounds();
        move |p| {
            let x = (low.x - MARGIN_M..=high.x + MARGIN_M).contains(&p.x);
            x && (low.y - MARGIN_M..=high.y + MARGIN_M).contains(&p.y)
        }
    }

    /// The assignment that a worker is at, or is to begin.
    pub(in crate::fleet) fn next_assignment(&self, worker: WorkerId) -> Option<AssignmentId> {
        self.ledger.index.assignments_of(worker).next()
    }

    /// Where a robot is, as far as it was seen.
    pub(in crate::fleet) fn place_of(&self, robot: RobotId) -> Point {
        let node = self.warehouse().nodes[self.ledger.node_of(robot)].at;
        self.scene.robot(robot).map_or(node, |t| t.pose.at)
    }
}
