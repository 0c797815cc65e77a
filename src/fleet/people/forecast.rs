//! Where workers will be within seconds, and how probably; whether such forecasts come true; and which robots brake for
//! them.
//!
//! Main type: [`Expected`], for display. Refuses: to let a robot drive because a forecast says that no one will be
//! there: forecasts only make robots brake.

use crate::people::state::{HumanState, NodesTaken};
use crate::state::floor::Floor;
use giveway_floor::id::WorkerId;
use giveway_floor::time::{Span, Time};
use giveway_people::aware::{HumanAwarePolicy, NodeWindows, Regions, Stay, occupancies};
use giveway_people::human::motion::{Fix, Motion};
use giveway_people::human::{
    Forecast, Hypothesis, Mixture, Model, Presence, Quality, Sighting, SightingOutcome, WATCHED_S,
    Whereabouts,
};

/// How far ahead forecasts for display go, seconds.
pub const AHEAD_S: [f64; 3] = [1.0, 2.0, 4.0];

/// How long the computed nodes that a worker will take are kept.
const LOOK_AGAIN: Span = Span::from_millis(400);
/// For two thirds of the workers, this much or twice as much longer, so that not all are due in one step.
const LATER: Span = Span::from_millis(100);
/// Nodes farther away are out of reach within the forecast time, metres.
const FORESEEN_M: f64 = 35.0;

/// How many bell curves for each moment are enough for display.
const CURVES: usize = 4;

/// Where one worker may be, for display; it decides nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// The worker.
    pub worker: WorkerId,
    /// How far ahead, and where the worker may be then, in few parts.
    pub ahead: Vec<(Span, Mixture)>,
}

impl HumanState {
    /// Where workers who are seen may be in the coming seconds, for display. Policies that do not decide by such
    /// forecasts have none.
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

    /// Takes an accepted sighting into the filter of how the worker moves.
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

    /// Notes where every worker may be going, and from time to time stores a forecast of each to see whether it comes
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

    /// Notes which nodes a worker will take: every now and then, and at once when the worker does something else.
    fn update_occupied(&mut self, floor: Floor<'_>, worker: WorkerId, place: &Whereabouts, now: Time) {
        let person = &self.people[worker];
        let kept = LOOK_AGAIN + LATER * i64::from(worker.0 % 3);
        let is_due = person.occupied.made.is_none_or(|(at, mode, version)| {
            now - at >= kept || (mode, version) != (person.mode, person.version) || person.relocated
        });
        if !is_due {
            return;
        }
        let (mover, band) = (place.mover, place.mover.band(place.velocity.norm()));
        let stay = |h: &Hypothesis| {
            let (at, window) = (*h.path.last()?, h.stays(band, now)?);
            Some(Stay { at, window, probability: h.probability })
        };
        let stays: Vec<Stay> = person.ways.iter().filter_map(stay).collect();
        let warehouse = floor.warehouse();
        let on_foot = self.afoot.nodes_within(warehouse, place.at, mover.far_m(FORESEEN_M));
        let nodes = |regions: &Regions| {
            let at = |t| self.forecast(floor, worker, t);
            let beside_m = regions.for_mover(mover).beside_m();
            occupancies(warehouse, (mover, beside_m), &on_foot, &stays, now, at)
        };
        let nodes = floor.regions.all().iter().map(nodes).collect();
        let made = Some((now, person.mode, person.version));
        self.people[worker].occupied = NodesTaken { nodes, made };
    }

    /// The forecast of a worker; nothing before the worker was seen.
    fn forecast_of<'a>(&'a self, floor: Floor<'a>, worker: WorkerId) -> Option<Forecast<'a>> {
        let person = self.people.get(worker)?;
        let motion = person.motion.as_ref()?;
        let model = &floor.settings.model;
        Some(Forecast { motion, ways: &person.ways, bound: &model.bound, free: &model.free })
    }

    /// Where a worker will be at a time, with regions as wide as experience has made them.
    pub(crate) fn forecast(&self, floor: Floor<'_>, worker: WorkerId, t: Time) -> Option<Mixture> {
        let forecast = self.forecast_of(floor, worker)?;
        let ahead_s = (t - forecast.motion.seen()?).max(Span::ZERO).as_secs_f64();
        // The errors were learned from people on foot; those of a vehicle are as many times larger as it is faster.
        let pace = self.people.get(worker)?.track.mover().pace();
        Some(forecast.at(t)?.scaled(self.coverage.scale(ahead_s) * pace))
    }
}
