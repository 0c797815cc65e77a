//! Handlers for robots and their kinds: joining and leaving, maintenance, pausing, what a robot has been through, and
//! why it waits.
//!
//! Main types: [`robot_life::RobotDetailDto`], [`kinds::KindDto`], [`halt::FleetDto`]. Refuses: to drive a robot.

pub mod halt;
pub mod kinds;
pub mod robot_life;
pub mod robots;
pub mod why;
