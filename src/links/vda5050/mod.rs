//! Robots that speak VDA 5050: a session for each, from the first word to the last.
//!
//! Main types: [`RobotSession`], [`RobotHeard`], [`SessionOutput`]. A session turns the fleet's commands into orders
//! and instant actions, and what the robot says into reports. What a robot says is a claim: a cancelled order has no
//! nodes left and the robot stands, a paused robot stands, a load was picked if the robot finished *our* action or
//! carries something else than before. Refuses: to send anything again before the robot has shown that it did not take
//! it.

mod acts;
mod adopt;
mod cancel;
mod charge;
mod contact;
mod corridor;
mod lease;
mod motion;
mod notice;
mod operator;
mod order;
mod overtaken;
mod pause;
pub mod probe;
mod report;
mod retry;
mod session;
#[cfg(test)]
mod tests;
mod trigger;
mod trust;
mod zones;

pub use contact::NotReady;
pub use notice::Notice;
pub use operator::{INIT_POSITION, SentAction};
pub use session::{MessageStamp, RobotHeard, RobotSession, RobotTold, SessionOutput, SessionStart};
pub use zones::{BlockedArea, closed_areas};
