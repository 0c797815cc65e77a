//! What happens to a robot, and what it is doing.
//!
//! Main types: [`RobotFact`], [`Task`]. Refuses: routes, which are in [`super::route`].

use super::route::Act;
use giveway_floor::id::{JobId, NodeId, RackId, RobotId};
use giveway_floor::time::Time;

/// Something that happened to a robot.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
#[repr(isize)]
pub enum RobotFact {
    /// A robot joined the fleet, standing on a node. Robots are numbered in order of joining.
    Registered {
        /// The new number.
        robot: RobotId,
        /// The robot's name.
        name: String,
        /// The name of the robot's kind.
        kind: String,
        /// Where the robot stands.
        node: NodeId,
        /// Time of the fact.
        at: Time,
    } = 0,
    /// A robot has another task, on which no job's state depends.
    Tasked {
        /// The robot.
        robot: RobotId,
        /// The new task.
        task: Task,
    } = 5,
    /// A robot has failed: it no longer works.
    Failed {
        /// The robot.
        robot: RobotId,
        /// Time of the fact.
        at: Time,
    } = 13,
    /// A robot works again.
    Repaired {
        /// The robot.
        robot: RobotId,
        /// Time of the fact.
        at: Time,
    } = 14,
    /// What is promised about a robot contradicts itself: the robot is treated as failed, whatever it reports, until a
    /// person releases it.
    Fenced {
        /// The robot.
        robot: RobotId,
        /// Time of the fact.
        at: Time,
    } = 15,
    /// A robot goes to maintenance, or comes back.
    Maintenance {
        /// The robot.
        robot: RobotId,
        /// Since when the robot is in maintenance; nothing if it works again.
        since: Option<Time>,
    } = 41,
    /// A robot is to leave the floor.
    Retired {
        /// The robot.
        robot: RobotId,
        /// Time of the fact.
        at: Time,
    } = 42,
    /// A robot has left the floor: it no longer holds anything.
    Left {
        /// The robot.
        robot: RobotId,
        /// Time of the fact.
        at: Time,
    } = 43,
    /// A robot that had left stands on the floor again.
    Returned {
        /// The robot.
        robot: RobotId,
        /// The name of the robot's kind.
        kind: String,
        /// Where the robot stands.
        node: NodeId,
        /// Time of the fact.
        at: Time,
    } = 44,
    /// A robot is reached over another link from now on.
    Linked {
        /// The robot.
        robot: RobotId,
        /// The name of the link.
        link: String,
    } = 49,
    /// People took the rack off a robot that cannot drive, and set it down on a storage node. What the robot was to do
    /// with the rack is no longer done.
    RackTaken {
        /// The robot.
        robot: RobotId,
        /// The rack.
        rack: RackId,
        /// The storage node where the rack stands now.
        node: NodeId,
        /// Time of the fact.
        at: Time,
    } = 45,
}

/// What a robot is doing. `Idle → Fetch → Deliver → Store → Idle`; `Fetch → Store` for relocations; `Idle → Move
/// → Idle`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Task {
    /// Nothing: the robot stands where it may stay.
    Idle,
    /// The robot goes to a rack and lifts it.
    Fetch {
        /// The job; nothing if the job is over while the robot may already drive to the rack and lift it.
        job: Option<JobId>,
        /// The rack.
        rack: RackId,
        /// Where the rack stands.
        node: NodeId,
    },
    /// The robot carries a rack to a station; its route goes on to `store`.
    Deliver {
        /// The job.
        job: JobId,
        /// The rack.
        rack: RackId,
        /// Where the robot stands while a person picks.
        station: NodeId,
        /// The storage node reserved for the rack.
        store: NodeId,
    },
    /// The robot brings a rack to a storage node and sets it down.
    Store {
        /// The job that ends when the rack is set down; nothing if the job ended at the station.
        job: Option<JobId>,
        /// The rack.
        rack: RackId,
        /// The storage node.
        store: NodeId,
    },
    /// The robot goes to `goal` without a rack, and on to `stay` if it cannot stay at `goal`.
    Move {
        /// The job, if a customer sent the robot.
        job: Option<JobId>,
        /// The node that the robot is sent to.
        goal: NodeId,
        /// The node where the robot stays in the end.
        stay: NodeId,
        /// Why the robot goes there.
        purpose: Purpose,
    },
}

/// Why a robot moves without a rack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Purpose {
    /// To charge.
    Charge,
    /// To be out of the way.
    Park,
    /// Because a customer wants it.
    Go,
}

impl Task {
    /// The task to go to a node for no customer, and stay there.
    pub fn rest_at(stay: NodeId, purpose: Purpose) -> Task {
        Task::Move { job: None, goal: stay, stay, purpose }
    }

    /// The job that the task serves.
    pub fn job(&self) -> Option<JobId> {
        match *self {
            Task::Deliver { job, .. } => Some(job),
            Task::Fetch { job, .. } | Task::Store { job, .. } | Task::Move { job, .. } => job,
            Task::Idle => None,
        }
    }

    /// Whether this task asks for an action that a route has the robot do.
    pub fn asks_for(&self, act: Act) -> bool {
        match (act, *self) {
            (Act::Lift(rack), Task::Fetch { rack: wanted, .. }) => rack == wanted,
            (Act::Set(rack), Task::Store { rack: wanted, .. } | Task::Deliver { rack: wanted, .. }) => {
                rack == wanted
            }
            (Act::Pick(_), Task::Deliver { .. }) | (Act::Arrive, Task::Move { .. }) => true,
            (Act::Lift(_) | Act::Set(_) | Act::Pick(_) | Act::Arrive, _) => false,
        }
    }

    /// The rack that the robot carries while on this task.
    pub fn carried(&self) -> Option<RackId> {
        match *self {
            Task::Deliver { rack, .. } | Task::Store { rack, .. } => Some(rack),
            Task::Idle | Task::Fetch { .. } | Task::Move { .. } => None,
        }
    }

    /// The node on which the robot ends, and which may be promised to no other robot.
    pub fn destination(&self) -> Option<NodeId> {
        match *self {
            Task::Idle => None,
            Task::Fetch { node, .. } => Some(node),
            Task::Deliver { store, .. } | Task::Store { store, .. } => Some(store),
            Task::Move { stay, .. } => Some(stay),
        }
    }
}

impl RobotFact {
    /// The robot that the fact is about.
    pub(crate) fn robot(&self) -> RobotId {
        match self {
            RobotFact::Registered { robot, .. }
            | RobotFact::Tasked { robot, .. }
            | RobotFact::Failed { robot, .. }
            | RobotFact::Repaired { robot, .. }
            | RobotFact::Fenced { robot, .. }
            | RobotFact::Maintenance { robot, .. }
            | RobotFact::Retired { robot, .. }
            | RobotFact::Left { robot, .. }
            | RobotFact::Returned { robot, .. }
            | RobotFact::Linked { robot, .. }
            | RobotFact::RackTaken { robot, .. } => *robot,
        }
    }
}
