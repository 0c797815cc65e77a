//! What is asked for becomes a fact or a refusal: jobs, robots that join, workers and their assignments, closures, what
//! operators and stations say.
//!
//! Main function: `Fleet::absorb`. Refuses: to decide anything about robots.

pub(in crate::fleet) mod absorb;
pub(in crate::fleet) mod enrolment;
pub(in crate::fleet) mod operator;
pub mod station;
pub(in crate::fleet) mod workers;
