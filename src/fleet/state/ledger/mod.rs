//! What was promised: jobs, holds, routes, racks. A fold over facts, durable.
//!
//! Main types: [`Ledger`], [`Promises`], [`Robot`]. Its fields are private to this folder: [`Ledger::evolve`] is the
//! only code that changes what was promised. Refuses: to plan, to read a clock, to know where anything is seen.

mod evolve;
mod parts;
mod refit;
mod upkeep;

pub use parts::{Contradiction, Parts};

use crate::state::fact::{Act, Stop, Task};
use crate::state::index::Index;
use crate::state::job::Job;
use crate::state::keys::Keys;
use crate::state::kinds::RobotKinds;
use crate::state::recurring::RecurringClosure;
use crate::state::wishes::Wishes;
use crate::state::worker::{Assignment, Closure, LastPlace};
use giveway_cell::Lines;
use giveway_floor::id::{
    AssignmentId, ClosureId, IdVec, JobId, NodeId, RackId, RobotId, SeriesId, StationId, WorkerId,
};
use giveway_floor::time::{Span, Time};
use giveway_floor::timeline::{Chain, Timeline, Visit};
use giveway_floor::warehouse::Warehouse;
use giveway_people::human::{Mover, Vehicle};
use std::collections::BTreeMap;
use std::ops::Deref;
use std::sync::Arc;

/// Where a rack is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RackAt {
    /// On a storage node.
    Stored(NodeId),
    /// On a robot.
    On(RobotId),
}

/// A visit whose rack has left before its last line was confirmed: the piece is on its way to the tote.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unconfirmed {
    /// The job, which is done except for this.
    pub job: JobId,
    /// The job's lines at this station.
    pub lines: Lines,
}

/// Whether a robot works on this floor: by registration, maintenance and leaving.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Service {
    /// The robot works.
    #[default]
    Works,
    /// The robot is to be maintained, or is being maintained: it takes no jobs.
    Maintenance {
        /// Since when the robot is in maintenance.
        since: Time,
    },
    /// The robot is to leave: it finishes what it has begun, and is gone when it is no longer heard of.
    Leaving {
        /// Since when the robot is to leave.
        since: Time,
    },
    /// The robot has left. If it is registered again, it works again.
    Gone {
        /// Since when the robot has been gone.
        since: Time,
    },
}

impl Robot {
    /// Whether the robot has left the floor.
    pub fn is_gone(&self) -> bool {
        matches!(self.service, Service::Gone { .. })
    }
}

/// A robot's record in the ledger: what it was told.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Robot {
    /// The robot's name.
    pub name: String,
    /// The name of the robot's kind.
    pub kind: String,
    /// The name of the link over which the robot is reached.
    pub link: String,
    /// What the robot is doing.
    pub task: Task,
    /// Stops ahead, in order.
    pub stops: Vec<Stop>,
    /// The serial number of the last stop at which the robot is done.
    pub acted: Option<u64>,
    /// Whether the robot cannot drive.
    pub failed: bool,
    /// Whether the robot's route was cut and not yet replaced.
    pub interrupted: bool,
    /// Since when the robot is to stand, by hand.
    pub paused: Option<Time>,
    /// Since when the robot is fenced off, because what is promised about it contradicts itself.
    pub fenced: Option<Time>,
    /// Whether the robot works on this floor.
    pub service: Service,
    /// How often the robot forgot what it was granted.
    pub recalls: u64,
}

/// What was promised, except for the holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Promises {
    /// Jobs that are not over.
    pub jobs: BTreeMap<JobId, Job>,
    /// The number of the next job.
    pub next_job: u64,
    /// Customers' keys of jobs, over or not.
    pub keys: Keys<JobId>,
    /// All robots.
    pub robots: IdVec<RobotId, Robot>,
    /// Where each rack is.
    pub racks: IdVec<RackId, RackAt>,
    /// Racks served per station.
    pub served: IdVec<StationId, u64>,
    /// All workers' names.
    pub workers: IdVec<WorkerId, String>,
    /// Workers on the floor, with where each was last known to be.
    pub on_floor: BTreeMap<WorkerId, LastPlace>,
    /// Workers who drive a vehicle; all others are on foot.
    pub vehicles: BTreeMap<WorkerId, Vehicle>,
    /// Assignments that are not over.
    pub assignments: BTreeMap<AssignmentId, Assignment>,
    /// The number of the next assignment.
    pub next_assignment: u64,
    /// Customers' keys of assignments, over or not.
    pub assignment_keys: Keys<AssignmentId>,
    /// Closed areas.
    pub closures: BTreeMap<ClosureId, Closure>,
    /// The number of the next closure.
    pub next_closure: u64,
    /// Recurring closures: areas that are closed again and again.
    pub recurring: BTreeMap<SeriesId, RecurringClosure>,
    /// The number of the next recurring closure.
    pub next_series: u64,
    /// Since when people are to leave the building.
    pub evacuation: Option<Time>,
    /// Stations at which picking is paused, and since when.
    pub paused_stations: BTreeMap<StationId, Time>,
    /// For each station the visit whose rack left at the last grasp, until its last line is confirmed.
    pub unconfirmed: BTreeMap<StationId, Unconfirmed>,
    /// Since when the whole fleet is to stand, by hand.
    pub stopped: Option<Time>,
    /// Jobs that were cancelled or failed lately, with when: jobs that are to come after them fail as well.
    pub ended_badly: BTreeMap<JobId, Time>,
    /// Sums over facts.
    pub counts: Sums,
    /// How often each rack was wanted lately.
    pub wishes: Wishes,
}

/// Everything that was promised. It is read like the [`Promises`] in it; only facts change it.
#[derive(Clone, Debug, PartialEq)]
pub struct Ledger {
    promises: Promises,
    /// All kinds of robots: the building is for them.
    kinds: RobotKinds,
    /// All holds.
    timeline: Timeline,
    /// What can be looked up instead of searched. It follows from the rest: see [`Ledger::reindex`].
    index: Index,
}

impl Deref for Ledger {
    type Target = Promises;

    fn deref(&self) -> &Promises {
        &self.promises
    }
}

/// Sums over facts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Sums {
    /// Racks served at stations.
    pub robot_deliveries: u64,
    /// Assignments completed by workers.
    pub human_deliveries: u64,
    /// Jobs done.
    pub done: u64,
    /// Jobs cancelled.
    pub cancelled: u64,
    /// Jobs that could not be done.
    pub failed: u64,
    /// Encounters of robots and workers.
    pub encounters: u64,
    /// How often a worker left the path.
    pub deviations: u64,
    /// How often a robot had to stop or to change its route because of a worker.
    pub interruptions: u64,
}

impl Ledger {
    /// Whether a worker has this number: it was given, and the worker who got it last has not left for good.
    pub fn knows(&self, worker: WorkerId) -> bool {
        self.promises.workers.get(worker).is_some_and(|name| !name.is_empty())
    }

    /// What a worker moves as.
    pub fn mover(&self, worker: WorkerId) -> Mover {
        self.promises.vehicles.get(&worker).map_or(Mover::OnFoot, |vehicle| Mover::Vehicle(*vehicle))
    }

    /// All kinds of robots: those of the site, and those that were added.
    #[inline]
    pub fn kinds(&self) -> &RobotKinds {
        &self.kinds
    }

    /// How many robots are of a kind, or were when they left the floor.
    pub fn robots_of(&self, kind: &str) -> usize {
        self.promises.robots.iter().filter(|r| r.kind == kind).count()
    }

    /// Robots of a kind that does not exist, each with the name of the kind: the site's file had it once.
    pub fn unknown_kinds(&self) -> Vec<(&str, &str)> {
        let unknown = self.promises.robots.iter().filter(|r| self.kinds.named(&r.kind).is_none());
        unknown.map(|r| (r.name.as_str(), r.kind.as_str())).collect()
    }

    /// The building, for all kinds of robots.
    #[inline]
    pub fn warehouse(&self) -> &Arc<Warehouse> {
        self.timeline.warehouse()
    }

    /// The visits of a robot.
    #[inline]
    pub fn chain(&self, robot: RobotId) -> &Chain {
        self.timeline.chain(robot).expect("every robot stands somewhere")
    }

    /// The node on which a robot stands or which it passed last.
    #[inline]
    pub fn node_of(&self, robot: RobotId) -> NodeId {
        self.chain(robot).visits().next().expect("every robot stands somewhere").node
    }

    /// Whether a robot stands at its station and the pick has not ended.
    pub fn is_picked_from(&self, robot: RobotId) -> bool {
        let here = self.chain(robot).first();
        let stop = self.robots[robot].stops.first();
        stop.is_some_and(|s| s.serial == here && matches!(s.act, Act::Pick(_)))
    }

    /// The rack on a robot.
    #[inline]
    pub fn rack_on(&self, robot: RobotId) -> Option<RackId> {
        let rack = self.robots[robot].task.carried()?;
        (self.racks[rack] == RackAt::On(robot)).then_some(rack)
    }

    /// The robots that are on the floor, by number.
    pub fn present(&self) -> impl Iterator<Item = RobotId> + use<> {
        let present = self.index.present().clone();
        (0..present.len()).map(move |i| present[i])
    }

    /// All holds.
    #[inline]
    pub fn timeline(&self) -> &Timeline {
        &self.timeline
    }

    /// What can be looked up instead of searched.
    pub fn index(&self) -> &Index {
        &self.index
    }

    /// Has the queue of waiting jobs go by this time from now on.
    pub fn advance_queue(&mut self, now: Time) {
        self.index.queue.advance(now);
    }

    /// The robot that stands on a node, or will be there in the end.
    pub fn resident(&self, node: NodeId) -> Option<RobotId> {
        self.index.places.resident(node)
    }
}

/// A visit that stands on a node for ever.
pub fn stand(node: NodeId, at: Time) -> Visit {
    let (loaded, stay) = (false, Span::ZERO);
    Visit { node, lane: None, loaded, enter: at, arrive: at, depart: Time::MAX, leave: Time::MAX, stay }
}
