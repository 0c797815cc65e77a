//! Poses of people in, guidance out: the feed of headsets, tags and gateways.
//!
//! [`intake`] turns messages of devices into sightings; it is pure, and so are [`thin`] and [`warn`]: numbers in,
//! numbers out. [`wire`] has the messages of headsets, [`message`] the messages to them, [`hub`] brings together the
//! poses of all sources and the guidance for all workers, [`lights`] is what is shown at a station, [`massrobotics`]
//! reads reports of other devices. One connection is in `http/feeds/headset.rs`. Refuses: to judge where people can be,
//! which the core does, and queues.

pub mod hub;
pub mod intake;
pub mod lights;
pub mod massrobotics;
pub mod message;
pub mod senses;
pub mod thin;
pub mod version;
pub mod warn;
pub mod wire;

#[cfg(test)]
mod tests;
