//! How robots give way to people: speed limits, holding back, leaving the way; and the published procedure to compare
//! with.
//!
//! Main type: [`state::Yielding`]; main functions: `limit_robots`, `give_way`, `revoke_grants`. Refuses: to be a safety
//! function.

mod arrive;
pub(crate) mod encounters;
pub(crate) mod evade;
pub(crate) mod halfway;
mod passing;
pub(crate) mod petkovic2021;
pub(crate) mod speed_limit;
pub(crate) mod state;
pub(crate) mod urgent;
