//! Local planning around people: how a robot with a corridor drives the next tenth of a second.
//!
//! Main types: [`LocalPlanner`], [`DriveState`], [`Twist`] (what it commands), [`NearPerson`] (a person near, with the
//! forecast), [`LocalMethod`], [`PassingRoom`] (whether there is room to pass). The dynamic window of Fox, Burgard and
//! Thrun (1997), and the improved one of Ye, Guo, Guo and Luo (2024, section 3.3), whose speeds are bounded by motor,
//! braking and safe spaces. Refuses: to leave the corridor; to plan routes or to hold resources, which it does not
//! know; and to be a safety function: a robot stops for people by itself.

mod drive;
mod improved;
mod outline;
mod planner;
mod room;
mod spaces;
#[cfg(test)]
mod tests;
mod traditional;

pub use drive::{DriveLimits, DriveState, Twist};
pub use improved::ImprovedWeights;
pub use outline::RobotOutline;
pub use planner::{LocalMethod, LocalPlanner};
pub use room::{LineSide, PassingRoom};
pub use spaces::{AHEAD_STEP_S, AHEAD_STEPS, NearPerson};
pub use traditional::TraditionalWeights;
