//! The simulated workers together: where they enter, how devices see them, which of them walk in pairs, and who does
//! what.
//!
//! Main types: `workers::Crew`, `sensor::Device` (how a device sees one of them). The behaviour of one worker is the
//! room `walker`. Refuses: to show the fleet anything but what devices measure.

mod entrance;
mod member;
mod pairs;
mod seen_vehicles;
mod sensor;
mod shared_tasks;
pub(crate) mod workers;
