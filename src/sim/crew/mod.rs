//! The simulated workers together: where they come in, how they are seen, who walks with whom, and whose work it is.
//!
//! Main types: `workers::Crew`, `sensor::Device` (how one of them is seen). What goes on in one worker is the room
//! `walker`. Refuses: to show the fleet anything but what devices measure.

mod entrance;
mod pairs;
mod sensor;
mod shared_tasks;
pub(crate) mod workers;
