//! Our recogniser: a person who walks to a goal makes no detours on the way.
//!
//! Main types: [`Detour`], [`PurposeModel`] (its figures, learned from recorded people). A step's likelihood follows
//! von Mises: it depends on the metres of detour that the step means for a goal, times the person's resoluteness.
//! Resoluteness is inferred along with the goal, so that a person who strolls gives no certainty (Fisac et al. 2018;
//! Yin et al. 2025); a person who goes *elsewhere* walks in all directions alike. Minds change at a rate per time, and
//! steps are counted by metres, so the rate of poses means nothing. Refuses: an undecided state; an undecided posterior
//! is flat, and its entropy shows it.

use super::Belief;
use super::sequence::{IntentSequence, IntentState};
use crate::human::Distances;
use crate::human::motion::{Fix, Motion, MotionModel, Use};
use giveway_floor::geometry::{Point, turn_between};
use giveway_floor::id::GoalId;
use giveway_floor::time::{Span, Time};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Number of degrees of resoluteness.
const DEGREES: usize = 4;
/// Distance after which a step is processed, metres …
const STEP_M: f64 = 0.4;
/// … and time after which a pause is processed.
const PAUSE: Span = Span::from_secs(1);
/// Steps shorter than this many standard deviations of a position may be noise.
const NOISE: f64 = 3.0;
/// A person this near to a goal has arrived, metres.
const THERE_M: f64 = 1.0;
/// A goal this near to a learned place is that place, metres.
const PLACE_M: f64 = 1.0;
/// Rate at which people change their resoluteness, per second.
const TEMPER_PER_S: f64 = 0.02;
/// Share of what steps say about resoluteness that counts: the steps of one straight leg are one piece of evidence.
/// Counted as many, they would make the model too sure of a person who turns at its end.
const EVIDENCE: f64 = 0.25;

/// Least probability of a goal.
const UNLIKELY: f64 = 1e-12;

/// Figures of the recogniser.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PurposeModel {
    /// Degrees of resoluteness: loss of log-probability per metre of detour.
    pub betas_per_m: [f64; DEGREES],
    /// Probability of each degree.
    pub beta_shares: [f64; DEGREES],
    /// Rate at which people change their goal on the way, per second.
    pub changes_per_s: f64,
    /// Weight of the present course: concentration of directions at one metre per second.
    pub kappa: f64,
    /// Share of people who go to no known goal.
    pub elsewhere: f64,
    /// How long people stay at a goal, seconds.
    pub dwell_s: f64,
    /// Places with learned figures.
    pub places: Vec<DetourPlace>,
}

/// Learned figures of people at one place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DetourPlace {
    /// East-west position, metres.
    pub x_m: f64,
    /// North-south position, metres.
    pub y_m: f64,
    /// How long people stay, seconds.
    pub dwell_s: f64,
    /// Where people go next: shares of all places, in the order of the places.
    pub next: Vec<f64>,
}

impl Default for PurposeModel {
    fn default() -> PurposeModel {
        PurposeModel {
            betas_per_m: [1.0, 1.75, 3.0, 5.0],
            beta_shares: [0.25, 0.25, 0.25, 0.25],
            changes_per_s: 0.1,
            kappa: 6.0,
            elsewhere: 0.05,
            dwell_s: 5.0,
            places: Vec::new(),
        }
    }
}

/// One person's recogniser.
#[derive(Clone, Debug)]
pub(super) struct Detour {
    model: Arc<PurposeModel>,
    /// Goals with their prior weights.
    weights: BTreeMap<GoalId, f64>,
    /// Learned shares of where people go next from the goal visited last, if any.
    next: BTreeMap<GoalId, f64>,
    /// Joint probabilities of goals and degrees of resoluteness.
    goals: BTreeMap<GoalId, [f64; DEGREES]>,
    elsewhere: f64,
    /// The most probable sequence of goals, by what each step says for each goal, whatever the resoluteness.
    sequence: IntentSequence,
    /// Factor for each goal from the present course.
    course: BTreeMap<GoalId, f64>,
    /// Time and position of the last processed step.
    last: Option<(Time, Point)>,
    /// The goal that the person is at.
    there: Option<GoalId>,
    /// The goal where the person has work to do.
    work: Option<GoalId>,
    motion: Motion,
    /// Standard deviation of positions, metres.
    sigma_m: f64,
}

impl Detour {
    pub fn new(model: Arc<PurposeModel>, motion: MotionModel) -> Detour {
        let elsewhere = model.elsewhere;
        let sequence = IntentSequence::new(vec![IntentState::Elsewhere], &[1.0], UNLIKELY);
        Detour {
            model,
            sequence,
            weights: BTreeMap::new(),
            next: BTreeMap::new(),
            goals: BTreeMap::new(),
            elsewhere,
            course: BTreeMap::new(),
            last: None,
            there: None,
            work: None,
            motion: Motion::new(motion),
            sigma_m: 0.02,
        }
    }

    pub fn add_goal(&mut self, goal: GoalId, weight: f64) {
        self.weights.insert(goal, weight.max(1e-6));
        let total: f64 = self.weights.values().sum();
        if self.last.is_none() {
            self.goals = self.weights.iter().map(|(g, w)| (*g, self.spread(w / total))).collect();
            self.elsewhere = self.model.elsewhere;
            let known = 1.0 - self.model.elsewhere;
            self.goals.values_mut().flatten().for_each(|p| *p *= known);
            self.begin_sequence();
        } else {
            // A new goal takes its prior share from all others.
            let share = self.weights[&goal] / total * (1.0 - self.model.elsewhere);
            self.goals.values_mut().flatten().for_each(|p| *p *= 1.0 - share);
            self.elsewhere *= 1.0 - share;
            self.goals.insert(goal, self.spread(share));
            self.sequence.add(IntentState::Goal(goal), share);
        }
        self.normalise();
    }

    /// Starts the sequence before the first observation.
    fn begin_sequence(&mut self) {
        let states = self.goals.keys().map(|g| IntentState::Goal(*g)).chain([IntentState::Elsewhere]);
        let shares: Vec<f64> = self.goals.values().map(|p| p.iter().sum()).chain([self.elsewhere]).collect();
        self.sequence = IntentSequence::new(states.collect(), &shares, UNLIKELY);
    }

    pub fn sequence(&self) -> &IntentSequence {
        &self.sequence
    }

    fn spread(&self, share: f64) -> [f64; DEGREES] {
        self.model.beta_shares.map(|b| b * share)
    }

    pub fn remove_goal(&mut self, goal: GoalId) {
        self.weights.remove(&goal);
        self.course.remove(&goal);
        self.sequence.remove(IntentState::Goal(goal));
        let share = self.goals.remove(&goal).map_or(0.0, |p| p.iter().sum());
        if self.there == Some(goal) {
            // The goal is done: the person goes on to something else, not known what.
            self.decide_anew(share);
        } else {
            self.elsewhere += share;
        }
        self.normalise();
    }

    /// A person at this goal stays until the work there is done.
    pub fn has_work_at(&mut self, goal: Option<GoalId>) {
        self.work = goal;
    }

    pub fn expect_error(&mut self, sigma_m: f64) {
        self.sigma_m = sigma_m;
    }

    pub fn belief(&self) -> Belief {
        let factor = |g: &GoalId| self.course.get(g).copied().unwrap_or(1.0);
        let mut goals: Vec<(GoalId, f64)> =
            self.goals.iter().map(|(g, p)| (*g, p.iter().sum::<f64>() * factor(g))).collect();
        let total = goals.iter().map(|g| g.1).sum::<f64>() + self.elsewhere;
        goals.iter_mut().for_each(|g| g.1 /= total);
        Belief { goals, undecided: 0.0, elsewhere: self.elsewhere / total }
    }

    pub fn observe(&mut self, seen: Time, at: Point, distances: &Distances) {
        match self.motion.see(Fix { seen, at, sigma_m: self.sigma_m }) {
            Use::Late | Use::Doubted => return,
            Use::Restarted => self.last = None,
            Use::Taken => {}
        }
        let now = self.motion.ahead(seen).expect("a fix was just taken in");
        let here = distances.from(now.at);
        let Some((before, from)) = self.last else {
            self.last = Some((seen, now.at));
            self.visit(now.at, distances);
            return;
        };
        let (step, passed) = ((now.at - from).norm(), seen - before);
        if step >= STEP_M.max(NOISE * self.sigma_m) {
            self.last = Some((seen, now.at));
            self.change_minds(passed);
            let start = distances.from(from);
            let fits = self.weigh(step, |goal| Some((start.to_goal(goal)?, here.to_goal(goal)?)));
            self.continue_sequence(seen, passed, &fits);
            self.visit(now.at, distances);
            self.normalise();
        } else if passed >= PAUSE {
            // A standing person goes nowhere: time passes, and the start of the next step stays.
            self.last = Some((seen, from));
            self.change_minds(passed);
            self.continue_sequence(seen, passed, &BTreeMap::new());
            self.normalise();
        }
        self.look(now.velocity.norm(), now.velocity.y.atan2(now.velocity.x), |goal| here.towards(goal));
    }

    /// Records a visit: from there the person goes on to another goal.
    fn visit(&mut self, at: Point, distances: &Distances) {
        let there = |g: &&GoalId| distances.place(**g).is_some_and(|p| (p - at).norm() <= THERE_M);
        self.there = self.weights.keys().find(there).copied();
        if let Some(goal) = self.there {
            self.next = self.next_from(goal, distances).unwrap_or_default();
        }
    }

    /// Where people go next from a goal, if that was learned.
    fn next_from(&self, from: GoalId, distances: &Distances) -> Option<BTreeMap<GoalId, f64>> {
        let place_of = |g: GoalId| {
            let at = distances.place(g)?;
            let off = |p: &DetourPlace| (Point::new(p.x_m, p.y_m) - at).norm();
            self.model.places.iter().position(|p| off(p) <= PLACE_M)
        };
        let shares = &self.model.places[place_of(from)?].next;
        // Shares can be compared only if every goal is a known place.
        self.weights.keys().map(|g| Some((*g, shares.get(place_of(*g)?)?.max(1e-6)))).collect()
    }

    /// Prior probabilities of the goals, up to a factor: by their own weights (the worker's task first) and by where
    /// people go from the last goal.
    fn prior(&self) -> BTreeMap<GoalId, f64> {
        let factor = |g: &GoalId| self.next.get(g).copied().unwrap_or(1.0);
        self.weights.iter().map(|(g, w)| (*g, w * factor(g))).collect()
    }

    /// The probability that a person still has the same goal, or still none: a person who has arrived leaves, unless
    /// there is work to do.
    fn keeps(&self, goal: Option<GoalId>, passed: Span) -> f64 {
        let dt = passed.as_secs_f64();
        let keeps = (-self.model.changes_per_s * dt).exp();
        let leaves = goal.is_some() && self.there == goal && self.work != goal;
        keeps * if leaves { (-dt / self.model.dwell_s).exp() } else { 1.0 }
    }

    /// Applies the same update to the most probable sequence; `fits` gives how well a step fits each goal.
    fn continue_sequence(&mut self, seen: Time, passed: Span, fits: &BTreeMap<GoalId, f64>) {
        let prior = self.prior();
        let (total, nobody) = (prior.values().sum::<f64>(), self.model.elsewhere);
        let known = if prior.is_empty() { 0.0 } else { 1.0 - nobody };
        let fresh = |state: IntentState| match state {
            IntentState::Goal(g) => known * prior.get(&g).map_or(0.0, |p| p / total),
            IntentState::Undecided | IntentState::Elsewhere => 1.0 - known,
        };
        let goal_of = |state: IntentState| match state {
            IntentState::Goal(g) => Some(g),
            IntentState::Undecided | IntentState::Elsewhere => None,
        };
        let kept: BTreeMap<Option<GoalId>, f64> =
            self.goals.keys().map(|g| Some(*g)).chain([None]).map(|g| (g, self.keeps(g, passed))).collect();
        let step = |from: IntentState, to: IntentState| {
            let kept = kept[&goal_of(from)];
            (1.0 - kept) * fresh(to) + if from == to { kept } else { 0.0 }
        };
        let states: Vec<Option<GoalId>> = kept.keys().skip(1).copied().chain([None]).collect();
        let fit = |i: usize| states[i].and_then(|g| fits.get(&g)).map_or(0.0, |f| f.max(UNLIKELY).ln());
        self.sequence.update(seen, step, fit);
    }

    /// Minds change with time: back to the prior, and from a reached goal to another one.
    fn change_minds(&mut self, passed: Span) {
        let same = (-TEMPER_PER_S * passed.as_secs_f64()).exp();
        let keeps = self.keeps(None, passed);
        let kept: Vec<f64> = self.goals.keys().map(|g| self.keeps(Some(*g), passed)).collect();
        let mut free = self.elsewhere * (1.0 - keeps);
        self.elsewhere *= keeps;
        for (p, kept) in self.goals.values_mut().zip(kept) {
            let sum: f64 = p.iter().sum();
            for (q, share) in p.iter_mut().zip(self.model.beta_shares) {
                *q = kept * (same * *q + (1.0 - same) * share * sum);
            }
            free += (1.0 - kept) * sum;
        }
        self.decide_anew(free);
    }

    /// Distributes a share of probability as if nothing had been observed yet.
    fn decide_anew(&mut self, free: f64) {
        let prior = self.prior();
        let total: f64 = prior.values().sum();
        let known = if prior.is_empty() { 0.0 } else { 1.0 - self.model.elsewhere };
        self.elsewhere += free * (1.0 - known);
        for (goal, p) in &mut self.goals {
            let share = free * known * prior[goal] / total;
            p.iter_mut().zip(self.model.beta_shares).for_each(|(q, b)| *q += share * b);
        }
    }

    /// Weighs a step of `step` metres; `ways` gives how far each goal was before and is now. Gives the step's
    /// likelihood for each goal, relative to a step in a random direction.
    fn weigh(&mut self, step: f64, ways: impl Fn(GoalId) -> Option<(f64, f64)>) -> BTreeMap<GoalId, f64> {
        let (before, mut fits) = (self.degrees(), BTreeMap::new());
        for (goal, p) in &mut self.goals {
            // The distance is unknown: neither for nor against the goal.
            let Some((then, now)) = ways(*goal) else { continue };
            let detour = (step + now - then).clamp(0.0, 2.0 * step);
            let sum: f64 = p.iter().sum();
            for (q, beta) in p.iter_mut().zip(self.model.betas_per_m) {
                *q *= (-beta * detour).exp() / bessel0e(beta * step);
            }
            fits.insert(*goal, p.iter().sum::<f64>() / sum);
        }
        self.temper(before);
        fits
    }

    /// Probabilities of the degrees of resoluteness over all goals.
    fn degrees(&self) -> [f64; DEGREES] {
        let mut sums = [0.0; DEGREES];
        for p in self.goals.values() {
            sums.iter_mut().zip(p).for_each(|(sum, q)| *sum += q);
        }
        sums
    }

    /// Takes back what a step said about resoluteness, except [`EVIDENCE`] of it. Neither the sum over all goals nor
    /// the comparison of the goals within one degree changes.
    fn temper(&mut self, before: [f64; DEGREES]) {
        let after = self.degrees();
        let share = |i: usize| if after[i] > 0.0 { (before[i] / after[i]).powf(1.0 - EVIDENCE) } else { 0.0 };
        let factors: [f64; DEGREES] = std::array::from_fn(share);
        let tempered: f64 = factors.iter().zip(after).map(|(f, a)| f * a).sum();
        if tempered <= 0.0 {
            return;
        }
        let whole = after.iter().sum::<f64>() / tempered;
        for p in self.goals.values_mut() {
            p.iter_mut().zip(factors).for_each(|(q, f)| *q *= f * whole);
        }
    }

    /// Updates the factors from the present course.
    fn look(&mut self, speed: f64, course: f64, towards: impl Fn(GoalId) -> Option<f64>) {
        let kappa = self.model.kappa * speed.min(1.0);
        self.course.clear();
        for goal in self.goals.keys() {
            if let Some(direction) = towards(*goal) {
                let cos = turn_between(course, direction).cos();
                self.course.insert(*goal, (kappa * (cos - 1.0)).exp() / bessel0e(kappa));
            }
        }
    }

    fn normalise(&mut self) {
        let total: f64 = self.goals.values().flatten().sum::<f64>() + self.elsewhere;
        assert!(total > 0.0 && total.is_finite(), "beliefs have a sum: {total}");
        self.goals.values_mut().flatten().for_each(|p| *p = (*p / total).max(UNLIKELY));
        self.elsewhere = (self.elsewhere / total).max(UNLIKELY);
    }
}

/// exp(−x) I₀(x) for x ≥ 0: the normaliser of von Mises (Abramowitz and Stegun, 9.8.1 and 9.8.2).
fn bessel0e(x: f64) -> f64 {
    const SMALL: [f64; 7] =
        [1.0, 3.515_622_9, 3.089_942_4, 1.206_749_2, 0.265_973_2, 0.036_076_8, 0.004_581_3];
    const LARGE: [f64; 9] = [
        0.398_942_28,
        0.013_285_92,
        0.002_253_19,
        -0.001_575_65,
        0.009_162_81,
        -0.020_577_06,
        0.026_355_37,
        -0.016_476_33,
        0.003_923_77,
    ];
    let series = |c: &[f64], t: f64| c.iter().rev().fold(0.0, |sum, k| sum * t + k);
    if x < 3.75 {
        series(&SMALL, (x / 3.75).powi(2)) * (-x).exp()
    } else {
        series(&LARGE, 3.75 / x) / x.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_people_go_next_does_not_outweigh_the_workers_own_task_for_good() {
        let place =
            |x_m: f64, next: [f64; 3]| DetourPlace { x_m, y_m: 0.0, dwell_s: 1.0, next: next.to_vec() };
        let places =
            vec![place(0.0, [0.0, 0.5, 0.5]), place(9.0, [0.5, 0.0, 0.5]), place(-9.0, [0.5, 0.5, 0.0])];
        let model = Arc::new(PurposeModel { places, ..PurposeModel::default() });
        let mut person = Detour::new(model, MotionModel::default());
        let mut distances = Distances::in_the_open();
        for (g, x, weight) in [(0, 0.0, 1.0), (1, 9.0, 1.0), (2, -9.0, 6.0)] {
            person.add_goal(GoalId(g), weight);
            distances.add_goal(GoalId(g), Point::new(x, 0.0));
        }
        // Standing at the first goal: minds change to the next one, the person's own task first.
        for k in 0..200 {
            person.observe(Time(k * 500_000), Point::new(0.0, 0.0), &distances);
        }
        let belief = person.belief();
        assert!(belief.of(GoalId(0)) < 0.1, "nobody goes where they are: {belief:?}");
        assert!(belief.of(GoalId(2)) > 4.0 * belief.of(GoalId(1)), "{belief:?}");
    }

    #[test]
    fn a_step_says_less_about_resoluteness_than_about_the_goal() {
        let mut person = Detour::new(Arc::new(PurposeModel::default()), MotionModel::default());
        (0..2).for_each(|g| person.add_goal(GoalId(g), 1.0));
        let before = person.degrees();
        // Straight at the first goal, straight away from the second.
        person.weigh(0.4, |g| Some(if g == GoalId(0) { (5.0, 4.6) } else { (5.0, 5.4) }));
        let after = person.degrees();
        let model = &person.model;
        let says = |i: usize| {
            let (beta, whole) = (model.betas_per_m[i] * 0.4, bessel0e(model.betas_per_m[i] * 0.4));
            (1.0 + (-2.0 * beta).exp()) / whole
        };
        let odds = |p: [f64; DEGREES]| p[DEGREES - 1] / p[0];
        let (said, taken) = (says(DEGREES - 1) / says(0), odds(after) / odds(before));
        assert!(said > 1.1 && (taken / said.powf(EVIDENCE) - 1.0).abs() < 1e-9, "{said} {taken}");
        let goals = |i: usize| person.goals[&GoalId(1)][i] / person.goals[&GoalId(0)][i];
        let expected = (-0.8 * model.betas_per_m[3]).exp();
        assert!((goals(3) / expected - 1.0).abs() < 1e-9, "{}", goals(3));
    }

    #[test]
    fn directions_under_von_mises_sum_to_one() {
        for x in [0.0, 0.3, 2.0, 3.7, 3.8, 9.0, 40.0] {
            let cells = 20_000;
            let angle = |i: i32| std::f64::consts::TAU * f64::from(i) / f64::from(cells);
            let sum: f64 = (0..cells).map(|i| (x * (angle(i).cos() - 1.0)).exp()).sum();
            assert!((sum / f64::from(cells) / bessel0e(x) - 1.0).abs() < 1e-6, "{x}");
        }
    }
}
