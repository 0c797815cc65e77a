//! Evaluates people: where each worker is, whether the worker left the path, where the worker is going, what to tell.
//!
//! Main types: [`state::HumanState`], [`report::PeopleReport`], [`intents::Intents`]. Refuses: to plan for robots.

pub(crate) mod barred;
pub(crate) mod blocked;
pub(crate) mod evacuate;
pub(crate) mod evaluate;
pub(crate) mod forecast;
pub(crate) mod foreseen;
mod goals;
pub(crate) mod guidance;
pub(crate) mod intent;
pub(crate) mod intents;
pub(crate) mod keep_out;
mod last_places;
mod lets_pass;
pub(crate) mod message;
mod nearest;
mod on_time;
mod open_work;
pub(crate) mod report;
pub(crate) mod routing;
pub(crate) mod state;
