//! What every part of the core may read: what was promised, what is seen, and the settings. Nothing can be changed
//! through it.
//!
//! Main type: [`Floor`]. Each part of the core adds its own queries. Refuses: to know of people, routes to come, or
//! anything else that a part keeps to itself.

use super::at_hand::AtHand;
use super::job::Job;
use super::kind::{ObeyedLimits, RobotKind};
use super::ledger::Ledger;
use super::regions::KindRegions;
use super::restrictions::Restrictions;
use super::scene::Scene;
use super::storage::Storage;
use super::visits::Visits;
use super::wait_graph::WaitGraph;
use crate::state::settings::Settings;
use giveway_floor::geometry::Point;
use giveway_floor::id::{BodyId, NodeId, RobotId};
use giveway_floor::route::{Conditions, Kinematics};
use giveway_floor::timeline::Visit;
use giveway_floor::warehouse::{Footprint, Warehouse};
use giveway_people::aware::Regions;
use std::sync::Arc;

/// Poses farther outside the map's nodes than this are absurd, metres.
const MARGIN_M: f64 = 3.0;

/// The floor as it is now.
#[derive(Clone, Copy)]
pub struct Floor<'a> {
    /// What was promised.
    pub ledger: &'a Ledger,
    /// What is seen.
    pub scene: &'a Scene,
    /// The settings.
    pub settings: &'a Settings,
    /// How people, closed areas and displaced robots restrict robots.
    pub restrictions: &'a Restrictions,
    /// What robots and workers wait for, as of the end of the last step.
    pub waits: &'a WaitGraph,
    /// How near robots of each kind come to people, and how fast they drive there.
    pub regions: &'a KindRegions,
    /// What the map says about storage.
    pub storage: &'a Storage,
    /// What is remembered about visits at work cells.
    pub visits: &'a Visits,
    /// The robot that is being dealt with.
    pub at_hand: &'a AtHand,
}

impl<'a> Floor<'a> {
    /// The building.
    pub fn warehouse(&self) -> &'a Arc<Warehouse> {
        self.ledger.warehouse()
    }

    /// The kind of a robot.
    pub fn kind(&self, robot: RobotId) -> &'a RobotKind {
        self.ledger.kinds().of(&self.ledger.robots[robot].kind)
    }

    /// Which speed limits a robot obeys: what its kind obeys, or less if its link has seen that.
    pub fn obeyed_limits(&self, robot: RobotId) -> ObeyedLimits {
        let seen = self.scene.link(robot).map_or(ObeyedLimits::Speeds, |link| link.limits);
        self.kind(robot).capabilities.limits.max(seen)
    }

    /// The kind of a robot, as the building knows it.
    pub fn body(&self, robot: RobotId) -> BodyId {
        self.ledger.timeline().body(robot)
    }

    /// The footprint of a robot, with the rack that it carries, if any.
    pub fn footprint(&self, robot: RobotId) -> &'a Footprint {
        self.warehouse().footprint(self.body(robot), self.ledger.rack_on(robot).is_some())
    }

    /// Half of a robot plus half of a person beside it, metres.
    pub fn beside_m(&self, robot: RobotId, person_m: f64) -> f64 {
        self.footprint(robot).half_m() + person_m
    }

    /// How near a robot comes to people, and how fast it drives there.
    pub fn regions(&self, robot: RobotId) -> &'a Regions {
        self.regions.of(self.body(robot))
    }

    /// The conditions on nodes that bind a robot.
    pub fn conditions(&self, robot: RobotId) -> &'a Conditions {
        self.restrictions.conditions.of(self.body(robot))
    }

    /// Whether lanes for a robot's kind lead to a node and from it.
    pub fn may_be_at(&self, robot: RobotId, node: NodeId) -> bool {
        self.warehouse().may_be_at(self.body(robot), node)
    }

    /// Whether a node is closed, or will be soon.
    pub fn is_closing(&self, node: NodeId) -> bool {
        self.restrictions.is_closing(node)
    }

    /// How a robot moves.
    pub fn kinematics(&self, robot: RobotId) -> &'a Kinematics {
        &self.kind(robot).kinematics
    }

    /// The serial number of the visit whose centre a robot has reached, by its own report: the ledger follows later in
    /// the step, and a robot that drove on meanwhile would seem to turn back.
    pub fn reached(&self, robot: RobotId) -> u64 {
        let chain = self.ledger.chain(robot);
        let said = self.scene.robot(robot).map_or(0, |t| t.reached);
        said.clamp(chain.first(), chain.granted() - 1)
    }

    /// The visits that a robot was granted and has not reached.
    pub fn granted_ahead(self, robot: RobotId) -> impl Iterator<Item = &'a Visit> {
        let chain = self.ledger.chain(robot);
        (self.reached(robot) + 1..chain.granted()).filter_map(|serial| chain.get(serial))
    }

    /// Where a robot was last seen; the place of its node if it was never seen.
    pub fn place_of(&self, robot: RobotId) -> Point {
        let node = self.warehouse().nodes[self.ledger.node_of(robot)].at;
        self.scene.robot(robot).map_or(node, |t| t.pose.at)
    }

    /// Whether the rack of a job leaves its station when the hand is out for the last time: the rack is wanted nowhere
    /// else.
    pub fn ends_out(self, job: &Job) -> bool {
        self.settings.flow.leaves_at_last_grasp() && job.request.then.is_empty()
    }

    /// Returns a test whether a person can be at a place at all.
    pub fn is_on_map(&self) -> impl Fn(Point) -> bool + use<> {
        let (low, high) = self.warehouse().bounds();
        move |p| {
            let x = (low.x - MARGIN_M..=high.x + MARGIN_M).contains(&p.x);
            x && (low.y - MARGIN_M..=high.y + MARGIN_M).contains(&p.y)
        }
    }
}
