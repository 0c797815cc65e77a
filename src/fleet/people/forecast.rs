//! Where workers will be within seconds, with what probability; whether such forecasts hold; and which robots brake for
//! them.
//!
//! Main type: [`Expected`], for readers. Refuses: to let a robot drive because a forecast says that nobody will be
//! there: forecasts only make robots brake.

use crate::aware::{BEYOND, HumanAwarePolicy, SLOW_MPS, Swept, THRESHOLD, collision};
use crate::fleet::Fleet;
use crate::geometry::Point;
use crate::human::motion::{Fix, Motion};
use crate::human::{Mixture, Outlook, Presence, Quality, Sighting, Taken, WATCHED_S};
use crate::id::{RobotId, WorkerId};
use crate::time::{Span, Time};

/// Robots farther from somebody than this meet nobody within the time of braking, metres.
const NEAR_M: f64 = 12.0;

/// How far ahead readers are told, seconds.
pub const AHEAD_S: [f64; 3] = [1.0, 2.0, 4.0];

/// So many bell curves for each moment are enough to be looked at.
const CURVES: usize = 4;

/// Where one worker may be, for readers; nothing is decided by it.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// Who.
    pub worker: WorkerId,
    /// How far ahead, and where then, in few parts.
    pub ahead: Vec<(Span, Mixture)>,
}

impl Fleet {
    /// Where workers who are seen may be in the coming seconds, for readers. Arms that do not decide by such forecasts
    /// have none.
    pub fn expectations(&self, now: Time) -> Vec<Expected> {
        if self.settings.policy != HumanAwarePolicy::Giveway {
            return Vec::new();
        }
        let seen = self.present(now).into_iter().filter(|(_, place)| place.presence != Presence::Lost);
        let expected = |(worker, _)| {
            let at = |s: f64| {
                let after = Span::from_secs_f64(s);
                Some((after, self.forecast(worker, now + after)?.merged(CURVES)))
            };
            let ahead: Vec<_> = AHEAD_S.into_iter().filter_map(at).collect();
            (!ahead.is_empty()).then_some(Expected { worker, ahead })
        };
        seen.filter_map(expected).collect()
    }

    /// Takes a sighting that was believed into the filter of how the worker moves.
    pub(in crate::fleet) fn follow_motion(&mut self, s: &Sighting, taken: Taken) {
        let (model, worker) = (self.settings.model.motion, s.worker);
        let person = self.crowd.person(worker);
        if taken == Taken::Relocated || person.motion.is_none() {
            person.motion = Some(Motion::new(model));
            self.crowd.coverage.forget(worker);
        }
        if s.quality == Quality::Lost {
            return;
        }
        let fix = Fix { seen: s.seen, at: s.at, sigma_m: s.accuracy_m };
        self.crowd.person(worker).motion.get_or_insert_with(|| Motion::new(model)).see(fix);
        self.crowd.coverage.judge(worker, s.seen, s.at);
    }

    /// Notes where everybody may be going, and keeps a forecast of everybody from time to time to see whether it
    /// comes true.
    pub(in crate::fleet) fn update_forecasts(&mut self, now: Time) {
        if self.settings.policy != HumanAwarePolicy::Giveway {
            return;
        }
        for (worker, place) in self.present(now) {
            self.crowd.people[worker].ways = self.hypotheses(worker, &place);
            if place.presence == Presence::Tracked && self.crowd.coverage.wants(worker, now) {
                let seen = self.crowd.people[worker].motion.as_ref().and_then(Motion::seen);
                let Some(seen) = seen else { continue };
                let ahead = WATCHED_S.map(|s| self.forecast(worker, seen + Span::from_secs_f64(s)));
                if let [Some(a), Some(b), Some(c)] = ahead {
                    self.crowd.coverage.expect(worker, now, seen, [a, b, c]);
                }
            }
        }
    }

    /// What is to be expected of a worker; nothing before it was seen.
    fn forecast_of(&self, worker: WorkerId) -> Option<Outlook<'_>> {
        let person = self.crowd.people.get(worker)?;
        let motion = person.motion.as_ref()?;
        let model = &self.settings.model;
        Some(Outlook { motion, ways: &person.ways, bound: &model.bound, free: &model.free })
    }

    /// Where a worker will be at a moment, with regions as wide as experience has made them.
    pub(in crate::fleet) fn forecast(&self, worker: WorkerId, t: Time) -> Option<Mixture> {
        let outlook = self.forecast_of(worker)?;
        let ahead_s = (t - outlook.motion.seen()?).max(Span::ZERO).as_secs_f64();
        Some(outlook.at(t)?.scaled(self.crowd.coverage.scale(ahead_s)))
    }

    /// Whether a robot would probably meet a worker if it did not brake now: the probability within the time that
    /// braking takes is at the threshold or beyond.
    pub(in crate::fleet) fn would_meet(
        &self,
        robot: RobotId,
        worker: WorkerId,
        at: Point,
        now: Time,
    ) -> bool {
        let far = self.crowd.people[worker].track.newest().is_none_or(|s| (s.at - at).norm() > NEAR_M);
        if far {
            return false;
        }
        let way = self.granted_way(robot, at);
        if way.len() < 2 {
            return false;
        }
        let loaded = self.ledger.rack_on(robot).is_some();
        let seen_mps = self.scene.robot(robot).map_or(0.0, |t| t.speed_mps);
        let speed_mps = seen_mps.max(SLOW_MPS);
        let times = self.crowd.regions.times(speed_mps, loaded);
        let time = Span::from_secs_f64(times.react_s + times.stop_s) + BEYOND;
        let robot = Swept { way, speed_mps, half_m: self.warehouse().footprint_m / 2.0 };
        collision(|t| self.forecast(worker, t), &robot, now, time).is_some_and(|p| p >= THRESHOLD)
    }
}
