//! What is reported of a belief: a credible set, or the goals by the published thresholds.
//!
//! Main type: [`Credible`]; main function: [`reported_goals`]. Refuses: thresholds that report less as more is known.

use super::{Belief, IntentState};
use giveway_floor::id::GoalId;

/// The smallest set of hypotheses that holds a given probability.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Credible {
    /// Goals of the set, the most probable first.
    pub goals: Vec<GoalId>,
    /// Whether *undecided* or *elsewhere* is in the set: then none of the goals may be the right one.
    pub open: bool,
}

impl Belief {
    /// The sum of all probabilities: one, up to rounding.
    pub fn sum(&self) -> f64 {
        self.goals.iter().map(|g| g.1).sum::<f64>() + self.undecided + self.elsewhere
    }

    /// The probability of a goal; zero if it is unknown.
    pub fn of(&self, goal: GoalId) -> f64 {
        self.goals.iter().find(|g| g.0 == goal).map_or(0.0, |g| g.1)
    }

    /// The most probable hypothesis; the first of equals.
    pub fn top(&self) -> IntentState {
        let all = self.all();
        all.into_iter().reduce(|a, b| if b.1 > a.1 { b } else { a }).map_or(IntentState::Elsewhere, |s| s.0)
    }

    /// Normalised entropy of the belief, from 0 (sure) to 1 (all hypotheses alike).
    pub fn entropy(&self) -> f64 {
        let all = self.all();
        let nats: f64 = all.iter().filter(|s| s.1 > 0.0).map(|s| -s.1 * s.1.ln()).sum();
        nats / (all.len().max(2) as f64).ln()
    }

    fn all(&self) -> Vec<(IntentState, f64)> {
        let goals = self.goals.iter().map(|g| (IntentState::Goal(g.0), g.1));
        goals
            .chain([(IntentState::Undecided, self.undecided), (IntentState::Elsewhere, self.elsewhere)])
            .collect()
    }

    /// The smallest set of hypotheses that together have this probability.
    pub fn credible(&self, probability: f64) -> Credible {
        let mut all = self.all();
        all.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let (mut set, mut sum) = (Credible { goals: Vec::new(), open: false }, 0.0);
        for (state, p) in all {
            if sum >= probability || p <= 0.0 {
                break;
            }
            sum += p;
            match state {
                IntentState::Goal(g) => set.goals.push(g),
                IntentState::Undecided | IntentState::Elsewhere => set.open = true,
            }
        }
        set
    }
}

/// The goals that chapter 4 reports to the planner: the end of the person's own path as long as it is nearly as
/// probable as the best, else all goals that are not much less probable than chance (Petković 2021, section 4.3.2, for
/// g + 1 states). The printed threshold 0.25 g would be one for four goals, and no other goal would ever be reported;
/// 0.25/g is meant.
pub fn reported_goals(belief: &Belief, path_end: GoalId) -> Vec<GoalId> {
    let g = belief.goals.len().saturating_sub(1).max(1) as f64;
    let best = belief.goals.iter().map(|x| x.1).fold(0.0, f64::max);
    if best - belief.of(path_end) < 0.25 / g {
        return vec![path_end];
    }
    belief.goals.iter().filter(|x| x.1 > 0.8 / g).map(|x| x.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn belief(goals: &[f64], elsewhere: f64) -> Belief {
        let goals = goals.iter().enumerate().map(|(i, p)| (GoalId(i as u64), *p)).collect();
        Belief { goals, undecided: 0.0, elsewhere }
    }

    #[test]
    fn a_credible_set_is_no_larger_than_it_must_be() {
        let b = belief(&[0.1, 0.7, 0.16], 0.04);
        assert_eq!(b.credible(0.95), Credible { goals: vec![GoalId(1), GoalId(2), GoalId(0)], open: false });
        assert_eq!(b.credible(0.5), Credible { goals: vec![GoalId(1)], open: false });
        assert!(b.credible(0.99).open);
        assert_eq!(
            (b.top(), belief(&[0.3], 0.7).top()),
            (IntentState::Goal(GoalId(1)), IntentState::Elsewhere)
        );
        assert!(belief(&[1.0], 0.0).entropy() < 1e-12 && b.entropy() > 0.5);
    }

    #[test]
    fn the_end_of_the_path_is_reported_until_another_goal_stands_out() {
        // Four goals and the end of the path (the last): the difference must be below 0.0625.
        let close = belief(&[0.24, 0.2, 0.18, 0.18, 0.2], 0.0);
        assert_eq!(reported_goals(&close, GoalId(4)), [GoalId(4)]);
        let far = belief(&[0.4, 0.25, 0.1, 0.05, 0.2], 0.0);
        assert_eq!(reported_goals(&far, GoalId(4)), [GoalId(0), GoalId(1)]);
    }
}
