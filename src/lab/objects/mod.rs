//! Simulated people who fetch objects: the thesis' tables of predictors of the object (Petković 2021, chapter 5).
//!
//! Main types: [`ObjectsBench`] (the people and the work), [`ObjectsReport`] (all figures), [`FeatureStudy`] (Table
//! 5.1). MoGaze and SubMotion are not here: rooms, walks, eyes and heads are simulated, arms are those of simulated
//! pickers. Refuses: to read clocks; a caller that times a frame brings one.

mod bench;
mod body;
mod change;
mod eyes;
mod frame;
mod gaze;
mod nets;
mod people;
mod report;
mod room;
mod rows;
mod rules;
mod score;
mod study;
#[cfg(test)]
mod tests;
mod walk;

pub use bench::{ObjectGroup, ObjectJob, ObjectsBench, ObjectsCourse};
pub use body::{FEATURES, FRAMES, ObjectTable};
pub use change::{CHANGES, ChangeFigures};
pub use frame::FrameBench;
pub use report::{GroupReport, ObjectsReport, RowReport};
pub use rows::{ObjectRow, RowKind, rows_of};
pub use study::{FeatureStudy, feature_study};
