//! The robot arm beside the picker in figures: seeds on the overlap of limbs and links, on bolts on a bench, and on
//! planners, again.
//!
//! Main modules: [`overlap`], [`bolts`], [`planners`], [`dropout`], [`moving`], [`person`] (ground truth), [`forecast`]
//! (predictions of it). Refuses: to read clocks; the caller passes one in if times are asked for.

pub mod bolts;
pub mod dropout;
pub mod forecast;
pub mod library;
pub mod marching;
pub mod moving;
pub mod net;
pub mod overlap;
pub mod person;
pub mod planners;
pub mod random_trees;
pub mod schedule;
mod teaching;
