//! Connections that stay open: the live feed of the floor, the feed of one station, the feeds of headsets.
//!
//! Main functions: [`floor::live`], [`station::live_station`], [`fn@headset::feed`]. Refuses: to wait for a client.

pub mod floor;
pub mod headset;
pub mod station;
