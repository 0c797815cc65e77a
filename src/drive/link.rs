//! The output for everything behind a link: orders for robots and arms, guidance for people, answers to requests.
//!
//! Main type: [`LinkOutput`]. Whatever comes back from a link is an input of the fleet. Refuses: to determine how
//! either travels.

use crate::{Released, Sent};
use giveway_cell::arm::ArmOrder;
use giveway_fleet::{CellWarning, Command, Guidance, Reply, Step, Token};
use giveway_floor::id::{RobotId, WorkerId};

/// The output at one moment.
#[derive(Clone, Copy, Debug, Default)]
pub struct LinkOutput<'a> {
    /// Stops, slow-downs and their ends.
    pub limits: &'a [(RobotId, Command)],
    /// Orders to robots.
    pub orders: &'a [(RobotId, Command)],
    /// Guidance for workers.
    pub guidance: &'a [(WorkerId, Guidance)],
    /// Warnings for people at work cells.
    pub warnings: &'a [CellWarning],
    /// Trajectories for robot arms.
    pub arms: &'a [ArmOrder],
    /// Answers to requests.
    pub replies: &'a [Reply],
    /// Requests that came to nothing.
    pub refused: &'a [Token],
}

impl<'a> From<&'a Sent> for LinkOutput<'a> {
    fn from(Sent { limits, guidance, warnings, arms, refused, .. }: &'a Sent) -> LinkOutput<'a> {
        LinkOutput { limits, guidance, warnings, arms, refused, ..LinkOutput::default() }
    }
}

impl<'a> From<&'a Released> for LinkOutput<'a> {
    fn from(Released { orders, replies }: &'a Released) -> LinkOutput<'a> {
        LinkOutput { orders, replies, ..LinkOutput::default() }
    }
}

impl<'a> From<&'a Step> for LinkOutput<'a> {
    /// Everything at once, without waiting for a journal.
    fn from(step: &'a Step) -> LinkOutput<'a> {
        let Step { urgent: limits, commands: orders, guidance, warnings, arms, replies, .. } = step;
        LinkOutput { limits, orders, guidance, warnings, arms, replies, refused: &[] }
    }
}
