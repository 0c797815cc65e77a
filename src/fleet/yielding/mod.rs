//! How robots give way to people: speed limits, holding back, leaving the way; and the published procedure to compare
//! with.
//!
//! Main type: [`state::Yielding`]; main functions: `limit_robots`, `give_way`, `revoke_grants`. Refuses: to be a safety
//! function.

mod arrive;
pub(in crate::fleet) mod encounters;
pub(in crate::fleet) mod evade;
pub(in crate::fleet) mod halfway;
mod passing;
pub(in crate::fleet) mod petkovic2021;
pub(in crate::fleet) mod speed_limit;
pub(in crate::fleet) mod state;
pub(in crate::fleet) mod urgent;
