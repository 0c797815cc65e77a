//! Inputs of one step while they are taken in.
//!
//! Main type: [`Intake`].

use crate::fleet::state::heard::Heard;
use crate::fleet::state::writer::Writer;
use crate::id::WorkerId;
use crate::warehouse::walkway::Walkways;

/// Inputs as they are taken in.
pub(super) struct Intake<'a> {
    pub writer: &'a mut Writer,
    pub walkways: &'a Walkways,
    /// Workers of whom no source knows where they are.
    pub lost: &'a [WorkerId],
    pub heard: Heard,
}
