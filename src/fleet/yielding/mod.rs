//! How robots give way to people: speed limits, holding back, leaving the way; and the published procedure to compare
//! with.
//!
//! Main type: [`Yielding`]; main functions: `limit_robots`, `give_way`, `revoke_grants`. Refuses: to be a safety
//! function.

pub(in crate::fleet) mod encounters;
pub(in crate::fleet) mod evade;
pub(in crate::fleet) mod petkovic2021;
pub(in crate::fleet) mod speed_limit;
pub(in crate::fleet) mod urgent;

use crate::aware::Meter;
use crate::fleet::state::yielding::YieldingState;
use petkovic2021::Procedure;

/// What is kept in mind about giving way, from step to step. Lost at a restart, and found out again.
#[derive(Debug, Default)]
pub(in crate::fleet) struct Yielding {
    /// For each robot.
    pub state: YieldingState,
    /// The published reaction, where that is what the fleet is to use.
    pub procedure: Procedure,
    /// Encounters that have begun.
    pub meter: Meter,
}
