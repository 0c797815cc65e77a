//! One search for all robots: context-aware route planning (CARP) over free windows.
//!
//! Main types: [`RouteQuery`] (what is wanted), [`Planner`] (search, estimates and scratch memory), [`Route`]
//! (resources with windows), [`NoRoute`] (why not). Refuses: to reserve anything itself, to plan to a place where the
//! robot could not stay, and to look at a clock: effort is counted in expansions.
//!
//! Sources: ter Mors et al. 2010 (search over the graph of free windows); thesis 4.2.3 (physical and conflicting
//! timelines); `reference/carp.md`, pitfalls 1 to 6. What is ours: gaits (standing, rolling) as part of the label with
//! intervals of arrival, so that a robot may wait in order to arrive at speed; lower bounds lifted to the next free
//! window of each goal, so that a busy station does not flood the search.

mod conditions;
mod estimate;
mod label;
pub mod motion;
mod search;
mod trace;

pub use conditions::{Cause, Condition, Conditions, Effect, Exemption, NO_PEOPLE};
pub use estimate::{Estimates, Table};
pub use motion::{Kinematics, MotionState, Pace, Rules};
pub use search::COME_OUT;

use crate::id::{BodyId, NodeId};
use crate::time::{Span, Time};
use crate::timeline::{Overlay, Visit};
use crate::warehouse::Warehouse;
use std::sync::Arc;

/// One leg of a query: drive to a goal and stay there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stage {
    /// The node to drive to.
    pub goal: NodeId,
    /// Whether a rack is carried on the way.
    pub loaded: bool,
    /// Whether a rack is lifted there: from then on the robot takes as much floor as one with a rack.
    pub lifts: bool,
    /// How long to stay there before the next stage. At the last stage, where the robot may stay for ever, this counts
    /// only if the place will be closed by hand.
    pub stay: Span,
}

impl Stage {
    /// A stage to a node without a rack, to stay there.
    pub fn to_stay(goal: NodeId) -> Stage {
        Stage { goal, loaded: false, lifts: false, stay: Span::ZERO }
    }
}

/// Whether room for a rack is held at a node that is visited on the way to a stage's goal: the robot comes with a rack,
/// or lifts one there.
fn is_loaded_at(stages: &[Stage], node: NodeId, stage: usize) -> bool {
    let here = stages[stage..].iter().take_while(|s| s.goal == node).count();
    let on = &stages[stage..];
    on.iter().take(here + 1).any(|s| s.loaded) || on.iter().take(here).any(|s| s.lifts)
}

/// What a search should find.
#[derive(Clone, Debug)]
pub struct RouteQuery<'a> {
    /// The visit that the route continues: where the robot is, or where its grants end.
    pub from: &'a Visit,
    /// Heading of the robot there, radians.
    pub heading: f64,
    /// The earliest time at which it can be ready to move there.
    pub ready: Time,
    /// The goals in order; the last one must be free for ever from some time on.
    pub stages: &'a [Stage],
    /// Number of labels that may be expanded. A route found within the first half is the earliest one.
    pub budget: u32,
    /// Conditions on nodes, such as those for people.
    pub conditions: &'a Conditions,
    /// Workers that the robot is already too near to and may move away from, and closed areas that it is in.
    pub exemptions: &'a [Exemption],
}

/// A route: what to hold, in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Route {
    /// The visit that the route starts from, with its new departure.
    pub kept: Visit,
    /// All visits after it; the last one never ends.
    pub visits: Vec<Visit>,
    /// For each stage, the number of `visits` after which its goal is reached; zero means at the start.
    pub stops: Vec<usize>,
    /// When the last goal is reached.
    pub arrival: Time,
    /// Number of labels expanded to find the route.
    pub expansions: u32,
}

impl Route {
    /// When the first goal is reached.
    pub fn first_arrival(&self) -> Time {
        match self.stops[0] {
            0 => self.kept.arrive,
            n => self.visits[n - 1].arrive,
        }
    }
}

/// Why there is no route.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NoRoute {
    /// There is no route even on an empty floor.
    Unreachable,
    /// Other robots are in the way for ever.
    Blocked,
    /// No route was found within the budget.
    BudgetSpent,
}

/// The search with its estimates and scratch memory.
#[derive(Clone, Debug)]
pub struct Planner {
    estimates: Estimates,
    scratch: search::Scratch,
    weight: f64,
}

impl Planner {
    /// A planner for one building and one set of rules, for robots of the building's first kind.
    pub fn new(warehouse: Arc<Warehouse>, rules: Rules) -> Planner {
        Planner::for_body(warehouse, BodyId(0), rules)
    }

    /// A planner for robots of one kind: over the lanes for that kind, with its footprints.
    pub fn for_body(warehouse: Arc<Warehouse>, body: BodyId, rules: Rules) -> Planner {
        let pace = Arc::new(Pace::new(&warehouse, rules));
        Planner {
            estimates: Estimates::new(warehouse, body, pace),
            scratch: search::Scratch::default(),
            weight: 0.0,
        }
    }

    /// Weights the remaining time more than the elapsed time: `f = g + w·h` with `w = 1 + k·(1 − g/(g + h))`, which
    /// falls from `1 + k` at the start to 1 at the goal (the dynamic weight of Ye et al., equation 2, which states no
    /// more about `w` than that it falls). Zero, the value in a new planner, is the search as documented.
    ///
    /// With a weight, the objective is the last arrival alone, and a route takes at most `1 + k` times as long as the
    /// best one (prices included), unless it was found in a hurry (see [`RouteQuery::budget`]).
    ///
    /// # Panics
    /// If the weight is negative or not a number.
    pub fn weigh(&mut self, k: f64) {
        assert!(k >= 0.0 && k.is_finite(), "a weight is not negative: {k}");
        self.weight = k;
    }

    /// The durations that the planner uses.
    pub fn pace(&self) -> &Arc<Pace> {
        self.estimates.pace()
    }

    /// The building.
    pub fn warehouse(&self) -> &Arc<Warehouse> {
        self.estimates.warehouse()
    }

    /// The cache of lower bounds.
    pub fn estimates(&mut self) -> &mut Estimates {
        &mut self.estimates
    }

    /// The route that reaches the first goal earliest and, among those, the last one earliest, given what others
    /// hold in `timeline`. The asking robot itself must hold nothing there (see
    /// [`crate::timeline::Timeline::without`]).
    ///
    /// # Errors
    /// Why there is no route, or none within the budget.
    pub fn plan(&mut self, ask: &RouteQuery<'_>, timeline: &Overlay<'_>) -> Result<Route, NoRoute> {
        search::plan(&mut self.estimates, &mut self.scratch, ask, timeline, self.weight)
    }

    /// Number of labels that the last search expanded, whether or not it found a route.
    pub fn expanded(&self) -> u32 {
        self.scratch.expanded()
    }

    /// How long the stages would take on an empty floor, from standing at a node.
    pub fn free_flow(&mut self, from: NodeId, stages: &[Stage]) -> Option<Span> {
        let mut total = Span::ZERO;
        let mut at = from;
        for (i, s) in stages.iter().enumerate() {
            let table = self.estimates.table(s.goal, s.loaded);
            total += if at == s.goal { Span::ZERO } else { self.estimates.bound_from(&table, at)? };
            if i + 1 < stages.len() {
                total += s.stay;
            }
            at = s.goal;
        }
        Some(total)
    }
}

#[cfg(test)]
mod tests;
