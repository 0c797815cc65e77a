//! Recorded people: data for training and scoring predictors.
//!
//! Main types: [`RecordedWalks`] (walks of a file), [`Stretch`] and [`Trip`] (what is scored). Refuses: to read files.

mod degrade;
pub mod forecasting;
pub mod meetings;
pub mod purposes;
mod recipe;
mod subject;
mod tracks;
mod windows;

pub use degrade::Degrade;
pub use subject::{Ground, Subject};
pub use tracks::{Format, RecordedWalk, RecordedWalks, STEP_S, TrackError, TrackPoint, goals};
pub use windows::{OBSERVED, PREDICTED, STEPS, Stretch, Trip, VISIT_M, all, scored, trips, visits};
