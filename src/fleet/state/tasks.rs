//! What tasks, stops, stations and assignments mean: queries that several parts of the core share.
//!
//! Refuses: to change anything.

use super::fact::{Act, Task};
use super::fault::Fault;
use super::floor::Floor;
use super::job_kind::JobKind;
use super::kind::Charging;
use giveway_floor::id::{AssignmentId, NodeId, RackId, RobotId, StationId, WorkerId};
use giveway_floor::warehouse::NodeKind;

impl Floor<'_> {
    /// Whether a robot is to stand: it is paused or fenced off, all robots are stopped, or it stands by in an
    /// evacuation.
    pub fn is_halted(&self, robot: RobotId) -> bool {
        let record = &self.ledger.robots[robot];
        let by_hand = self.ledger.stopped.is_some() || record.paused.is_some() || record.fenced.is_some();
        by_hand || self.stands_by(robot)
    }

    /// Whether a robot stands because the building is evacuated and it is in no one's way.
    pub fn stands_by(&self, robot: RobotId) -> bool {
        self.ledger.evacuation.is_some() && !self.restrictions.clears_ways_out.contains(&robot)
    }

    /// Whether a robot may already drive up to its next stop, and so will do there what it was told.
    pub fn next_stop_is_granted(&self, robot: RobotId) -> bool {
        let next = self.ledger.robots[robot].stops.first();
        next.is_some_and(|s| s.serial < self.ledger.chain(robot).granted())
    }

    /// Whether another rack than `rack` stands on a storage node, or is to come there.
    pub fn storage_taken(&self, node: NodeId, rack: RackId) -> bool {
        let places = &self.ledger.index().places;
        let stands = places.rack_on(node).is_some_and(|k| k != rack);
        let promised = |t: &Task| match *t {
            Task::Deliver { store, rack: k, .. } | Task::Store { store, rack: k, .. } => {
                store == node && k != rack
            }
            Task::Idle | Task::Fetch { .. } | Task::Move { .. } => false,
        };
        stands
            || places.bound_for(node).iter().any(|r| promised(&self.ledger.robots[*r].task))
            || places.is_wanted_for_another(node, rack)
    }

    /// Whether another robot stands on a node or is sent to it.
    pub fn is_promised(&self, node: NodeId, robot: RobotId) -> bool {
        self.ledger.index().places.is_promised(node, robot)
    }

    /// Whether a robot stands at a charger and does not report that it gets no current there.
    pub fn at_charger(&self, robot: RobotId) -> bool {
        let here = self.warehouse().nodes[self.ledger.node_of(robot)].kind;
        let gets_none = || self.scene.robot(robot).is_some_and(|t| t.fault == Some(Fault::Unplugged));
        here == NodeKind::Charger && !gets_none()
    }

    /// Whether robots that cannot drive cut a robot off from all stations.
    pub fn is_shut_in(&self, robot: RobotId) -> bool {
        let (here, loaded) = (self.ledger.node_of(robot), self.ledger.rack_on(robot).is_some());
        self.restrictions.cut_off.is_shut_in(here, loaded)
    }

    /// Whether a place is closed, or will be soon, or is storage that broken robots cut off from all stations.
    pub fn is_shut_off(&self, node: NodeId) -> bool {
        self.is_closing(node) || self.restrictions.cut_off.storage().contains_key(&node)
    }

    /// Whether a job leads to a place that is closed, or will be soon, or is cut off.
    pub fn job_is_closed_off(&self, kind: &JobKind, rack_at: NodeId) -> bool {
        let goal = kind.goal(self.warehouse());
        let is_blocked = || self.restrictions.cut_off.blocks_job(self.warehouse(), kind, rack_at).is_some();
        self.is_shut_off(rack_at) || goal.is_some_and(|n| self.is_shut_off(n)) || is_blocked()
    }

    /// The action of a robot at the stop where it is, if that is not done yet.
    pub fn act_here(&self, robot: RobotId) -> Option<Act> {
        let here = self.ledger.chain(robot).first();
        let stop = self.ledger.robots[robot].stops.first().filter(|s| s.serial == here)?;
        (stop.act != Act::Arrive).then_some(stop.act)
    }

    /// Whether a robot needs a route: the stops ahead are not those of its task. A failed robot needs none.
    pub fn lacks_route(&self, robot: RobotId) -> bool {
        let record = &self.ledger.robots[robot];
        if record.failed {
            return false;
        }
        let has = |wanted: fn(&Act) -> bool| record.stops.iter().any(|s| wanted(&s.act));
        let pick = |a: &Act| matches!(a, Act::Pick(_));
        match record.task {
            Task::Idle => false,
            Task::Fetch { .. } => !has(|a| matches!(a, Act::Lift(_))),
            Task::Deliver { .. } => !has(pick),
            Task::Store { .. } => !has(|a| matches!(a, Act::Set(_))) || has(pick),
            Task::Move { goal, .. } => {
                let at = |serial: u64| self.ledger.chain(robot).get(serial).map(|v| v.node);
                !record.stops.iter().any(|s| s.act == Act::Arrive && at(s.serial) == Some(goal))
            }
        }
    }

    /// Whether a robot stands at the end of its route.
    pub fn rests(&self, robot: RobotId) -> bool {
        let chain = self.ledger.chain(robot);
        chain.first() + 1 == chain.end()
    }

    /// The station that a robot carries its rack to.
    pub fn station_of(&self, robot: RobotId) -> Option<StationId> {
        let Task::Deliver { station, .. } = self.ledger.robots[robot].task else { return None };
        self.warehouse().nodes[station].kind.reserved_for()
    }

    /// Whether a robot stands with its rack where it lifted it, until its station has room. It may step aside for a
    /// person and come back, but gets no route to the station before its turn.
    pub fn waits_for_room(&self, robot: RobotId) -> bool {
        let here = self.warehouse().kind(self.ledger.node_of(robot));
        here == NodeKind::Storage && self.station_of(robot).is_some() && self.lacks_route(robot)
    }

    /// The assignment that a worker is carrying out, or is to begin next.
    pub fn next_assignment(&self, worker: WorkerId) -> Option<AssignmentId> {
        self.ledger.index().assignments_of(worker).next()
    }

    /// Charge of a robot, 0 to 1; 0 if it was never heard of.
    pub(crate) fn battery(&self, robot: RobotId) -> f64 {
        self.scene.robot(robot).map_or(0.0, |t| t.battery)
    }

    /// Whether a robot has too little charge for any job.
    pub(crate) fn is_critical(&self, robot: RobotId) -> bool {
        self.battery(robot) < self.charging(robot).critical
    }

    /// When robots of this robot's kind charge.
    pub(crate) fn charging(&self, robot: RobotId) -> &Charging {
        &self.kind(robot).charging
    }
}
