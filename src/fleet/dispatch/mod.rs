//! Which robot does which job with which rack, and when robots charge.
//!
//! Main functions: [`jobs::assign`] (at the least sum of costs: `assignment.rs`), [`charging::rest`].
//! Refuses: to plan routes, and to remember anything from step to step.

pub(crate) mod assignment;
pub(crate) mod blocked;
pub(crate) mod chains;
pub(crate) mod charging;
pub(crate) mod enough;
pub(crate) mod idle;
pub(crate) mod jobs;
pub(crate) mod leaving;
pub(crate) mod maintenance;
pub(crate) mod named;
pub(crate) mod silent;
mod work_ahead;
