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
    /// Workers of whom no source knows where they are.
    pub lost: &'a [WorkerId],
    pub heard: StepNews,
}
