//! Poses of people in, guidance out: the feed of headsets, tags and gateways.
//!
//! [`align`], [`clock`], [`course`], [`pose`], [`thin`], [`intake`], [`joints`], [`swap`] and [`warn`] are pure:
//! numbers in, numbers out. [`wire`] is what headsets say, [`message`] what they are told, [`hub`] is where poses of
//! all sources and guidance for all workers meet, [`lights`] is what is shown at a station, [`session`] is one
//! connection. Refuses: to judge where people can be, which the core does, and queues.

pub mod align;
pub mod clock;
pub mod course;
pub mod hub;
pub mod intake;
pub mod joints;
pub mod lights;
pub mod message;
pub mod pose;
pub mod session;
pub mod swap;
pub mod thin;
mod version;
pub mod warn;
pub mod wire;

#[cfg(test)]
mod conventions;
#[cfg(test)]
mod tests;
