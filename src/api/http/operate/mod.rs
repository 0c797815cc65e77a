//! Handlers for running the server: health and metrics, alarms, webhooks.
//!
//! Main functions: [`health::health`], [`alarms::list`], [`webhooks::add`]. Refuses: to run the floor.

pub mod alarms;
pub mod health;
pub mod webhooks;
