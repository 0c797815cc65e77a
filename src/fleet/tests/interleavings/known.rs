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

const FACE_TO_FACE: &str = "a robot waits for the worker, who is told to walk on and does not get anywhere";

/// All that are known.
pub(super) const KNOWN: &[KnownFailure] = &[
    KnownFailure {
        floor: "station, 3",
        worker: (Manner::Obeys, true),
        way: "111 111 111 111f 110 111 111",
        obeys: true,
        what: FACE_TO_FACE,
    },
    KnownFailure {
        floor: "ring, 2",
        worker: (Manner::Wanders, true),
        way: "11>9,9 10>6,9 11>3,9",
        obeys: true,
        what: FACE_TO_FACE,
    },
];
