//! Between two steps: does a pose mean that somebody has to stop, so that the next step should not wait?
//!
//! Nothing is decided here and nothing changes; the step that follows decides, with everything that it knows.
//! Costs one look at each robot and one close look at those nearby.

use super::Fleet;
use super::people::GuidanceState;
use crate::human::{Sighting, Taken};
use crate::id::Dense;
use crate::time::Time;

/// Whoever is slower than this need not be told to stop, metres per second.
const STANDS_MPS: f64 = 0.05;

impl Fleet {
    /// Whether a step that took in this sighting now would, as things were seen last, stop a robot that drives, or tell
    /// the worker to stand who was not told yet.
    pub fn calls_for_stop(&self, s: &Sighting, now: Time) -> bool {
        let Some(person) = self.crowd.people.get(s.worker) else {
            // Nobody knows yet what it means that somebody is there.
            return s.worker.ix() < self.ledger.workers.len();
        };
        let mut track = person.track.clone();
        if track.see(s, now, self.is_on_map()) == Taken::Ignored {
            return false;
        }
        let Some(place) = track.whereabouts(now) else { return false };
        let stops = |robot| {
            let drives = self.scene.robot(robot).is_some_and(|t| t.speed_mps > STANDS_MPS);
            let told = self.crowd.limits.get(&robot).is_some_and(|(limit, _)| *limit == Some(0.0));
            drives && !told && self.limit_for(robot, &[(s.worker, place)], now).0 == Some(0.0)
        };
        let stands = person.told.as_ref().is_some_and(|(told, _)| told.state == GuidanceState::Stop);
        self.ledger.robots.ids().any(stops) || !stands && self.drives_up(&place, &self.near(&place)).is_some()
    }
}
