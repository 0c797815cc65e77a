//! Why the fleet refuses a request.
//!
//! Main type: [`Refusal`], nested by what is refused. Refuses: to put it into words; the API does.

use giveway_cell::{LineProblem, LineRefusal};
use giveway_floor::id::{
    AssignmentId, ClosureId, JobId, NodeId, RackId, RobotId, SeriesId, StationId, WorkerId,
};
use giveway_floor::warehouse::NodeKind;

/// Limits on how many of something the fleet accepts at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Bounded {
    /// Jobs that are not over.
    Jobs,
    /// Assignments that are not over.
    Assignments,
    /// Robots that have joined.
    Robots,
    /// Workers who are known.
    Workers,
    /// Closures that are announced, in force, or over since less than a day.
    Closures,
    /// Recurring closures.
    Series,
    /// Robot kinds, including those of the site.
    Kinds,
}

/// Why a request is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Refusal {
    /// A job cannot be accepted, changed or cancelled as asked.
    Job(JobRefusal),
    /// What is asked or said about a visit to a station cannot be accepted.
    Pick(PickRefusal),
    /// A rack cannot be there, or cannot be moved as asked.
    Rack(RackRefusal),
    /// A robot cannot do what is asked of it.
    Robot(RobotRefusal),
    /// A worker cannot be dealt with as asked.
    Worker(WorkerRefusal),
    /// An area cannot be closed or opened, or the building cannot be evacuated.
    Area(AreaRefusal),
    /// A robot kind cannot be added or removed.
    Kind(KindRefusal),
    /// There is no such rack, station, node or robot.
    UnknownPlace,
    /// The map has no charger, or no parking place.
    NoSuchPlace(NodeKind),
    /// The fleet already has this many of them, and accepts no more.
    TooMany(Bounded, usize),
}

impl From<LineRefusal> for Refusal {
    fn from(why: LineRefusal) -> Refusal {
        Refusal::Pick(PickRefusal::Line(why))
    }
}

/// Why a job is not accepted, changed, cancelled or given to another robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum JobRefusal {
    /// No job has this number.
    Unknown(JobId),
    /// The job is already over.
    IsOver(JobId),
    /// A robot already works on the job.
    HasBegun(JobId),
    /// The job's rack stands at its station, or is on its way to where it is to stay.
    CannotBeTaken(JobId),
    /// This kind of job names its robot.
    NamesItsRobot(&'static str),
    /// The robot can never do the job.
    NotForRobot(RobotId),
    /// A rack cannot go on from a station to the same one, and only deliveries go to stations.
    SameStationTwice,
    /// The job is to come after a job that does not exist.
    UnknownPredecessor(JobId),
    /// The job comes after more other jobs than it may.
    TooManyBefore(usize),
    /// A priority is a number from 0 to 9.
    Priority(u8),
    /// The deadline of the job is in the past.
    DeadlineIsOver,
    /// Jobs of this kind have no station that could be changed.
    HasNoStation(&'static str),
    /// Jobs of this kind name no robot.
    HasNoRobot(&'static str),
}

/// Why a visit to a station, or what is said about one, is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PickRefusal {
    /// No robot stands at the station with a rack to pick from.
    NothingThere(StationId),
    /// A line (counted from 0) of one of the job's stations (counted from 0) cannot be picked.
    CannotPick(usize, usize, LineProblem),
    /// A job must have lines for each of its stations, or for none.
    LinesPerStation,
    /// What is said about a line cannot be accepted.
    Line(LineRefusal),
}

/// Why a rack cannot be there, or cannot be moved as asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RackRefusal {
    /// Racks go onto storage nodes only.
    NotStorage(NodeId),
    /// The storage node has a rack, or is promised to one.
    StorageTaken(NodeId),
    /// The rack is on no robot.
    IsStored(RackId),
    /// No robot kind can carry the rack and drive both to it and to where it is wanted.
    NoKindFor(RackId),
}

/// Why a robot cannot join, leave, drive to a node or give up its rack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RobotRefusal {
    /// There is no robot kind of this name.
    UnknownKind,
    /// No lanes for robots of that kind lead to the node and from it.
    NotForKind(NodeId),
    /// The robot has left the floor.
    IsGone(RobotId),
    /// Another robot holds the node, or is promised it.
    PlaceTaken(NodeId),
    /// The robot with the rack can drive: it sets the rack down itself.
    CanDrive(RobotId),
    /// The floor has no link, so the robot would never be heard of.
    NoLink,
    /// The floor has no link of this name.
    UnknownLink,
    /// The floor has several links, and the request does not say over which one the robot is reached.
    WhichLink,
}

/// Why a request about a worker, or for a worker to do something, is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum WorkerRefusal {
    /// No worker has this number.
    Unknown(WorkerId),
    /// The worker is on the floor, or has something to do: the place is not free.
    Busy(WorkerId),
    /// The worker is seen, or not on the floor: there is no place to vouch for.
    NotLost(WorkerId),
    /// No person can stand there, or so near to it that it would narrow anything.
    NoPlaceForPeople,
    /// No assignment has this number, or it is over.
    UnknownAssignment(AssignmentId),
    /// People cannot walk to this node.
    OutOfReach(NodeId),
}

/// Why an area is not closed or opened, or the building is not evacuated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AreaRefusal {
    /// No area is closed under this number.
    UnknownClosure(ClosureId),
    /// No recurring closure has this number.
    UnknownSeries(SeriesId),
    /// An area needs at least three corners and some time.
    Empty,
    /// An area has more corners than it may.
    TooManyCorners(usize),
    /// A closure recurs too often, before an occurrence is over, or never.
    Recurrence,
    /// The map has no doors.
    NoExits,
}

/// Why a robot kind is not added, replaced or removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum KindRefusal {
    /// The site's file has a kind of this name.
    OfSite,
    /// No kind of this name was added.
    Unknown,
    /// This many robots are of the kind, or were when they left and may come back.
    InUse(usize),
    /// The kind's outlines reach beyond those for which the map was drawn.
    TooLarge,
    /// Holds on this floor are too short for the kind.
    Clearance,
}
