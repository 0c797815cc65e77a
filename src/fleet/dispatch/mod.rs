//! Which robot does which job with which rack, and when robots charge.
//!
//! Main functions: [`jobs::assign`] (at the least sum of costs: `assignment.rs`), [`charging::rest`].
//! Refuses: to plan routes, and to keep anything in mind from step to step.

pub(in crate::fleet) mod assignment;
pub(in crate::fleet) mod blocked;
pub(in crate::fleet) mod chains;
pub(in crate::fleet) mod charging;
pub(in crate::fleet) mod enough;
pub(in crate::fleet) mod idle;
pub(in crate::fleet) mod jobs;
pub(in crate::fleet) mod leaving;
pub(in crate::fleet) mod maintenance;
mod work_ahead;
