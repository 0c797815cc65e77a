//! A virtual robot with its simple body, for callers without a simulated one.
//!
//! Main type: [`EmbodiedRobot`]. Refuses: bodies of another kind, which go with [`VirtualRobot::step`] directly.

use super::body::{BodyCommand, VirtualBody};
use super::setup::RobotSetup;
use super::{RobotMessage, VirtualRobot};
use crate::model::Message;

/// A virtual robot and its body.
#[derive(Clone, Debug)]
pub struct EmbodiedRobot {
    /// The protocol side, to be set and asked between steps.
    pub robot: VirtualRobot,
    body: VirtualBody,
    command: BodyCommand,
    stepped_us: Option<i64>,
}

impl EmbodiedRobot {
    /// A robot that is switched on where its setup says.
    pub fn new(setup: RobotSetup) -> EmbodiedRobot {
        let place = &setup.position;
        let body = VirtualBody::new(setup.body, place.x, place.y, place.theta);
        EmbodiedRobot {
            robot: VirtualRobot::new(setup),
            body,
            command: BodyCommand::default(),
            stepped_us: None,
        }
    }

    /// Moves the body until a time in microseconds, lets the robot act on what it received, and returns what it says.
    /// The time between two steps is the robot's delay in noticing anything.
    pub fn step(&mut self, now_us: i64, received: &[Message]) -> Vec<RobotMessage> {
        let elapsed_us = self.stepped_us.map_or(0, |before_us| now_us.saturating_sub(before_us).max(0));
        self.stepped_us = Some(self.stepped_us.unwrap_or(now_us).max(now_us));
        // A robot that was carried elsewhere since its last command stands there and has left its path.
        if let Some(placed) = self.robot.placed.take() {
            self.command = BodyCommand { placed: Some(placed), ..BodyCommand::default() };
        }
        let report = self.body.advance(elapsed_us, &self.command);
        let step = self.robot.step(now_us, received, &report);
        self.command = step.command;
        step.messages
    }

    /// The body, to be looked at.
    pub fn body(&self) -> &VirtualBody {
        &self.body
    }

    /// What the body is told until the next step.
    pub fn command(&self) -> &BodyCommand {
        &self.command
    }
}
