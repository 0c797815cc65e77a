//! Where the people near a place are and will be in the next seconds, for robots that pass them.
//!
//! Main type: [`ForeseenPerson`]. Refuses: to guess where an unseen person walks.

use crate::people::state::HumanState;
use crate::state::floor::Floor;
use giveway_floor::geometry::{Point, Vector};
use giveway_floor::id::WorkerId;
use giveway_floor::time::{Span, Time};
use giveway_people::human::{Mixture, Mover, Presence};
use giveway_people::local::{AHEAD_STEP_S, AHEAD_STEPS, NearPerson};

/// One person near a place, as the fleet believes.
#[derive(Clone, Debug, PartialEq)]
pub struct ForeseenPerson {
    /// The worker.
    pub worker: WorkerId,
    /// Where the person most probably is now.
    pub at: Point,
    /// How the person moves, metres per second.
    pub velocity: Vector,
    /// What the person moves as.
    pub mover: Mover,
    /// Where the person will be [`AHEAD_STEP_S`] from now, twice that, and so on; nothing for a person who is not seen.
    pub ahead: Vec<Mixture>,
    /// Whether the person is seen now, and in one place.
    pub is_seen: bool,
}

impl ForeseenPerson {
    /// The person as the local planner takes it.
    pub fn near(&self) -> NearPerson<'_> {
        NearPerson { at: self.at, velocity: self.velocity, ahead: &self.ahead }
    }
}

impl HumanState {
    /// When a worker who is at work will be done, if that is known and not over.
    pub(crate) fn done_at(&self, worker: WorkerId, now: Time) -> Option<Time> {
        let person = self.people.get(worker)?;
        let done = person.there_since? + person.plan.as_ref()?.stay;
        (done > now).then_some(done)
    }

    /// People who may be within this many metres of a place; a person whose sources disagree, in each of the places.
    pub(crate) fn foreseen(
        &self,
        floor: Floor<'_>,
        at: Point,
        within_m: f64,
        now: Time,
    ) -> Vec<ForeseenPerson> {
        let step = Span::from_secs_f64(AHEAD_STEP_S);
        let doubted: Vec<WorkerId> = self.others(now).into_iter().map(|(worker, _)| worker).collect();
        let mut near = self.places(now);
        near.retain(|(_, w)| (w.at - at).norm() - w.reach_m <= within_m);
        let person = |(worker, w): (WorkerId, giveway_people::human::Whereabouts)| {
            let is_seen = w.presence == Presence::Tracked && !doubted.contains(&worker);
            let moments = if is_seen { AHEAD_STEPS } else { 0 };
            let forecast = |k: usize| self.forecast(floor, worker, now + step * k as i64);
            let ahead = (1..=moments).map_while(forecast).collect();
            ForeseenPerson { worker, at: w.at, velocity: w.velocity, mover: w.mover, ahead, is_seen }
        };
        near.into_iter().map(person).collect()
    }
}
