//! Inputs of one step while they are taken in.
//!
//! Main type: [`Intake`].

use crate::fleet::state::core::Core;
use crate::fleet::state::heard::Heard;
use crate::warehouse::walkway::Walkways;

/// Inputs as they are taken in.
pub(super) struct Intake<'a> {
    pub core: &'a mut Core,
    pub walkways: &'a Walkways,
    pub heard: Heard,
}
