//! Work that no simulated worker has of its own: some of it always waits for the nearest one who is free.
//!
//! Main type: [`SharedTasks`]. Refuses: to say who is to do it.

use crate::random::Stream;
use crate::scenario::Assignments;
use giveway_fleet::{AssignmentRequest, Ledger};
use giveway_floor::id::{AssignmentId, NodeId};
use giveway_floor::time::Span;

/// Purpose of the stream, see [`Stream::new`].
const PURPOSE: u64 = 36;

/// What is to be done by whoever is near.
#[derive(Debug)]
pub(super) struct SharedTasks {
    places: Stream,
    asked: u64,
    seed: u64,
}

impl SharedTasks {
    /// Nothing yet.
    pub fn new(seed: u64) -> SharedTasks {
        SharedTasks { places: Stream::new(seed, PURPOSE, 0), asked: 0, seed }
    }

    /// What is asked for, so that one assignment waits for each of `workers`.
    pub fn ask(
        &mut self,
        workers: usize,
        assignments: &Assignments,
        fronts: &[NodeId],
        ledger: &Ledger,
    ) -> Vec<AssignmentRequest> {
        let (Assignments::Random { stay_s } | Assignments::List { stay_s, .. }) = assignments else {
            return Vec::new();
        };
        if fronts.is_empty() {
            return Vec::new();
        }
        let waiting = unassigned(ledger).count();
        let new = (waiting..workers).map(|_| {
            let at = match assignments {
                Assignments::List { .. } => self.asked as usize % fronts.len(),
                _ => self.places.below(fronts.len()),
            };
            self.asked += 1;
            // A restarted world may have asked for the same before: the key says so.
            let key = Some(format!("shared/{}/{}", self.seed, self.asked));
            let stay = Span::from_secs_f64(*stay_s);
            AssignmentRequest { place: fronts[at], stay, what: "pick".into(), key: key.map(Into::into) }
        });
        new.collect()
    }
}

/// Assignments that nobody has.
pub(super) fn unassigned(ledger: &Ledger) -> impl Iterator<Item = AssignmentId> + '_ {
    ledger.assignments.iter().filter(|(_, a)| a.worker.is_none()).map(|(id, _)| *id)
}
