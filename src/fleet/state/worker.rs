//! People on the floor as the fleet deals with them: what they are to do, what they are told, which robots they met.
//!
//! Main types: [`Assignment`], [`Closure`], [`Guidance`], [`Encounter`], [`WorkerView`]. Refuses: beliefs
//! about people (the `human` module) and decisions about robots (the step).

pub use giveway_people::human::{FeedCounts, Presence};

use super::keys::ClientKey;
use giveway_floor::geometry::{Point, Pose, Spot};
use giveway_floor::id::{AssignmentId, ClosureId, NodeId, RobotId, SeriesId, WorkerId};
use giveway_floor::time::{Span, Time, Window};
use giveway_people::human::IntentState;

/// What a worker is to do, as it is handed in.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct AssignmentRequest {
    /// Where. At a storage node the worker goes to the nearest place from which the rack can be reached.
    pub place: NodeId,
    /// How long it takes there.
    pub stay: Span,
    /// What, in the customer's words.
    pub what: String,
    /// The customer's own key: the same key never makes a second assignment.
    pub key: Option<ClientKey>,
}

/// How far an assignment has come. `Waiting → Walking → Working → Done`; `Cancelled` ends any.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AssignmentState {
    /// The worker is at another one, or not on the floor; or nobody has it yet.
    Waiting,
    /// The worker is on the way.
    Walking,
    /// The worker is at the place.
    Working,
    /// Done.
    Done,
    /// Somebody cancelled it.
    Cancelled,
}

impl AssignmentState {
    /// Whether nothing will happen any more.
    pub fn is_over(self) -> bool {
        matches!(self, AssignmentState::Done | AssignmentState::Cancelled)
    }

    /// The word for it on the wire.
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
    /// The worker; nobody while it waits for the nearest one who is free.
    pub worker: Option<WorkerId>,
    /// What.
    pub request: AssignmentRequest,
    /// How far it is.
    pub state: AssignmentState,
    /// When it was accepted.
    pub accepted: Time,
}

/// Where a worker on the floor was known to be, as the journal has it: to a few metres while the worker is seen,
/// exactly where the worker was lost. So a restart knows where somebody may be whose headset is silent since.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LastPlace {
    /// Where.
    pub at: Spot,
    /// When the worker was seen there.
    pub seen: Time,
    /// How far from there the worker is at most, on foot, where a supervisor vouches for that, millimetres.
    pub within_mm: Option<i64>,
}

/// Whom a closure keeps out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Binds {
    /// Robots alone: people are at work there.
    Robots,
    /// People alone.
    People,
    /// Everybody.
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

    /// What a word on the wire stands for.
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
    /// Its outline; where nodes are named, only to be shown.
    pub outline: Vec<Spot>,
    /// Exactly the nodes that are closed; where empty, all that robots would reach into the outline from.
    pub nodes: Vec<NodeId>,
    /// When.
    pub window: Window,
    /// Why, in the supervisor's words.
    pub reason: String,
    /// Whom it keeps out.
    pub binds: Binds,
    /// The recurring closure of which it is one occurrence.
    pub series: Option<SeriesId>,
}

/// How a closure stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClosureState {
    /// It has not begun.
    Announced,
    /// Robots keep out.
    Closed,
    /// Robots may drive there again.
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
    /// How it stands at a time.
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
    /// How things stand.
    pub state: GuidanceState,
    /// Why, where it is not just as planned.
    pub reason: Option<GuidanceReason>,
    /// Counts up with every new path.
    pub version: u64,
    /// The path from here on, metres; empty where there is none.
    pub path: Vec<Point>,
    /// The next point to walk to.
    pub next: Option<Point>,
    /// When the end of the path is reached at usual speed.
    pub eta: Option<Time>,
    /// Until when, about, the worker waits for a robot to pass, if it is told to.
    pub wait: Option<Time>,
    /// What the path is for.
    pub assignment: Option<AssignmentId>,
    /// Whether the worker is at the place of the assignment.
    pub arrived: bool,
    /// Robots nearby, nearest first.
    pub near: Vec<NearRobot>,
}

/// How things stand with a worker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum GuidanceState {
    /// Nothing to do.
    #[default]
    Idle,
    /// On the path.
    Following,
    /// Off the path.
    Deviating,
    /// Off the old path, a new one is shown.
    Redirected,
    /// Stand still.
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

/// Why a worker is told something else than to follow the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GuidanceReason {
    /// The worker left the path.
    LeftPath,
    /// A robot comes nearer and is close already.
    RobotComes(RobotId),
    /// A robot stands on the path and cannot leave.
    RobotInTheWay(RobotId),
    /// A robot has nowhere else to go, and waits until the worker, who has nothing to do or no way, makes room.
    RobotWaits(RobotId),
    /// A robot has waited for long and passes now: the worker stands aside for a moment.
    RobotPasses(RobotId),
    /// A robot takes the way ahead for a few seconds: waiting for it is there earlier than any other way.
    RobotCrosses(RobotId),
    /// A robot has waited for long because the headset knows badly where it is: its wearer touches marks.
    PlaceUnsure(RobotId),
    /// The worker stands where a rack or a station is that waiting jobs need, or on the only way there.
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
    /// Which.
    pub robot: RobotId,
    /// Between the centres, metres.
    pub distance_m: f64,
    /// Direction from the worker to it, radians in the map's frame.
    pub bearing: f64,
    /// Time to the closest approach if both go on as they do; nothing where they move apart.
    pub closest: Option<Span>,
    /// How fast it drives, metres per second.
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
    /// When it began.
    pub began: Time,
    /// When the robot was out of the region again.
    pub ended: Time,
    /// Where the worker was.
    pub at: Spot,
    /// Radius of region 1 then, millimetres.
    pub radius_mm: i64,
    /// Closest distance between the centres, millimetres.
    pub closest_mm: i64,
    /// Speed of the robot when it came in, millimetres per second.
    pub robot_mmps: i64,
    /// Speed of the worker then.
    pub worker_mmps: i64,
    /// What the fleet did about the robot.
    pub reaction: Reaction,
    /// How much later the task that the robot had when it began ends than was planned then, as far as is known when the
    /// encounter ends.
    pub delay: Span,
}

/// One worker, as outsiders see it.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkerView {
    /// The name.
    pub name: String,
    /// How well the place is known.
    pub presence: Presence,
    /// The last pose, if there was any.
    pub pose: Option<Pose>,
    /// When it was seen.
    pub seen: Option<Time>,
    /// Walking speed, metres per second.
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
    /// Probability of going somewhere else.
    pub elsewhere: f64,
    /// What the worker has most probably been up to, the oldest first.
    pub episodes: Vec<WorkerEpisode>,
    /// What became of the sightings.
    pub feed: FeedCounts,
}

/// A stretch of time in which a worker was most probably up to the same thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkerEpisode {
    /// What.
    pub state: IntentState,
    /// Where the goal is, if it is one.
    pub place: Option<Point>,
    /// Since when.
    pub since: Time,
}

/// A closed area, as outsiders see it.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosureView {
    /// Its number.
    pub id: ClosureId,
    /// The area.
    pub closure: Closure,
}
