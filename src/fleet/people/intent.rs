//! Where workers may be going: the known goals, the distances to them, and what is believed of each worker.
//!
//! The results are kept in [`Intents`](crate::people::intents::Intents). Goals are the workers' tasks, the doors, and
//! the corners of the hall, which stand for everything else (Petković 2021, section 4.3.2). Refuses: to follow workers
//! whose place is only guessed.

use crate::people::intents::{DOORS, PLACES, goal_of};
use crate::people::state::{HumanState, WalkMode};
use crate::state::floor::Floor;
use giveway_floor::id::{AssignmentId, GoalId, NodeId, WorkerId};
use giveway_floor::time::{Span, Time};
use giveway_floor::warehouse::walkway::EdgeSet;
use giveway_people::aware::HumanAwarePolicy;
use giveway_people::human::{
    Hypothesis, Intention, Method, Presence, Quality, Whereabouts, straight_on, towards_goal,
};
use std::collections::{BTreeMap, BTreeSet};

/// How much more probable the worker's own task is than any other goal, before anything is seen.
const OWN_TASK: f64 = 3.0;
/// How often walkways are blocked anew by the robots that stand on them.
const CUT_AGAIN: Span = Span::from_millis(200);
/// Goals with less probability than this get no path.
const NEGLIGIBLE: f64 = 0.02;
/// How far paths are followed, metres.
const FAR_M: f64 = 25.0;
/// How far a person who goes elsewhere is followed, metres.
const ELSEWHERE_M: f64 = 5.0;
/// How many tasks of other workers a worker may be going to help with, oldest first.
const OTHERS: usize = 3;
impl HumanState {
    /// Updates what is believed of every worker with what was seen in this step.
    pub(crate) fn infer(&mut self, floor: Floor<'_>, now: Time) {
        let method = match floor.settings.policy {
            HumanAwarePolicy::Nhir | HumanAwarePolicy::Shir => return,
            HumanAwarePolicy::Phir => Method::Chapter4,
            HumanAwarePolicy::Giveway => floor.settings.method,
        };
        self.know_places(floor);
        self.block_walkways(floor, now);
        for (worker, place) in self.present(now) {
            self.infer_one(floor, worker, &place, method);
        }
    }

    /// Keeps the places of tasks that a worker may be bound for among the goals, and no others.
    fn know_places(&mut self, floor: Floor<'_>) {
        self.intents.early = floor.early_assignments();
        let own = self.people.ids().filter_map(|w| floor.next_assignment(w));
        let may_be = own.chain(self.intents.early.iter().map(|(id, _)| *id));
        let place = |id| floor.ledger.assignments[&id].request.place;
        let wanted: BTreeMap<GoalId, NodeId> = may_be.map(|id| (goal_of(place(id)), place(id))).collect();
        let mind = &mut self.intents;
        let known: Vec<GoalId> = mind.distances.goals().map(|(g, _)| g).filter(|g| g.0 >= PLACES).collect();
        for goal in known.iter().filter(|g| !wanted.contains_key(g)) {
            mind.distances.remove_goal(*goal);
        }
        for (goal, node) in wanted.into_iter().filter(|(g, _)| !known.contains(g)) {
            let at = floor.ledger.warehouse().nodes[node].at;
            let at = self.walkways.on_floor(at).unwrap_or(at);
            mind.distances.add_goal(goal, at);
        }
    }

    /// Cuts the walkways on which robots stand, and restores those that they left.
    fn block_walkways(&mut self, floor: Floor<'_>, now: Time) {
        if self.intents.cut_at.is_some_and(|t| now - t < CUT_AGAIN) {
            return;
        }
        self.intents.cut_at = Some(now);
        let mut cut: EdgeSet = self.walkways.no_edges();
        for robot in floor.ledger.present() {
            if floor.scene.robot(robot).is_none_or(|t| t.speed_mps < 0.05) {
                let edges = self.walkways.edges_within(floor.place_of(robot), floor.beside_m(robot, 0.2));
                edges.into_iter().for_each(|e| {
                    cut.insert(e);
                });
            }
        }
        self.intents.distances.set_cut(&cut);
    }

    fn infer_one(&mut self, floor: Floor<'_>, worker: WorkerId, place: &Whereabouts, method: Method) {
        let goals = self.goals_of(floor, worker, method);
        let task = floor.next_assignment(worker).map(|a| goal_of(floor.ledger.assignments[&a].request.place));
        let person = &self.people[worker];
        let Some(seen) = person.track.newest().filter(|_| person.fresh).copied() else { return };
        if place.presence != Presence::Tracked || seen.quality != Quality::Tracked {
            return;
        }
        let mind = &mut self.intents;
        if person.relocated {
            mind.intentions.remove(&worker);
        }
        let fresh = || (Intention::new(method, &floor.settings.model), BTreeSet::new());
        let (intention, known) = mind.intentions.entry(worker).or_insert_with(fresh);
        for goal in known.iter().filter(|g| !goals.contains_key(g)) {
            intention.remove_goal(*goal);
        }
        known.retain(|g| goals.contains_key(g));
        for (goal, weight) in goals {
            // A method that has no room for another goal goes on without it.
            if !known.contains(&goal) && intention.add_goal(goal, weight).is_ok() {
                known.insert(goal);
            }
        }
        intention.has_work_at(task);
        intention.expect_error(seen.accuracy_m);
        intention.observe(seen.seen, seen.at, seen.heading, &mind.distances);
    }

    /// The goals that a worker may have, with their weights: the worker's own task first. As published, the corners of
    /// the hall and the end of the path, all with the same weight: five, which is as many as chapter 3 tells apart
    /// well.
    fn goals_of(&self, floor: Floor<'_>, worker: WorkerId, method: Method) -> BTreeMap<GoalId, f64> {
        let as_published = method != Method::Detour;
        let fixed = self.intents.fixed.iter().filter(|g| !as_published || g.0 < DOORS);
        let mut goals: BTreeMap<GoalId, f64> = fixed.map(|g| (*g, 1.0)).collect();
        if let Some(id) = floor.next_assignment(worker) {
            let weight = if as_published { 1.0 } else { OWN_TASK };
            goals.insert(goal_of(floor.ledger.assignments[&id].request.place), weight);
        }
        if !as_published {
            // Tasks of others, oldest first: people help one another, and pick up what is on the way.
            let others = self.intents.early.iter().filter(|(_, w)| *w != worker).take(OTHERS);
            for (id, _) in others {
                goals.entry(goal_of(floor.ledger.assignments[id].request.place)).or_insert(1.0);
            }
        }
        goals
    }

    /// Where a worker may be going, with paths from here.
    pub(crate) fn hypotheses(&self, worker: WorkerId, place: &Whereabouts) -> Vec<Hypothesis> {
        let person = &self.people[worker];
        if !matches!(person.mode, WalkMode::Deviating { .. }) {
            let path = person.rest_of_path(place.at).unwrap_or_else(|| vec![place.at]);
            let stay = person.plan.as_ref().map_or(Span::from_secs(1), |p| p.stay);
            return vec![Hypothesis { probability: 1.0, path, stay: Some(stay) }];
        }
        let mind = &self.intents;
        let Some(belief) = mind.belief(worker) else { return self.elsewhere(place, 1.0) };
        // An undecided worker is on the way to one of several goals: to each in proportion to its probability.
        let known: f64 = belief.goals.iter().map(|g| g.1).sum();
        let shared = if known > NEGLIGIBLE { belief.undecided / known } else { 0.0 };
        let likely =
            belief.goals.iter().map(|(g, p)| (*g, p * (1.0 + shared))).filter(|(_, p)| *p >= NEGLIGIBLE);
        let mut all: Vec<Hypothesis> = likely
            .filter_map(|(goal, probability)| {
                let path = towards_goal(&mind.distances, goal, place.at, FAR_M)?;
                Some(Hypothesis { probability, path, stay: Some(Span::from_secs(3)) })
            })
            .collect();
        let nobody_knows = if shared > 0.0 { 0.0 } else { belief.undecided };
        all.extend(self.elsewhere(place, belief.elsewhere + nobody_knows));
        all
    }

    /// A person who goes to no known goal goes straight on, for a few metres.
    fn elsewhere(&self, place: &Whereabouts, probability: f64) -> Vec<Hypothesis> {
        let v = place.velocity;
        let path = if v.norm() > 0.3 {
            straight_on(&self.walkways, place.at, v.y.atan2(v.x), ELSEWHERE_M)
        } else {
            vec![place.at]
        };
        vec![Hypothesis { probability, path, stay: Some(Span::from_secs(1)) }]
    }
}

impl Floor<'_> {
    /// The oldest assignments, and of each worker no more than another may help with. For every worker, they include
    /// the oldest of all other workers' assignments.
    fn early_assignments(&self) -> Vec<(AssignmentId, WorkerId)> {
        let index = &self.ledger.index();
        let own = |worker| index.assignments_of(worker).take(OTHERS).map(move |id| (id, worker));
        let mut early: Vec<(AssignmentId, WorkerId)> = index.assigned_workers().flat_map(own).collect();
        early.sort_unstable();
        early.truncate(2 * OTHERS);
        early
    }
}
