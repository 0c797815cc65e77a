//! What people decide by hand: the whole fleet or one robot stands until a person lets it go on.
//!
//! Such an order is a fact, so a restart forgets none of it. Robots are told to stand at once, before the fact is
//! durable. Refuses: to be an emergency stop, which is the robot's own; and to take back what was promised: a robot
//! that stands keeps its holds, and robots behind it wait.

use crate::requests::intake::Intake;
use crate::state::fact::FloorFact;
use crate::state::floor::Floor;
use crate::state::refusal::Refusal;
use crate::state::request::{Answer, Answered};
use giveway_floor::id::{Dense, RobotId};
use giveway_floor::time::Time;

impl Intake<'_> {
    /// Has one robot, or the whole fleet, stand.
    pub(crate) fn halt(&mut self, robot: Option<RobotId>, now: Time) -> Answered {
        if self.writer.floor().halted_since(robot)?.is_none() {
            self.writer.record(FloorFact::Halted { robot, at: now });
        }
        Ok(Answer::Done)
    }

    /// Lets one robot, or the whole fleet, go on. A robot that was paused, or is fenced off, stays so when the fleet
    /// goes on.
    pub(crate) fn release(&mut self, robot: Option<RobotId>, now: Time) -> Answered {
        let fenced =
            robot.is_some_and(|r| self.writer.ledger().robots.get(r).is_some_and(|r| r.fenced.is_some()));
        if self.writer.floor().halted_since(robot)?.is_some() || fenced {
            self.writer.record(FloorFact::Released { robot, at: now });
        }
        Ok(Answer::Done)
    }
}

impl Floor<'_> {
    fn halted_since(&self, robot: Option<RobotId>) -> Result<Option<Time>, Refusal> {
        match robot {
            None => Ok(self.ledger.stopped),
            Some(r) if r.ix() < self.ledger.robots.len() => Ok(self.ledger.robots[r].paused),
            Some(_) => Err(Refusal::UnknownPlace),
        }
    }
}
