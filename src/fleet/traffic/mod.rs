//! Routes and grants: which robots need a route, what has come true, what is late, how far each robot may drive now.
//!
//! Main type: [`state::Traffic`]; main functions: `note_progress`, `plan_needed`, `grant`. Refuses: to decide what a
//! robot does, and to know why a robot yields.

pub(in crate::fleet) mod closures;
pub(in crate::fleet) mod displaced;
pub(in crate::fleet) mod evacuation;
pub(in crate::fleet) mod failure;
pub(in crate::fleet) mod fence;
mod first_step;
mod goal_chain;
pub(in crate::fleet) mod grant;
pub(in crate::fleet) mod joint;
pub(in crate::fleet) mod obstruction;
pub(in crate::fleet) mod plan;
pub(in crate::fleet) mod progress;
pub(in crate::fleet) mod revoke;
pub(in crate::fleet) mod stages;
pub(in crate::fleet) mod state;
mod step_out;
mod tentative;
pub(in crate::fleet) mod truncate;
mod turns;
pub(in crate::fleet) mod visits;
