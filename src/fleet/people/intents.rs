//! What is remembered about intents: goals with the distances to them, and what is believed of each worker.
//!
//! Main type: [`Intents`]. Goals are the workers' tasks, the doors, and the corners of the hall, which stand for
//! everything else (Petković 2021, section 4.3.2). Refuses: to look at anything that is seen.

use giveway_floor::geometry::Point;
use giveway_floor::id::{AssignmentId, Dense, GoalId, NodeId, WorkerId};
use giveway_floor::time::Time;
use giveway_floor::warehouse::walkway::Walkways;
use giveway_floor::warehouse::{NodeKind, Warehouse};
use giveway_people::human::tiles::Tiles;
use giveway_people::human::{Belief, Distances, IntentEpisode, Intention, Method};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Numbers of goals: corners first, doors from `DOORS` on, places of tasks from `PLACES` on.
pub(super) const DOORS: u64 = 4;
pub(super) const PLACES: u64 = 1000;

/// All that is remembered about intents.
#[derive(Clone, Debug)]
pub struct Intents {
    pub distances: Distances,
    pub fixed: Vec<GoalId>,
    pub cut_at: Option<Time>,
    pub intentions: BTreeMap<WorkerId, (Intention, BTreeSet<GoalId>)>,
    /// The oldest assignments, a few of each worker.
    pub early: Vec<(AssignmentId, WorkerId)>,
}

impl Intents {
    /// # Panics
    /// If the method judges people on tiles and the floor has too many: [`Tiles::fit`] says so beforehand.
    pub fn new(warehouse: &Warehouse, walkways: Arc<Walkways>, method: Method) -> Intents {
        let mut distances = Distances::over(walkways.clone());
        if method == Method::Chapter3Tiles {
            let tiles = Tiles::of(warehouse, &walkways);
            distances =
                distances.with_tiles(tiles.expect("a floor that is too large is refused with its method"));
        }
        let (low, high) = warehouse.bounds();
        let corners = [(low.x, low.y), (high.x, low.y), (high.x, high.y), (low.x, high.y)];
        let corners = corners.map(|(x, y)| Point::new(x, y));
        let doors = warehouse.nodes_where(|k| k == NodeKind::Exit).into_iter().take(3);
        let places = corners.into_iter().chain(doors.map(|n| warehouse.nodes[n].at));
        let mut fixed: Vec<GoalId> = Vec::new();
        for (i, place) in places.enumerate() {
            let Some((node, _)) = walkways.nearest(place) else { continue };
            let at = walkways.nodes()[node].at;
            if distances.goals().all(|(_, g)| (g - at).norm() > 1.0) {
                distances.add_goal(GoalId(i as u64), at);
                fixed.push(GoalId(i as u64));
            }
        }
        Intents { distances, fixed, cut_at: None, intentions: BTreeMap::new(), early: Vec::new() }
    }

    /// What is believed of a worker.
    pub fn belief(&self, worker: WorkerId) -> Option<Belief> {
        self.intentions.get(&worker).map(|(i, _)| i.belief())
    }

    /// What a worker has most probably been doing, and since when; the oldest first.
    pub fn episodes(&self, worker: WorkerId) -> Vec<IntentEpisode> {
        self.intentions.get(&worker).map(|(i, _)| i.episodes()).unwrap_or_default()
    }

    /// Forgets what was believed of a worker: the next sighting starts anew.
    pub fn forget(&mut self, worker: WorkerId) {
        self.intentions.remove(&worker);
    }
}

/// The node of a goal that is the place of a task.
pub(crate) fn task_place(goal: GoalId) -> Option<NodeId> {
    goal.0.checked_sub(PLACES).map(|n| NodeId::at(n as usize))
}

/// The goal that is the place of a task.
pub(crate) fn goal_of(place: NodeId) -> GoalId {
    GoalId(PLACES + place.ix() as u64)
}
