//! Inputs of one step while they are taken in.
//!
//! Main type: [`Intake`].

use crate::state::heard::StepNews;
use crate::state::writer::Writer;
use giveway_floor::id::WorkerId;
use giveway_floor::warehouse::walkway::Walkways;

/// Inputs as they are taken in.
pub(super) struct Intake<'a> {
    pub writer: &'a mut Writer,
    pub walkways: &'a Walkways,
    /// Workers of whose place no source knows.
    pub lost: &'a [WorkerId],
    pub heard: StepNews,
}
