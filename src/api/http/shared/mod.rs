//! What the handlers of several rooms share: lists and their pages, names in paths, tables, stretches of time, long
//! texts, the answer to what is done.
//!
//! Main types: [`paging::Paging`], [`shared_text::SharedText`]; main functions: [`named::parse_robot`], [`done::done`].
//! Refuses: routes of its own.

pub mod done;
pub mod named;
pub mod paging;
pub mod shared_text;
pub mod stretch;
pub mod table;
