//! Where workers are most probably going, recorded when that changes.
//!
//! Refuses: to infer anything, and goals at corners of the hall, which only stand for everything else.

use crate::people::intents::DOORS;
use crate::people::state::HumanState;
use crate::state::fact::Fact;
use crate::state::note::FloorNote;
use crate::state::writer::Writer;
use giveway_floor::time::{Span, Time};

/// A goal less probable than this does not count yet.
const PROBABLE: f64 = 0.6;

/// Least time between two recorded goals of a worker.
const AGAIN: Span = Span::from_secs(5);

impl HumanState {
    /// Records the goal of each worker whose most probable goal is another one than before, and probable enough.
    pub(super) fn note_goals(&mut self, writer: &mut Writer, now: Time) {
        for (worker, _) in self.present(now) {
            let Some(belief) = self.intents.belief(worker) else { continue };
            let best = belief.goals.iter().max_by(|a, b| a.1.total_cmp(&b.1));
            let Some((goal, probability)) = best.copied().filter(|(g, p)| g.0 >= DOORS && *p >= PROBABLE)
            else {
                continue;
            };
            let told = self.people[worker].goal_noted;
            if told.is_some_and(|(before, at)| before == goal || now - at < AGAIN) {
                continue;
            }
            let Some(place) = self.intents.distances.place(goal) else { continue };
            self.people[worker].goal_noted = Some((goal, now));
            let percent = (100.0 * probability.min(1.0)).round() as u8;
            writer.record(Fact::Noted(FloorNote::Goal { worker, place: place.into(), percent, at: now }));
        }
    }
}
