//! Robots that join, go to maintenance and come back, and leave.
//!
//! A robot that is to leave finishes what it has begun, like a robot in maintenance, and is gone once it has not been
//! heard of for a while. A robot that is registered again under its name comes back.
//! A robot in maintenance finishes what it has begun, takes no more jobs, and rests at a parking place until an
//! operator lets it work again: a restart forgets none of that. Refuses: robots on places that others hold, and of
//! unknown kinds.

use crate::requests::intake::Intake;
use crate::state::fact::{Fact, RobotFact};
use crate::state::floor::Floor;
use crate::state::ledger::Service;
use crate::state::refusal::{Bounded, Refusal, RobotRefusal};
use crate::state::request::{Answer, Answered, Made};
use giveway_floor::geometry::Point;
use giveway_floor::id::{Dense, NodeId, RobotId};
use giveway_floor::time::{Time, Window};

/// A robot that is farther from all nodes than this is not on the floor, metres.
const JOINS_WITHIN_M: f64 = 3.0;

impl Intake<'_> {
    /// Lets a robot join; a robot of a known name is the same robot, wherever it stands by now.
    pub(crate) fn register(
        &mut self,
        (name, kind, link): (String, String, Option<String>),
        node: NodeId,
        now: Time,
    ) -> Answered {
        let known = self.writer.ledger().robots.pairs().find(|(_, r)| r.name == name).map(|(robot, _)| robot);
        if let Some(robot) = known.filter(|r| !self.writer.ledger().robots[*r].is_gone()) {
            return Ok(Answer::Robot(Made { id: robot, new: false }));
        }
        if known.is_none() && self.writer.ledger().robots.len() >= self.writer.settings.limits.robots {
            return Err(Refusal::TooMany(Bounded::Robots, self.writer.ledger().robots.len()));
        }
        let link = self.link_for(link)?;
        if self.writer.ledger().kinds().named(&kind).is_none() {
            return Err(Refusal::Robot(RobotRefusal::UnknownKind));
        }
        if self.writer.warehouse().nodes.get(node).is_none() {
            return Err(Refusal::UnknownPlace);
        }
        let robot = known.unwrap_or(RobotId::at(self.writer.ledger().robots.len()));
        if let Some(why) = self.writer.floor().keeps_out(robot, &kind, node) {
            return Err(Refusal::Robot(why));
        }
        self.writer.scene.forget(robot);
        self.writer.record(match known {
            None => Fact::Robot(RobotFact::Registered { robot, name, kind, node, at: now }),
            Some(_) => Fact::Robot(RobotFact::Returned { robot, kind, node, at: now }),
        });
        // The robot has the usual link until it is said to have another one.
        if self.writer.ledger().robots[robot].link != link {
            self.writer.record(RobotFact::Linked { robot, link });
        }
        Ok(Answer::Robot(Made { id: robot, new: true }))
    }

    /// The link by which a robot is reached: the named one, or the only one.
    fn link_for(&self, named: Option<String>) -> Result<String, Refusal> {
        let links = &self.writer.settings.links;
        let refused = match (named, &links[..]) {
            (_, []) => RobotRefusal::NoLink,
            (Some(name), _) if links.contains(&name) => return Ok(name),
            (Some(_), _) => RobotRefusal::UnknownLink,
            (None, [only]) => return Ok(only.clone()),
            (None, _) => RobotRefusal::WhichLink,
        };
        Err(Refusal::Robot(refused))
    }

    /// Sends a robot to maintenance; a robot that leaves goes on leaving.
    pub(crate) fn begin_maintenance(&mut self, robot: RobotId, now: Time) -> Answered {
        if self.service_of(robot)? == Service::Works {
            self.writer.record(RobotFact::Maintenance { robot, since: Some(now) });
        }
        Ok(Answer::Done)
    }

    /// Brings a robot back from maintenance, or lets it stay on the floor after all.
    pub(crate) fn end_maintenance(&mut self, robot: RobotId) -> Answered {
        match self.service_of(robot)? {
            Service::Works | Service::Gone { .. } => {}
            Service::Maintenance { .. } | Service::Leaving { .. } => {
                self.writer.record(RobotFact::Maintenance { robot, since: None });
            }
        }
        Ok(Answer::Done)
    }

    /// Has a robot leave the floor.
    pub(crate) fn retire(&mut self, robot: RobotId, now: Time) -> Answered {
        if !matches!(self.service_of(robot)?, Service::Leaving { .. }) {
            self.writer.record(RobotFact::Retired { robot, at: now });
        }
        Ok(Answer::Done)
    }

    fn service_of(&self, robot: RobotId) -> Result<Service, Refusal> {
        let record = self.writer.ledger().robots.get(robot).ok_or(Refusal::UnknownPlace)?;
        if record.is_gone() { Err(Refusal::Robot(RobotRefusal::IsGone(robot))) } else { Ok(record.service) }
    }
}

impl Floor<'_> {
    /// Why a robot of a kind cannot join on a node; nothing if it can.
    fn keeps_out(&self, robot: RobotId, kind: &str, node: NodeId) -> Option<RobotRefusal> {
        // A hold that should be over by the plan still counts until the robot has left.
        let (warehouse, ever) = (self.warehouse(), Window::new(Time(i64::MIN), Time::MAX));
        let body = warehouse.body_of(kind);
        if !warehouse.may_be_at(body, node) {
            return Some(RobotRefusal::NotForKind(node));
        }
        let line = warehouse.line(body, false, warehouse.node_resource(node));
        let is_held = self.ledger.timeline().holders_during(line, ever, robot).next().is_some();
        let in_the_way = || self.scene.all_displaced().any(|(_, d)| d.nodes.contains(&node));
        let is_taken = is_held || self.is_promised(node, robot) || in_the_way();
        is_taken.then_some(RobotRefusal::PlaceTaken(node))
    }

    /// The nearest node on which a robot of a kind could join that was found at a place: it is in others' way there
    /// before anything is held for it, and its first report says where it really is. A place that is farther than
    /// [`JOINS_WITHIN_M`] from all nodes is not on this floor.
    pub(crate) fn place_to_join(&self, kind: &str, at: Point) -> Option<NodeId> {
        self.ledger.kinds().named(kind)?;
        let next = RobotId::at(self.ledger.robots.len());
        let far = |node: &NodeId| (self.warehouse().nodes[*node].at - at).norm();
        let is_on_floor = !self.warehouse().nodes_within(at, JOINS_WITHIN_M).is_empty();
        let mut all: Vec<NodeId> = self.warehouse().nodes.ids().filter(|_| is_on_floor).collect();
        all.sort_by(|a, b| far(a).total_cmp(&far(b)));
        all.into_iter().find(|node| self.keeps_out(next, kind, *node).is_none())
    }
}
