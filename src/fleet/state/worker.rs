//! People on the floor as the fleet deals with them: what they are to do, what they are told, which robots they met.
//!
//! Main types: [`Assignment`], [`Closure`], [`Guidance`], [`Encounter`], [`WorkerView`]. Refuses: beliefs
//! about people (the `human` module) and decisions about robots (the step).

pub use giveway_people::human::{FeedCounts, Presence};

use super::keys::ClientKey;
use giveway_floor::geometry::{Point, Pose, Spot};
use giveway_floor::id::{AssignmentId, ClosureId, NodeId, RobotId, SeriesId, WorkerId};
use giveway_floor::time::{Span, Time, Window};
use giveway_people::human::{IntentState, Mover};

/// What a worker is to do, as submitted.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct AssignmentRequest {
    /// Where to go. At a storage node, the worker goes to the nearest place from which the rack can be reached.
    pub place: NodeId,
    /// How long the work there takes.
    pub stay: Span,
    /// What to do, in the customer's words.
    pub what: String,
    /// The customer's own key: the same key never makes a second assignment.
    pub key: Option<ClientKey>,
}

/// How far an assignment has come. `Waiting → Walking → Working → Done`; `Cancelled` ends any.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AssignmentState {
    /// The worker has another assignment first or is not on the floor, or the assignment has no worker yet.
    Waiting,
    /// The worker is on the way.
    Walking,
    /// The worker is at the place.
    Working,
    /// Done.
    Done,
    /// The assignment was cancelled.
    Cancelled,
}

impl AssignmentState {
    /// Whether nothing more will happen to the assignment.
    pub fn is_over(self) -> bool {
        matches!(self, AssignmentState::Done | AssignmentState::Cancelled)
    }

    /// The state's word on the wire.
    pub fn word(self) -> &'static str {
        match self {
            AssignmentState::Waiting => "waiting",
            AssignmentState::Walking => "walking",
            AssignmentState::Working => "working",
            AssignmentState::Done => "done",
            AssignmentState::Cancelled => "cancelled",
        }
    }
}

/// An assignment that is not over.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Assignment {
    /// The worker; nothing while the assignment waits for the nearest free one.
    pub worker: Option<WorkerId>,
    /// What is to be done.
    pub request: AssignmentRequest,
    /// How far the assignment has come.
    pub state: AssignmentState,
    /// When the assignment was accepted.
    pub accepted: Time,
}

/// Where a worker on the floor was last known to be, by the journal: to a few metres while the worker is seen, exactly
/// where the worker was lost. So a restart knows where a worker may be whose headset has been silent since.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LastPlace {
    /// The place.
    pub at: Spot,
    /// When the worker was seen there.
    pub seen: Time,
    /// How far from there the worker is at most, on foot, if a supervisor vouches for that, millimetres.
    pub within_mm: Option<i64>,
}

/// Whether a closure keeps out robots, people or both.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Binds {
    /// Robots alone: people are at work there.
    Robots,
    /// People alone.
    People,
    /// Robots and people.
    #[default]
    Both,
}

impl Binds {
    /// Whether robots are kept out.
    pub fn robots(self) -> bool {
        self != Binds::People
    }

    /// Whether people are kept out.
    pub fn people(self) -> bool {
        self != Binds::Robots
    }

    /// What a word on the wire means.
    pub fn of(word: &str) -> Option<Binds> {
        [Binds::Robots, Binds::People, Binds::Both].into_iter().find(|b| b.word() == word)
    }

    /// The word for it on the wire.
    pub fn word(self) -> &'static str {
        match self {
            Binds::Robots => "robots",
            Binds::People => "people",
            Binds::Both => "both",
        }
    }
}

/// An area that robots, people or both keep out of, marked by hand.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Closure {
    /// The outline of the area; if nodes are named, only to be shown.
    pub outline: Vec<Spot>,
    /// Exactly the nodes that are closed; if empty, all nodes from which a robot would reach into the outline.
    pub nodes: Vec<NodeId>,
    /// When the area is closed.
    pub window: Window,
    /// Why the area is closed, in the supervisor's words.
    pub reason: String,
    /// Whether the closure keeps out robots, people or both.
    pub binds: Binds,
    /// The recurring closure of which this is one occurrence, if any.
    pub series: Option<SeriesId>,
}

/// Whether a closure is ahead, in force or over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClosureState {
    /// The closure has not begun.
    Announced,
    /// The closure is in force: robots keep out.
    Closed,
    /// The closure is over: robots may drive there again.
    Over,
}

impl ClosureState {
    /// The word for it on the wire.
    pub fn word(self) -> &'static str {
        match self {
            ClosureState::Announced => "announced",
            ClosureState::Closed => "closed",
            ClosureState::Over => "over",
        }
    }
}

impl Closure {
    /// The state of the closure at a time.
    pub fn state(&self, now: Time) -> ClosureState {
        match self.window {
            w if now < w.start() => ClosureState::Announced,
            w if now < w.end() => ClosureState::Closed,
            _ => ClosureState::Over,
        }
    }
}

/// What a worker is told.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Guidance {
    /// The worker's situation.
    pub state: GuidanceState,
    /// Why the situation is not as planned, if it is not.
    pub reason: Option<GuidanceReason>,
    /// Counts up with every new path.
    pub version: u64,
    /// The path from here on, metres; empty where there is none.
    pub path: Vec<Point>,
    /// The next point to walk to.
    pub next: Option<Point>,
    /// When the worker reaches the end of the path at usual speed.
    pub eta: Option<Time>,
    /// Until about when the worker waits for a robot to pass, if told to.
    pub wait: Option<Time>,
    /// The assignment that the path is for.
    pub assignment: Option<AssignmentId>,
    /// Whether the worker is at the place of the assignment.
    pub arrived: bool,
    /// Robots nearby, nearest first.
    pub near: Vec<NearRobot>,
}

/// A worker's situation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum GuidanceState {
    /// The worker has nothing to do.
    #[default]
    Idle,
    /// The worker is on the path.
    Following,
    /// The worker is off the path.
    Deviating,
    /// The worker is off the old path, and a new one is shown.
    Redirected,
    /// The worker is to stand still.
    Stop,
}

impl GuidanceState {
    /// The word for it on the wire.
    pub fn word(self) -> &'static str {
        match self {
            GuidanceState::Idle => "idle",
            GuidanceState::Following => "following",
            GuidanceState::Deviating => "deviating",
            GuidanceState::Redirected => "redirected",
            GuidanceState::Stop => "stop",
        }
    }
}

/// Why a worker is told something other than to follow the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GuidanceReason {
    /// The worker left the path.
    LeftPath,
    /// A robot is close already and comes nearer.
    RobotComes(RobotId),
    /// A robot stands on the path and cannot leave.
    RobotInTheWay(RobotId),
    /// A robot has nowhere else to go, and waits until the worker, who has nothing to do or no way, makes room.
    RobotWaits(RobotId),
    /// A robot has waited for long and passes now: the worker stands aside for a moment.
    RobotPasses(RobotId),
    /// A robot takes the way ahead for a few seconds: by waiting, the worker gets there earlier than by any other way.
    RobotCrosses(RobotId),
    /// A robot has waited for long because the headset is unsure of its place: its wearer touches marks.
    PlaceUnsure(RobotId),
    /// The worker stands at a rack or a station that waiting jobs need, or on the only way there.
    CutsOff,
    /// The way leads round an area that is closed to people, or soon will be.
    RoundClosure(ClosureId),
    /// The area in which the worker stands is closed: the path leads out.
    LeavesClosure(ClosureId),
    /// The place of the assignment is in an area that is closed to people, or would be before the work is done.
    PlaceClosed(ClosureId),
    /// The building is evacuated: the path leads to a door.
    Evacuation,
    /// No way to the place is free.
    NoWay,
    /// The headset does not know where it is.
    NotTracked,
}

/// A robot near a worker.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearRobot {
    /// The robot.
    pub robot: RobotId,
    /// Distance between the centres, metres.
    pub distance_m: f64,
    /// Direction from the worker to the robot, radians in the map's frame.
    pub bearing: f64,
    /// Time to the closest approach if both keep moving as they do; nothing if they move apart.
    pub closest: Option<Span>,
    /// How fast the robot drives, metres per second.
    pub speed_mps: f64,
}

/// What the fleet did about an encounter, or before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Reaction {
    /// Nothing.
    Kept,
    /// The robot was slowed.
    Slowed,
    /// The robot had to wait.
    Held,
    /// The robot got another route.
    Rerouted,
    /// The robot was stopped.
    Stopped,
}

impl Reaction {
    /// The word for it on the wire.
    pub fn word(self) -> &'static str {
        match self {
            Reaction::Kept => "kept",
            Reaction::Slowed => "slowed",
            Reaction::Held => "held",
            Reaction::Rerouted => "rerouted",
            Reaction::Stopped => "stopped",
        }
    }
}

/// A moving robot came into region 1 of a worker (DESIGN §8).
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Encounter {
    /// The worker.
    pub worker: WorkerId,
    /// The robot.
    pub robot: RobotId,
    /// When the encounter began.
    pub began: Time,
    /// When the robot was out of the region again.
    pub ended: Time,
    /// Where the worker was.
    pub at: Spot,
    /// Radius of region 1 when the encounter began, millimetres.
    pub radius_mm: i64,
    /// Closest distance between the centres, millimetres.
    pub closest_mm: i64,
    /// Speed of the robot when it came into the region, millimetres per second.
    pub robot_mmps: i64,
    /// Speed of the worker at that time, millimetres per second.
    pub worker_mmps: i64,
    /// What the fleet did about the robot.
    pub reaction: Reaction,
    /// How much later the task that the robot had when the encounter began ends than was planned then, as far as is
    /// known when the encounter ends.
    pub delay: Span,
}

/// One worker, as outsiders see it.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkerView {
    /// The name.
    pub name: String,
    /// What the worker moves as.
    pub mover: Mover,
    /// How well the worker's place is known.
    pub presence: Presence,
    /// The last pose, if there was any.
    pub pose: Option<Pose>,
    /// When the last pose was seen.
    pub seen: Option<Time>,
    /// Speed, metres per second.
    pub speed_mps: f64,
    /// One standard deviation of the position, metres, grown with silence.
    pub accuracy_m: f64,
    /// Where a lost worker may be by now: nodes within the way that the worker may have walked, round walls and racks.
    /// Empty while the worker is seen.
    pub area: Vec<NodeId>,
    /// Radii of regions 1, 2 and 3, metres, for a robot without a rack.
    pub regions_m: [f64; 3],
    /// What the worker is told.
    pub guidance: Guidance,
    /// Where the worker may be going, with probabilities, most probable first.
    pub goals: Vec<(Point, f64)>,
    /// Probability that nothing can be said yet.
    pub undecided: f64,
    /// Probability that the worker is going somewhere else.
    pub elsewhere: f64,
    /// What the worker has most probably been doing, the oldest first.
    pub episodes: Vec<WorkerEpisode>,
    /// What became of the sightings of the worker.
    pub feed: FeedCounts,
}

/// A span of time in which a worker was most probably doing the same thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkerEpisode {
    /// What the worker was doing.
    pub state: IntentState,
    /// Where the goal is, if the worker had one.
    pub place: Option<Point>,
    /// When the span began.
    pub since: Time,
}

/// A closed area, as outsiders see it.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosureView {
    /// The number of the closure.
    pub id: ClosureId,
    /// The area.
    pub closure: Closure,
}
