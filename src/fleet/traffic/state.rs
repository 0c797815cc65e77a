//! What traffic remembers from step to step: planners, robots in need of a route, why grants were withheld.
//!
//! Main types: [`Traffic`], [`Withheld`]. Refuses: to decide.

use crate::state::floor::Floor;
use crate::state::needs::Needs;
use crate::state::planners::Planners;
use giveway_floor::id::{IdVec, NodeId, ResourceId, RobotId};
use giveway_floor::route::Cause;
use giveway_floor::time::{Span, Time};
use std::collections::{BTreeMap, BTreeSet};

/// Why the visit after the last granted one was not granted. Granting finds the reason; *why waiting* reads it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Withheld {
    /// Nothing is reserved beyond the last granted visit.
    End,
    /// The robot has not finished its action at a stop.
    Stop,
    /// The visit is not due for a while.
    Early,
    /// This robot comes first on this resource.
    Turn(ResourceId, RobotId),
    /// The robot would meet a person, a closed area or a robot that stands there; until this time, where it is known.
    Condition(Cause, Option<Time>),
}

/// Where a robot between two nodes goes on to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// To the node that the robot was on its way to.
    Forward,
    /// To the node that the robot reached last.
    Back,
}

/// A place that is closed for a while because a robot could not get there.
#[derive(Clone, Copy, Debug)]
pub struct Obstruction {
    /// The robot that most recently could not get there.
    pub by: RobotId,
    /// The node from which that robot came.
    pub from: NodeId,
    /// When the place was closed.
    pub since: Time,
    /// When robots may try the place again.
    pub until: Time,
    /// Whether the robot reported that something stands there.
    pub said: bool,
}

/// Counts of route searches. They promise nothing to any robot, so they are no facts and start at zero with the
/// process.
#[derive(Clone, Copy, Debug, Default)]
pub struct SearchCounts {
    pub plans: u64,
    pub failures: u64,
    pub replans: u64,
    pub insertions: InsertionCounts,
}

/// How often a route was inserted by moving other robots, and what that gained.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Hash)]
pub struct InsertionCounts {
    /// How often a robot without a route looked for one that moves others.
    pub tried: u64,
    /// How often all the robots concerned got routes.
    pub succeeded: u64,
    /// How many of these insertions had no route for the robot behind the others, so that there is nothing to compare.
    pub only_way: u64,
    /// How much earlier all robots together arrive than if the others had been planned first and the robot last; summed
    /// over the insertions for which that order was possible.
    pub gain: Span,
}

/// Labels that the searches of one step have expanded, and the limit for the whole step. A search that has begun may
/// use up the budget of one search.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    pub spent: u32,
    pub whole: u32,
}

impl Effort {
    /// The effort at the start of a step: nothing is spent.
    pub fn of_a_step(floor: Floor<'_>) -> Effort {
        Effort { spent: 0, whole: floor.settings.expansions_per_step }
    }

    pub fn spend(&mut self, labels: u32) {
        self.spent += labels;
    }

    /// How many labels may still be expanded.
    pub fn left(self) -> u32 {
        self.whole.saturating_sub(self.spent)
    }

    pub fn is_spent(self) -> bool {
        self.spent >= self.whole
    }
}

/// What traffic remembers about routes and grants from step to step. A restart loses it, and it is found out again.
#[derive(Clone, Debug)]
pub struct Traffic {
    pub planners: Planners,
    pub needs: Needs,
    pub tally: SearchCounts,
    pub effort: Effort,
    /// How long searches took, nanoseconds by the stopwatch of the settings.
    pub plan_times: Vec<u64>,
    /// Robots in the ledger at the start that have not been heard of since.
    pub(super) unheard: BTreeSet<RobotId>,
    /// Time of the first step, if the ledger had robots at the start.
    pub(super) started: Option<Time>,
    /// Why the last step granted each robot no more.
    pub(super) withheld: IdVec<RobotId, Option<Withheld>>,
    /// When each robot's grant was last revoked while the robot stood.
    pub(super) revoked: BTreeMap<RobotId, Time>,
    /// The direction in which each robot that stands between two nodes goes on, and since when.
    pub(super) directions: BTreeMap<RobotId, (Direction, Time)>,
    /// Places that robots could not get to, and chargers that gave no current.
    pub(super) obstructions: BTreeMap<NodeId, Obstruction>,
    /// When each robot last looked for a route round a closed area.
    pub(super) looked_round: BTreeMap<RobotId, Time>,
    /// When each robot that stands with a rack, cut off from where the rack is to go, looks for another place next, and
    /// how often it has looked in vain.
    pub(super) cut_off: BTreeMap<RobotId, (Time, usize)>,
    /// When each robot on a way out last looked for a place to leave for, while the building is evacuated.
    pub(super) cleared: BTreeMap<RobotId, Time>,
    /// Whether robots drive to the end of what they were granted and get no further grants.
    pub settling: bool,
}

impl Traffic {
    /// The state before any planning, when no robot has been heard of.
    pub fn new(floor: Floor<'_>) -> Traffic {
        Traffic {
            planners: Planners::new(floor.warehouse(), floor.ledger.kinds()),
            needs: Needs::default(),
            tally: SearchCounts::default(),
            effort: Effort::of_a_step(floor),
            plan_times: Vec::new(),
            unheard: floor.ledger.present().collect(),
            started: None,
            withheld: IdVec::new(),
            revoked: BTreeMap::new(),
            directions: BTreeMap::new(),
            obstructions: BTreeMap::new(),
            looked_round: BTreeMap::new(),
            cut_off: BTreeMap::new(),
            cleared: BTreeMap::new(),
            settling: false,
        }
    }

    /// Makes a planner for each robot kind, after the kinds have changed.
    pub(crate) fn refit(&mut self, floor: Floor<'_>) {
        self.planners = Planners::new(floor.warehouse(), floor.ledger.kinds());
    }

    /// When a robot last looked for a route round a closed area.
    pub fn looked_round(&self, robot: RobotId) -> Option<Time> {
        self.looked_round.get(&robot).copied()
    }

    /// Why the last step granted a robot no more, if there was a reason.
    pub fn withheld(&self, robot: RobotId) -> Option<Withheld> {
        self.withheld.get(robot).copied().flatten()
    }

    /// Whether a robot's grant was revoked and it has not left yet.
    pub fn is_revoked(&self, robot: RobotId) -> bool {
        self.revoked.contains_key(&robot)
    }
}
