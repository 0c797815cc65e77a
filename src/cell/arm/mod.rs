//! A robot arm beside the picker: where its links are, how probably they meet a person's arm, and how it keeps clear.
//!
//! Main types: [`ArmKind`], [`Capsule`], [`UncertainLimbs`], [`Choice`], [`ArmControl`]. It is no safety function: the arm's own monitored stop
//! protects people, and what is decided here makes it needed less often. Refuses: clocks, chance, and paths that were
//! not checked.

mod capsule;
mod choice;
mod kinematics;
mod mpc;
mod qp;
mod risk;
mod schedule;

pub use capsule::{Capsule, Nearest, least_distance_m};
pub use choice::{Choice, choose};
pub use kinematics::{
    ARM_POINTS, ArmKind, ArmKindError, ArmPose, AxisRow, Joints, LinkShape, between, joint_distance,
};
pub use mpc::{
    ArmControl, ArmGoal, ArmPlan, ArmPlanRefusal, ArmWeights, CYCLE_S, FROZEN, HORIZON, WorkPlane,
};
pub use risk::{
    LimbBone, MOST_POINTS, UncertainLimbs, UncertainPoint, bone_covariance, first_order_probability,
    normal_below, normalised_probability, overlap_probability, printed_probability,
};
pub use schedule::{TargetTable, TargetTableError};
