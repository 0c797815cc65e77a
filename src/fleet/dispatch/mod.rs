//! Which robot does which job with which rack, where racks are stored, and when robots charge.
//!
//! Main functions: `assign` (at the least sum of costs: `assignment.rs`), `best_storage`, `rest`. Refuses: to plan
//! routes.

pub(in crate::fleet) mod assignment;
pub mod charging;
pub(in crate::fleet) mod jobs;
pub(in crate::fleet) mod storage;
