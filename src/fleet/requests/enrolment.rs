//! Robots that join, go to maintenance and come back.
//!
//! A robot in maintenance finishes what it has begun, takes no more jobs, and rests at a parking place until somebody
//! lets it work again: a restart forgets none of that. Refuses: robots on places that others hold, and of kinds that
//! there are not.

use crate::fleet::Fleet;
use crate::fleet::state::fact::{Fact, Purpose, Task};
use crate::fleet::state::io::{Bounded, Refusal, Reply};
use crate::fleet::state::job::JobState;
use crate::fleet::state::ledger;
use crate::id::{Dense, NodeId, RobotId};
use crate::time::{Time, Window};
use crate::timeline::Holder;
use crate::warehouse::NodeKind;

impl Fleet {
    /// A robot joins; one of this name is the same robot, wherever it stands by now.
    pub(in crate::fleet) fn register(
        &mut self,
        token: u64,
        (name, kind): (String, String),
        node: NodeId,
        now: Time,
    ) -> Result<Reply, Refusal> {
        let known = self.ledger.robots.pairs().find(|(_, r)| r.name == name).map(|(robot, _)| robot);
        if let Some(robot) = known {
            return Ok(Reply::Registered { token, robot, new: false });
        }
        if self.ledger.robots.len() >= self.settings.robots_max {
            return Err(Refusal::TooMany(Bounded::Robots, self.ledger.robots.len()));
        }
        if !self.settings.kinds.iter().any(|k| k.name == kind) {
            return Err(Refusal::UnknownKind);
        }
        if self.warehouse().nodes.get(node).is_none() {
            return Err(Refusal::UnknownPlace);
        }
        let robot = RobotId::at(self.ledger.robots.len());
        let (resource, ever) = (self.warehouse().node_resource(node), Window::new(now, Time::MAX));
        let mut others = self.ledger.timeline.holders_during(resource, ever, Holder::Robot(robot));
        if others.next().is_some() || self.floor().is_promised(node, robot) {
            return Err(Refusal::PlaceTaken(node));
        }
        drop(others);
        self.record(Fact::Registered { robot, name, kind, node, at: now });
        Ok(Reply::Registered { token, robot, new: true })
    }

    /// A robot goes to maintenance, or comes back from there.
    pub(in crate::fleet) fn maintain(
        &mut self,
        token: u64,
        robot: RobotId,
        begins: bool,
        now: Time,
    ) -> Result<Reply, Refusal> {
        let record = self.ledger.robots.get(robot).ok_or(Refusal::UnknownPlace)?;
        if record.maintenance.is_some() != begins {
            self.record(Fact::Maintenance { robot, since: begins.then_some(now) });
        }
        Ok(Reply::Done { token })
    }

    /// Robots in maintenance give back jobs that they have not begun, and go to a parking place. Where none is free
    /// they rest where they are.
    pub(in crate::fleet) fn send_to_maintenance(&mut self, now: Time) {
        for robot in ledger::all(&self.ledger.robots) {
            let record = &self.ledger.robots[robot];
            if record.maintenance.is_none() || record.failed || self.floor().is_halted(robot) {
                continue;
            }
            if self.scene.fit(robot, now).is_none() {
                continue;
            }
            match record.task {
                Task::Fetch { job: Some(job), node, .. } if !self.floor().next_stop_is_granted(robot) => {
                    let stay = self.free_place(robot, NodeKind::Parking).unwrap_or(node);
                    let task = Task::Move { job: None, goal: stay, stay, purpose: Purpose::Park };
                    self.progress(job, JobState::Waiting, Some((robot, task)), now);
                }
                Task::Idle if self.warehouse().kind(self.ledger.node_of(robot)) != NodeKind::Parking => {
                    if let Some(stay) = self.free_place(robot, NodeKind::Parking) {
                        let task = Task::Move { job: None, goal: stay, stay, purpose: Purpose::Park };
                        self.record(Fact::Tasked { robot, task });
                    }
                }
                _ => {}
            }
        }
    }
}
