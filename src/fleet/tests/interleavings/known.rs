//! States from which the fleet is known to fail, one for each floor and worker that has any.
//!
//! Main type: [`KnownFailure`]. A test checks whether each still fails: what was mended is to be taken out.

use super::floors::{Hired, Manner, TinyFloor};

/// A state from which the fleet does not make progress as it should.
pub(super) struct KnownFailure {
    pub floor: &'static str,
    /// The worker, and whether there is an assignment.
    pub worker: (Manner, bool),
    /// How to get there, and whether the worker obeys from then on.
    pub way: &'static str,
    pub obeys: bool,
    /// What is seen to happen.
    pub what: &'static str,
}

impl KnownFailure {
    pub fn is_of(&self, floor: &TinyFloor, hired: &Hired) -> bool {
        self.floor == floor.name && self.worker == (hired.manner, hired.assignment.is_some())
    }
}

/// All known failures.
pub(super) const KNOWN: &[KnownFailure] = &[];
