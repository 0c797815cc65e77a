//! Handlers for robots and robot kinds: joining and leaving, maintenance, pausing, a robot's history, and why it waits.
//!
//! Main types: [`robot_life::RobotDetailDto`], [`kinds::KindDto`], [`halt::FleetDto`]. Refuses: to drive a robot.

pub mod halt;
pub mod kinds;
pub mod linked;
pub mod robot_life;
pub mod robots;
pub mod why;
