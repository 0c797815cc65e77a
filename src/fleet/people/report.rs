//! What the evaluation of people gives the step: places, guidance, and conditions for robots.
//!
//! Main type: [`PeopleReport`]. Refuses: to act on it.

use crate::people::state::HumanState;
use crate::state::heard::WorkerInput;
use crate::state::regions::KindConditions;
use crate::state::worker::Guidance;
use crate::state::writer::Writer;
use crate::state::yielding::YieldingState;
use giveway_floor::id::{IdVec, WorkerId};
use giveway_floor::time::Time;
use giveway_people::human::Whereabouts;
use std::collections::BTreeSet;

/// What the rest of the step gets to know about people.
#[derive(Debug)]
pub struct PeopleReport {
    /// Where each worker is, if on the floor and among robots.
    pub places: IdVec<WorkerId, Option<Whereabouts>>,
    /// Where else workers may be.
    pub others: Vec<(WorkerId, Whereabouts)>,
    /// Workers who stand to let a robot pass.
    pub let_pass: BTreeSet<WorkerId>,
    /// What workers are told now.
    pub guidance: Vec<(WorkerId, Guidance)>,
}

impl HumanState {
    /// Takes in what was heard of workers, follows each, and reports.
    pub(crate) fn evaluate(
        &mut self,
        writer: &mut Writer,
        heard: &[WorkerInput],
        yielding: &YieldingState,
        now: Time,
    ) -> PeopleReport {
        self.hear(writer, heard, now);
        self.follow(writer, yielding, now);
        self.restrict(writer.floor(), now);
        let guidance = self.guide(writer.floor(), now);
        let among = |place: &Whereabouts| !self.is_at_workplace(place);
        let places = self.people.iter().map(|p| p.track.whereabouts(now).filter(among)).collect();
        PeopleReport { places, others: self.others(now), let_pass: self.standing_aside(now), guidance }
    }

    /// The conditions that workers cause for the search and for grants, for each robot kind, as of the last evaluation.
    pub(crate) fn conditions(&self) -> &KindConditions {
        &self.conditions
    }
}
