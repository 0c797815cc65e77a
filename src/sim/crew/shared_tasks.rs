//! Assignments that belong to no simulated worker: some of them always wait for the nearest free one.
//!
//! Main type: [`SharedTasks`]. Refuses: to choose the worker.

use crate::random::Stream;
use crate::scenario::Assignments;
use giveway_fleet::{AssignmentRequest, Ledger};
use giveway_floor::id::{AssignmentId, NodeId};
use giveway_floor::time::Span;

/// Purpose of the stream, see [`Stream::new`].
const PURPOSE: u64 = 36;

/// Assignments for whichever worker is near.
#[derive(Debug)]
pub(super) struct SharedTasks {
    places: Stream,
    asked: u64,
    seed: u64,
}

impl SharedTasks {
    /// No assignments yet.
    pub fn new(seed: u64) -> SharedTasks {
        SharedTasks { places: Stream::new(seed, PURPOSE, 0), asked: 0, seed }
    }

    /// Requests for new assignments, so that one waits for each of `workers`.
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
            // A world before a restart may have made the same request; the key identifies it.
            let key = Some(format!("shared/{}/{}", self.seed, self.asked));
            let stay = Span::from_secs_f64(*stay_s);
            AssignmentRequest { place: fronts[at], stay, what: "pick".into(), key: key.map(Into::into) }
        });
        new.collect()
    }
}

/// Assignments without a worker.
pub(super) fn unassigned(ledger: &Ledger) -> impl Iterator<Item = AssignmentId> + '_ {
    ledger.assignments.iter().filter(|(_, a)| a.worker.is_none()).map(|(id, _)| *id)
}
