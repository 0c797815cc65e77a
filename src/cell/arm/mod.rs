//! A robot arm beside the picker: where its links are, how probably they meet a person's arm, and how it keeps clear.
//!
//! Main types: [`ArmKind`], [`Capsule`], [`UncertainLimbs`], [`Choice`], [`ArmControl`], [`ArmSpace`], [`ArmSeam`],
//! [`ArmSite`] (an arm at its station), [`StationArm`] (what it does there). This is no safety function: the arm's own
//! monitored stop protects people, and the decisions here make that stop act less often. Refuses: clocks, chance, and
//! paths that were not checked.

mod backoff;
mod beside;
mod capsule;
mod choice;
mod grip;
mod kinematics;
mod mpc;
mod pace;
mod qp;
mod risk;
mod seam;
mod sight;
mod site;
mod space;
mod stand;
mod task;
mod trees;

pub use beside::DELTA;
pub use capsule::{Capsule, Nearest, least_distance_m};
pub use choice::{Choice, choose};
pub use grip::{ArmGrip, ArmOrder, ArmSaid, GripAct, Gripped};
pub use kinematics::{
    ARM_POINTS, ArmKind, ArmKindError, ArmPosture, AxisRow, Joints, LinkShape, between, joint_distance,
};
pub use mpc::{
    ArmControl, ArmGoal, ArmPlan, ArmPlanRefusal, ArmWeights, CYCLE_S, FROZEN, HORIZON, WorkPlane,
};
pub use pace::{RunAhead, STANDS_BY, WayRun};
pub use risk::{
    LimbBone, MOST_POINTS, UncertainLimbs, UncertainPoint, bone_covariance, first_order_probability,
    normal_below, normalised_probability, overlap_probability, printed_probability,
};
pub use seam::{
    ArmReport, ArmSeam, ArmTrajectory, ArmTrouble, LATE_AFTER, LONGEST_TRAJECTORY, SILENT_AFTER, WELL_AFTER,
};
pub use sight::{PickerAhead, PickerSight};
pub use site::{ArmSite, SlotAccess, base_of, rest};
pub use space::{ArmSpace, ArmWay, CHECK_MARGIN_M, CHECK_RAD};
pub use task::{ArmActivity, ArmDeed, ArmMode, ArmTask, StationArm, Surroundings, TASK_SAMPLES};
pub use trees::{GROWS_RAD, JointTree, rrt_connect, towards};
