//! Handlers for the building and what stands in it: the map and drafts of maps, racks, stations, lists of robots,
//! closures, evacuation, timelines.
//!
//! Main types: [`map::MapAnswer`], [`closures::NewClosure`], [`evacuation::EvacuationDto`]. Refuses: to know jobs and
//! people.

pub mod closing;
pub mod closures;
pub mod evacuation;
pub mod lists;
pub mod map;
pub mod maps;
pub mod publish;
pub mod recurring;
pub mod stations;
pub mod timelines;
