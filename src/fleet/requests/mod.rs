//! Requests become facts or refusals: jobs, robots that join, workers and their assignments, closures, and what
//! operators, stations and people beside broken robots say.
//!
//! Main function: [`absorb()`]; it returns what later parts of the step need,
//! [`StepNews`](crate::state::heard::StepNews). Refuses: to decide anything about robots.

mod absorb;
mod areas;
mod arm;
mod change;
mod enrolment;
pub(crate) mod hands;
mod intake;
mod jobs;
mod kinds;
mod operator;
mod racks;
mod reassign;
mod station;
mod visit;
mod workers;

pub(crate) use absorb::absorb;
