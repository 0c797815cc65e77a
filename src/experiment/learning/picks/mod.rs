//! Learning from people who reach.
//!
//! Refuses: to read files.
#![allow(dead_code, missing_docs)]
pub mod adam;
pub mod arm;
pub mod course;
pub mod places;
pub mod ends;
pub mod items;
pub mod layers;
