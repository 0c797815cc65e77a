//! What the handlers of several rooms share: pages of lists, names in paths, tables, periods of time, long texts, and
//! the answer 204.
//!
//! Main types: [`paging::Paging`], [`shared_text::SharedText`]; main functions: [`named::parse_robot`], [`done::done`].
//! Refuses: routes of its own.

pub mod done;
pub mod named;
pub mod paging;
pub mod shared_text;
pub mod stretch;
pub mod table;
