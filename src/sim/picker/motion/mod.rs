//! How people reach, as ground truth: a person's build and habits, and one movement from a point to a place.
//!
//! Main types: [`ArmBuild`], [`ArmReach`], [`ArmPose`]. Speeds follow a minimum jerk, warped so that it peaks early;
//! paths are bent, a second correction may follow, shoulder and head move along, the head turns part of the way and the
//! eyes go ahead of it. Right arms are computed; left ones are their mirror image. Refuses: straight, symmetric
//! movements of people who look where they reach.

mod build;
mod reach;
#[cfg(test)]
mod tests;

pub use build::{ArmBuild, ArmRest, ArmSide};
pub use reach::{ArmPose, ArmReach, minimum_jerk};
