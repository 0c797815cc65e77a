//! Routes and grants: which robots need a route, what has come true, what is late, how far each robot may drive now.
//!
//! Main type: [`state::Traffic`]; main functions: `note_progress`, `plan_needed`, `grant`. Refuses: to decide what a
//! robot does, and to know why a robot yields.

pub(crate) mod closures;
pub(crate) mod displaced;
pub(crate) mod evacuation;
pub(crate) mod failure;
pub(crate) mod fence;
mod first_step;
mod goal_chain;
pub(crate) mod grant;
pub(crate) mod joint;
pub(crate) mod obstruction;
pub(crate) mod plan;
pub(crate) mod progress;
pub(crate) mod revoke;
pub(crate) mod stages;
pub(crate) mod state;
mod step_out;
mod tentative;
pub(crate) mod truncate;
mod turns;
pub(crate) mod visits;
