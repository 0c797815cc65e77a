//! Second phase: what do people mean for robots? Beliefs become stops, regions and prices before any robot is planned.
//!
//! Stops and slow-downs leave at once; everything else enters the search and the grants as conditions.
//! Refuses: to plan for robots, and to trust a sighting that cannot be true.

use crate::people::routing::REDIRECT;
use crate::people::state::{HumanState, Led, LetsPassStage, Person, STROLL_MPS, WalkMode};
use crate::state::floor::Floor;
use crate::state::heard::WorkerInput;
use crate::state::writer::Writer;
use crate::state::yielding::YieldingState;
use giveway_floor::id::WorkerId;
use giveway_floor::route::Conditions;
use giveway_floor::time::{Span, Time};
use giveway_people::aware::{Effects, HumanAwarePolicy};
use giveway_people::human::{Conduct, Hypothesis, Presence, Sighting, SightingOutcome, Whereabouts};

/// A worker who has followed a new path for this far is on the path again, metres.
const BACK_M: f64 = 1.0;

impl HumanState {
    /// Takes in what was heard of workers.
    pub(super) fn hear(&mut self, writer: &mut Writer, heard: &[WorkerInput], now: Time) {
        for worker in self.people.ids() {
            self.people[worker].track.move_as(writer.ledger().mover(worker));
        }
        for heard in heard {
            match heard {
                WorkerInput::Seen(sighting) => self.sight(writer.floor(), sighting, now),
                WorkerInput::Cleared(worker) => self.clear(*worker, now),
                WorkerInput::Narrowed(worker, place) => self.person(*worker).track.remember(place.into()),
                WorkerInput::SignedOff(worker) => self.sign_off(writer, *worker, now),
            }
        }
    }

    /// Takes a sighting in.
    fn sight(&mut self, floor: Floor<'_>, s: &Sighting, now: Time) {
        let is_on_map = floor.is_on_map();
        let person = self.person(s.worker);
        person.track.move_as(floor.ledger.mover(s.worker));
        let taken = person.track.see(s, now, is_on_map);
        match taken {
            SightingOutcome::Ignored | SightingOutcome::Noted => return,
            SightingOutcome::Moved => person.fresh = true,
            SightingOutcome::Relocated => (person.fresh, person.relocated) = (true, true),
        }
        self.follow_motion(&floor.settings.model, s, taken);
    }

    /// Forgets what was believed of a worker: a supervisor says that it is wrong. Sightings from before that are still
    /// under way change nothing any more.
    pub(super) fn clear(&mut self, worker: WorkerId, now: Time) {
        self.intents.forget(worker);
        let person = self.person(worker);
        person.track.clear(now);
        let (version, track) = (person.version, std::mem::take(&mut person.track));
        *self.person(worker) = Person { version, track, ..Person::default() };
    }

    /// Follows all workers: where they are, whether they left their paths, where they may be going.
    pub(super) fn follow(&mut self, writer: &mut Writer, yielding: &YieldingState, now: Time) {
        self.note_closures(writer.floor());
        self.let_robots_pass(writer.floor(), yielding, now);
        self.hand_out(writer, now);
        for worker in self.people.ids() {
            self.watch(writer, yielding, worker, now);
        }
        if !self.people.is_empty() {
            self.infer(writer.floor(), now);
            self.note_goals(writer, now);
            self.update_forecasts(writer.floor(), now);
            self.note_places(writer, now);
        }
    }

    /// Follows one worker: assignment, path, deviation.
    fn watch(&mut self, writer: &mut Writer, yielding: &YieldingState, worker: WorkerId, now: Time) {
        let Some(place) = self.whereabouts(worker, now) else { return };
        let is_evacuated = self.lead_to_exit(writer, worker, place.at, now);
        if is_evacuated {
            // The worker's assignments wait.
        } else if self.people[worker].lets_pass.is_none_or(|l| l.stage == LetsPassStage::Waits) {
            self.mind_closures(writer.floor(), yielding, worker, place.at, now);
            self.take_up_work(writer, yielding, worker, place.at, now);
        }
        let person = &mut self.people[worker];
        if person.relocated {
            // The worker did not walk there: the path starts here anew.
            self.route_on(writer.floor(), yielding, worker, place.at, now);
            return;
        }
        if !person.fresh {
            return;
        }
        person.note_place(place.at, now);
        let stands = place.velocity.norm() < STROLL_MPS;
        person.stands_since = stands.then(|| person.stands_since.unwrap_or(now));
        if person.lets_pass.is_some() && person.waits().is_none() {
            return self.watch_aside(worker, &place);
        }
        let waits = !is_evacuated && self.keep_on_time(writer.floor(), yielding, worker, &place, now);
        if !waits {
            self.look_ahead(writer.floor(), yielding, worker, &place, now);
            self.make_room(writer.floor(), yielding, worker, place.at, now);
        }
        let person = &mut self.people[worker];
        let Some(plan) = person.plan.as_mut() else { return };
        let conduct = plan.follower.observe(place.at, place.sigma_m);
        // A person at work does not stay on one point, least of all beside a robot.
        let works = stands && plan.assignment.is_some() && plan.is_there(place.at);
        match (conduct, person.mode) {
            (Conduct::OnPath, _) if works => self.at_the_end(writer, yielding, worker, place.at, now),
            (Conduct::Deviating, WalkMode::Deviating { .. }) => {
                self.show_the_way_back(writer.floor(), yielding, worker, place.at, now)
            }
            // The worker was told to stop off the path: the procedure tries again by itself.
            (Conduct::Deviating, WalkMode::Stopped { .. })
                if writer.settings.policy != HumanAwarePolicy::Giveway => {}
            (Conduct::Deviating, _) => self.leaves_path(writer, yielding, worker, place.at, now),
            (Conduct::Outside, _) => {}
            (Conduct::OnPath, WalkMode::Deviating { .. }) => {
                let start = plan.follower.path()[0];
                if (place.at - start).norm() > BACK_M {
                    person.mode = WalkMode::Following;
                }
            }
            (Conduct::OnPath, WalkMode::Redirected) if plan.follower.progress() == 0 => {}
            (Conduct::OnPath, WalkMode::Stopped { since }) if now - since < REDIRECT => {}
            (Conduct::OnPath, _) => person.mode = WalkMode::Following,
            (Conduct::Arrived, _) => self.at_the_end(writer, yielding, worker, place.at, now),
        }
    }

    /// Computes the conditions that people cause for the search and for grants, for each robot kind.
    pub(super) fn restrict(&mut self, floor: Floor<'_>, now: Time) {
        let ours = floor.settings.policy == HumanAwarePolicy::Giveway;
        let present = self.among_robots(now);
        let others = if ours { self.others(now) } else { Vec::new() };
        let mut all = std::mem::take(&mut self.conditions);
        all.all_mut().for_each(Conditions::clear);
        for (set, (conditions, regions)) in all.with_regions(floor.regions).enumerate() {
            let effects = Effects { warehouse: floor.warehouse(), regions, afoot: &self.afoot, now };
            for (worker, place) in &present {
                self.restrict_around(&effects, (set, conditions), (*worker, place), ours);
            }
            for (worker, place) in &others {
                effects.presence(conditions, *worker, place, Span::ZERO);
            }
        }
        self.conditions = all;
    }

    /// Adds the conditions that one person causes for robots of one set of regions.
    fn restrict_around(
        &self,
        effects: &Effects<'_>,
        (set, conditions): (usize, &mut Conditions),
        (worker, place): (WorkerId, &Whereabouts),
        ours: bool,
    ) {
        let (person, now) = (&self.people[worker], effects.now);
        if self.stands_aside(worker, now) && place.presence != Presence::Lost {
            effects.stands_aside(conditions, worker, place);
        } else if ours || place.presence == Presence::Lost {
            let stood = person.stands_since.filter(|_| ours).map_or(Span::ZERO, |t| now - t);
            effects.presence(conditions, worker, place, stood);
            match person.occupied.nodes.get(set) {
                Some(nodes) => effects.occupied(conditions, worker, nodes),
                None => {
                    let band = place.mover.band(place.velocity.norm());
                    effects.forecast(conditions, (worker, place.mover), &person.ways, band);
                }
            }
            if !self.coverage.is_trusted() {
                effects.reachable(conditions, worker, place);
            }
        } else if let WalkMode::Stopped { since } = person.mode {
            // A worker who was told to stop stands, and does not walk the path that was given before.
            effects.presence(conditions, worker, place, now - since);
        } else if let Some(path) = person.rest_of_path(place.at) {
            let stay = person.plan.as_ref().map(|p| p.stay);
            let path = Hypothesis { probability: 1.0, path, stay };
            effects.plan(conditions, (worker, place.mover), &path, place.mover.any_band());
        }
    }

    /// Leads a worker as the published procedure says, from the next step on.
    pub(crate) fn lead(&mut self, worker: WorkerId, led: Led, now: Time) {
        let person = &mut self.people[worker];
        match led {
            Led::AsExpected(path) => {
                person.expect(path, now);
                person.mode = WalkMode::Following;
            }
            Led::Redirected(path) => {
                person.give(path, None, Span::ZERO, now);
                person.mode = WalkMode::Redirected;
            }
            Led::Stopped { by } => {
                person.blocked_since = by.map(|r| (r, now));
                person.mode = WalkMode::Stopped { since: now };
            }
        }
    }
}
