//! Handlers for what customers order: jobs for robots, assignments for workers.
//!
//! Main type: [`new_job::NewJob`]. Refuses: to choose the robot or the worker.

pub mod assignments;
pub mod batch;
pub mod jobs;
pub mod new_job;
