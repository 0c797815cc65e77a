//! The published recognisers: chapter 3 (goals, undecided, elsewhere) and chapter 4 (goals only).
//!
//! Main type: [`Published`]. Petković 2021, sections 3.3, 3.4 and 4.3.2, with the errors of the print corrected (see
//! `motion.rs`, `chain.rs`). Updates come with displacement, not with messages, so that a fast stream of poses does not
//! shorten the memory. Refuses: prior knowledge of the worker's task, which these methods have no place for.

use super::chain::IntentBelief;
use super::sequence::IntentState;
use super::{TooManyGoals, motion};
use crate::human::Distances;
use giveway_floor::geometry::{Point, turn_between};
use giveway_floor::id::GoalId;
use giveway_floor::time::{Span, Time};
use std::collections::{BTreeMap, VecDeque};
use std::f64::consts::FRAC_PI_8;

/// Transitions of chapter 3: away from a goal, towards a goal, to elsewhere, and back from there (eq. 3.16).
pub(super) const ALPHA: f64 = 0.5;
pub(super) const BETA: f64 = 0.1;
pub(super) const GAMMA: f64 = 0.05;
pub(super) const DELTA: f64 = 0.1;
/// Chapter 4: probability of keeping a goal from one update to the next.
const STAY: f64 = 0.823;
/// Eq. 3.20: with more goals, the undecided state would have a negative probability of staying.
const GOALS_MAX: usize = ((1.0 - GAMMA) / BETA) as usize;
/// With more goals, the thesis found, the model hardly ever decides.
pub(super) const GOALS_WELL: usize = 5;
/// Distance walked per update, metres …
const GATE_M: f64 = 0.25;
/// Share of a new value in the low-pass filter.
const FRESH: f64 = 0.5;
/// Least time before a person is called irrational for walking away from all goals.
const PATIENCE: Span = Span::from_secs(1);

/// Least probability of *undecided* (eq. 3.18 has it; the text says the same of eq. 3.17, whose print would be zero if
/// one goal fits fully and no other at all).
const DOUBT: f64 = 0.1;

/// The chapter whose method is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Chapter {
    Three,
    Four,
}

/// One person's recogniser.
#[derive(Clone, Debug)]
pub(super) struct Published {
    chapter: Chapter,
    chain: IntentBelief,
    /// Position, heading and time of the last update.
    last: Option<(Point, Option<f64>, Time)>,
    smooth: BTreeMap<GoalId, f64>,
    evidence: Evidence,
}

impl Published {
    pub fn new(chapter: Chapter) -> Published {
        let chain = match chapter {
            Chapter::Three => IntentBelief::undecided(),
            Chapter::Four => IntentBelief::new(Vec::new(), Vec::new()),
        };
        Published { chapter, chain, last: None, smooth: BTreeMap::new(), evidence: Evidence::new(PATIENCE) }
    }

    pub fn add_goal(&mut self, goal: GoalId) -> Result<(), TooManyGoals> {
        match self.chapter {
            Chapter::Three => return add_goal_of_chapter_three(&mut self.chain, goal, self.last.is_none()),
            // Before the first observation all goals are equal; the print's 1/g is meant to be 1/(g + 1) for g + 1
            // states.
            Chapter::Four if self.last.is_none() => {
                let mut states: Vec<IntentState> =
                    self.chain.goals().chain([goal]).map(IntentState::Goal).collect();
                states.sort_unstable();
                states.dedup();
                let share = 1.0 / states.len() as f64;
                self.chain = IntentBelief::new(states.clone(), vec![share; states.len()]);
            }
            Chapter::Four => self.chain.add_goal(goal),
        }
        Ok(())
    }

    pub fn remove_goal(&mut self, goal: GoalId) {
        self.chain.remove_goal(goal, IntentState::Undecided);
        self.smooth.remove(&goal);
    }

    pub fn is_doubtful(&self) -> bool {
        self.chapter == Chapter::Three && self.chain.goals().count() > GOALS_WELL
    }

    pub fn chain(&self) -> &IntentBelief {
        &self.chain
    }

    pub fn observe(&mut self, seen: Time, at: Point, heading: Option<f64>, distances: &Distances) {
        let heading = heading.filter(|_| self.chapter == Chapter::Three);
        let Some((from, before, _)) = self.last else {
            self.last = Some((at, heading, seen));
            return;
        };
        let turned = heading.zip(before).is_some_and(|(now, then)| turn_between(then, now) > FRAC_PI_8);
        if (at - from).norm() < GATE_M && !turned {
            return;
        }
        self.last = Some((at, heading, seen));
        let goals: Vec<GoalId> = self.chain.goals().collect();
        if goals.is_empty() {
            return;
        }
        let raw = motion::validate(distances, &goals, from, at, heading);
        let mut smooth = Vec::with_capacity(goals.len());
        for (goal, v) in goals.iter().zip(&raw) {
            let kept = self.smooth.entry(*goal).or_insert(*v);
            *kept += FRESH * (v - *kept);
            smooth.push(*kept);
        }
        match self.chapter {
            Chapter::Three => {
                let goes_nowhere = self.evidence.add(seen, goals.iter().copied().zip(raw).collect());
                weigh_chapter_three(&mut self.chain, &smooth, goes_nowhere, seen);
            }
            Chapter::Four => {
                let others = (self.chain.states().len() - 1).max(1) as f64;
                let step = |from: IntentState, to: IntentState| {
                    if from == to { STAY } else { (1.0 - STAY) / others }
                };
                let emission: Vec<f64> = smooth.iter().map(|v| v.tanh()).collect();
                self.chain.update(step, &emission, seen);
            }
        }
    }
}

/// Adds a goal to a chain of chapter 3; `is_new` says that nothing was observed yet, so that *undecided* is certain
/// (eq. 3.19).
pub(super) fn add_goal_of_chapter_three(
    chain: &mut IntentBelief,
    goal: GoalId,
    is_new: bool,
) -> Result<(), TooManyGoals> {
    if chain.goals().count() >= GOALS_MAX && chain.goals().all(|g| g != goal) {
        return Err(TooManyGoals { at_most: GOALS_MAX });
    }
    if !is_new {
        chain.add_goal(goal);
        return Ok(());
    }
    let mut states: Vec<IntentState> = chain.states().to_vec();
    states.push(IntentState::Goal(goal));
    states.sort_unstable();
    states.dedup();
    let start = |s: &IntentState| if *s == IntentState::Undecided { 1.0 } else { 0.0 };
    *chain = IntentBelief::new(states.clone(), states.iter().map(start).collect());
    Ok(())
}

/// One update of the chain of chapter 3 (eq. 3.16 to 3.18). `goes_nowhere` is the best recent average, if it is too low
/// for any goal.
pub(super) fn weigh_chapter_three(
    chain: &mut IntentBelief,
    v: &[f64],
    goes_nowhere: Option<f64>,
    seen: Time,
) {
    let goals = v.len() as f64;
    let step = move |from: IntentState, to: IntentState| match (from, to) {
        (IntentState::Goal(a), IntentState::Goal(b)) => f64::from(a == b) * (1.0 - ALPHA),
        (IntentState::Goal(_), IntentState::Undecided) => ALPHA,
        (IntentState::Undecided, IntentState::Goal(_)) => BETA,
        (IntentState::Undecided, IntentState::Undecided) => 1.0 - goals * BETA - GAMMA,
        (IntentState::Undecided, IntentState::Elsewhere) => GAMMA,
        (IntentState::Elsewhere, IntentState::Undecided) => DELTA,
        (IntentState::Elsewhere, IntentState::Elsewhere) => 1.0 - DELTA,
        _ => 0.0,
    };
    let emission: Vec<f64> = match goes_nowhere {
        None => {
            let mut sorted = v.to_vec();
            sorted.sort_by(f64::total_cmp);
            let ahead = sorted.last().copied().unwrap_or(0.0)
                - sorted.len().checked_sub(2).map_or(0.0, |second| sorted[second]);
            v.iter().map(|v| v.tanh()).chain([(1.0 - ahead).max(DOUBT).tanh(), 0.0]).collect()
        }
        Some(best) => v.iter().map(|_| 0.0).chain([DOUBT.tanh(), (1.0 - best).tanh()]).collect(),
    };
    chain.update(step, &emission, seen);
}

/// How well a person has recently been moving towards each goal.
#[derive(Clone, Debug)]
pub(super) struct Evidence {
    /// Time span that must be covered before the evidence counts.
    patience: Span,
    late: VecDeque<(Time, BTreeMap<GoalId, f64>)>,
}

impl Evidence {
    pub fn new(patience: Span) -> Evidence {
        Evidence { patience, late: VecDeque::new() }
    }

    /// Adds one update. Gives the best average over the goals, if the evidence suffices and it is at most 0.5.
    pub fn add(&mut self, seen: Time, v: BTreeMap<GoalId, f64>) -> Option<f64> {
        let goals: Vec<GoalId> = v.keys().copied().collect();
        self.late.push_back((seen, v));
        while self.late.len() > 1 && self.late[1].0 <= seen - self.patience {
            self.late.pop_front();
        }
        if self.late[0].0 > seen - self.patience {
            return None;
        }
        let average = |goal: &GoalId| {
            let known = self.late.iter().filter_map(|(_, v)| v.get(goal));
            known.clone().sum::<f64>() / known.count().max(1) as f64
        };
        let best = goals.iter().map(average).fold(0.0, f64::max);
        (best <= 0.5).then_some(best)
    }
}
