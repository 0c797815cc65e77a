//! What people mean for robots: regions, closures, prices. The only place where `human` and `route` meet.
//!
//! Main types: [`HumanAwarePolicy`] (which method decides), [`Regions`] (radii and speeds), [`Effects`] (beliefs to
//! conditions), [`Zone`] (keep, slow down, or change the route), [`Meter`] (encounters), [`Covered`] (what is closed).
//! Refuses: to plan, and to command robots.

mod afoot;
mod collision;
mod covered;
mod effects;
mod encounter;
mod occupancy;
mod passing;
mod regions;
pub mod safe_space;
pub mod zone_answers;

pub use afoot::Afoot;
pub use collision::{BEYOND, Swept, THRESHOLD, collision};
pub use covered::{AreaFault, Covered, check_area, covered};
pub use effects::{Effects, NodeWindows, nodes_in};
pub use encounter::{MOVES_MPS, Meeting, Meter, Near};
pub use occupancy::{Occupancy, Stay, occupancies};
pub use passing::{DriveAhead, Walk, leaves_after, moves_within};
pub use regions::{Regions, SLOW_MPS, quantised};
pub use safe_space::{Adaptation, Zone};

/// How the fleet deals with people: ours, and three to compare it with (Petković 2021, section 4.4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum HumanAwarePolicy {
    /// No prediction: replans when a worker who left the path is within region 1 of a robot.
    Nhir,
    /// Predicts that a worker who left the path goes straight on.
    Shir,
    /// Predicts by the published intention recognition, and reacts by the published procedure.
    Phir,
    /// Predicts occupancies with probabilities, and makes only those robots give way that would meet the worker.
    #[default]
    Giveway,
}

impl HumanAwarePolicy {
    /// All policies.
    pub const ALL: [HumanAwarePolicy; 4] =
        [HumanAwarePolicy::Nhir, HumanAwarePolicy::Shir, HumanAwarePolicy::Phir, HumanAwarePolicy::Giveway];

    /// The policy's name in files and tables.
    pub fn word(self) -> &'static str {
        match self {
            HumanAwarePolicy::Nhir => "nhir",
            HumanAwarePolicy::Shir => "shir",
            HumanAwarePolicy::Phir => "phir",
            HumanAwarePolicy::Giveway => "giveway",
        }
    }

    /// The policy of that name.
    pub fn named(name: &str) -> Option<HumanAwarePolicy> {
        HumanAwarePolicy::ALL.into_iter().find(|a| a.word() == name)
    }
}
