//! What the handlers of all requests share, and the ports to the program that runs the API that must know the caller.
//!
//! Main types: [`api::Api`], which each handler gets as [`called::Called`]; [`records::Records`],
//! [`records::QueuedRequest`], [`publish::MapPort`], [`alarms::Alarms`], [`metrics::Metrics`]. Refuses: to know routes.

pub mod alarms;
pub mod api;
pub mod called;
pub mod kind_checks;
pub mod metrics;
pub mod publish;
pub mod records;
