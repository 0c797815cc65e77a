//! What traffic keeps in mind from step to step: planners, robots in need of a route, why grants were withheld.
//!
//! Main types: [`Traffic`], [`Withheld`]. Refuses: to decide.

use crate::state::floor::Floor;
use crate::state::needs::Needs;
use crate::state::planners::Planners;
use giveway_floor::id::{IdVec, NodeId, ResourceId, RobotId};
use giveway_floor::route::Cause;
use giveway_floor::time::{Span, Time};
use std::collections::{BTreeMap, BTreeSet};

/// Why the visit after the last granted one was not granted. The grant itself finds it, and *why waiting* reads it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Withheld {
    /// Nothing is reserved beyond.
    End,
    /// What the robot is to do at a stop is not done.
    Stop,
    /// It is not due for a while.
    Early,
    /// This holder comes first on this resource.
    Turn(ResourceId, RobotId),
    /// It would meet a person, a closed area or a robot that stands there; until then, where that is known.
    Condition(Cause, Option<Time>),
}

/// Where a robot goes on to from between two nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// To the node that it was on its way to.
    Forward,
    /// To the node that it reached last.
    Back,
}

/// A place that is closed for a while because a robot could not get there.
#[derive(Clone, Copy, Debug)]
pub struct Obstruction {
    /// The robot that was kept from it last.
    pub by: RobotId,
    /// The node that this robot had come from.
    pub from: NodeId,
    /// Since when it is closed.
    pub since: Time,
    /// When it is tried again.
    pub until: Time,
    /// Whether the robot reported that something stands there.
    pub said: bool,
}

/// How often routes were searched for. It promises nothing to any robot, so it is no fact and starts at zero with the
/// process.
#[derive(Clone, Copy, Debug, Default)]
pub struct SearchCounts {
    pub plans: u64,
    pub failures: u64,
    pub replans: u64,
    pub insertions: InsertionCounts,
}

/// How often a route was inserted by moving others, and what that gained.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Hash)]
pub struct InsertionCounts {
    /// How often a robot without a route looked for one that moves others.
    pub tried: u64,
    /// How often all of them got routes.
    pub succeeded: u64,
    /// How often, of these, the robot would have had no route behind the others, so that nothing compares.
    pub only_way: u64,
    /// By how much all of them arrive earlier, in sum, than if the others had been planned first and the robot last;
    /// over the insertions for which that was possible.
    pub gain: Span,
}

/// Labels that the searches of one step have expanded, and how many they may together. A search that has begun may use
/// all that one search may.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    pub spent: u32,
    pub whole: u32,
}

impl Effort {
    /// None of what one step may take is spent.
    pub fn of_a_step(floor: Floor<'_>) -> Effort {
        Effort { spent: 0, whole: floor.settings.expansions_per_step }
    }

    pub fn spend(&mut self, labels: u32) {
        self.spent += labels;
    }

    /// What is left of it.
    pub fn left(self) -> u32 {
        self.whole.saturating_sub(self.spent)
    }

    pub fn is_spent(self) -> bool {
        self.spent >= self.whole
    }
}

/// What is kept in mind about routes and grants, from step to step. Lost at a restart, and found out again.
#[derive(Clone, Debug)]
pub struct Traffic {
    pub planners: Planners,
    pub needs: Needs,
    pub tally: SearchCounts,
    pub effort: Effort,
    /// How long searches took, nanoseconds by the stopwatch of the settings.
    pub plan_times: Vec<u64>,
    /// Robots of which the ledger knew at the start and that have not been heard of since.
    pub(super) unheard: BTreeSet<RobotId>,
    /// When the first step was, if there were such robots.
    pub(super) started: Option<Time>,
    /// Why the last step granted each robot no more than it did.
    pub(super) withheld: IdVec<RobotId, Option<Withheld>>,
    /// When each robot's grant was revoked last, while it stood.
    pub(super) revoked: BTreeMap<RobotId, Time>,
    /// Where robots go on to that stand between two nodes, and since when.
    pub(super) directions: BTreeMap<RobotId, (Direction, Time)>,
    /// Places that robots could not get to and chargers without current, as robots reported.
    pub(super) obstructions: BTreeMap<NodeId, Obstruction>,
    /// When each robot last looked for a route round a closed area.
    pub(super) looked_round: BTreeMap<RobotId, Time>,
    /// When each robot that stands with a rack, cut off from where the rack is to go, looks for another place next.
    pub(super) cut_off: BTreeMap<RobotId, Time>,
    /// When each robot on a way out last looked for a place to leave for, while the building is evacuated.
    pub(super) cleared: BTreeMap<RobotId, Time>,
    /// Whether robots drive to the end of what they were granted, and no further.
    pub settling: bool,
}

impl Traffic {
    /// Nothing is planned, and no robot was heard of.
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

    /// The kinds of robots have changed: there is a planner for each.
    pub(crate) fn refit(&mut self, floor: Floor<'_>) {
        self.planners = Planners::new(floor.warehouse(), floor.ledger.kinds());
    }

    /// When a robot last looked for a route round a closed area.
    pub fn looked_round(&self, robot: RobotId) -> Option<Time> {
        self.looked_round.get(&robot).copied()
    }

    /// Why the last step granted a robot no more than it did, if there was a reason.
    pub fn withheld(&self, robot: RobotId) -> Option<Withheld> {
        self.withheld.get(robot).copied().flatten()
    }

    /// Whether a robot's grant was revoked and it has not left yet.
    pub fn is_revoked(&self, robot: RobotId) -> bool {
        self.revoked.contains_key(&robot)
    }
}
