//! Handlers for people: workers, their positions from tags and devices, lost workers, and the names behind pseudonyms.
//!
//! Main functions: [`workers::hire`], [`positions::one`], [`reports::post`], [`lost::clear`]. Refuses: to show a name
//! to a caller who may not see names.

pub mod lost;
pub mod positions;
pub mod pseudonyms;
pub mod reports;
pub mod workers;
