//! The robot arm beside the picker in figures: seeds of the overlap of limbs and links, of bolts on a bench, and of
//! planners, again.
//!
//! Main modules: [`overlap`], [`bolts`], [`planners`], [`dropout`], [`moving`], [`person`] (ground truth),
//! [`forecast`] (what predicts it). Refuses: to read clocks; the caller passes one in where times are asked for.

pub mod bolts;
pub mod dropout;
pub mod forecast;
pub mod library;
pub mod moving;
pub mod overlap;
pub mod person;
pub mod planners;
mod teaching;
