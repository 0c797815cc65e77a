//! Why a robot does not go on, in one value.
//!
//! Main type: [`Why`]. Refuses: to follow the chain of waiting; the wait-for graph does.

use crate::state::displaced::Displacement;
use giveway_floor::id::{ClosureId, NodeId, ResourceId, RobotId, StationId, WorkerId};

/// Why a robot does not go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Why {
    /// Another robot was promised the next resource first.
    WaitsFor(ResourceId, RobotId),
    /// A worker is near, or will be.
    GivesWay(WorkerId),
    /// The way leads into an area that robots keep out of.
    Closed(ClosureId),
    /// A robot stands in every place of the station to which this robot is to go.
    QueueFull(StationId),
    /// It is not this robot's turn at its station: the named robot has a place there, or comes before it.
    NotItsTurn(StationId, RobotId),
    /// Picking is paused at the station to which the robot is to go.
    StationPaused(StationId),
    /// A hand, or a robot arm, is in the opening of this station, where the robot stands or is about to come.
    HandInOpening(StationId),
    /// No route was found yet; the robot tries again.
    NoRoute,
    /// The robot cannot drive.
    Failed,
    /// The robot's emergency stop is pressed.
    EmergencyStop,
    /// A person drives the robot.
    Manual,
    /// Something that the robot cannot pass stands on its way to this node.
    Obstructed(NodeId),
    /// The robot stands at a charger and gets no current.
    Unplugged,
    /// The robot stands where nothing is held for it, or does not carry what it should.
    Displaced(Displacement),
    /// The named robot, which is displaced or cannot drive, stands on the way, and there is no way round.
    BlockedBy(RobotId),
    /// Something stands on this node on the robot's way, as another robot reported.
    WayObstructed(NodeId),
    /// The robot has not been heard of.
    Silent,
    /// The robot's link takes no orders for it, and says why.
    Refused,
    /// An operator paused the robot.
    Paused,
    /// The robot is in maintenance, and gets no jobs.
    Maintenance,
    /// The robot is to leave the floor: once switched off, it is gone.
    Leaving,
    /// The robot has left the floor.
    Gone,
    /// An operator stopped the whole fleet.
    Stopped,
    /// The building is evacuated.
    Evacuation,
}

impl Why {
    /// The station outside which the robot waits, if it waits outside one.
    pub fn station(self) -> Option<StationId> {
        match self {
            Why::QueueFull(s) | Why::NotItsTurn(s, _) | Why::StationPaused(s) => Some(s),
            _ => None,
        }
    }

    /// Whether the reason is about the robot itself, whatever happens around it: no job moves the robot, and only the
    /// robot, or the person who stopped it, ends that.
    pub fn is_by_itself(self) -> bool {
        use Why::{
            Displaced, EmergencyStop, Evacuation, Failed, Gone, Leaving, Maintenance, Manual, Paused,
            Refused, Silent, Stopped, Unplugged,
        };
        matches!(
            self,
            Failed
                | EmergencyStop
                | Manual
                | Displaced(_)
                | Silent
                | Refused
                | Paused
                | Maintenance
                | Stopped
                | Evacuation
                | Leaving
                | Gone
        ) || self == Unplugged
    }
}
