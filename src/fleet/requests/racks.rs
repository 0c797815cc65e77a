//! People take a rack off a robot that cannot drive, and say where they set it down.
//!
//! Main function: `take_rack_off`. The rack is in storage from then on, and its job goes on from there: a delivery
//! waits for another robot, a job to store the rack there is done. Refuses: to take a rack from a robot that can drive,
//! and a node that is taken, or that a robot is to drive over.

use crate::requests::intake::Intake;
use crate::state::fact::{RobotFact, Task};
use crate::state::job::JobState;
use crate::state::job_kind::JobKind;
use crate::state::ledger::RackAt;
use crate::state::refusal::{RackRefusal, Refusal, RobotRefusal};
use crate::state::request::{Answer, Answered};
use giveway_floor::id::{Dense, NodeId, RackId, RobotId};
use giveway_floor::time::{Time, Window};
use giveway_floor::warehouse::NodeKind;

impl Intake<'_> {
    /// Notes that a rack now stands on a storage node, and no longer on the robot.
    pub(crate) fn take_rack_off(&mut self, rack: RackId, node: NodeId, now: Time) -> Answered {
        let robot = self.robot_to_unload(rack, node, now)?;
        self.writer.record(RobotFact::RackTaken { robot, rack, node, at: now });
        match self.writer.ledger().robots[robot].task.job() {
            None => self.writer.record(RobotFact::Tasked { robot, task: Task::Idle }),
            Some(job) => {
                let record = &self.writer.ledger().jobs[&job];
                if matches!(record.state, JobState::Picking { .. }) {
                    self.writer.progress(job, JobState::Carrying { robot }, None, now);
                }
                let is_done = match self.writer.ledger().jobs[&job].request.kind {
                    JobKind::Return { .. } => true,
                    JobKind::Relocate { node: goal, .. } => goal == node,
                    _ => false,
                };
                let state = if is_done { JobState::Done } else { JobState::Waiting };
                self.writer.progress(job, state, Some((robot, Task::Idle)), now);
            }
        }
        Ok(Answer::Done)
    }

    /// The robot that has a rack on it, if people may have set that rack down on a node.
    fn robot_to_unload(&self, rack: RackId, node: NodeId, now: Time) -> Result<RobotId, Refusal> {
        let (ledger, floor) = (&self.writer.ledger(), self.writer.floor());
        if rack.ix() >= ledger.racks.len() || node.ix() >= self.writer.warehouse().nodes.len() {
            return Err(Refusal::UnknownPlace);
        }
        let RackAt::On(robot) = ledger.racks[rack] else {
            return Err(Refusal::Rack(RackRefusal::IsStored(rack)));
        };
        if !ledger.robots[robot].failed && self.writer.scene.fit(robot, now).is_some() {
            return Err(Refusal::Robot(RobotRefusal::CanDrive(robot)));
        }
        if self.writer.warehouse().kind(node) != NodeKind::Storage {
            return Err(Refusal::Rack(RackRefusal::NotStorage(node)));
        }
        let (own, ever) = (robot, Window::new(Time(i64::MIN), Time::MAX));
        let line = ledger.timeline().line(own, true, self.writer.warehouse().node_resource(node));
        let is_held = ledger.timeline().holders_during(line, ever, own).next().is_some();
        if floor.storage_taken(node, rack) || is_held {
            return Err(Refusal::Rack(RackRefusal::StorageTaken(node)));
        }
        Ok(robot)
    }
}
