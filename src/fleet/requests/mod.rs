//! What is asked for becomes a fact or a refusal: jobs, robots that join, workers and their assignments, closures, what
//! operators, stations and people beside broken robots say.
//!
//! Main function: [`absorb()`]; it gives what others are to hear, [`StepNews`](crate::state::heard::StepNews).
//! Refuses: to decide anything about robots.

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
