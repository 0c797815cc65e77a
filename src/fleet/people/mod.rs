//! Evaluates people: where each worker is, whether the worker left the path, where to, what the worker is told.
//!
//! Main types: [`state::HumanState`], [`report::PeopleReport`], [`intents::Intents`]. Refuses: to plan for robots.

pub(in crate::fleet) mod barred;
pub(in crate::fleet) mod blocked;
pub(in crate::fleet) mod evacuate;
pub(in crate::fleet) mod evaluate;
pub(in crate::fleet) mod forecast;
pub(in crate::fleet) mod foreseen;
mod goals;
pub(in crate::fleet) mod guidance;
pub(in crate::fleet) mod intent;
pub(in crate::fleet) mod intents;
pub(in crate::fleet) mod keep_out;
mod last_places;
mod lets_pass;
pub(in crate::fleet) mod message;
mod nearest;
mod on_time;
mod open_work;
pub(in crate::fleet) mod report;
pub(in crate::fleet) mod routing;
pub(in crate::fleet) mod state;
