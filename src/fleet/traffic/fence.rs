//! A robot about which the ledger contradicts itself is fenced off, so that the others go on.
//!
//! Main function: [`Fleet::fence`]. It is treated like a robot that failed, whatever it says: it keeps what it was
//! granted, those behind it get other ways, its job goes to another. It stays so over a restart, until a person
//! releases it. Refuses: to repair anything; what is wrong is for a person to see.

use crate::fleet::Fleet;
use crate::fleet::state::fact::Fact;
use crate::id::{Dense, RobotId};
use crate::time::Time;

impl Fleet {
    /// The robot that was being dealt with when a step ended in a panic, if it was one.
    pub fn at_hand(&self) -> Option<RobotId> {
        self.at_hand
    }

    /// Fences a robot off. The facts leave with those of the next step.
    ///
    /// # Panics
    /// If even that contradicts the ledger.
    pub fn fence(&mut self, robot: RobotId, now: Time) {
        let known = robot.ix() < self.ledger.robots.len();
        if known && self.ledger.robots[robot].fenced.is_none() {
            self.record(Fact::Fenced { robot, at: now });
            self.give_up(robot, now);
        }
    }
}

/// The one robot that a fact is about.
pub(in crate::fleet) fn robot_of(fact: &Fact) -> Option<RobotId> {
    match fact {
        Fact::Registered { robot, .. }
        | Fact::Tasked { robot, .. }
        | Fact::Granted { robot, .. }
        | Fact::Passed { robot, .. }
        | Fact::Acted { robot, .. }
        | Fact::Revoked { robot, .. }
        | Fact::Placed { robot, .. }
        | Fact::Failed { robot, .. }
        | Fact::Repaired { robot, .. }
        | Fact::Fenced { robot, .. }
        | Fact::Maintenance { robot, .. } => Some(*robot),
        Fact::Routed { bookings } => match &bookings[..] {
            [only] => Some(only.robot),
            _ => None,
        },
        _ => None,
    }
}
