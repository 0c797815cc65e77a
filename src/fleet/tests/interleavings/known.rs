//! States from which the fleet is known not to get on as it should, one for each floor and worker where there are some.
//!
//! Main type: [`KnownFailure`]. A test asks whether it is still so: what was mended is to be taken out.

use super::floors::{Hired, Manner, TinyFloor};

/// A state from which the fleet does not get on as it should.
pub(super) struct KnownFailure {
    pub floor: &'static str,
    /// The worker, and whether there is an assignment.
    pub worker: (Manner, bool),
    /// How to get there, and whether the worker obeys from then on.
    pub way: &'static str,
    pub obeys: bool,
    /// What is seen.
    pub what: &'static str,
}

impl KnownFailure {
    pub fn is_of(&self, floor: &TinyFloor, hired: &Hired) -> bool {
        self.floor == floor.name && self.worker == (hired.manner, hired.assignment.is_some())
    }
}

/// All that are known.
pub(super) const KNOWN: &[KnownFailure] = &[];
