//! Why a robot does not go on, in one value.
//!
//! Main type: [`Why`]. Refuses: to follow the chain of waiting; the wait-for graph does.

use crate::state::displaced::Displacement;
use giveway_floor::id::{ClosureId, NodeId, ResourceId, RobotId, StationId, WorkerId};

/// Why a robot does not go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Why {
    /// Another holder was promised the next resource first.
    WaitsFor(ResourceId, RobotId),
    /// A worker is near, or will be.
    GivesWay(WorkerId),
    /// The way leads into an area that robots keep out of.
    Closed(ClosureId),
    /// In every place of the station to which it is to go stands a robot.
    QueueFull(StationId),
    /// It is not its turn at the station to which it is to go: this robot has a place there, or comes before it.
    NotItsTurn(StationId, RobotId),
    /// Nobody picks at the station to which it is to go.
    StationPaused(StationId),
    /// A hand, or a robot arm, is in the opening of this station, where it stands or is about to come.
    HandInOpening(StationId),
    /// No route was found yet; it tries again.
    NoRoute,
    /// It cannot drive.
    Failed,
    /// Its emergency stop is pressed.
    EmergencyStop,
    /// A person drives it.
    Manual,
    /// Something that it cannot pass stands on its way to this node.
    Obstructed(NodeId),
    /// It stands at a charger and gets no current.
    Unplugged,
    /// It stands where nothing is held for it, or does not carry what it should.
    Displaced(Displacement),
    /// This robot, which is displaced or cannot drive, stands on its way, and it finds no way round.
    BlockedBy(RobotId),
    /// Something stands on this node on its way, as another robot reported.
    WayObstructed(NodeId),
    /// It has not been heard of.
    Silent,
    /// Its link takes no orders for it, and says why.
    Refused,
    /// An operator paused it.
    Paused,
    /// It is in maintenance, and gets no jobs.
    Maintenance,
    /// It is to leave the floor: switched off, it is gone.
    Leaving,
    /// It has left the floor.
    Gone,
    /// An operator stopped the whole fleet.
    Stopped,
    /// The building is evacuated.
    Evacuation,
}

impl Why {
    /// The station outside which it is, if it is outside one.
    pub fn station(self) -> Option<StationId> {
        match self {
            Why::QueueFull(s) | Why::NotItsTurn(s, _) | Why::StationPaused(s) => Some(s),
            _ => None,
        }
    }

    /// Whether it is about the robot itself, whatever happens around it: no job moves it, and only the robot, or the
    /// person who stopped it, ends that.
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
