//! Robots of others: what a link makes of the fleet's orders and of what robots say, without a network.
//!
//! Main type: [`vda5050::RobotSession`], one for each robot. Pure: time and messages come from outside, and everything
//! that is to happen outside is handed back. Refuses: to believe a robot, and to know MQTT.

pub mod vda5050;
