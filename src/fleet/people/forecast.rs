//! Where workers will be within seconds, with what probability; whether such forecasts hold; and which robots brake for
//! them.
//!
//! Main type: [`Expected`], for readers. Refuses: to let a robot drive because a forecast says that nobody will be
//! there: forecasts only make robots brake.

use crate::aware::HumanAwarePolicy;
use crate::fleet::people::state::HumanState;
use crate::fleet::state::floor::Floor;
use crate::human::motion::{Fix, Motion};
use crate::human::{Forecast, Mixture, Model, Presence, Quality, Sighting, SightingOutcome, WATCHED_S};
use crate::id::WorkerId;
use crate::time::{Span, Time};

/// How far ahead readers are told, seconds.
pub const AHEAD_S: [f64; 3] = [1.0, 2.0, 4.0];

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
    pub(in crate::fleet) fn expectations(&self, floor: Floor<'_>, now: Time) -> Vec<Expected> {
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
    pub(in crate::fleet) fn follow_motion(&mut self, model: &Model, s: &Sighting, taken: SightingOutcome) {
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
    pub(in crate::fleet) fn update_forecasts(&mut self, floor: Floor<'_>, now: Time) {
        if floor.settings.policy != HumanAwarePolicy::Giveway {
            return;
        }
        for (worker, place) in self.present(now) {
            self.people[worker].ways = self.hypotheses(worker, &place);
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

    /// What is to be expected of a worker; nothing before it was seen.
    fn forecast_of<'a>(&'a self, floor: Floor<'a>, worker: WorkerId) -> Option<Forecast<'a>> {
        let person = self.people.get(worker)?;
        let motion = person.motion.as_ref()?;
        let model = &floor.settings.model;
        Some(Forecast { motion, ways: &person.ways, bound: &model.bound, free: &model.free })
    }

    /// Where a worker will be at a moment, with regions as wide as experience has made them.
    pub(in crate::fleet) fn forecast(&self, floor: Floor<'_>, worker: WorkerId, t: Time) -> Option<Mixture> {
        let forecast = self.forecast_of(floor, worker)?;
        let ahead_s = (t - forecast.motion.seen()?).max(Span::ZERO).as_secs_f64();
        Some(forecast.at(t)?.scaled(self.coverage.scale(ahead_s)))
    }
}
