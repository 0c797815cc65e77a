//! Our recogniser: whoever walks to a goal makes no detours on the way.
//!
//! Main type: [`Detour`]. A goal loses probability with every metre of detour that it would mean; between updates the
//! person may change its mind at a rate per time, not per message. The idea that people minimise the way that is left
//! is that of the published method; likelihood and rates follow Ziebart et al. 2009 and Fisac et al. 2018. What is
//! added here is *elsewhere*: who makes more than half a metre of detour a metre for every goal is bound for none.
//! Refuses: an undecided state; an undecided posterior is flat, and its entropy says so.

use super::Belief;
use crate::geometry::{Point, turn_between};
use crate::human::Distances;
use crate::id::GoalId;
use crate::time::Time;
use std::collections::BTreeMap;

/// Loss of log-probability per metre of detour.
const BETA_PER_M: f64 = 4.0;
/// Gain of log-probability per 0.4 s for facing the way to the goal, at a metre a second.
const KAPPA: f64 = 0.6;
/// To keep one's mind for 0.4 s.
const STAY: f64 = 0.97;
/// The interval of [`KAPPA`] and [`STAY`], seconds.
const BEAT_S: f64 = 0.4;
/// Who is bound elsewhere walks as if every goal lay 60° beside the way: half a metre of detour a metre.
const ASIDE: f64 = 0.5;
/// Prior probability of elsewhere.
const ELSEWHERE: f64 = 0.05;
/// An update every so many metres …
const GATE_M: f64 = 0.25;
/// … or so many seconds.
const GATE_S: f64 = 1.0;
/// A step shorter than so many standard deviations of a position may be none.
const NOISE: f64 = 4.0;
/// Whoever makes no such step for so many seconds stands.
const PAUSE_S: f64 = 3.0;

/// One person's recogniser.
#[derive(Clone, Debug, Default)]
pub(super) struct Detour {
    /// Goals with their prior weights.
    weights: BTreeMap<GoalId, f64>,
    goals: BTreeMap<GoalId, f64>,
    elsewhere: f64,
    last: Option<(Time, Point)>,
    /// One standard deviation of positions, metres.
    sigma_m: f64,
}

impl Detour {
    pub fn add_goal(&mut self, goal: GoalId, weight: f64) {
        if self.weights.insert(goal, weight.max(1e-6)).is_none() {
            self.goals.insert(goal, 0.0);
        }
        let fresh = self.last.is_none();
        let prior = self.prior();
        if fresh {
            (self.goals, self.elsewhere) = (prior, ELSEWHERE);
        } else {
            // A new goal takes its prior share from all others.
            let share = prior[&goal];
            self.goals.values_mut().for_each(|p| *p *= 1.0 - share);
            self.elsewhere *= 1.0 - share;
            self.goals.insert(goal, share);
        }
        self.normalise();
    }

    pub fn remove_goal(&mut self, goal: GoalId) {
        self.weights.remove(&goal);
        self.elsewhere += self.goals.remove(&goal).unwrap_or(0.0);
        self.normalise();
    }

    pub fn expect_error(&mut self, sigma_m: f64) {
        self.sigma_m = sigma_m;
    }

    pub fn belief(&self) -> Belief {
        let goals = self.goals.iter().map(|(g, p)| (*g, *p)).collect();
        Belief { goals, undecided: 0.0, elsewhere: self.elsewhere }
    }

    fn prior(&self) -> BTreeMap<GoalId, f64> {
        let total: f64 = self.weights.values().sum();
        self.weights.iter().map(|(g, w)| (*g, w / total * (1.0 - ELSEWHERE))).collect()
    }

    pub fn observe(&mut self, seen: Time, at: Point, heading: Option<f64>, distances: &Distances) {
        let Some((before, from)) = self.last else {
            self.last = Some((seen, at));
            return;
        };
        let (step, passed) = ((at - from).norm(), (seen - before).as_secs_f64());
        if passed <= 0.0 || (step < GATE_M && passed < GATE_S) {
            return;
        }
        if step < NOISE * self.sigma_m {
            // As likely the source's error as a step of the person: time passes, and nothing is learnt.
            if passed >= PAUSE_S {
                self.last = Some((seen, at));
                self.forget(passed);
            }
            return;
        }
        self.last = Some((seen, at));
        self.forget(passed);
        self.weigh(step, passed, distances, [from, at], heading);
        self.normalise();
    }

    /// Minds change: with time all belief goes back to the prior.
    fn forget(&mut self, passed: f64) {
        let stay = STAY.powf(passed / BEAT_S);
        let prior = self.prior();
        for (goal, p) in &mut self.goals {
            *p = stay * *p + (1.0 - stay) * prior[goal];
        }
        self.elsewhere = stay * self.elsewhere + (1.0 - stay) * ELSEWHERE;
    }

    /// Both ends of the step are measured on the floor as it is now, so that a robot that closes a way between two
    /// looks is no detour of the person's.
    fn weigh(
        &mut self,
        step: f64,
        passed: f64,
        distances: &Distances,
        ends: [Point; 2],
        heading: Option<f64>,
    ) {
        let [from, to] = ends.map(|p| distances.from(p));
        let pace = (step / passed).min(1.0);
        let facing_weight = heading.map_or(0.0, |_| KAPPA * pace * (passed / BEAT_S).min(1.0));
        let nowhere = -BETA_PER_M * step * ASIDE + facing_weight * ASIDE;
        for (goal, p) in &mut self.goals {
            let detour = match (from.to_goal(*goal), to.to_goal(*goal)) {
                (Some(then), Some(now)) => (step + now - then).clamp(0.0, 2.0 * step),
                // Nobody can say how far it is: neither for nor against more than walking beside it.
                _ => step,
            };
            let facing = heading.and_then(|h| Some(turn_between(h, to.towards(*goal)?).cos()));
            *p *= (-BETA_PER_M * detour + facing_weight * facing.unwrap_or(0.0)).exp();
        }
        self.elsewhere *= nowhere.exp();
    }

    fn normalise(&mut self) {
        let total: f64 = self.goals.values().sum::<f64>() + self.elsewhere;
        if total > 0.0 {
            self.goals.values_mut().for_each(|p| *p /= total);
            self.elsewhere /= total;
        } else {
            // All weights have sunk below what numbers can hold: start anew.
            (self.goals, self.elsewhere) =
                (self.prior(), if self.goals.is_empty() { 1.0 } else { ELSEWHERE });
        }
    }
}
