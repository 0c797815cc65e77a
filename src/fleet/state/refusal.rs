//! Why the fleet refuses a request.
//!
//! Main type: [`Refusal`], nested by what is refused. Refuses: words for it; the API has them.

use giveway_cell::{LineProblem, LineRefusal};
use giveway_floor::id::{
    AssignmentId, ClosureId, JobId, NodeId, RackId, RobotId, SeriesId, StationId, WorkerId,
};
use giveway_floor::warehouse::NodeKind;

/// What the fleet takes a limited number of at once.
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
    /// Closures that are announced, closed, or over since less than a day.
    Closures,
    /// Recurring closures.
    Series,
    /// Kinds of robots, with those of the site.
    Kinds,
}

/// Why a request is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Refusal {
    /// What is wanted of a job cannot be.
    Job(JobRefusal),
    /// What is wanted of a visit to a station, or said about one, cannot be.
    Pick(PickRefusal),
    /// A rack cannot be there.
    Rack(RackRefusal),
    /// What is wanted of a robot cannot be.
    Robot(RobotRefusal),
    /// What is wanted of a worker cannot be.
    Worker(WorkerRefusal),
    /// An area cannot be closed or opened, or the building not be left.
    Area(AreaRefusal),
    /// A kind of robots cannot be added or removed.
    Kind(KindRefusal),
    /// There is no such rack, station, node or robot.
    UnknownPlace,
    /// The map has no charger, or no parking place.
    NoSuchPlace(NodeKind),
    /// There are as many of a kind as the fleet takes.
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
    /// The job was over already.
    IsOver(JobId),
    /// A robot works on the job already.
    HasBegun(JobId),
    /// The job's rack stands at its station, or is on its way to where it is to stay.
    CannotBeTaken(JobId),
    /// This kind of job names its robot.
    NamesItsRobot(&'static str),
    /// The robot can never do the job.
    NotForRobot(RobotId),
    /// A rack cannot go on from a station to the same one, and only deliveries go to stations.
    SameStationTwice,
    /// A job cannot come after one that does not exist.
    UnknownPredecessor(JobId),
    /// A job comes after more others than it may.
    TooManyBefore(usize),
    /// A priority is a number from 0 to 9.
    Priority(u8),
    /// A job cannot be done before now.
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
    /// A line, counted from 0, of a station of the job, counted likewise, cannot be picked.
    CannotPick(usize, usize, LineProblem),
    /// A job has lines for each of its stations, or for none.
    LinesPerStation,
    /// What is said about a line cannot be.
    Line(LineRefusal),
}

/// Why a rack does not go there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RackRefusal {
    /// Racks go onto storage nodes only.
    NotStorage(NodeId),
    /// The storage node has a rack, or is promised to one.
    StorageTaken(NodeId),
    /// The rack is on no robot.
    IsStored(RackId),
    /// No kind of robots can carry the rack, and drive to it and to where it is wanted.
    NoKindFor(RackId),
}

/// Why a robot does not join, leave, drive there or give up its rack.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RobotRefusal {
    /// There is no such kind of robots.
    UnknownKind,
    /// No lanes for robots of that kind lead to the node and from it.
    NotForKind(NodeId),
    /// The robot has left the floor.
    IsGone(RobotId),
    /// Another robot holds the node, or is promised it.
    PlaceTaken(NodeId),
    /// The robot with the rack can drive: it sets it down itself.
    CanDrive(RobotId),
    /// The floor has no link: no robot would ever be heard of.
    NoLink,
    /// The floor has no link of this name.
    UnknownLink,
    /// The floor has several links, and the robot is to say by which it is reached.
    WhichLink,
}

/// Why something is not done about a worker, or given to one to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum WorkerRefusal {
    /// No worker has this number.
    Unknown(WorkerId),
    /// The worker is on the floor, or has something to do: the place is not free.
    Busy(WorkerId),
    /// The worker is seen, or not on the floor: nobody has to vouch for the place.
    NotLost(WorkerId),
    /// Nobody can stand there, or so near to it that it would narrow anything.
    NoPlaceForPeople,
    /// No assignment has this number, or it is over.
    UnknownAssignment(AssignmentId),
    /// People cannot walk to this node.
    OutOfReach(NodeId),
}

/// Why an area is not closed or opened, or the building not left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AreaRefusal {
    /// No area is closed under this number.
    UnknownClosure(ClosureId),
    /// No recurring closure has this number.
    UnknownSeries(SeriesId),
    /// An area needs three corners and some time.
    Empty,
    /// An area has more corners than it may.
    TooManyCorners(usize),
    /// A closure recurs too often, before an occurrence is over, or never.
    Recurrence,
    /// The map has no doors.
    NoExits,
}

/// Why a kind of robots is not added, replaced or removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum KindRefusal {
    /// The site's file has a kind of this name.
    OfSite,
    /// No kind of this name was added.
    Unknown,
    /// So many robots are of the kind, or were when they left: they may come back.
    InUse(usize),
    /// Its outlines reach beyond those for which the map was drawn.
    TooLarge,
    /// Holds on this floor are too short for it.
    Clearance,
}
