//! The floor: what a warehouse is, and who holds which part of it when. Nothing here depends on people, jobs or moving
//! robots.
//!
//! - [`time`], [`id`], [`text`], [`geometry`]: integer microseconds and half-open windows; one newtype per kind of
//!   thing; names and tables as people write them, and every sentence for people, with a code of its own; metres and
//!   radians in the map's frame.
//! - [`warehouse`]: the building. Nodes, lanes, racks, stations; which of them exclude each other; checks that
//!   refuse a map on which robots could get stuck; formats.
//! - [`timeline`]: which robot holds which resource when, and in which order.
//! - [`route`]: the one search, over free windows.
//!
//! Pure. Refuses: clocks, files, chance, and any second search.

pub mod geometry;
pub mod id;
pub mod route;
pub mod text;
pub mod time;
pub mod timeline;
pub mod warehouse;
