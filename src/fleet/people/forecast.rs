//! Where workers will be within seconds, with what probability; whether such forecasts hold; and which robots brake for
//! them.
//!
//! Main type: [`Expected`], for readers. Refuses: to let a robot drive because a forecast says that nobody will be
//! there: forecasts only make robots brake.

use crate::people::state::{HumanState, NodesTaken};
use crate::state::floor::Floor;
use giveway_floor::id::WorkerId;
use giveway_floor::time::{Span, Time};
use giveway_people::aware::{HumanAwarePolicy, NodeWindows, Regions, Stay, occupancies};
use giveway_people::human::motion::{Fix, Motion};
use giveway_people::human::{
    Band, Forecast, Hypothesis, Mixture, Model, Presence, Quality, Sighting, SightingOutcome, WATCHED_S,
    Whereabouts,
};

/// How far ahead readers are told, seconds.
pub const AHEAD_S: [f64; 3] = [1.0, 2.0, 4.0];

/// Which nodes a worker will take is worked out again after so long …
const LOOK_AGAIN: Span = Span::from_millis(400);
/// … and this much or twice as much later for two thirds of the workers, so that not all are due in one step.
const LATER: Span = Span::from_millis(100);
/// Nodes farther away are out of reach within the time that is looked ahead, metres.
const FORESEEN_M: f64 = 35.0;

/// So many bell curves for each moment are enough to be looked at.
const CURVES: usize = 4;

/// Where one worker may be, for readers; nothing is decided by it.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// The worker.
    pub worker: WorkerId,
    /// How far ahead, and where then, in few parts.
    pub ahead: Vec<(Span, Mixture)>,
}

impl HumanState {
    /// Where workers who are seen may be in the coming seconds, for readers. Arms that do not decide by such forecasts
    /// have none.
    pub(crate) fn expectations(&self, floor: Floor<'_>, now: Time) -> Vec<Expected> {
        if floor.settings.policy != HumanAwarePolicy::Giveway {
            return Vec::new();
        }
        let seen = self.present(now).into_iter().filter(|(_, place)| place.presence != Presence::Lost);
        let expected = |(worker, _)| {
            let at = |s: f64| {
                let after = Span::from_secs_f64(s);
                Some((after, self.forecast(floor, worker, now + after)?.merged(CURVES)))
            };
            let ahead: Vec<_> = AHEAD_S.into_iter().filter_map(at).collect();
            (!ahead.is_empty()).then_some(Expected { worker, ahead })
        };
        seen.filter_map(expected).collect()
    }

    /// Takes a sighting that was believed into the filter of how the worker moves.
    pub(crate) fn follow_motion(&mut self, model: &Model, s: &Sighting, taken: SightingOutcome) {
        let (model, worker) = (model.motion, s.worker);
        let person = self.person(worker);
        if taken == SightingOutcome::Relocated || person.motion.is_none() {
            person.motion = Some(Motion::new(model));
            self.coverage.forget(worker);
        }
        if s.quality == Quality::Lost {
            return;
        }
        let fix = Fix { seen: s.seen, at: s.at, sigma_m: s.accuracy_m };
        self.person(worker).motion.get_or_insert_with(|| Motion::new(model)).see(fix);
        self.coverage.score(worker, s.seen, s.at);
    }

    /// Notes where every worker may be going, and from time to time keeps a forecast of each to see whether it comes
    /// true.
    pub(crate) fn update_forecasts(&mut self, floor: Floor<'_>, now: Time) {
        if floor.settings.policy != HumanAwarePolicy::Giveway {
            return;
        }
        for (worker, place) in self.present(now) {
            self.people[worker].ways = self.hypotheses(worker, &place);
            if floor.settings.node_windows == NodeWindows::Mixture {
                self.update_occupied(floor, worker, &place, now);
            }
            if place.presence == Presence::Tracked && self.coverage.wants(worker, now) {
                let seen = self.people[worker].motion.as_ref().and_then(Motion::seen);
                let Some(seen) = seen else { continue };
                let ahead = WATCHED_S.map(|s| self.forecast(floor, worker, seen + Span::from_secs_f64(s)));
                if let [Some(a), Some(b), Some(c)] = ahead {
                    self.coverage.expect(worker, now, seen, [a, b, c]);
                }
            }
        }
    }

    /// Notes which nodes a worker will take: anew every now and then, and at once when the worker does something else.
    fn update_occupied(&mut self, floor: Floor<'_>, worker: WorkerId, place: &Whereabouts, now: Time) {
        let person = &self.people[worker];
        let kept = LOOK_AGAIN + LATER * i64::from(worker.0 % 3);
        let is_due = person.occupied.made.is_none_or(|(at, mode, version)| {
            now - at >= kept || (mode, version) != (person.mode, person.version) || person.relocated
        });
        if !is_due {
            return;
        }
        let band = Band::around(place.velocity.norm());
        let stay = |h: &Hypothesis| {
            let (at, window) = (*h.path.last()?, h.stays(band, now)?);
            Some(Stay { at, window, probability: h.probability })
        };
        let stays: Vec<Stay> = person.ways.iter().filter_map(stay).collect();
        let warehouse = floor.warehouse();
        let on_foot = self.afoot.nodes_within(warehouse, place.at, FORESEEN_M);
        let nodes = |regions: &Regions| {
            let at = |t| self.forecast(floor, worker, t);
            occupancies(warehouse, regions.beside_m(), &on_foot, &stays, now, at)
        };
        let nodes = floor.regions.all().iter().map(nodes).collect();
        let made = Some((now, person.mode, person.version));
        self.people[worker].occupied = NodesTaken { nodes, made };
    }

    /// What is to be expected of a worker; nothing before it was seen.
    fn forecast_of<'a>(&'a self, floor: Floor<'a>, worker: WorkerId) -> Option<Forecast<'a>> {
        let person = self.people.get(worker)?;
        let motion = person.motion.as_ref()?;
        let model = &floor.settings.model;
        Some(Forecast { motion, ways: &person.ways, bound: &model.bound, free: &model.free })
    }

    /// Where a worker will be at a moment, with regions as wide as experience has made them.
    pub(crate) fn forecast(&self, floor: Floor<'_>, worker: WorkerId, t: Time) -> Option<Mixture> {
        let forecast = self.forecast_of(floor, worker)?;
        let ahead_s = (t - forecast.motion.seen()?).max(Span::ZERO).as_secs_f64();
        Some(forecast.at(t)?.scaled(self.coverage.scale(ahead_s)))
    }
}
