//! Between two steps: does a pose mean that a robot or a worker has to stop, so that the next step should not wait?
//!
//! Nothing is decided here and nothing changes; the next step decides, with everything that it knows. Costs one look at
//! each robot and one close look at those nearby.

use crate::people::state::HumanState;
use crate::state::floor::Floor;
use crate::state::io::Telemetry;
use crate::state::worker::GuidanceState;
use crate::traffic::state::Traffic;
use crate::yielding::state::Yielding;
use giveway_floor::geometry::Vector;
use giveway_floor::id::Dense;
use giveway_floor::time::{Span, Time};
use giveway_people::human::{Sighting, SightingOutcome, Whereabouts};

/// A robot slower than this need not be told to stop, metres per second.
const STANDS_MPS: f64 = 0.05;
/// Robots farther away stop for no person, metres.
const NEAR_M: f64 = 8.0;
/// How long after a robot was seen it is assumed to have driven on at most.
const OLD: Span = Span::from_millis(200);

impl Yielding {
    /// Whether a step that took in this sighting now would, as things were last seen, stop a robot that drives, or tell
    /// the worker to stand, unless the worker was already told.
    pub(crate) fn calls_for_stop(
        &self,
        floor: Floor<'_>,
        people: &HumanState,
        traffic: &Traffic,
        s: &Sighting,
        now: Time,
    ) -> bool {
        let Some(person) = people.people.get(s.worker) else {
            // The worker is new to the fleet: only a step can tell what that means.
            return s.worker.ix() < floor.ledger.workers.len();
        };
        let mut track = person.track.clone();
        if matches!(track.see(s, now, floor.is_on_map()), SightingOutcome::Ignored | SightingOutcome::Noted) {
            return false;
        }
        let Some(place) = track.whereabouts(now) else { return false };
        let others = track.others(now);
        let stands = person.told.as_ref().is_some_and(|(told, _)| told.state == GuidanceState::Stop);
        let limits = self.limits(floor, people, traffic);
        floor.ledger.present().any(|robot| {
            let Some(seen) = floor.scene.robot(robot).filter(|t| t.speed_mps > STANDS_MPS) else {
                return false;
            };
            let is_near = |w: &Whereabouts| (w.at - seen.pose.at).norm() - w.reach_m <= NEAR_M;
            let here = Some(seen_from(&place, seen, now)).filter(is_near);
            let elsewhere = others.iter().map(|other| seen_from(other, seen, now)).filter(is_near);
            let near: Vec<_> = here.into_iter().chain(elsewhere).map(|w| (s.worker, w)).collect();
            if near.is_empty() {
                return false;
            }
            let told = self.state.of(robot).is_told_to_stand();
            let stops = || limits.limit_for(robot, &near, now).0 == Some(0.0);
            !told && stops() || !stands && here.is_some_and(|place| people.drives_up(floor, robot, &place))
        })
    }
}

/// Where a person is as seen from a robot that has driven on since it was seen.
fn seen_from(place: &Whereabouts, robot: &Telemetry, now: Time) -> Whereabouts {
    let age = (now - robot.seen).clamp(Span::ZERO, OLD);
    let ahead = Vector::new(robot.pose.heading.cos(), robot.pose.heading.sin());
    Whereabouts { at: place.at - ahead * (robot.speed_mps * age.as_secs_f64()), ..*place }
}
