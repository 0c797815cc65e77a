//! What a worker waits for: a robot in the way, a way, or nothing.
//!
//! Refuses: to say that nothing will happen because a worker stands for a moment.

use crate::people::state::{HumanState, LetsPassStage, WalkMode};
use crate::state::wait_graph::{Edge, Party};
use crate::state::yielding::STANDS;
use giveway_floor::id::WorkerId;
use giveway_floor::time::{Span, Time};
use giveway_people::human::Presence;

/// A worker who paces up and down in one place for this long is not about to walk on.
const PACES: Span = Span::from_secs(30);

impl HumanState {
    /// What a worker waits for.
    pub(super) fn edge(&self, worker: WorkerId, now: Time) -> Edge {
        let person = &self.people[worker];
        let Some(place) = self.whereabouts(worker, now) else { return Edge::Moves };
        if place.presence == Presence::Lost {
            // A person has to look where the worker is.
            return Edge::Operator;
        }
        if let Some(lets_pass) = person.lets_pass {
            return match lets_pass.stage {
                LetsPassStage::Walks => Edge::Moves,
                LetsPassStage::TouchesMarks | LetsPassStage::Stands | LetsPassStage::Waits => {
                    Edge::Until(lets_pass.until)
                }
            };
        }
        // If a worker is not seen well, it is not known what is in the way.
        let blocked = person.blocked_since.filter(|_| place.presence == Presence::Tracked);
        let blocked = blocked.map(|(robot, _)| Edge::On(Party::Robot(robot)));
        if matches!(person.mode, WalkMode::Stopped { .. }) {
            return blocked.unwrap_or(Edge::NoWay);
        }
        let stood = person.stands_since.map(|since| now - since);
        let is_at_work = person.plan.is_some() && person.there_since.is_some();
        // It is not known where a worker without a path wants to go: one who paces up and down may wait for robots.
        let paces = person.plan.is_none() && person.lingers.is_some_and(|(_, since)| now - since > PACES);
        match stood {
            Some(_) if blocked.is_some() => blocked.expect("just seen"),
            Some(stood) if stood > STANDS && !is_at_work => Edge::Still,
            _ if paces => Edge::Still,
            _ => Edge::Moves,
        }
    }
}
