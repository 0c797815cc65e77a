//! What tests of whole floors see of the inside of a fleet.
//!
//! Such tests need the simulator, which knows this crate, so they stand outside of it. Main types: [`Internals`],
//! [`InternalsMut`]. Refuses: use outside tests; `tests/walls` looks for it.

use super::Fleet;
pub use super::people::blocked::WaysPast;
use super::people::state::HumanState;
pub use super::people::state::{Person, WalkMode};
pub use super::state::floor::Floor;
pub use super::state::visits::Visits;
use super::state::writer::Writer;
pub use super::traffic::progress::ORPHANS_PER_STEP;
use super::traffic::state::Traffic;
use super::yielding::state::Yielding;

/// The parts of a fleet.
pub struct Internals<'a> {
    /// Ledger, scene, and what the step writes.
    pub writer: &'a Writer,
    /// Beliefs about people.
    pub people: &'a HumanState,
    /// Which robots give way to which workers.
    pub yielding: &'a Yielding,
    /// Routes and grants.
    pub traffic: &'a Traffic,
}

/// The parts of a fleet, to change.
pub struct InternalsMut<'a> {
    /// Ledger, scene, and what the step writes.
    pub writer: &'a mut Writer,
    /// Routes and grants.
    pub traffic: &'a mut Traffic,
}

impl Fleet {
    /// The parts of the fleet.
    pub fn internals(&self) -> Internals<'_> {
        let Fleet { writer, people, yielding, traffic, .. } = self;
        Internals { writer, people, yielding, traffic }
    }

    /// The parts of the fleet, to change.
    pub fn internals_mut(&mut self) -> InternalsMut<'_> {
        let Fleet { writer, traffic, .. } = self;
        InternalsMut { writer, traffic }
    }
}
